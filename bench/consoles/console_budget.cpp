#include "bench/consoles/console_budget.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>

#include "bench/consoles/gpu_bound.hpp"
#include "bench/report/timeline.hpp"
#include "core/error.hpp"
#include "platform_sim/frame/frame_clock.hpp"
#include "platform_sim/kernel_rows.hpp"
#include "platform_sim/memory/spu_program.hpp"
#include "platform_sim/pricing/priced_core.hpp"
#include "platform_sim/pricing/record_stage.hpp"

namespace pelt {

namespace {

// By then chains hang and swing as they do from there on, and nothing starts afresh.
constexpr uint32_t kPricedFrame = 30;
// A frame's limits are four more timings of it.
constexpr uint32_t kLimitsEvery = 10;
constexpr uint32_t kTrialFrames = 8;

SceneOptions OptionsOn(const ConsoleRequest& request) {
  SceneOptions options = request.scene;
  options.plan.must_fit = request.console == Console::kPs3;
  return options;
}

// What every stage costs there, from a frame that skips nothing; of all strands, so that it is the
// same however many LOD leaves, each layer in the quality that the request's frames have it in.
StageCosts Price(Scenario& scenario, const ConsoleRequest& request, const SceneOptions& options) {
  RunningScenario running(scenario, options);
  SerialExecutor serial;
  SkipSettings skip = request.skip;
  skip.lod = false;
  for (uint32_t f = 0; f < kPricedFrame; ++f) {
    running.Begin(f, skip, request.lod);
    serial.Run(running.scene().CurrentFrame());
  }
  const SkipSettings all{.sleep = false,
                         .unmoved = false,
                         .sort = false,
                         .cull = false,
                         .wind = false,
                         .light = false,
                         .lod = false};
  running.Begin(kPricedFrame, all, request.lod);
  const CoreKind kind = request.console == Console::kPs3 ? CoreKind::kSpu : CoreKind::kXenon;
  const PricedCore core = MakePricedCore(kind, request.numbers);
  return PriceStages(running.scene().CurrentFrame(), RecordingKernels(), core, {},
                     request.known.get())
      .OrThrow();
}

// Frames whose work was done, timed again with other code.
class OtherOrder {
 public:
  OtherOrder(ConsoleMachine machine, double code_order, const Plan& plan)
      : machine_(With(std::move(machine), code_order)), statistics_(machine_, plan) {}

  void Add(const FrameWork& work) { statistics_.Add(TimeFrame(work, machine_)); }
  Spread Summarise() const {
    const FrameSummary s = statistics_.Summarise();
    return {s.median_ms, s.p95_ms, s.worst_ms};
  }

 private:
  static ConsoleMachine With(ConsoleMachine machine, double code_order) {
    machine.code_order = code_order;
    return machine;
  }

