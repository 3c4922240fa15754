// Frames on consoles: what must be conserved, what follows from the numbers, what must be noticed.
#include "platform_sim/frame/console_frame.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "platform_sim/frame/frame_clock.hpp"
#include "platform_sim/frame/modelled_frame.hpp"
#include "tests/determinism/planted_faults.hpp"
#include "tests/jobs/synthetic_scene.hpp"
#include "tests/jobs/tiny_scene.hpp"
#include "tests/platform_sim/modelled_scene.hpp"

namespace pelt::testing {
namespace {

constexpr uint32_t kFrames = 20;
constexpr float kCyclesPerIteration = 120.0f;

std::vector<ConsoleMachine> Consoles() { return {Ps3(1), Ps3(3), Ps3(6), Xbox()}; }

std::string NameOf(const ConsoleMachine& machine) {
  return machine.name + " with " + std::to_string(machine.units) + " units";
}

Cycles Sum(const WorkCycles& cycles) {
  return std::accumulate(cycles.begin(), cycles.end(), Cycles{0});
}

TEST(ConsoleFrame, DigestsAreTheSerialExecutors) {
  Scenario scenario = TinyScenario();
  for (const ConsoleMachine& machine : Consoles()) {
    const auto expected = RunDigests(scenario, OptionsOn(machine), kFrames);
    const ModelledRun run = RunOn(scenario, machine, kFrames, kCyclesPerIteration);
    ExpectSameFrames(expected, run.digests, NameOf(machine));
    for (const LocalStoreFault& f : run.faults)
      ADD_FAILURE() << NameOf(machine) << ": " << f.stage << ": " << f.what;
  }
}

TEST(ConsoleFrame, TwoRunsTakeTheSameCycles) {
  Scenario scenario = TinyScenario();
  for (const ConsoleMachine& machine : Consoles()) {
    const ModelledRun a = RunOn(scenario, machine, kFrames, kCyclesPerIteration);
    const ModelledRun b = RunOn(scenario, machine, kFrames, kCyclesPerIteration, true);
    for (uint32_t f = 0; f < kFrames; ++f) {
      EXPECT_EQ(a.frames[f].cycles, b.frames[f].cycles) << NameOf(machine) << ", frame " << f;
      EXPECT_EQ(a.frames[f].stage_cycles, b.frames[f].stage_cycles);
    }
    EXPECT_EQ(TimeFrame(a.last_work, machine).cycles, a.frames.back().cycles)
        << "the work of a frame times to the same on its own";
  }
}

// Slices without gaps, each item computed once, and what they add up to.
void ExpectConserved(const ModelledRun& run, const ModelledFrame& frame,
                     const ConsoleMachine& machine) {
  ASSERT_EQ(frame.units.size(), machine.units);
  std::vector<std::vector<uint32_t>> computed(frame.passes.size());
  for (const UnitTimeline& unit : frame.units) {
    Cycles at = 0;
    for (const UnitSlice& slice : unit.slices) {
      ASSERT_EQ(slice.begin, at);
      ASSERT_GT(slice.end, slice.begin);
      at = slice.end;
      if (slice.work == UnitWork::kCompute) computed[slice.pass].push_back(slice.item);
    }
    ASSERT_EQ(at, frame.cycles);
    for (const TransferSlice& t : unit.transfers) {
      // Lines may begin to leave a cache only after the frame, which does not wait for them;
      // nothing else is empty.
      const bool after = machine.local_store_bytes == 0 && t.put && t.begin == frame.cycles;
      if (after)
        ASSERT_EQ(t.begin, t.end);
      else
        ASSERT_LT(t.begin, t.end);
    }
  }
  Cycles units = 0, critical = 0;
  uint64_t pass_bytes[2] = {0, 0}, transferred = 0, moved = 0, code_bytes = 0, code_transfers = 0;
  for (uint32_t p = 0; p < frame.passes.size(); ++p) {
    const ModelledPass& pass = frame.passes[p];
    EXPECT_LE(pass.begin, pass.end);
    EXPECT_LE(pass.end, frame.cycles);
    units += Sum(pass.unit_cycles);
    critical += Sum(pass.critical_cycles);
    EXPECT_EQ(pass.critical_cycles[size_t(UnitWork::kImbalance)], 0);
    pass_bytes[0] += pass.get_bytes;
    pass_bytes[1] += pass.put_bytes;
    code_bytes += pass.code_bytes;
    moved += pass.get_bytes + pass.put_bytes + pass.code_bytes + pass.wasted_bytes;
    std::sort(computed[p].begin(), computed[p].end());
    EXPECT_EQ(std::adjacent_find(computed[p].begin(), computed[p].end()), computed[p].end());
    EXPECT_EQ(computed[p].size(), pass.items) << "pass " << p;
  }
  EXPECT_EQ(units, frame.cycles * machine.units);
  if (machine.local_store_bytes > 0) {
    const auto bytes = double(pass_bytes[0] + pass_bytes[1] + code_bytes);
    EXPECT_GE(double(frame.cycles) + 1.0, bytes / machine.memory.read_rate);
  }
  EXPECT_EQ(critical, frame.cycles);
  const auto total = [](const std::vector<uint64_t>& v) {
    return std::accumulate(v.begin(), v.end(), uint64_t{0});
  };
  EXPECT_EQ(total(frame.stream_get_bytes), pass_bytes[0]);
  EXPECT_EQ(total(frame.stream_put_bytes), pass_bytes[1]);
  Cycles stage_cycles = 0, compute = 0;
  for (const Cycles c : frame.stage_cycles) stage_cycles += c;
  for (const ModelledPass& pass : frame.passes)
    compute += pass.unit_cycles[size_t(UnitWork::kCompute)];
  EXPECT_EQ(stage_cycles, compute);
  for (const UnitTimeline& unit : frame.units)
    for (const TransferSlice& t : unit.transfers) {
      transferred += t.bytes;
      code_transfers += t.item == kNoBlock;
    }
  // Code and parameters move in whole lines.
  EXPECT_GE(transferred, moved);
  EXPECT_LE(transferred, moved + code_transfers * machine.line_bytes);
  EXPECT_EQ(run.shape.ItemCount(run.plan.passes.back().domain),
            run.last_work.passes.back().items.size());
}

TEST(ConsoleFrame, NothingIsLost) {
  Scenario scenario = TinyScenario();
  for (const ConsoleMachine& machine : Consoles()) {
    SCOPED_TRACE(NameOf(machine));
    const ModelledRun run = RunOn(scenario, machine, kFrames, kCyclesPerIteration, true);
    for (const ModelledFrame& frame : run.frames) ExpectConserved(run, frame, machine);
  }
}

// ---- Made items ---------------------------------------------------------------------------------

FrameWork MadeWork(uint32_t items, double cycles, uint32_t kib = 16, bool double_buffered = true) {
  ItemWork item;
  item.stages = {{0, {cycles, cycles * 1.5}, {cycles, cycles * 1.5}}};
  if (kib > 0) {
    item.get = item.put = {kib * 1024ull, 1, 1, kib * 8};
    item.streams = {{StreamOf<&Streams::curves>, kib * 1024ull, kib * 1024ull}};
  }
  FrameWork work;
  work.stage_count = 1;
  work.stream_count = kStreamCount;
  work.passes.push_back({0, double_buffered, 4096, 64, {}, {}});
  work.passes[0].items.assign(items, item);
  work.graph = PassAfterPass(work);
  return work;
}
Cycles StageCycles(const ModelledFrame& frame) { return frame.stage_cycles[0]; }

// A unit with a store fetches a character's palette once per pass, however many of its items it takes.
TEST(MovedData, APaletteComesOnceAPass) {
  Scenario scenario = TinyScenario();
  const ModelledRun run = RunOn(scenario, Ps3(1), 2, kCyclesPerIteration);
  uint32_t items = 0;
  for (const PassWork& pass : run.last_work.passes) {
    const Domain domain = run.plan.passes[pass.pass].domain;
    if (domain <= Domain::kCharacter) continue;
    std::vector<uint32_t> fetched(run.shape.character_count);
    for (uint32_t i = 0; i < pass.items.size(); ++i)
      for (const ItemWork::StreamBytes& moved : pass.items[i].streams)
        if (moved.stream == StreamOf<&Streams::palette>) {
          ++items;
          fetched[PlaceOf(run.shape, domain, i).first[size_t(Domain::kCharacter)]] +=
              moved.get_bytes > 0;
        }
    for (const uint32_t times : fetched) EXPECT_LE(times, 1u) << "pass " << pass.pass;
  }
  EXPECT_GT(items, 2 * run.shape.character_count);
}

// Of rows of lanes only what lives is moved, in whole quads.
TEST(MovedData, DeadLanesAreNotMoved) {
  Scenario scenario = TinyScenario();
  const ConsoleMachine machine = Ps3(1);
  RunningScenario running(scenario, OptionsOn(machine));
  RunFrame(running, 0);
  const Frame frame = running.scene().CurrentFrame();
  uint32_t pass = 0;
  while (frame.plan->passes[pass].domain != Domain::kChunk) ++pass;
  MovedData data(machine);
  constexpr Stream kRoots = StreamOf<&Streams::roots>;
  const uint64_t whole = DescribeStream(kRoots).block_bytes;
  uint32_t part = 0;
  for (uint32_t chunk = 0; chunk < running.scene().shape().ItemCount(Domain::kChunk); ++chunk) {
    ItemWork work;
    work.streams = {{kRoots, whole, 0}};
    work.get.bytes = whole;
    work.get.lines = uint32_t(whole / machine.line_bytes);
    data.Apply(frame, 0, pass, chunk, work);
    const uint64_t live = frame.memory->LiveLanes(kRoots, chunk),
                   rows = whole / 4 / kStrandsPerChunk;
    const uint64_t of_row = (live * 4 + 15) / 16 * 16;
    EXPECT_TRUE(work.streams[0].get_bytes == rows * of_row || work.streams[0].get_bytes == whole);
    EXPECT_EQ(work.get.bytes % machine.line_bytes, 0u);
    if (of_row * 2 > kStrandsPerChunk * 4) continue;
    ++part;
    EXPECT_LT(work.streams[0].get_bytes, whole);
    EXPECT_LT(work.get.lines, whole / machine.line_bytes);
  }
  EXPECT_GT(part, 0u);
}

TEST(FrameClock, DrawingIsAllThatIsLeft) {
  for (const uint32_t units : {1u, 3u, 6u}) {
    ConsoleMachine machine = Ps3(6);
    machine.units = units;
    machine = WithoutLimit(WithoutLimit(machine, PassLimit::kMemory), PassLimit::kCompute);
    const FrameWork work = MadeWork(50, 1000.0);
    // The line serves one unit after another.
    EXPECT_EQ(TimeFrame(work, machine).cycles, 50 * machine.draw_cycles + machine.barrier_cycles);
    // One dispatcher: its work for every item, and then the unit's.
    machine.dispatcher_cycles = 70'000;
    EXPECT_EQ(TimeFrame(work, machine).cycles,
              50 * machine.dispatcher_cycles + machine.draw_cycles + machine.barrier_cycles);
  }
  const ConsoleMachine nothing =
      WithoutLimit(WithoutLimit(WithoutLimit(Ps3(), PassLimit::kMemory), PassLimit::kCompute),
                   PassLimit::kDispatch);
  EXPECT_EQ(TimeFrame(MadeWork(50, 1000.0), nothing).cycles, 0);
}

TEST(FrameClock, ComputeAloneIsItemsOverUnits) {
  ConsoleMachine machine =
      WithoutLimit(WithoutLimit(Ps3(), PassLimit::kMemory), PassLimit::kDispatch);
  EXPECT_EQ(TimeFrame(MadeWork(60, 1000.0), machine).cycles, 10'000);
  // One item more than fits the last round leaves five units idle for one item's time.
  const ModelledFrame frame = TimeFrame(MadeWork(61, 1000.0), machine);
  EXPECT_EQ(frame.cycles, 11'000);
  EXPECT_EQ(frame.passes[0].unit_cycles[size_t(UnitWork::kImbalance)], 5'000);
  EXPECT_EQ(frame.passes[0].critical_cycles[size_t(UnitWork::kCompute)], 11'000);
  // No model applies the availability; a verdict does, to the frame's whole time.
  machine.availability = 0.5;
  EXPECT_EQ(TimeFrame(MadeWork(60, 1000.0), machine).cycles, 10'000);
  EXPECT_EQ(machine.Available(10.0), 20.0);
}

// Neither console is favoured: what was not measured on the one is taken from the other.
TEST(ConsoleMachines, HaveOneAvailability) {
  EXPECT_EQ(Ps3().availability, 0.92);
  EXPECT_EQ(Xbox().availability, Ps3().availability);
  EXPECT_NE(Ps3().availability_from.find("measured on a retail PS3"), std::string::npos);
  EXPECT_NE(Xbox().availability_from.find("none was measured"), std::string::npos);
}

// The same machine for any availability: rates of memory and compute are the models' own.
TEST(ConsoleMachines, AreTimedWithoutTheirAvailability) {
  CellParameters cell;
  XenonParameters xenon;
  cell.availability_permille = xenon.availability_permille = 500;
  EXPECT_EQ(MakeCell(cell, AtomicDispatch(150)).OrThrow().memory.read_rate,
            MakeCell({}, AtomicDispatch(150)).OrThrow().memory.read_rate);
  EXPECT_EQ(MakeXenon(xenon).OrThrow().memory.read_rate, MakeXenon({}).OrThrow().memory.read_rate);
}

TEST(FrameClock, ThreadsOfACoreSlowEachOtherDown) {
  ConsoleMachine machine =
      WithoutLimit(WithoutLimit(Xbox(), PassLimit::kMemory), PassLimit::kDispatch);
  EXPECT_EQ(TimeFrame(MadeWork(1, 1000.0, 0), machine).cycles, 1000);
  EXPECT_EQ(TimeFrame(MadeWork(6, 1000.0, 0), machine).cycles, 1500);
  // Of two, the longer has the core to itself when the shorter is done: 600 of its 1000 are left.
  FrameWork two = MadeWork(2, 1000.0, 0);
  two.passes[0].items[1].stages[0] = {0, {400.0, 600.0}, {400.0, 600.0}};
  EXPECT_EQ(TimeFrame(two, machine).cycles, 1200);
}

TEST(FrameClock, TwoBuffersHideTransfersAndOneDoesNot) {
  const ConsoleMachine machine = Ps3(1);
  const double compute = 40'000.0;
  const Cycles computed = StageCycles(TimeFrame(MadeWork(20, compute), machine));
  const Cycles two = TimeFrame(MadeWork(20, compute), machine).cycles;
  const Cycles one = TimeFrame(MadeWork(20, compute, 16, false), machine).cycles;
  EXPECT_LT(double(two), double(computed) * 1.06);
  const double moved = 20 * 2 * 16384.0 / machine.memory.port_read_rate;
  EXPECT_GT(double(one), double(computed) + 0.95 * moved);
}

// A unit that ran this pass last has its code; another's must come.
TEST(FrameClock, CodeComesWhenAnotherPassRanBetween) {
  const ConsoleMachine machine = Ps3(2);
  FrameWork work = MadeWork(8, 5000.0);
  work.passes.push_back(work.passes[0]);
  work.graph = PassAfterPass(work);
  EXPECT_EQ(TimeFrame(work, machine).passes[0].code_bytes, 2 * (4096u + 64u));
  EXPECT_EQ(TimeFrame(work, machine).passes[1].code_bytes, 2 * 64u);
  work.passes[1].pass = 1;
  EXPECT_EQ(TimeFrame(work, machine).passes[1].code_bytes, 2 * (4096u + 64u));
  // A unit that finds no item fetches no code.
  EXPECT_EQ(TimeFrame(MadeWork(1, 5000.0), machine).passes[0].code_bytes, 4096u + 64u);
}

// What waits for one layer begins while another's chunks are worked on: chunks of 1000 cycles, 30 and
// 6 of them, then an item for each layer.
TEST(FrameClock, LayersDoNotWaitForEachOther) {
  const ConsoleMachine machine =
      WithoutLimit(WithoutLimit(Ps3(3), PassLimit::kMemory), PassLimit::kDispatch);
  FrameWork work = MadeWork(36, 1000.0, 0, false);
  work.passes.push_back(MadeWork(2, 10'000.0, 0, false).passes[0]);
  work.passes[1].pass = 1;
  work.passes[1].items[1].stages[0].scheduled = {1000.0, 1000.0};
  SceneShape shape;
  shape.AddLayer(0, 0, 30);
  shape.AddLayer(0, 0, 6);
  const auto cycles = [&](Domain within) {
    Plan plan;
    plan.passes = {{0, 1, Domain::kChunk, {}, 0, 0, 0, false, {}},
                   {0, 1, Domain::kLayer, {}, 0, 0, 0, false, {{0, within}}}};
    plan.waits_of_end = {{1, Domain::kScene}};
    work.graph = BuildGraph(plan, shape);
    const ModelledFrame frame = TimeFrame(work, machine);
    EXPECT_EQ(Sum(frame.passes[0].critical_cycles) + Sum(frame.passes[1].critical_cycles),
              frame.cycles);
    EXPECT_EQ(Sum(frame.passes[1].critical_cycles), 10'000);
    return frame.cycles;
  };
  EXPECT_EQ(cycles(Domain::kScene), 12'000 + 10'000);
  EXPECT_EQ(cycles(Domain::kLayer), 10'000 + 10'000) << "the first layer's item runs beside chunks";
}

TEST(ConsoleFrame, MoreSpusAreNotSlower) {
  Scenario scenario = TinyScenario();
  const FrameWork tiny = RunOn(scenario, Ps3(), 3, kCyclesPerIteration).last_work;
  for (const FrameWork& work : {tiny, MadeWork(200, 30'000.0), MadeWork(200, 3'000.0)}) {
    Cycles before = INT64_MAX;
    for (uint32_t spus = 1; spus <= 6; ++spus) {
      ConsoleMachine machine = Ps3();
      machine.units = spus;
      const Cycles cycles = TimeFrame(work, machine).cycles;
      // Where memory binds, more SPUs make it turn more often, and fetch code more often.
      EXPECT_LE(double(cycles), double(before) * 1.06) << spus << " SPUs";
      before = std::min(before, cycles);
    }
  }
}

// ---- What binds ---------------------------------------------------------------------------------

TEST(FrameSummary, SaysWhatBindsAndAddsUp) {
  const ConsoleMachine machine = Ps3();
  Plan plan;
  plan.table = &TableOf<Streams>();
  plan.stages.resize(1);
  plan.passes.resize(1);
  plan.passes[0].stage_count = 1;
  const auto summarise = [&](const FrameWork& work) {
    FrameStatistics statistics(machine, plan);
    const ModelledFrame frame = TimeFrame(work, machine);
    statistics.Add(frame);
    statistics.AddLimits(frame, work);
    return statistics.Summarise();
  };
  const FrameSummary compute = summarise(MadeWork(120, 60'000.0));
  EXPECT_EQ(compute.passes[0].binds, PassLimit::kCompute);
  EXPECT_LT(compute.bus_use, 0.6);
  const FrameSummary memory = summarise(MadeWork(120, 2'000.0));
  EXPECT_EQ(memory.passes[0].binds, PassLimit::kMemory);
  EXPECT_GT(memory.bus_use, 0.8);
  EXPECT_LE(memory.bus_use, 1.0);
  EXPECT_EQ(summarise(MadeWork(120, 10.0, 0)).passes[0].binds, PassLimit::kDispatch);
  EXPECT_EQ(summarise(MadeWork(7, 60'000.0)).passes[0].binds, PassLimit::kCompute);
  FrameWork uneven = MadeWork(6, 1'000.0, 0);
  uneven.passes[0].items[0].stages[0].scheduled.cycles = 60'000.0;
  EXPECT_EQ(summarise(uneven).passes[0].GainMs(PassLimit::kImbalance) > 0.0, true);

  const auto total = [](const WorkMs& ms) { return std::accumulate(ms.begin(), ms.end(), 0.0); };
  for (const FrameSummary* s : {&compute, &memory}) {
    EXPECT_NEAR(total(s->critical_ms), s->median_ms, 1e-9);
    EXPECT_NEAR(total(s->unit_ms), s->median_ms, 1e-9);
    EXPECT_NEAR(s->stages[0].wall_ms, s->passes[0].ms, 1e-9);
    EXPECT_EQ(s->worst_ms, s->median_ms);
    EXPECT_EQ(s->stream_get_bytes[size_t(StreamOf<&Streams::curves>)], 120 * 16384.0);
  }
}

// ---- What must be noticed -----------------------------------------------------------------------

std::string WhyNot(const ConsoleMachine& machine, uint32_t code_bytes = 2048,
                   uint64_t clock_hz = 0) {
  Scenario scenario = TinyScenario();
  RunningScenario running(scenario, OptionsOn(Ps3()));
  const FurScene& scene = running.scene();
  const StageCosts costs = FlatCosts(scene.plan(), scene.shape(),
                                     clock_hz ? clock_hz : machine.clock_hz, 1.0f, code_bytes);
  return ConsoleExecutor::Make(machine, costs, scene.CurrentFrame()).error();
}

TEST(ConsoleFrame, RefusesWhatCannotBe) {
  const std::string store = WhyNot(Ps3(), 64 * 1024);
  EXPECT_NE(store.find("does not fit"), std::string::npos) << store;
  EXPECT_NE(store.find("too many for 262144: code "), std::string::npos) << store;
  EXPECT_NE(WhyNot(Ps3(), 2048, 1'000'000'000).find("clock"), std::string::npos);
  ConsoleMachine none = Ps3();
  none.units = 0;
  EXPECT_NE(WhyNot(none).find("may be zero"), std::string::npos);

  const auto cell_error = [](auto change) {
    CellMemoryParameters p;
    change(p);
    return MakeCell(p, AtomicDispatch(150)).error();
  };
  EXPECT_NE(cell_error([](auto& p) { p.spu_count = 0; }).find("no SPU"), std::string::npos);
  EXPECT_NE(cell_error([](auto& p) { p.spu_count = 7; }).find("7 SPUs"), std::string::npos);
  EXPECT_NE(cell_error([](auto& p) { p.local_store_bytes = 16 * 1024; }).find("16384"),
            std::string::npos);
  EXPECT_NE(cell_error([](auto& p) { p.clock_hz = 0; }).find("clock"), std::string::npos);
  XenonParameters xenon;
  xenon.cores = 0;
  EXPECT_NE(MakeXenon(xenon).error().find("no core"), std::string::npos);
  xenon = {};
  xenon.clock_hz = 0;
  EXPECT_NE(MakeXenon(xenon).error().find("clock"), std::string::npos);
}

// A kernel that leaves its block is caught while the frame is timed, on whichever unit it ran.
TEST(ConsoleFrame, NoticesAFaultyKernel) {
  SyntheticScene scene({{0, 0, 9}});
  constexpr FaultParams kParams{1};
  const auto faults_of = [&](const Stage& stage) {
    const Plan plan = CompilePlan({stage}, scene.shape(), {}).OrThrow();
    const ConsoleMachine machine = Ps3();
    const StageCosts costs = FlatCosts(plan, scene.shape(), machine.clock_hz, 100.0f);
    const auto executor = ConsoleExecutor::Make(machine, costs, {&plan, &scene.memory()}).OrThrow();
    executor->Run({&plan, &scene.memory()});
    return executor->faults().size();
  };
  EXPECT_EQ(faults_of(MakeStage<Derive>(Domain::kChunk, kParams)), 0u);
  EXPECT_EQ(faults_of(MakeStage<WritesThroughConstCast>(Domain::kChunk, kParams)), 9u);
}

// Costs that a stage has the wrong way round move the frame: nothing of it is lost in transfers.
// The cheaper, the more of a frame is moving data and the modal kernels' code, regardless of their cost: a
// PS3's takes 0.15 ms at least.
TEST(ConsoleFrame, ADearerStageMakesALongerFrame) {
  Scenario scenario = TinyScenario();
  for (const ConsoleMachine& machine : {Ps3(), Xbox()}) {
    Cycles before = 0;
    for (const float cycles : {400.0f, 800.0f, 1600.0f, 3200.0f, 6400.0f}) {
      const Cycles now = RunOn(scenario, machine, 2, cycles).frames.back().cycles;
      EXPECT_GT(double(now), double(before) * (cycles < 1600.0f ? 1.05 : 1.5)) << cycles;
      before = now;
    }
  }
}

}  // namespace
}  // namespace pelt::testing
