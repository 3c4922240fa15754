// A recording replays bit for bit on everything that can run it, and a change of one bit shows.
#include <gtest/gtest.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "bench/command/commands.hpp"
#include "bench/verify/lockstep.hpp"
#include "bench/verify/replay.hpp"
#include "bench/verify/stage_digests.hpp"
#include "core/file_bytes.hpp"
#include "core/kernels/frame_table.hpp"
#include "tests/command/command_fixture.hpp"
#include "tests/run_frame.hpp"
#include "tests/traces/recordings.hpp"
#include "traces/diff.hpp"

namespace pelt {
namespace {

class TraceCommand : public test::CommandFixture {
 protected:
  // Records tiny; the teleport at frame 20 and the weather are in it.
  std::string RecordTiny(const std::string& name, uint32_t frames, bool lod = false,
                         VertexOrder order = VertexOrder::kSorted) const {
    RecordArgs args;
    args.run.request.scene = "tiny";
    args.run.options.frames = frames;
    args.run.options.skip.lod = lod;
    args.run.options.lod.strand_budget = lod ? 400 : 0;
    args.run.options.scene.vertex_order = order;
    args.out = OutputPath::Of(Path(name));
    ::testing::internal::CaptureStdout();
    EXPECT_EQ(Record(args), 0);
    ::testing::internal::GetCapturedStdout();
    return args.out.path();
  }
};

ReplayResult ReplayAs(const InputLog& log, const VerifyCase& what) {
  ReplayScene replay = ReplayScene::Open(log, "x", SceneOptionsOf(what)).OrThrow();
  const std::unique_ptr<Executor> executor = MakeExecutor(what);
  return Replay(log, replay, *executor);
}

TEST_F(TraceCommand, ReplayIsTheSameOnEverySetExecutorAndWorkerCount) {
  const InputLog log = ReadInputLogFile(RecordTiny("a.peltinput", 24)).OrThrow();
  std::vector<VerifyCase> cases;
  for (const Isa isa : kAllIsas)
    if (FindKernels(isa)) cases.push_back({.isa = isa});
  for (const uint32_t workers : {1u, 3u, 7u})
    cases.push_back({.executor = "tbb", .workers = workers, .isa = BestIsa()});
  cases.push_back({.executor = "permuted", .order_seed = 5});
  cases.push_back({.executor = "local-store"});
  cases.push_back({.fuse = false});
  cases.push_back({.piecewise_sort = true});
  for (const VerifyCase& what : cases) {
    const ReplayResult result = ReplayAs(log, what);
    EXPECT_TRUE(result.Same()) << NameCase(what) << ": " << DescribeReplay(result);
    EXPECT_EQ(result.frames, 24u);
  }
}

// From the middle of a run: what came before is a snapshot, and the digests are those of the whole.
TEST_F(TraceCommand, ARecordingMayBeginAnywhere) {
  const InputLog whole = ReadInputLogFile(RecordTiny("whole.peltinput", 24)).OrThrow();
  RecordArgs args;
  args.run.request.scene = "tiny";
  args.run.options.frames = 24;
  args.from = 17;
  args.out = OutputPath::Of(Path("end.peltinput"));
  ::testing::internal::CaptureStdout();
  ASSERT_EQ(Record(args), 0);
  ::testing::internal::GetCapturedStdout();
  InputLog end = ReadInputLogFile(args.out.path()).OrThrow();
  ASSERT_EQ(end.FrameCount(), 7u);
  EXPECT_FALSE(end.snapshot.empty());
  for (uint32_t f = 0; f < end.FrameCount(); ++f)
    EXPECT_EQ(end.frames[f].digest, whole.frames[17 + f].digest) << "frame " << f;
  for (const VerifyCase& what :
       {VerifyCase{}, VerifyCase{.executor = "local-store", .piecewise_sort = true},
        VerifyCase{.executor = "tbb", .workers = 3, .isa = BestIsa()}})
    EXPECT_TRUE(ReplayAs(end, what).Same()) << NameCase(what);
  end.snapshot.back() ^= std::byte{1};
  EXPECT_NE(ReplayScene::Open(end, "x", {}).error().find("its snapshot: the snapshot is damaged"),
            std::string::npos);
  args.from = 24;
  EXPECT_THROW(Record(args), Error);
}

TEST_F(TraceCommand, LodAndTheIndexBufferAreReplayedToo) {
  const InputLog lod = ReadInputLogFile(RecordTiny("lod.peltinput", 12, true)).OrThrow();
  EXPECT_TRUE(ReplayAs(lod, {}).Same());
  const InputLog index =
      ReadInputLogFile(RecordTiny("index.peltinput", 12, false, VertexOrder::kIndexBuffer))
          .OrThrow();
  EXPECT_TRUE(index.about.index_buffer);
  EXPECT_TRUE(ReplayAs(index, {}).Same());
  const InputLog plain = ReadInputLogFile(RecordTiny("plain.peltinput", 12)).OrThrow();
  EXPECT_NE(lod.frames[11].digest, plain.frames[11].digest);
  EXPECT_NE(index.frames[11].digest, plain.frames[11].digest);
}

TEST_F(TraceCommand, ARecordingHasTheDigestsOfTheRun) {
  const InputLog log = ReadInputLogFile(RecordTiny("a.peltinput", 6)).OrThrow();
  Scenario tiny = LoadScenario("tiny");
  RunningScenario running(tiny, {});
  RunOptions options;
  options.frames = 6;
  const RunReport report = RunFrames(tiny, running, options);
  EXPECT_EQ(ReplayAs(log, {}).digest, report.digest);
}

TEST_F(TraceCommand, ATamperedPoseBitIsFoundAtItsFrame) {
  const InputLog log = ReadInputLogFile(RecordTiny("a.peltinput", 8)).OrThrow();
  const auto tampered = RewriteLog(log, 5, [](FrameInput&, std::vector<PoseBlock>& poses) {
    float& value = poses[0].rotation_key[0][0][2];
    value = std::bit_cast<float>(std::bit_cast<uint32_t>(value) ^ 1u << 16);
  });
  const ReplayResult result = ReplayAs(ReadInputLog(tampered, "x").OrThrow(), {});
  ASSERT_FALSE(result.Same());
  EXPECT_EQ(result.first->frame, 5u);
  EXPECT_EQ(result.frames, 8u);  // the rest is run all the same
  EXPECT_EQ(result.first->recorded, log.frames[5].digest);
  EXPECT_NE(DescribeReplay(result).find("frame 5"), std::string::npos);

  WriteFileBytes("input log", Path("bad.peltinput"), tampered).OrThrow();
  ReplayArgs args;
  args.path = Path("bad.peltinput");
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(ReplayRecording(args), 1);
  EXPECT_NE(::testing::internal::GetCapturedStdout().find("DIFFERENT BITS"), std::string::npos);
}

TEST_F(TraceCommand, UnchangedRewritingIsTheSameFile) {
  const std::string path = RecordTiny("a.peltinput", 4);
  const auto again = RewriteLog(ReadInputLogFile(path).OrThrow(), 0, [](FrameInput&, auto&) {});
  EXPECT_EQ(again, ReadFileBytes("input log", path).OrThrow());
}

TEST_F(TraceCommand, AFrameThatCannotRunIsRefusedByName) {
  const InputLog log = ReadInputLogFile(RecordTiny("a.peltinput", 5)).OrThrow();
  const auto bad = RewriteLog(log, 3, [](FrameInput& input, auto&) { input.dt_s = -1.0; });
  const ReplayResult result = ReplayAs(ReadInputLog(bad, "x").OrThrow(), {});
  ASSERT_FALSE(result.Same());
  EXPECT_EQ(result.first->frame, 3u);
  EXPECT_EQ(result.frames, 3u);
  EXPECT_NE(result.first->refused.find("dt_s"), std::string::npos);
  EXPECT_NE(DescribeReplay(result).find("REFUSED: frame 3"), std::string::npos);
}

TEST_F(TraceCommand, ADamagedGroomIsAnErrorThatNamesIt) {
  InputLog log = ReadInputLogFile(RecordTiny("a.peltinput", 2)).OrThrow();
  log.grooms[0][1000] ^= std::byte{1};
  const Result<ReplayScene> replay = ReplayScene::Open(log, "log.peltinput", SceneOptions{});
  ASSERT_FALSE(replay) << "a damaged groom was accepted";
  EXPECT_NE(replay.error().find("log.peltinput, groom 0"), std::string::npos) << replay.error();
}

TEST_F(TraceCommand, ARecordingOfAnotherChunkCapacityIsToldFirst) {
  InputLog log = ReadInputLogFile(RecordTiny("a.peltinput", 2)).OrThrow();
  log.chunk_strands = kStrandsPerChunk / 2;
  const Result<ReplayScene> replay = ReplayScene::Open(log, "log.peltinput", SceneOptions{});
  ASSERT_FALSE(replay) << "another chunk capacity was accepted";
  EXPECT_NE(replay.error().find("input log 'log.peltinput': recorded with"), std::string::npos);
  EXPECT_NE(replay.error().find("strands per chunk"), std::string::npos) << replay.error();
}

TEST_F(TraceCommand, AReplaysDigestLogIsTheRunsOne) {
  const std::string path = RecordTiny("a.peltinput", 5);
  ::testing::internal::CaptureStdout();
  RunArgs run;
  run.request.scene = "tiny";
  run.options.frames = 5;
  run.digest_log = OutputPath::Of(Path("run.digests"));
  EXPECT_EQ(pelt::Run(run), 0);
  ReplayArgs replay;
  replay.path = path;
  replay.as = {.isa = Isa::kReference};
  replay.digest_log = OutputPath::Of(Path("replay.digests"));
  replay.json = true;
  ::testing::internal::GetCapturedStdout();
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(ReplayRecording(replay), 0);
  const auto json = nlohmann::json::parse(::testing::internal::GetCapturedStdout());
  EXPECT_EQ(json["same"], true);
  EXPECT_EQ(json["frames"], 5);
  EXPECT_EQ(ReadFileBytes("log", run.digest_log.path()).OrThrow(),
            ReadFileBytes("log", replay.digest_log.path()).OrThrow());
}

TEST_F(TraceCommand, ShowTellsWhatIsInside) {
  ShowArgs args;
  args.path = RecordTiny("a.peltinput", 3);
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(ShowRecording(args), 0);
  const std::string text = ::testing::internal::GetCapturedStdout();
  EXPECT_NE(text.find("scene tiny"), std::string::npos);
  EXPECT_NE(text.find("frames 3, characters 1,"), std::string::npos) << text;
  EXPECT_NE(text.find("8 layers, 1410 strands, 24 joints"), std::string::npos) << text;
  args.json = true;
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(ShowRecording(args), 0);
  const auto json = nlohmann::json::parse(::testing::internal::GetCapturedStdout());
  EXPECT_EQ(json["frames"].size(), 3u);
}

// ---- The digests of a stage ---------------------------------------------------------------------

TEST(StageDigests, EveryValueBlockIsInExactlyOneLine) {
  Scenario tiny = LoadScenario("tiny");
  for (const bool pieces : {false, true}) {
    RunningScenario running(tiny, {.piecewise_sort_chunks = pieces});
    testing::RunFrame(running, 0);
    const StageDigests stages(running.scene());
    DigestLog before = stages.Begin("tiny", "", VertexOrder::kSorted);
    stages.AddFrame(running.scene(), before);
    const SceneShape& shape = running.scene().shape();
    for (uint32_t s = 0; s < kStreamCount; ++s) {
      const StreamDesc& desc = DescribeStream(Stream(s));
      if (desc.role != Role::kValue) continue;
      for (uint32_t i = 0; i < shape.ItemCount(desc.domain); ++i) {
        std::byte* block = running.scene().memory().Block(Stream(s), i);
        const uint32_t at = IsInLayer(desc.domain) ? i : 0;
        if (!block || running.scene().LiveLanes(Stream(s), at) == 0) continue;
        const uint32_t byte = desc.rows[0].offset_bytes;  // of the first lane
        block[byte] ^= std::byte{1};
        DigestLog after = stages.Begin("tiny", "", VertexOrder::kSorted);
        stages.AddFrame(running.scene(), after);
        block[byte] ^= std::byte{1};
        uint32_t lines = 0;
        for (size_t c = 0; c < before.columns.size(); ++c) {
          if (before.digests[c] == after.digests[c]) continue;
          ++lines;
          if (before.columns[c].stage != kWholeFrameStage) {
            EXPECT_EQ(before.columns[c].stream, desc.name);
          }
        }
        ASSERT_EQ(lines, 2u) << desc.name << " " << i;  // its own and the whole frame's
      }
    }
  }
}

// Two scenes after a frame, one of which a test spoils.
class StageDigestsOfAFault : public ::testing::Test {
 protected:
  StageDigestsOfAFault() {
    for (RunningScenario* running : {&good_, &bad_}) testing::RunFrame(*running, 0);
  }
  auto Find() const {
    const StageDigests stages(good_.scene());
    DigestLog a = stages.Begin("tiny", "", VertexOrder::kSorted), b = a;
    stages.AddFrame(good_.scene(), a);
    stages.AddFrame(bad_.scene(), b);
    return FindDifference(a, b);
  }