  ConsoleMachine machine_;
  FrameStatistics statistics_;
};

std::vector<std::string> Describe(const std::vector<LocalStoreFault>& faults) {
  std::vector<std::string> out;
  for (const LocalStoreFault& fault : faults)
    out.push_back(fmt::format("{} on item {} {}", fault.stage, fault.item, fault.what));
  return out;
}

}  // namespace

std::string_view ConsoleName(Console console) {
  return console == Console::kPs3 ? "ps3" : "xbox360";
}

ConsoleMachine MakeConsole(const ConsoleRequest& request) {
  if (std::string error; !CheckPlatforms(request.numbers, error)) throw Error(error);
  const CellParameters& cell = request.numbers.cell;
  const double draw_ns = cell.Nanoseconds(double(AtomicBounceCycles(cell)));
  ConsoleMachine machine = (request.console == Console::kXbox360
                                ? MakeXenon(request.numbers.xenon)
                                : MakeCell(cell, AtomicDispatch(uint32_t(draw_ns + 0.5))))
                               .OrThrow();
  machine.code_order = std::clamp(MeasuredCodePlace().mean, 0.0, 1.0);
  return machine;
}

PricedScene PriceScene(Scenario& scenario, const ConsoleRequest& request) {
  const SceneOptions options = OptionsOn(request);
  return {options, Price(scenario, request, options)};
}

ConsoleRun::ConsoleRun(Scenario& scenario, const ConsoleRequest& request)
    : scenario_(scenario),
      request_(request),
      options_(OptionsOn(request)),
      machine_(MakeConsole(request)) {  // before pricing: what cannot be needs none
  if (request_.frames == 0) request_.frames = scenario.default_frames;
  costs_ = Price(scenario_, request_, options_);
  const Plan priced = RunningScenario(scenario_, options_).scene().plan();
  if (request_.console == Console::kPs3) ChargeCode(priced);
  try {
    running_ = std::make_unique<RunningScenario>(scenario_, options_);
  } catch (const Error& error) {
    throw Error(fmt::format("{} on {}: {}", scenario_.name, machine_.name, error.what()));
  }
  // Where code leaves more room than was thought, large layers sort in other stages.
  if (!std::ranges::equal(
          priced.stages, running_->scene().plan().stages, {},
          [](const Stage& s) { return s.kernel.name; },
          [](const Stage& s) { return s.kernel.name; }))
    costs_ = Price(scenario_, request_, options_);
  MakeExecutor(running_->scene());
}

// Plans know the blocks of a pass, not its code: they are made again with what its stages turned out to have.
void ConsoleRun::ChargeCode(const Plan& priced) {
  std::map<std::string_view, uint32_t> taken;
  for (size_t s = 0; s < priced.stages.size(); ++s) {
    const KernelDesc& kernel = priced.stages[s].kernel;
    taken[kernel.name] = costs_.stages[s].code_bytes + uint32_t(kernel.params_bytes);
  }
  const SpuRuntimeParameters& runtime = machine_.runtime;
  options_.plan.code_and_data_bytes =
      machine_.local_store_bytes - runtime.code_bytes - runtime.stack_bytes;
  options_.plan.code_bytes = [taken = std::move(taken)](std::string_view kernel) {
    const auto found = taken.find(kernel);
    return found == taken.end() ? 0 : found->second;
  };
}

std::unique_ptr<ConsoleExecutor> ConsoleRun::MakeExecutor(const FurScene& scene) const {
  auto console = ConsoleExecutor::Make(machine_, costs_, scene.CurrentFrame());
  if (!console)
    throw Error(fmt::format("{} on {}: {}", scenario_.name, machine_.name, console.error()));
  return *std::move(console);
}

ConsoleBudget ConsoleRun::Run() {
  running_.reset();  // before there is another
  running_ = std::make_unique<RunningScenario>(scenario_, options_);
  RunningScenario host(scenario_, options_);
  FurScene& scene = running_->scene();
  const auto console = MakeExecutor(scene);
  console->KeepTimelines(true);
  ConsoleBudget budget;
  budget.scene = scenario_.name;
  budget.layers = scene.shape().layer_count;
  budget.characters = scene.shape().character_count;
  budget.strands = scene.layout().strand_count;
  budget.machine = machine_;
  budget.costs = costs_;
  budget.stores = console->stores();

  SerialExecutor serial;
  FrameStatistics statistics(machine_, scene.plan());
  OtherOrder scheduled(machine_, 0.0, scene.plan()), as_written(machine_, 1.0, scene.plan());
  for (uint32_t f = 0; f < request_.warm_up; ++f)
    for (RunningScenario* running : {running_.get(), &host}) {
      running->Begin(f, request_.skip, request_.lod);
      serial.Run(running->scene().CurrentFrame());
    }
  for (uint32_t f = 0; f < request_.frames; ++f) {
    if (request_.progress) request_.progress(f, request_.frames);
    running_->Begin(request_.warm_up + f, request_.skip, request_.lod);
    console->Run(scene.CurrentFrame());
    const ModelledFrame& frame = console->modelled();
    statistics.Add(frame);
    scheduled.Add(console->work());
    as_written.Add(console->work());
    // Not the first frames, in which all starts afresh; of few frames the last.
    if (f % kLimitsEvery == kLimitsEvery - 1 || (f + 1 == request_.frames && f < kLimitsEvery))
      statistics.AddLimits(frame, console->work());
    if (frame.cycles > budget.slowest.cycles) budget.slowest = frame;
    host.Begin(request_.warm_up + f, request_.skip, request_.lod);
    serial.Run(host.scene().CurrentFrame());
    if (f % kDigestEvery != 0 && f + 1 != request_.frames) continue;
    budget.digest = scene.DigestFrame();
    ++budget.digests_compared;
    if (budget.digest != host.scene().DigestFrame() && !budget.differs_at) budget.differs_at = f;
  }
  budget.summary = statistics.Summarise();
  budget.scheduled_ms = scheduled.Summarise();
  budget.as_written_ms = as_written.Summarise();
  budget.warm_up = request_.warm_up;
  budget.live_strands = scene.LiveStrands();
  budget.drawn_strands = scene.DrawnStrands();
  budget.faults = Describe(console->faults());
  const uint32_t last = request_.warm_up + request_.frames - 1;
  const Camera camera = host.Prepare(last, request_.skip, request_.lod).camera;
  budget.gpu =
      request_.console == Console::kPs3 ? request_.numbers.cell.gpu : request_.numbers.xenon.gpu;
  budget.draws = FindDrawPasses(scene, MakeView(camera));
  return budget;
}

FrameSummary ConsoleRun::Time(const SkipSettings& skip, const LodSettings& lod, uint32_t warm_up,
                              uint32_t frames, uint32_t* live_strands) const {
  RunningScenario running(scenario_, options_);
  const auto console = MakeExecutor(running.scene());
  FrameStatistics statistics(machine_, running.scene().plan());
  SerialExecutor serial;
  for (uint32_t f = 0; f < warm_up + frames; ++f) {
    running.Begin(f, skip, lod);
    if (f < warm_up) {
      serial.Run(running.scene().CurrentFrame());
      continue;
    }
    console->Run(running.scene().CurrentFrame());
    statistics.Add(console->modelled());
  }
  if (live_strands) *live_strands = running.scene().LiveStrands();
  return statistics.Summarise();
}

ConsoleRun::LodTrial ConsoleRun::TryLod(const LodSettings& lod, Trial trial) {
  SkipSettings skip = request_.skip;
  skip.lod = true;
  const bool all = trial == Trial::kAllFrames;
  // Of few frames the first, in which all starts afresh, would be too many.
  const uint32_t warm_up = std::max(request_.warm_up, all ? 0 : kTrialFrames / 2);
  LodTrial out;
  const FrameSummary summary =
      Time(skip, lod, warm_up, all ? request_.frames : kTrialFrames / 2, &out.live_strands);
  out.ms = machine_.Available(all ? summary.p95_ms : summary.worst_ms);
  return out;
}

double ConsoleRun::TimeVerdictMs() const {
  return machine_.Available(
      Time(request_.skip, request_.lod, request_.warm_up, request_.frames, nullptr).p95_ms);
}

namespace {

// Strand budgets are looked for to within a 64th of the scene's strands.
constexpr uint32_t kSteps = 64;

using Trial = ConsoleRun::Trial;
using LodTrial = ConsoleRun::LodTrial;

// A strand budget in kSteps-ths of `most`, found on few frames and then checked against all of them,
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
