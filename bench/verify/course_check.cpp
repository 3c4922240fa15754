#include "bench/verify/course_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "bench/verify/checks.hpp"
#include "bench/verify/random_course.hpp"
#include "core/character/builtin_character.hpp"
#include "core/character/pose.hpp"
#include "core/error.hpp"
#include "core/groom/bake.hpp"
#include "core/kernels/frame_table.hpp"
#include "core/random.hpp"

namespace pelt {

namespace {

// Now and then at a bound or anywhere between; else what it usually is, or about that.
double DrawNumber(Random& random, double low, double high, double usual) {
  const uint32_t how = random.Below(32);
  if (how == 0) return low;
  if (how == 1) return high;
  if (how < 4) return random.Uniform(low, high);
  if (how < 18) return usual;
  // What is 0 when unsaid is drawn on all scales below its bound.
  double value = usual != 0.0 ? usual * 4.0 : high;
  value *= random.Uniform(0.5, 1.0) / double(1u << random.Below(usual != 0.0 ? 5 : 12));
  if (low < 0.0 && random.Below(2)) value = -value;
  return std::clamp(value, low, high);
}

template <class T>
void DrawParam(Random& random, const LayerParamRow<T>& row, T& value) {
  if constexpr (std::is_same_v<T, float>) {
    value = float(DrawNumber(random, row.low, row.high, double(value)));
  } else if constexpr (std::is_same_v<T, bool> || std::is_enum_v<T>) {
    value = T(random.Below(uint32_t(row.high) + 1));
  } else if constexpr (std::is_same_v<T, uint32_t>) {
    value = uint32_t(DrawNumber(random, row.low, row.high, double(value)));
  } else {
    for (auto& element : value)
      element = float(DrawNumber(random, row.low, row.high, double(element)));
  }
}

void SetUsual(LayerParams& params, std::string_view key) {
  ForEachLayerParam([&](const auto& row) {
    if (row.key == key) params.*row.member = LayerParams{}.*row.member;
  });
}

// What does not go together is unsaid again, key by key.
LayerParams DrawParams(Random& random) {
  constexpr uint32_t kPoints[] = {4, 5, 9};
  LayerParams params;
  ForEachLayerParam([&](const auto& row) { DrawParam(random, row, params.*row.member); });
  params.points = kPoints[random.Below(3)];
  params.max_distance =
      std::max(params.max_distance, params.max_distance > 0.0f ? kLeastMaxDistance : 0.0f);
  while (const auto bad = FindBadCombination(params)) SetUsual(params, bad->key);
  return params;
}

Attribute DrawAttribute(Random& random, const StrandAttribute& row, const Attribute& usual) {
  Attribute drawn(float(DrawNumber(random, row.low, row.high, double(usual.value))));
  if (random.Below(2)) drawn.randomise = float(random.Uniform());
  if (random.Below(4) == 0) {
    const float ends[] = {float(DrawNumber(random, row.low, row.high, double(usual.value))),
                          float(DrawNumber(random, row.low, row.high, double(usual.value)))};
    drawn.range = glm::vec2(std::min(ends[0], ends[1]), std::max(ends[0], ends[1]));
  }
  return drawn;
}

glm::vec3 DrawVector(Random& random, float low, float high) {
  glm::vec3 v;
  for (int c = 0; c < 3; ++c) v[c] = float(random.Uniform(low, high));
  return v;
}

template <class T>
const T& DrawOne(Random& random, const std::vector<T>& from) {
  return from[random.Below(uint32_t(from.size()))];
}

LayerSetup DrawLayer(Random& random, const Character& character, std::string name) {
  LayerSetup layer;
  layer.name = std::move(name);
  layer.seed = random.U64();
  layer.params = DrawParams(random);
  for (const StrandAttribute& row : kStrandAttributes)
    layer.*row.member = DrawAttribute(random, row, layer.*row.member);
  layer.max_strands = 1 + random.Below(200);
  layer.density = 1.0e4f * float(1u << random.Below(6));
  layer.clump_controls = 16u << random.Below(3);
  layer.film_strip_count = 1 + random.Below(4);
  layer.base_colour = random.U32();
  layer.tip_colour = random.U32();
  for (uint32_t i = random.Below(3); i > 0; --i)
    layer.comb.push_back({DrawVector(random, -0.5f, 1.0f), DrawVector(random, -1.0f, 1.0f),
                          float(random.Uniform(0.05, 0.5))});
  layer.comb_normal_weight = float(random.Uniform());
  if (random.Below(4) == 0) layer.comb_joint = DrawOne(random, character.skeleton.name);
  if (random.Below(2)) layer.mask.materials = {DrawOne(random, character.mesh.materials)};
  return layer;
}

// Both of them take a while to make, so they are made once.
const Character& SmallCharacter(BuiltinBody body) {
  static const Character kMonster = MakeBuiltinCharacter({.tiny = true});
  static const Character kScorpion =
      MakeBuiltinCharacter({.body = BuiltinBody::kScorpion, .tiny = true});
  return body == BuiltinBody::kMonster ? kMonster : kScorpion;
}

// Throws Error where a layer comes out without a strand.
void AddActor(Random& random, Scenario& scenario) {
  const Character& character = SmallCharacter(BuiltinBody(random.Below(4) == 0));
  FurSetup setup;
  setup.path = "drawn";
  const uint32_t layers = 1 + random.Below(4);
  for (uint32_t l = 0; l < layers; ++l)
    setup.layers.push_back(
        DrawLayer(random, character, fmt::format("{}.{}", scenario.actors.size(), l)));
  setup.layers[0].params.enabled = true;
  constexpr float kSizes[] = {1.0f, 1.0f, 1.0f, 0.25f, 3.0f};
  Actor actor{};
  actor.character = uint32_t(scenario.characters.size());
  actor.groom = uint32_t(scenario.grooms.size());
  actor.clip = int32_t(random.Below(uint32_t(character.clips.size()) + 1)) - 1;
  actor.phase_s = random.Uniform();
  actor.weather_share = float(random.Uniform());
  const float size = kSizes[random.Below(5)];
  for (int c = 0; c < 3; ++c) actor.placement[c][c] = size;
  actor.placement[3] = glm::vec4(DrawVector(random, -0.3f, 0.3f), 1.0f);
  if (random.Below(3) == 0) {
    actor.teleport_frame = int32_t(random.Below(50));
    actor.teleport_by = DrawVector(random, -1.0f, 1.0f);
  }
  scenario.grooms.push_back(
      BakeGroom(character, ComputeRestGeometry(character, 1.0f), setup, 1.0f));
  scenario.characters.push_back(character);
  scenario.actors.push_back(actor);
}

RandomScene DrawFrom(Random random) {
  RandomScene drawn;
  Scenario& scenario = drawn.scenario;
  scenario.name = "drawn";
  for (uint32_t c = 1 + random.Below(2); c > 0; --c) AddActor(random, scenario);
  scenario.velocities = random.Below(2);
  scenario.origins = random.Below(3) == 0;
  if (scenario.origins && random.Below(2)) scenario.place = glm::dvec3(1.0e4, 0.0, -5.0e3);
  drawn.skip.cull = random.Below(4) == 0;
  drawn.skip.lod = random.Below(3) == 0;
  drawn.lod.strand_budget = random.Below(2) ? uint32_t(scenario.StrandCount() / 2) : 0;
  drawn.lod.fast_quality_px = float(random.Below(3));
  drawn.lod.budget_us = 50 * random.Below(4);
  drawn.lod.costs = {400.0f, 5.0f, 100.0f, {20.0f, 10.0f, 40.0f, 80.0f, 160.0f}};
  drawn.lod.least_chains = 0.5f * float(random.Below(3));
  DrawCourse(random, scenario);
  size_t layers = 0;
  for (const Groom& groom : scenario.grooms) layers += groom.layers.size();
  drawn.text =
      fmt::format("{} layers, {} strands{}{}", layers, scenario.StrandCount(),
                  scenario.velocities ? ", velocities" : "", scenario.origins ? ", origins" : "");
  return drawn;
}

template <class T>
std::string ShowValue(const LayerParamRow<T>& row, const T& value) {
  if constexpr (std::is_enum_v<T>)
    return fmt::format("\"{}\"", row.words[size_t(value)]);
  else if constexpr (std::is_class_v<T>)
    return fmt::format("[{}, {}, {}]", value[0], value[1], value[2]);
  else
    return fmt::format("{}", value);
}

}  // namespace

RandomScene DrawScene(uint64_t seed) {
  for (uint64_t attempt = 0;; ++attempt) try {
      return DrawFrom(Random(MixSeed(seed, attempt)));
    } catch (const Error&) {  // a layer without a strand: the next
      if (attempt == 1000) throw;
    }
}

std::string DescribeDrawn(const LayerParams& params) {
  std::string text;
  const LayerParams usual;
  ForEachLayerParam([&](const auto& row) {
    if (params.*row.member == usual.*row.member) return;
    text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", row.key,
                        ShowValue(row, params.*row.member));
  });
  return text;
}

