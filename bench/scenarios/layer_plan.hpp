// How the layers of a scene are simulated, as a file: `pelt fit --out` writes it, `--plan` reads it.
//
//   [[layer]]
//   character = 0          # of the scene
//   name = "head under"    # the setup's
//   solver = "modal"
//   quality = "fine"       # and curl_follows: of the modal solver, not given: the layer's own
//   chain_share = 0.5      # of its chains at mesh vertices that are simulated
//   strand_share = 0.75    # of its strands, as if it had been baked with fewer
//
// Layers that the file does not name stay as they are.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/groom/groom.hpp"

namespace pelt {

struct Scenario;

// What is not given stays as it is.
struct SimulationChoice {
  std::optional<Solver> solver;
  std::optional<ModalQuality> quality;
  std::optional<CurlFollows> curl_follows;
  std::optional<float> chain_share = {};
  std::optional<float> strand_share = {};  // above 0
  friend bool operator==(const SimulationChoice&, const SimulationChoice&) = default;
};

struct LayerChoice {
  uint32_t character = 0;
  std::string name;
  SimulationChoice choice;
  uint32_t line = 0;  // of the file, for messages
};

// Throw Error with the file's line: of a file that is none, of what is not in the scene, of a solver that
// a layer cannot have.
std::vector<LayerChoice> ReadLayerPlan(const std::string& path);
void ApplyLayerPlan(std::span<const LayerChoice> plan, const std::string& path, Scenario& scenario);
std::string LayerPlanText(std::span<const LayerChoice> plan);

// Why the layer cannot have it, and then nothing has changed.
std::optional<BadKey> ChangeSimulation(Groom& groom, size_t layer, const SimulationChoice& choice);

}  // namespace pelt
