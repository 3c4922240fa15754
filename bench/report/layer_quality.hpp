// The quality that each layer's strands were simulated in, frame by frame, and how wrong that may look: the scene
// chooses it for what is seen (core/modal/quality_on_screen.hpp), and what a frame costs is the price of that choice.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/report/report_tree.hpp"
#include "jobs/scene.hpp"

namespace pelt {

struct LayerQuality {
  std::string name;
  uint32_t character = 0;
  std::string_view solver,
      asked;  // as in a setup; asked: quality, empty of other solvers than modal
  std::array<uint32_t, 3> frames{};  // by quality
  uint32_t chain_level = 0;          // coarsest of a frame
  float error_px = 0.0f;             // largest bound of a frame
};

// Of each layer of the scene; no frame counted.
std::vector<LayerQuality> QualitiesOf(const FurScene& scene, std::span<const Groom* const> grooms);
// After a frame.
void AddFrame(const FurScene& scene, std::vector<LayerQuality>& layers);

// "layer_quality"; in text layers that are alike are one row.
void AddLayerQuality(const std::vector<LayerQuality>& layers, ReportTree& tree);

}  // namespace pelt