namespace {

// An interlude's input is that of another frame, so that anything that is taken from it shows.
constexpr uint32_t kElsewhere = 7;
constexpr std::string_view kNames[] = {"a refused frame", "a pause", "the same grooms again",
                                       "another scene goes on"};
static_assert(std::size(kNames) == kInterludes);

std::optional<Finding> MoveOn(CaseTurn& turn, Scenario& scenario, const FrameSettings& settings,
                              const VerifyOptions& options) {
  auto next = std::make_unique<CaseRun>(scenario, turn.what, settings, options.tamper);
  if (!next->scene().CopyStateFrom(turn.run->scene()))
    return Finding{FindingKind::kExecutor, "", "", "a scene of the same case refuses its state"};
  turn.run = std::move(next);
  return {};
}

}  // namespace

std::string_view InterludeName(Interlude what) { return kNames[size_t(what)]; }

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

namespace {

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

}  // namespace

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
  std::vector<const ExecutorRow*> rows;
  for (const ExecutorRow& row : ExecutorRows())
    if (!row.stages_alone && row.IsAvailable()) rows.push_back(&row);
  for (const Isa isa : kAllIsas) {
    VerifyCase what;
    what.isa = isa;
    what.executor = *rows[(seed + uint64_t(isa)) % rows.size()];
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
    turn.last = fmt::format(", {} ahead of frame {}", InterludeName(interlude), frame);
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
