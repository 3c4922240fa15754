// A sleeper must see every input that changes.
//
// The scene comes to rest until most of its chunks sleep, damped where it does not by itself. From
// there one number of its input changes, is held for a frame and goes back; every executor must give
// the bits of a scene with all skips off, which came to rest without ever sleeping. What a pose gives at once (the
// palette, the roots) is also compared with a scene that sees this pose in its first frame: a change that is hidden
// from the one that never sleeps too is found so.
//
// What breaks if ignored: skips are compared where nothing sleeps, or where nothing wakes.
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "bench/verify/checks.hpp"
#include "bench/verify/frame_digests.hpp"
#include "traces/digest.hpp"

namespace pelt {
namespace {

constexpr uint32_t kFramesEach = 4, kFramesChanged = 2;
constexpr uint32_t kFramesAhead = 4;  // where what is around a change differs too

uint32_t CountChunks(const FurScene& scene, bool asleep) {
  uint32_t count = 0;
  for (uint32_t c = 0; c < scene.shape().chunk_count; ++c) {
    const uint32_t flags = scene.memory().Of<&Streams::chunk_state>(c)->flags;
    count += (flags & kChunkVisible) && ((flags & kChunkSimulate) == 0) == asleep;
  }
  return count;
}

// Rows that are a function of this frame's pose alone, or of that and its lights.
struct PoseRow {
  Stream stream;
  std::string_view row;
  InputChange::Part of = InputChange::Part::kPose;
};
constexpr InputChange::Part kLights = InputChange::Part::kLights;
constexpr PoseRow kPoseRows[] = {{StreamOf<&Streams::local_pose>, "translation"},
                                 {StreamOf<&Streams::local_pose>, "rotation"},
                                 {StreamOf<&Streams::local_pose>, "scale"},
                                 {StreamOf<&Streams::palette>, "matrix"},
                                 {StreamOf<&Streams::bounds>, "low"},
                                 {StreamOf<&Streams::bounds>, "high"},
                                 {StreamOf<&Streams::anchors>, "position"},
                                 {StreamOf<&Streams::anchors>, "normal"},
                                 {StreamOf<&Streams::anchors>, "tangent"},
                                 {StreamOf<&Streams::roots>, "position"},
                                 {StreamOf<&Streams::roots>, "normal"},
                                 {StreamOf<&Streams::roots>, "tangent"},
                                 {StreamOf<&Streams::layer_light>, "harmonics", kLights},
                                 {StreamOf<&Streams::layer_light>, "ambient", kLights},
                                 {StreamOf<&Streams::layer_light>, "sun_rgb", kLights},
                                 {StreamOf<&Streams::layer_light>, "rim_rgb", kLights}};

uint64_t DigestPoseRow(const FurScene& scene, const PoseRow& what) {
  const StreamDesc& desc = DescribeStream(what.stream);
  Digest digest;
  for (const RowDesc& row : desc.rows) {
    if (row.name != what.row) continue;
    StreamDesc one = desc;
    one.rows = {&row, 1};
    for (uint32_t i = 0; i < scene.shape().ItemCount(desc.domain); ++i)
      if (const std::byte* block = scene.memory().Block(what.stream, i))
        AddBlock(digest, one, block, scene.LiveLanes(what.stream, i));
  }
  return digest.Value();
}

class WakingCheck {
 public:
  WakingCheck(Scenario& scenario, const VerifyOptions& options, bool lod, bool all,
              VerifyReport& report)
      : scenario_(scenario),
        options_(options),
        report_(report),
        first_frame_(options.frames / 3 + kSettleFrames),
        lod_(lod),
        all_(all),
        asleep_(scenario, Best(), Sleeping(), {}),
        awake_(scenario, Best(), Never(), {}),
        reference_(scenario, Best(), Never(), {}),
        pristine_(scenario, Best(), Never(), {}),
        fresh_(scenario, Best(), Never(), {}) {}

  // False, and nothing reported, when no chunk sleeps and there is another way to have one do so.
  bool Run(bool last_way) {
    if (!ComeToRest(last_way)) return !found_none_;
    MakeRuns();
    for (const InputChange& change : changes_) {
      const bool for_lod = change.part == InputChange::Part::kLod;
      const bool for_both = change.name.starts_with("camera.eye");
      if (lod_ != for_lod && !for_both) continue;
      if (all_ && change.type != InputChange::Type::kOneWay) continue;
      if (change.type == InputChange::Type::kOneWay) {
        TryChange(change, Amount::kMuch);
        continue;
      }
      for (const Amount amount : {Amount::kOneUlp, Amount::kMuch}) TryChange(change, amount);
      if (change.type == InputChange::Type::kDouble) TryChange(change, Amount::kBelowFloat);
    }
    return true;
  }