  Scenario tiny_ = LoadScenario("tiny");
  RunningScenario good_{tiny_, {}}, bad_{tiny_, {}};
  const SceneShape& shape_ = bad_.scene().shape();
};

TEST_F(StageDigestsOfAFault, IsNamedAtTheStageOfItsLayersKind) {
  uint32_t verlet_chunk = 0;
  while (!(shape_.layer_kind[shape_.chunk_layer[verlet_chunk]] & kLayerVerlet)) ++verlet_chunk;
  const bool five = shape_.layer_kind[shape_.chunk_layer[verlet_chunk]] & kLayerFivePoints;
  const Stream stream =
      five ? StreamOf<&Streams::strand_points5> : StreamOf<&Streams::strand_points4>;
  *bad_.scene().memory().Block(stream, verlet_chunk) ^= std::byte{1};
  const auto found = Find();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->place[1].second, five ? "simulate_verlet_5" : "simulate_verlet_4");
}

// What is a patch's belongs to the stage of its layer's kind too, regardless of which chunk has its number.
TEST_F(StageDigestsOfAFault, OfAPatchIsNamedAtTheStageOfItsLayersKind) {
  for (const bool modal : {false, true}) {
    uint32_t patch = 0;
    while (!(shape_.layer_kind[shape_.patch_layer[patch]] & kLayerVertexChains) ||
           ((shape_.layer_kind[shape_.patch_layer[patch]] & kLayerModal) != 0) != modal)
      ++patch;
    std::byte& spoilt = *bad_.scene().memory().Block(StreamOf<&Streams::vertex_loads>, patch);
    spoilt ^= std::byte{1};
    const auto found = Find();
    spoilt ^= std::byte{1};
    ASSERT_TRUE(found);
    EXPECT_EQ(found->place[1].second, modal ? "chain_loads" : "chain_displacements");
    EXPECT_EQ(found->place[2].second, "vertex_loads");
  }
}

// The log of a sort in pieces lists other stages; what both list is the same.
TEST(StageDigests, WholeAndPiecewiseSortCompare) {
  Scenario tiny = LoadScenario("tiny");
  std::vector<DigestLog> logs;
  for (const bool pieces : {false, true}) {
    RunningScenario running(tiny, {.piecewise_sort_chunks = pieces});
    const StageDigests stages(running.scene());
    logs.push_back(stages.Begin("tiny", "", VertexOrder::kSorted));
    for (uint32_t f = 0; f < 3; ++f) {
      testing::RunFrame(running, f);
      stages.AddFrame(running.scene(), logs.back());
    }
  }
  EXPECT_NE(logs[0].columns, logs[1].columns);
  EXPECT_FALSE(FindDifference(logs[0], logs[1]));
}

}  // namespace
}  // namespace pelt
