// Going back: what a frame takes over from the one before is all in a snapshot.
//
// A scene runs, is taken as bytes at a random place, runs on, gets the bytes back and runs on from
// there again, under every executor: the frames must have the bits of a scene that never went back.
// Every second time a pause comes first, which has to show the frame before. The scene itself is put
// back, so anything that a stage, the scene or an executor kept of the frames in between shows, and the
// first stage is named whose values differ.
//
// What breaks if ignored: rollback netcode drifts apart, and recordings that begin with a snapshot
// replay otherwise.
#include <fmt/format.h>

#include <algorithm>

#include "bench/verify/checks.hpp"
#include "bench/verify/frame_digests.hpp"
#include "core/random.hpp"

namespace pelt {
namespace {

constexpr uint32_t kPlaces = 4;  // for each executor

class RollbackCheck {
 public:
  RollbackCheck(Scenario& scenario, const VerifyOptions& options, Settings settings)
      : scenario_(scenario),
        options_(options),
        settings_(settings),
        straight_(scenario, {.isa = BestIsa()}, FrameSettingsOf(settings, scenario), {}) {}

  CheckResult Run(const ExecutorEntry& entry, uint64_t seed) {
    VerifyCase what{.executor = entry, .isa = BestIsa(), .settings = settings_};
    if (entry.HasWorkers()) what.workers = 3;
    CheckResult result;
    result.section = "rollback";
    result.name = fmt::format("{}, {}, {} frames back", entry.name, SettingsName(settings_),
                              options_.rollback);
    CaseRun run(scenario_, what, FrameSettingsOf(settings_, scenario_), options_.tamper);
    Random random(seed);
    uint32_t next = 0;
    for (uint32_t place = 0; place < kPlaces && result.passed; ++place) {
      const uint32_t at = next + random.Below(options_.frames / kPlaces + 1);
      for (; next < at; ++next) run.RunFrame(next);
      GoBack(run, what, at, place % 2 == 1 && at > 0, result);
      next = at + options_.rollback;
    }
    return result;
  }

 private:
  const StreamDigests& Expected(uint32_t frame) {
    while (course_.size() <= frame) {
      straight_.RunFrame(uint32_t(course_.size()));
      course_.push_back(DigestsOf(straight_.scene()));
    }
    return course_[frame];
  }
  bool IsSame(CaseRun& run, uint32_t frame) {
    return SameDigests(Expected(frame), DigestsOf(run.scene()), {.bookkeeping = false});
  }

  // A pause, seen from where the frame was.
  static void ShowAgain(CaseRun& run, uint32_t frame) {
    run.RunFrame(frame, [](FrameInput& input, FurScene&) { input.dt_s = 0.0; });
  }

  // On to `at + rollback`, and back.
  void TurnBack(CaseRun& run, uint32_t at) {
    bytes_.resize(run.scene().SnapshotBytes());
    const char* fault = run.scene().Snapshot(bytes_);
    for (uint32_t f = at; f < at + options_.rollback; ++f) run.RunFrame(f);
    if (!fault) fault = run.scene().Restore(bytes_);
    if (fault) throw Error(fmt::format("rollback at frame {}: {}", at, fault));
  }

  void GoBack(CaseRun& run, const VerifyCase& what, uint32_t at, bool pause, CheckResult& result) {
    TurnBack(run, at);
    if (pause) {
      ShowAgain(run, at - 1);
      ++result.seen;
      if (!IsSame(run, at - 1)) return Fail(what, at, at - 1, true, result);
    }
    for (uint32_t f = at; f < at + options_.rollback; ++f) {
      run.RunFrame(f);
      ++result.seen;
      if (!IsSame(run, f)) return Fail(what, at, f, pause, result);
    }
  }

  // Once more, beside a scene that goes straight: stage by stage.
  void Fail(const VerifyCase& what, uint32_t at, uint32_t frame, bool pause, CheckResult& result) {
    const FrameSettings settings = FrameSettingsOf(settings_, scenario_);
    CaseRun straight(scenario_, {.isa = BestIsa()}, settings, {});
    CaseRun back(scenario_, what, settings, options_.tamper);
    for (uint32_t f = 0; f < at; ++f) {
      straight.RunFrame(f);
      back.RunFrame(f);
    }
    TurnBack(back, at);
    std::optional<Mismatch> mismatch;
    if (pause) {
      ShowAgain(back, at - 1);
      mismatch = FindMismatch(straight, back, at - 1);
    }
    for (uint32_t f = at; f <= frame && !mismatch; ++f) {
      straight.RunFrame(f);
      back.RunFrame(f);
      mismatch = FindMismatch(straight, back, f);
    }
    if (!mismatch) {
      mismatch.emplace();
      mismatch->frame = frame;
      mismatch->reproduced = false;
    }
    result.Fail(FindingKind::kRollback, *mismatch);
    result.reason =
        fmt::format("back from frame {} to {}: ", at + options_.rollback, at) + result.reason;
  }

  Scenario& scenario_;
  const VerifyOptions& options_;
  Settings settings_;
  CaseRun straight_;
  Course course_;
  std::vector<std::byte> bytes_;
};

}  // namespace

void CheckRollback(Scenario& scenario, const VerifyOptions& options, VerifyReport& report) {
  if (options.rollback == 0) return;
  uint64_t seed = 0;
  for (const Settings settings : {Settings::kSkips, Settings::kLod}) {
    RollbackCheck check(scenario, options, settings);
    for (const ExecutorEntry& entry : ExecutorEntries())
      if (entry.IsAvailable()) report.checks.push_back(check.Run(entry, ++seed));
  }
}

}  // namespace pelt
