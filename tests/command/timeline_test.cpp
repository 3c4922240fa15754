// Recorded frames as a timeline and a trace: the right slices on the right tracks, arrows along
// what the ports say, and nothing before what it needs.
#include "bench/report/timeline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>

#include "bench/report/run_report.hpp"
#include "jobs/tick_clock.hpp"
#include "tests/traces/trace_checker.hpp"
#include "traces/chrome_trace.hpp"

namespace pelt::testing {
namespace {

constexpr uint32_t kFrames = 6, kFrom = 3;

struct RecordedRun {
  Scenario scenario = LoadScenario("tiny");
  RunningScenario running;
  std::vector<FrameRecord> records;
  TickScale scale;
  uint32_t workers;

  RecordedRun(ExecutorKind executor, uint32_t workers, const SceneOptions& options = {})
      : running(scenario, options), workers(workers) {
    RunOptions run;
    run.scene = options;
    run.executor = executor;
    run.workers = workers;
    run.frames = kFrames;
    run.observe_from_frame = kFrom;
    run.observe = [&](const FinishedFrame& f) {
      records.push_back(RecordFrame(f.scene, f.profile, f.frame, f.ticks));
    };
    RunFrames(scenario, running, run);
  }
  Timeline Build() { return BuildTimeline(running.scene(), records, workers, scale.NsPerTick()); }
};

struct Case {
  const char* name;
  ExecutorKind executor;
  uint32_t workers;
  bool fuse, pieces;
};
class TimelineOf : public ::testing::TestWithParam<Case> {
 protected:
  RecordedRun MakeRun() const {
    SceneOptions options;
    options.plan.fuse = GetParam().fuse;
    options.piecewise_sort_chunks = GetParam().pieces ? 1 : 0;
    return RecordedRun(GetParam().executor, GetParam().workers, options);
  }
};

bool StartsWith(const std::string& text, const std::string& head) {
  return text.rfind(head, 0) == 0;
}

TEST_P(TimelineOf, NestsFramesOverPassesOverItemsOverStages) {
  RecordedRun run = MakeRun();
  const CheckedTrace trace = TraceChecker::Check(ChromeTrace(run.Build()));
  EXPECT_EQ(trace.faults, std::vector<std::string>{});
  std::map<int, std::string> threads;
  for (uint32_t w = 0; w < GetParam().workers; ++w) threads[int(w) + 1] = WorkerName(w);
  EXPECT_EQ(trace.threads, threads);

  uint32_t frames = 0, runs = 0;
  for (const TraceSlice& slice : trace.slices) {
    const size_t above = slice.parents.size() + (slice.tid == 1 ? 0 : 1);  // others have no frame
    if (above == 0) {
      EXPECT_TRUE(StartsWith(slice.name, "frame ")) << slice.name;
      ++frames;
    } else if (above == 1) {
      EXPECT_TRUE(StartsWith(slice.name, "pass ") || slice.name == "poses and parameters")
          << slice.name;
    } else {
      ASSERT_LE(above, 3u) << slice.name;
      EXPECT_TRUE(StartsWith(slice.parents[slice.tid == 1 ? 1 : 0], "pass "));
      if (above == 3) ++runs;
    }
  }
  EXPECT_EQ(frames, kFrames - kFrom);
  uint32_t recorded = 0;
  for (const FrameRecord& record : run.records) {
    EXPECT_FALSE(record.runs.empty());
    // All of them are timed in every fourth frame, none in the others.
    for (const FrameRecord::StageRun& stage : record.runs) {
      EXPECT_EQ(stage.Ticks() != 0, record.frame % 4 == 1);
      recorded += stage.Ticks() != 0;
    }
  }
  EXPECT_EQ(runs, recorded);
  EXPECT_GT(runs, 100u);
}

TEST_P(TimelineOf, HasEveryItemThatRanOnceAndInItsPass) {
  RecordedRun run = MakeRun();
  const FurScene& scene = run.running.scene();
  for (const FrameRecord& record : run.records) {
    std::set<std::pair<uint32_t, uint32_t>> seen;
    for (const FrameRecord::Item& item : record.items) {
      EXPECT_TRUE(seen.emplace(item.pass, item.item).second);
      EXPECT_LT(item.worker, GetParam().workers);
      const Pass& pass = scene.plan().passes[item.pass];
      for (uint32_t r = item.first_run; r < item.first_run + item.run_count; ++r) {
        EXPECT_GE(record.runs[r].stage, pass.first_stage);
        EXPECT_LT(record.runs[r].stage, pass.first_stage + pass.stage_count);
        EXPECT_LE(item.begin_ticks, record.runs[r].begin_ticks);
        EXPECT_LE(record.runs[r].begin_ticks, record.runs[r].end_ticks);
        EXPECT_LE(record.runs[r].end_ticks, item.end_ticks);
      }
    }
    // What activates has no gate: it runs on every patch, and one of the two of chunks on each.
    uint32_t patches = 0, chunks = 0, followers = 0;
    for (const FrameRecord::StageRun& stage : record.runs) {
      const std::string_view name = scene.plan().stages[stage.stage].kernel.name;
      patches += name == "activate_patch";
      chunks += name == "activate";
      followers += name == "activate_followers";
    }
    EXPECT_EQ(patches, scene.shape().patch_count);
    EXPECT_EQ(chunks + followers, scene.shape().chunk_count);
    EXPECT_GT(chunks, 0u);
    EXPECT_GT(followers, 0u);
  }
}

// No item starts before those have ended that it waits for, as far as the clocks of two cores agree.
TEST_P(TimelineOf, NothingStartsBeforeWhatItWaitsFor) {
  RecordedRun run = MakeRun();
  const FurScene& scene = run.running.scene();
  const Plan& plan = scene.plan();
  const auto slack = uint64_t(1000.0 / run.scale.NsPerTick());
  uint64_t pairs = 0;
  for (const FrameRecord& record : run.records)
    for (const FrameRecord::Item& item : record.items)
      for (const Wait& wait : plan.passes[item.pass].waits) {
        if (wait.list != Stream::kNone) continue;
        const auto unit = [&](const FrameRecord::Item& i) {
          return PlaceOf(scene.shape(), plan.passes[i.pass].domain, i.item)
              .first[size_t(wait.within)];
        };
        for (const FrameRecord::Item& before : record.items) {
          if (before.pass != wait.pass || unit(before) != unit(item)) continue;
          ++pairs;
          EXPECT_LE(before.end_ticks, item.begin_ticks + slack);
        }
      }
  EXPECT_GT(pairs, 50u);
}

// An arrow leaves a pass that writes what it is named for, and reaches one that reads it.
TEST_P(TimelineOf, ArrowsGoFromItemToItemAndForward) {
  RecordedRun run = MakeRun();
  const CheckedTrace trace = TraceChecker::Check(ChromeTrace(run.Build()));
  EXPECT_GE(trace.flows.size(), run.records.size());
  for (const auto& [id, flow] : trace.flows) {
    EXPECT_LE(flow.leave_us, flow.reach_us) << flow.name;
    const auto is_pass = [](const std::string& n) { return StartsWith(n, "pass "); };
    for (const std::vector<std::string>& end : {flow.from, flow.to}) {
      EXPECT_EQ(std::count_if(end.begin(), end.end(), is_pass), 1) << flow.name;
      EXPECT_FALSE(is_pass(end.back())) << "an end is an item";
    }
  }
}

TEST_P(TimelineOf, CountsWhatMovedAndWhatLives) {
  RecordedRun run = MakeRun();
  const Timeline timeline = run.Build();
  ASSERT_EQ(timeline.counters.size(), 3u);
  for (const Timeline::Counter& counter : timeline.counters)
    EXPECT_GE(counter.samples.size(), run.records.size()) << counter.name;
  const FrameRecord& last = run.records.back();
  EXPECT_EQ(timeline.counters[0].samples.back().values,
            (std::vector<double>{double(last.live_strands), double(last.drawn_strands)}));
  EXPECT_GT(last.drawn_strands, 0u);
  // The passes of a frame sum to the frame.
  double frames_mb = 0.0, passes_mb = 0.0;
  for (const auto& sample : timeline.counters[1].samples) frames_mb += sample.values[0];
  for (const auto& sample : timeline.counters[2].samples) passes_mb += sample.values[0];
  EXPECT_GT(frames_mb, 0.0);
  EXPECT_NEAR(frames_mb, passes_mb, 1e-9 * frames_mb);
}

INSTANTIATE_TEST_SUITE_P(Executors, TimelineOf,
                         ::testing::Values(Case{"serial", "serial", 1, true, false},
                                           Case{"tbb3", "tbb", 3, true, false},
                                           Case{"tbb3_unfused", "tbb", 3, false, false},
                                           Case{"tbb3_pieces", "tbb", 3, true, true},
                                           Case{"permuted", "permuted", 1, true, false},
                                           Case{"pull3", "pull", 3, true, false},
                                           Case{"door3", "door", 3, true, false}),
                         [](const auto& info) { return std::string(info.param.name); });

// What ports say, against a list made by hand for the first passes of the frame.
TEST(Timeline, DependenciesFollowThePorts) {
  const RecordedRun run("serial", 1);
  const Plan& plan = run.running.scene().plan();
  const auto pass_of = [&](std::string_view stage) {
    for (uint32_t p = 0; p < plan.passes.size(); ++p)
      for (uint32_t s = 0; s < plan.passes[p].stage_count; ++s)
        if (plan.stages[plan.passes[p].first_stage + s].kernel.name == stage) return p;
    ADD_FAILURE() << "no stage " << stage;
    return 0u;
  };
  const std::vector<bool> all(plan.passes.size(), true);
  const auto found = FindDependencies(plan, all);
  const auto has = [&](const std::vector<PassDependency>& list, std::string_view from,
                       std::string_view to, Stream stream) {
    return std::any_of(list.begin(), list.end(), [&](const PassDependency& d) {
      return d.producer == pass_of(from) && d.consumer == pass_of(to) && d.stream == stream;
    });
  };
  EXPECT_TRUE(has(found, "joint_palette", "skin", StreamOf<&Streams::palette>));
  EXPECT_TRUE(has(found, "skin", "roots", StreamOf<&Streams::skinned>));
  EXPECT_TRUE(has(found, "activate_patch", "activate_followers", StreamOf<&Streams::patch_state>));
  EXPECT_TRUE(has(found, "bound_layer", "order_layers", StreamOf<&Streams::bounds>));
  EXPECT_TRUE(has(found, "collect_changes", "write_instances", StreamOf<&Streams::layer_sort>));
  EXPECT_TRUE(has(found, "sort_layer", "write_instances", StreamOf<&Streams::order>));
  // Written and read inside one pass, or read before it is written.
  for (const PassDependency& d : found) {
    EXPECT_LT(d.producer, d.consumer);
    EXPECT_NE(d.stream, StreamOf<&Streams::pose>);
    EXPECT_NE(d.stream, StreamOf<&Streams::anchors>);
  }
  // A pass that did not run gives and takes nothing.
  std::vector<bool> unsorted = all;
  unsorted[pass_of("sort_layer")] = false;
  for (const PassDependency& d : FindDependencies(plan, unsorted)) {
    EXPECT_NE(d.producer, pass_of("sort_layer"));
    EXPECT_NE(d.consumer, pass_of("sort_layer"));
  }
}

// The trace shows faults of the recording; it does not hide them.
TEST(Timeline, ARecordedFaultIsSeenInTheTrace) {
  RecordedRun run("tbb", 3);
  std::vector<FrameRecord> records = run.records;
  FrameRecord::Item& item = records.back().items[records.back().items.size() / 2];
  item.end_ticks = records.back().ticks.end + uint64_t(5000.0 / run.scale.NsPerTick());
  const Timeline timeline =
      BuildTimeline(run.running.scene(), records, run.workers, run.scale.NsPerTick());
  EXPECT_FALSE(TraceChecker::Check(ChromeTrace(timeline)).faults.empty());
}

TEST(Timeline, RecordsWithoutChangingTheBits) {
  Scenario tiny = LoadScenario("tiny");
  uint64_t digests[2];
  for (int i = 0; i < 2; ++i) {
    RunOptions options;
    options.executor = "tbb";
    options.workers = 3;
    options.frames = 12;
    uint32_t recorded = 0;
    if (i) options.observe = [&](const FinishedFrame&) { ++recorded; };
    RunningScenario running(tiny, options.scene);
    digests[i] = RunFrames(tiny, running, options).digest;
    EXPECT_EQ(recorded, i ? 12u : 0u);
  }
  EXPECT_EQ(digests[0], digests[1]);
}

}  // namespace
}  // namespace pelt::testing