 private:
  struct Turn {
    VerifyCase what;
    std::unique_ptr<CaseRun> run;
  };

  VerifyCase Best() const { return {.isa = BestIsa()}; }
  FrameSettings Sleeping() const {
    FrameSettings settings = FrameSettingsOf(lod_ ? Settings::kLod : Settings::kSkips, scenario_);
    settings.skip.cull = false;  // what leaves the view starts again: another check's business
    return settings;
  }
  FrameSettings Never() const { return {NoSkips(lod_), Sleeping().lod}; }

  CheckResult NewResult(std::string name) const {
    CheckResult result;
    result.section = all_ ? "waking of all" : "waking";
    result.name = std::move(name);
    return result;
  }

  bool ComeToRest(bool last_way) {
    CheckResult result = NewResult(lod_ ? "coming to rest, LOD" : "coming to rest");
    FrameInput last;
    for (uint32_t f = 0; f < first_frame_; ++f) {
      asleep_.RunFrame(f, [&](FrameInput& input, FurScene&) { last = input; });
      awake_.RunFrame(f);
    }
    result.seen = CountChunks(asleep_.scene(), true);
    const bool rests = result.seen > 0;
    if (!SameDigests(DigestsOf(asleep_.scene()), DigestsOf(awake_.scene()),
                     {.bookkeeping = false})) {
      if (const auto mismatch = FindMismatch(awake_, asleep_, first_frame_ - 1))
        result.Fail(FindingKind::kSkip, *mismatch);
    } else if (!rests) {
      found_none_ = !last_way;
      if (found_none_) return false;
      result.Miss(fmt::format("no chunk sleeps after {} frames, damped too, so none can wake",
                              first_frame_));
    }
    changes_ = ListInputChanges(last, asleep_.scene());
    report_.checks.push_back(result);
    unchanged_.clear();
    reference_.scene().CopyStateFrom(awake_.scene());
    for (uint32_t k = 0; k < kFramesEach; ++k) {
      reference_.RunFrame(first_frame_ + k);
      unchanged_.push_back(DigestsOf(reference_.scene()));
    }
    return rests && result.passed;
  }

  void MakeRuns() {
    std::vector<VerifyCase> cases = {Best()};
    for (const ExecutorEntry& entry : ExecutorEntries().subspan(1)) {
      if (!entry.IsAvailable()) continue;
      VerifyCase what = Best();
      what.executor = entry;
      if (entry.HasWorkers()) what.workers = 2;
      what.order_seed = 1;
      cases.push_back(what);
    }
    for (const VerifyCase& what : cases) {
      auto run = std::make_unique<CaseRun>(scenario_, what, Sleeping(), options_.tamper);
      // A layer too large for a local store sorts in pieces there: a scene of another shape.
      if (run->scene().CopyStateFrom(asleep_.scene())) runs_.push_back({what, std::move(run)});
    }
  }

  static uint32_t AheadOf(const InputChange& change) { return change.around ? kFramesAhead : 0; }

  // Frame k of those ahead of the change and the ones from it on.
  bool Step(CaseRun& run, uint32_t k, const InputChange& change, Amount amount, bool apply) {
    const uint32_t from = AheadOf(change);
    const auto changed = [&](FrameInput& input, FurScene& scene) {
      if (change.around) change.around(input);
      if (k >= from && k < from + kFramesChanged && apply) change.apply(input, scene, amount);
    };
    return run.TryRunFrame(first_frame_ + k, changed);
  }

  // False when the frame refuses the changed input.
  bool RunReference(const InputChange& change, Amount amount, Course& course, CheckResult& result) {
    const bool apply = change.part != InputChange::Part::kSkip;  // it keeps all of them off
    reference_.scene().CopyStateFrom(awake_.scene());
    course.clear();
    for (uint32_t k = 0; k < AheadOf(change) + kFramesEach; ++k) {
      if (!Step(reference_, k, change, amount, apply)) return false;
      course.push_back(DigestsOf(reference_.scene()));
      if (k == 0) CompareWithFresh(change, amount, result);
    }
    return true;
  }

