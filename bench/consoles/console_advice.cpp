#include "bench/consoles/console_advice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "bench/report/timeline.hpp"

namespace pelt {
namespace {

// Strand budgets are looked for to within a 64th of the scene's strands.
constexpr uint32_t kSteps = 64;

using Trial = ConsoleRun::Trial;
using LodTrial = ConsoleRun::LodTrial;

// A strand budget in kSteps-ths of `most`, found on few frames and then held against all of them,
// less by an eighth as long as they do not fit; `found` is of those.
uint32_t FindSteps(ConsoleRun& run, uint64_t most, double target_ms, LodTrial& found) {
  LodSettings lod = run.request().lod;
  const auto fits_with = [&](uint32_t steps, Trial trial) {
    lod.strand_budget = uint32_t(most * steps / kSteps);
    if (lod.strand_budget == 0) return false;  // would be no budget
    found = run.TryLod(lod, trial);
    return found.ms <= target_ms;
  };
  uint32_t fits = 0, over = kSteps;
  while (over - fits > 1) {
    const uint32_t step = (fits + over) / 2;
    (fits_with(step, Trial::kFewFrames) ? fits : over) = step;
  }
  while (fits > 0 && !fits_with(fits, Trial::kAllFrames)) fits -= std::max(1u, fits / 8);
  return fits;
}

// Whether LOD alone is enough; if not, the strand budget that is.
std::string AdviseLod(ConsoleRun& run, const ConsoleBudget& budget, double target_ms) {
  const LodSettings& lod = run.request().lod;
  const bool has_lod = run.request().skip.lod;
  LodTrial found;
  if (!has_lod) {
    found = run.TryLod(lod, Trial::kAllFrames);
    if (found.ms <= target_ms)
      return fmt::format("LOD: with --lod it takes {:.2f} ms, {} of {} strands live", found.ms,
                         found.live_strands, budget.strands);
  }
  const uint64_t most = has_lod && lod.strand_budget ? lod.strand_budget : budget.strands;
  const uint32_t fits = FindSteps(run, most, target_ms, found);
  if (fits == 0)
    return fmt::format(
        "strands: not even a budget of {} is enough: what is left (chains at vertices, whole "
        "blocks, poses) does not depend on strands",
        most / kSteps);
  return fmt::format(
      "strands: with --lod --strand-budget {} it takes {:.2f} ms, {} of {} strands live",
      most * fits / kSteps, found.ms, found.live_strands, budget.strands);
}

// What one item costs beside its work shrinks with larger chunks, until two of them no longer fit.
std::string AdviseChunks(const ConsoleRun& run, const ConsoleBudget& budget) {
  const FrameSummary& s = budget.summary;
  const double overhead_ms =
      s.unit_ms[size_t(UnitWork::kDispatch)] + s.unit_ms[size_t(UnitWork::kCommands)];
  std::string out = fmt::format(
      "chunks: drawing items and giving transfers takes {:.2f} ms at {} strands per chunk; twice "
      "that size would save at most half of it",
      overhead_ms, kStrandsPerChunk);
  const Plan& plan = run.scene().plan();
  for (uint32_t p = 0; p < budget.stores.size(); ++p) {
    const PassStore& store = budget.stores[p];
    if (!IsInLayer(plan.passes[p].domain) || store.buffer_sets != 2) continue;
    const uint64_t more = store.buffer_bytes * store.buffer_sets;
    if (more <= store.free_bytes) continue;
    return out + fmt::format(", but {} would lack {} bytes of local store for two buffers",
                             PassName(plan, p), more - store.free_bytes);
  }
  return out;
}

std::string AdviseLimits(const ConsoleRun& run, const ConsoleBudget& budget) {
  const FrameSummary& s = budget.summary;
  std::array<double, kPassLimitCount> gain{};
  uint32_t longest = 0;
  for (uint32_t p = 0; p < s.passes.size(); ++p) {
    for (uint32_t l = 0; l < kPassLimitCount; ++l)
      gain[l] += std::max(0.0, s.passes[p].GainMs(PassLimit(l)));
    if (s.passes[p].ms > s.passes[longest].ms) longest = p;
  }
  std::string out = "what binds: free";
  for (uint32_t l = 0; l < kPassLimitCount; ++l)
    out += fmt::format("{} {} would save {:.2f} ms", l ? "," : "", PassLimitName(PassLimit(l)),
                       gain[l]);
  return out + fmt::format("; the longest is {}, {:.2f} ms, bound by {}",
                           PassName(run.scene().plan(), longest), s.passes[longest].ms,
                           PassLimitName(s.passes[longest].binds));
}

}  // namespace

std::vector<std::string> Advise(ConsoleRun& run, const ConsoleBudget& budget, double target_ms) {
  if (budget.Fits(target_ms)) return {};
  std::vector<std::string> lines = {AdviseLod(run, budget, target_ms)};
  lines.push_back(AdviseChunks(run, budget));
  lines.push_back(AdviseLimits(run, budget));
  return lines;
}

}  // namespace pelt
