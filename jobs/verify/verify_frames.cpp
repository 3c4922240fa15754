#include "jobs/verify/verify_frames.hpp"

#include "core/format.hpp"
#include "jobs/verify/guarded_executor.hpp"
#include "jobs/verify/mismatch.hpp"
#include "traces/digest.hpp"

namespace pelt {
namespace {

// Both in step, the one serially: where they part, or nothing.
std::optional<Mismatch> FindParting(const std::function<NextFrame()>& make, uint32_t frames,
                                    Executor& executor) {
  SerialExecutor serial;
  const NextFrame next_expected = make(), next_found = make();
  for (uint32_t f = 0; f < frames; ++f) {
    const Frame expected = next_expected(), found = next_found();
    serial.Run(expected);
    executor.Run(found);
    if (DigestFrame(*expected.memory) == DigestFrame(*found.memory)) continue;
    std::optional<Mismatch> mismatch = FindMismatch(expected, found);
    if (!mismatch) mismatch.emplace();  // of a stream that no stage writes
    mismatch->frame = f;
    return mismatch;
  }
  return std::nullopt;
}

bool SamePlace(const Mismatch& a, const Mismatch& b) {
  return a.frame == b.frame && a.stage == b.stage && a.item == b.item && a.found == b.found;
}

}  // namespace

std::vector<Finding> VerifyFrames(const std::function<NextFrame()>& make, uint32_t frames,
                                  std::span<Executor* const> executors) {
  std::vector<Finding> findings;
  const auto find = [&](FindingKind kind, const std::string& who, const Mismatch& where) {
    findings.push_back(
        {kind, where.stage, where.stream, Format("{}: {}", who, DescribeMismatch(where))});
  };
  SerialExecutor serial;
  const std::optional<Mismatch> never_same = FindParting(make, frames, serial);
  if (never_same) find(FindingKind::kHiddenState, "run again", *never_same);
  if (GuardedExecutor::IsAvailable()) {
    GuardedExecutor guarded;
    const NextFrame next = make();
    for (uint32_t f = 0; f < frames; ++f) guarded.Run(next());
    findings.insert(findings.end(), guarded.findings().begin(), guarded.findings().end());
  }
  // Compared with a reference that differs every time, they would all be found at fault.
  for (size_t e = 0; e < executors.size() && !never_same; ++e) {
    const std::optional<Mismatch> first = FindParting(make, frames, *executors[e]);
    if (!first) continue;
    const std::optional<Mismatch> again = FindParting(make, frames, *executors[e]);
    const bool same = again && SamePlace(*first, *again);
    find(same ? FindingKind::kOrder : FindingKind::kRace, Format("executors[{}]", e), *first);
  }
  return findings;
}

std::string DescribeFinding(const Finding& finding) {
  return Format("{}: {}", FindingName(finding.kind), finding.text);
}

}  // namespace pelt