  void CompareWithFresh(const InputChange& change, Amount amount, CheckResult& result) {
    if (std::ranges::none_of(kPoseRows, [&](const PoseRow& r) { return r.of == change.part; }))
      return;
    fresh_.scene().CopyStateFrom(pristine_.scene());
    if (!Step(fresh_, 0, change, amount, true)) return;
    for (const PoseRow& row : kPoseRows) {
      if (row.of != change.part) continue;
      if (DigestPoseRow(fresh_.scene(), row) == DigestPoseRow(reference_.scene(), row)) continue;
      const std::string_view stream = DescribeStream(row.stream).name;
      result.Fail({FindingKind::kSleep, "", std::string(stream),
                   fmt::format("row {} of stream {} is not what the input gives in a first frame: "
                               "the change is not seen",
                               row.row, stream)});
      return;
    }
  }

  void TryChange(const InputChange& change, Amount amount) {
    const bool one_way = change.type == InputChange::Type::kOneWay;
    CheckResult result =
        NewResult(one_way ? change.name : fmt::format("{}, {}", change.name, AmountName(amount)));
    Course course;
    bool accepted = RunReference(change, amount, course, result);
    if (!accepted && amount == Amount::kMuch)
      for (const Amount smaller : {Amount::kLess, Amount::kLittle}) {
        if (accepted) break;
        accepted = RunReference(change, smaller, course, result);
        if (accepted) amount = smaller;
      }
    if (!accepted) {
      result.LeaveOut("the frame refuses the changed input");
    } else {
      const uint32_t ahead = AheadOf(change);
      for (uint32_t k = 0; k < kFramesEach; ++k)
        result.felt |= !SameDigests(course[ahead + k], ahead ? course[ahead - 1] : unchanged_[k],
                                    {.bookkeeping = false});
      for (size_t r = 0; r < runs_.size(); ++r)
        if (r == 0 || options_.every_executor || r == 1 + turn_ % (runs_.size() - 1))
          CompareRun(runs_[r], change, amount, course, result);
      ++turn_;
    }
    report_.checks.push_back(std::move(result));
  }

  void CompareRun(Turn& turn, const InputChange& change, Amount amount, const Course& course,
                  CheckResult& result) {
    CaseRun& run = *turn.run;
    run.scene().CopyStateFrom(asleep_.scene());
    uint32_t awake_before = 0;
    for (uint32_t k = 0; k < AheadOf(change) + kFramesEach; ++k) {
      if (k == AheadOf(change)) awake_before = CountChunks(run.scene(), false);
      Step(run, k, change, amount, true);
      // Fewer are awake where the change lets one sleep: nothing woke then.
      if (k == AheadOf(change))
        result.seen += std::max(CountChunks(run.scene(), false), awake_before) - awake_before;
      if (SameDigests(course[k], DigestsOf(run.scene()), {.bookkeeping = false})) continue;
      FailAt(turn, change, amount, k, result);
      return;
    }
    for (const Finding& finding : run.executor().Findings()) result.Fail(finding);
  }

  void FailAt(Turn& turn, const InputChange& change, Amount amount, uint32_t frames,
              CheckResult& result) {
    Mismatch where;
    where.reproduced = false;
    reference_.scene().CopyStateFrom(awake_.scene());
    turn.run->scene().CopyStateFrom(asleep_.scene());
    for (uint32_t k = 0; k <= frames; ++k) {
      Step(reference_, k, change, amount, change.part != InputChange::Part::kSkip);
      Step(*turn.run, k, change, amount, true);
      if (const auto mismatch = FindMismatch(reference_, *turn.run, first_frame_ + k)) {
        where = *mismatch;
        break;
      }
    }
    result.Fail(FindingKind::kSleep, where);
    result.reason = fmt::format("{}, {} frames after the change: {}", NameCase(turn.what),
                                int(frames) - int(AheadOf(change)), result.reason);
  }

