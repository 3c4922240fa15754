// A scene's course in lock-step on every instruction set, executors in rotation, with what may stand between two
// frames and with other grooms from some frame on.
//
// The reference leaves out nothing but what changes the picture, and has no interludes.
#include <fmt/format.h>

#include <memory>
#include <utility>

#include "bench/verify/checks.hpp"
#include "bench/verify/frame_digests.hpp"
#include "bench/verify/random_course.hpp"
#include "core/kernels/frame_table.hpp"
#include "core/random.hpp"
#include "traces/digest.hpp"

namespace pelt {
namespace {

// ---- Interludes ------------------------------------------------------------------------------

// What may stand between two frames and changes no bit of any frame after it.
enum class Interlude : uint8_t {
  kRefused,   // a frame is refused
  kPause,     // time stands still, and the eye is elsewhere
  kReplaced,  // the grooms are replaced by the same ones
  kMoved,     // another scene goes on from the state
};
constexpr uint32_t kInterludes = 4;
constexpr std::string_view kNames[] = {"a refused frame", "a pause", "the same grooms again",
                                       "another scene goes on"};
static_assert(std::size(kNames) == kInterludes);

// A scene that is run by a case, and may go over to another scene of that case.
struct CaseTurn {
  VerifyCase what;
  std::unique_ptr<CaseRun> run;
  std::string last;  // interlude, and ahead of which frame
};

std::optional<Finding> MoveOn(CaseTurn& turn, Scenario& scenario, const FrameSettings& settings,
                              const VerifyOptions& options) {
  auto next = std::make_unique<CaseRun>(scenario, turn.what, settings, options.tamper);
  if (!next->scene().CopyStateFrom(turn.run->scene()))
    return Finding{FindingKind::kExecutor, "", "", "a scene of the same case refuses its state"};
  turn.run = std::move(next);
  return {};
}

// An interlude's input is that of another frame, so that anything that is taken from it shows.
constexpr uint32_t kElsewhere = 7;

// Ahead of frame `frame`. What does not happen as it should is returned.
std::optional<Finding> Interrupt(CaseTurn& turn, Interlude interlude, Scenario& scenario,
                                 const FrameSettings& settings, uint32_t frame,
                                 const VerifyOptions& options) {
  CaseRun& run = *turn.run;
  const auto with_step = [&](double dt_s) {
    return run.TryRunFrame(frame + kElsewhere,
                           [dt_s](FrameInput& input, FurScene&) { input.dt_s = dt_s; });
  };
  switch (interlude) {
    case Interlude::kRefused:
      if (!with_step(-1.0)) return {};
      return Finding{FindingKind::kExecutor, "", "", "a frame of negative time is run"};
    case Interlude::kPause:
      // A first frame of no time is a frame; and what is culled keeps the keys of the last eye that saw it.
      if (frame > 0 && !settings.skip.cull) with_step(0.0);
      return {};
    case Interlude::kReplaced:
      if (run.scene().ReplaceGrooms(scenario.ActorGrooms())) return {};
      return Finding{FindingKind::kExecutor, "", "", "the same grooms are refused"};
    case Interlude::kMoved:
      return MoveOn(turn, scenario, settings, options);
  }
  return {};
}

// ---- The check -------------------------------------------------------------------------------

constexpr uint32_t kLongCourseFrames = 75;   // of a scene that is not drawn: over a second
constexpr uint32_t kBetweenInterludes = 12;  // frames, in the mean

// The same strands with other values, as a setup is tuned.
Scenario Tune(const Scenario& scenario) {
  Scenario tuned = scenario;
  for (Groom& groom : tuned.grooms)
    for (GroomLayer& layer : groom.layers) {
      LayerParams& params = layer.params;
      params.weight *= 0.75f;
      params.wind_response *= 0.5f;
      params.tip_width *= 0.5f;
      params.damping_ratio *= 0.5f;
      params.friction *= 0.5f;
    }
  return tuned;
}

FrameSettings WithSkips(const SkipSettings& skip, const FrameSettings& of) {
  FrameSettings settings{skip, of.lod};
  settings.skip.cull = of.skip.cull;
  settings.skip.lod = of.skip.lod;
  return settings;
}

class CourseCheck {
 public:
  // Of `settings` culling and LOD count. The scenario must outlive this.
  CourseCheck(Scenario& scenario, const FrameSettings& settings, uint64_t seed,
              const VerifyOptions& options);

  // Once: runs the frames, and adds what is found to `result`.
  void Run(uint32_t frames, CheckResult& result);
  uint64_t digest() const { return digest_.Value(); }  // of the reference

 private:
  void AddTurns(uint64_t seed);
  // False when it parts from the reference there, and is not run on.
  bool RunTurn(CaseTurn& turn, uint32_t frame, CaseRun& reference, const StreamDigests& expected,
               CheckResult& result);
  std::string KeysOf(const Mismatch& mismatch) const;

