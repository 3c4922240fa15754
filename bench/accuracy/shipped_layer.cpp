#include "bench/accuracy/shipped_layer.hpp"

#include "core/groom/layer_params.hpp"
#include "core/modal/modal_material.hpp"

namespace pelt::accuracy {
namespace {

constexpr double kDefaultLength_m = 0.03;  // LayerSetup's, as a test holds it

}  // namespace

Preset DefaultLayer(int links) {
  const LayerParams params;
  const double frequency =
      FrequencyOfHardness(uint32_t(links), double(params.angular_hardness_middle),
                          double(params.angular_hardness_end), params.iterations);
  return {kDefaultLayer, kDefaultLength_m, frequency, double(params.velocity_damping),
          double(params.damping_ratio)};
}

std::vector<Preset> ShippedPresets(std::vector<Preset> presets, int links) {
  presets.push_back(DefaultLayer(links));
  return presets;
}

std::vector<ShippedRow> MeasureShipped(const Suite& suite, const std::vector<int>& rates, Isa isa) {
  std::vector<ShippedRow> rows;
  for (const char* name : {"modal-fine", "modal", "modal-best"})
    for (size_t preset = 0; preset < suite.options.presets.size(); ++preset)
      for (const bool velocities : {false, true}) {
        ShippedRow row{preset, *FindSolver(name), {}};
        row.solver.velocities = velocities;
        const SolverFactory factory = FactoryOf(row.solver, isa);
        for (const int rate : rates)
          row.scores.push_back(ScoreSolver(suite, preset, factory, rate));
        rows.push_back(std::move(row));
      }
  return rows;
}

}  // namespace pelt::accuracy