  Scenario& scenario_;
  const VerifyOptions& options_;
  VerifyReport& report_;
  uint32_t first_frame_;
  bool lod_, all_;
  CaseRun asleep_, awake_;    // at rest; the one sleeps, the other never did
  CaseRun reference_;         // goes on from `awake_`
  CaseRun pristine_, fresh_;  // never run; run for one frame from there
  Course unchanged_;          // of it, when nothing changes
  std::vector<InputChange> changes_;
  std::vector<Turn> runs_;  // go on from `asleep_`
  size_t turn_ = 0;
  bool found_none_ = false;  // that sleeps, and another way is left
};

// Has everything swing out: bending as fast as it can without swinging over, and hair that no
// stiffness holds by its drag.
void Damp(Scenario& scenario) {
  for (Groom& groom : scenario.grooms)
    for (GroomLayer& layer : groom.layers) {
      layer.params.damping_ratio = std::max(layer.params.damping_ratio, 1.0f);
      layer.params.velocity_damping = std::max(layer.params.velocity_damping, 20.0f);
    }
}

// Spheres that stand in the resting fur, so that where they stand is felt: at the tip of a strand
// of each solver, as far as there is room for them. And one capsule, across such a tip.
void AddTouchingColliders(Scenario& scenario, uint32_t rest_frames) {
  CaseRun run(scenario, {.isa = BestIsa()}, {NoSkips(), {}}, {});
  for (uint32_t f = 0; f < rest_frames; ++f) run.RunFrame(f);
  const FurScene& scene = run.scene();
  const SceneShape& shape = scene.shape();
  // Chains of the strands themselves: those at mesh vertices stand somewhere else.
  constexpr uint32_t kSolver = kLayerVerlet | kLayerModal | kLayerVertexChains;
  for (const uint32_t solver : {0u, uint32_t(kLayerVerlet), uint32_t(kLayerModal)}) {
    if (scenario.spheres.size() == kSpheresPerScene) return;
    for (uint32_t l = 0; l < shape.layer_count; ++l) {
      const auto& layer = *scene.memory().Of<&Streams::layers>(l);
      if ((shape.layer_kind[l] & kSolver) != solver || !(layer.flags & kLayerSimulate)) continue;
      const uint32_t chunk = shape.layer_first_chunk[l];
      const auto& roots = *scene.memory().Of<&Streams::roots>(chunk);
      const std::array<double, 3> from = scene.OriginOfLayer(l);
      const auto tip_of = [&](int axis) {
        return WithPoints(StrandPointsOf(shape.layer_kind[l]), [&]<uint32_t kPoints> {
          const auto& points = *scene.memory().Of<ChainStreams<kPoints, false>::kPosition>(chunk);
          return float(points.position[kPoints - 2][axis][0] + from[size_t(axis)]);
        });
      };
      MovingSphere sphere;
      sphere.radius = 0.5f * layer.length_max;
      for (int axis = 0; axis < 3; ++axis) {
        const float tip = tip_of(axis);
        sphere.centre[axis] = tip + 0.6f * sphere.radius * roots.normal[axis][0];
      }
      scenario.spheres.push_back(sphere);
      if (!scenario.capsules.empty()) break;
      CapsuleCollider capsule;
      capsule.radius = 0.5f * sphere.radius;
      for (int axis = 0; axis < 3; ++axis) {
        const float tip = tip_of(axis);
        const float across = 1.5f * sphere.radius * roots.tangent[axis][0];
        capsule.from[axis] = tip - across;
        capsule.to[axis] = tip + across;
      }
      scenario.capsules.push_back(capsule);
      break;
    }
  }
}

void CheckWakingOf(Scenario& scenario, const VerifyOptions& options, bool all,
                   VerifyReport& report) {
  const uint32_t rest_before = scenario.rest_from_frame;
  const std::vector<MovingSphere> spheres_before = scenario.spheres;
  const std::vector<CapsuleCollider> capsules_before = scenario.capsules;
  scenario.rest_from_frame = options.frames / 3;
  AddTouchingColliders(scenario, scenario.rest_from_frame + kSettleFrames);
  const std::vector<Groom> grooms_before = scenario.grooms;
  for (const bool lod : {false, true}) {
    if (all && lod) continue;
    if (WakingCheck(scenario, options, lod, all, report).Run(false)) continue;
    Damp(scenario);
    WakingCheck(scenario, options, lod, all, report).Run(true);
    scenario.grooms = grooms_before;
  }
  scenario.rest_from_frame = rest_before;
  scenario.spheres = spheres_before;
  scenario.capsules = capsules_before;
}

}  // namespace

void CheckWaking(Scenario& scenario, const VerifyOptions& options, VerifyReport& report) {
  CheckWakingOf(scenario, options, false, report);
}
void CheckWakingOfAll(Scenario& scenario, const VerifyOptions& options, VerifyReport& report) {
  CheckWakingOf(scenario, options, true, report);
}

}  // namespace pelt