  Random random_;
  Scenario &scenario_, *grooms_;  // the latter has the grooms of now
  Scenario tuned_;
  const VerifyOptions& options_;
  FrameSettings never_, skips_;
  VertexOrder order_;
  std::vector<CaseTurn> turns_;
  Digest digest_;
};

CourseCheck::CourseCheck(Scenario& scenario, const FrameSettings& settings, uint64_t seed,
                         const VerifyOptions& options)
    : random_(MixSeed(seed, ~0ull)),
      scenario_(scenario),
      grooms_(&scenario),
      tuned_(Tune(scenario)),
      options_(options),
      never_(WithSkips(NoSkips(), settings)),
      skips_(WithSkips({}, settings)),
      order_(random_.Below(2) ? VertexOrder::kSorted : VertexOrder::kIndexBuffer) {
  AddTurns(seed);
}

void CourseCheck::AddTurns(uint64_t seed) {
  std::vector<const ExecutorEntry*> entries;
  for (const ExecutorEntry& entry : ExecutorEntries())
    if (!entry.stages_alone && entry.IsAvailable()) entries.push_back(&entry);
  for (const Isa isa : kAllIsas) {
    VerifyCase what;
    what.isa = isa;
    what.executor = *entries[(seed + uint64_t(isa)) % entries.size()];
    const uint32_t workers = random_.Below(4) ? 2 + random_.Below(3) : 20;
    if (what.executor->HasWorkers()) what.workers = workers;
    what.order_seed = random_.Below(100);
    what.fuse = random_.Below(4) != 0;
    what.vertex_order = order_;
    what.piecewise_sort = random_.Below(4) == 0;
    if (!FindKernels(isa) || (options_.filter && !options_.filter(what))) continue;
    auto run = std::make_unique<CaseRun>(scenario_, what, skips_, options_.tamper);
    turns_.push_back({what, std::move(run), {}});
  }
}

void CourseCheck::Run(uint32_t frames, CheckResult& result) {
  VerifyCase what;
  what.vertex_order = order_;
  CaseRun reference(scenario_, what, never_, {});
  const uint32_t tuned_from = frames / 3 + random_.Below(frames / 3);
  for (uint32_t f = 0; f < frames; ++f) {
    if (f == tuned_from) {
      grooms_ = &tuned_;
      bool taken = reference.GoOnWith(tuned_);
      for (CaseTurn& turn : turns_) taken &= turn.run->GoOnWith(tuned_);
      if (!taken) result.Fail({FindingKind::kExecutor, "", "", "tuned grooms are refused"});
    }
    reference.RunFrame(f);
    digest_.Add64(reference.scene().DigestFrame());
    const StreamDigests expected = DigestsOf(reference.scene());
    std::erase_if(turns_,
                  [&](CaseTurn& turn) { return !RunTurn(turn, f, reference, expected, result); });
  }
  for (const CaseTurn& turn : turns_)
    for (const Finding& finding : turn.run->executor().Findings()) result.Fail(finding);
}

bool CourseCheck::RunTurn(CaseTurn& turn, uint32_t frame, CaseRun& reference,
                          const StreamDigests& expected, CheckResult& result) {
  if (random_.Below(kBetweenInterludes) == 0) {
    const auto interlude = Interlude(random_.Below(kInterludes));
    turn.last = fmt::format(", {} ahead of frame {}", kNames[size_t(interlude)], frame);
    if (const auto wrong = Interrupt(turn, interlude, *grooms_, skips_, frame, options_))
      result.Fail(*wrong);
  }
  turn.run->RunFrame(frame);
  ++result.seen;
  if (SameDigests(expected, DigestsOf(turn.run->scene()), {.bookkeeping = false})) return true;
  const auto mismatch = FindMismatch(reference, *turn.run, frame);
  if (!mismatch) return true;
  const bool first = result.passed;
  if (first) result.mismatch = mismatch;
  result.Fail(
      {FindingKind::kValue, mismatch->stage, mismatch->stream,
       fmt::format("{}{}: {}{}", NameCase(turn.what), turn.last, DescribeMismatch(*mismatch),
                   first ? KeysOf(*mismatch) : std::string())});
  return false;
}

std::string CourseCheck::KeysOf(const Mismatch& mismatch) const {
  for (const Groom& groom : scenario_.grooms)
    for (const GroomLayer& layer : groom.layers)
      if (layer.name == mismatch.layer) return "; its keys: " + DescribeDrawn(layer.params);
  return {};
}

}  // namespace

VerifyReport VerifyRandom(uint32_t count, uint64_t seed, const VerifyOptions& options) {
  VerifyReport report;
  report.scene = fmt::format("drawn from seeds {} to {}", seed, seed + count - 1);
  report.frames = kDrawnFrames;
  report.shard = options.shard;
  for (const Isa isa : kAllIsas)
    if (!FindKernels(isa))
      report.not_run.push_back(fmt::format("instruction set {}", IsaName(isa)));
  Digest digest;
  for (uint64_t s = seed; s < seed + count; ++s) {
    if (options.progress) options.progress(uint32_t(s - seed), count, fmt::format("seed {}", s));
    if (!TakesNext(options, report)) continue;
    RandomScene drawn = DrawScene(s);
    CheckResult result;
    result.section = fmt::format("seed {}", s);
    result.name = drawn.text;
    result.place = report.places - 1;
    CourseCheck check(drawn.scenario, {drawn.skip, drawn.lod}, s, options);
    check.Run(kDrawnFrames, result);
    report.checks.push_back(std::move(result));
    report.characters += uint32_t(drawn.scenario.actors.size());
    report.strands += drawn.scenario.StrandCount();
    digest.Add64(check.digest());
  }
  report.digest = digest.Value();
  return report;
}

void CheckWholeCourse(Scenario& scenario, const VerifyOptions& options, VerifyReport& report) {
  for (const bool apart : {false, true}) {
    Scenario course = scenario;
    course.velocities = course.origins = apart;
    CheckResult result;
    result.section = "course";
    result.name = apart ? "with velocities, origins and LOD" : "as the scene is";
    const Settings settings = apart ? Settings::kLod : Settings::kSkips;
    CourseCheck check(course, FrameSettingsOf(settings, course), apart, options);
    check.Run(kLongCourseFrames, result);
    report.checks.push_back(std::move(result));
  }
}

}  // namespace pelt
