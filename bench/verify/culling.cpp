// Culling, judged by something else than culling.
//
// The camera looks away from the scene to every side and back, and its near and far planes pass
// through it, so that every layer leaves the view and returns. A second scene culls nothing and
// skips nothing. Where one of a layer's strands is in view there, point by point (ViewTest),
// the layer must not be culled. One that has been in view from the first frame must have the second
// scene's bits; one that returns, those of a scene that begins in that frame, because it starts
// from its groom. What is out of view is not drawn. At last cameras stand so that of each layer the
// outermost tip alone is in view, from six sides: the box has to hold the fur, not only the skin.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "bench/verify/checks.hpp"
#include "bench/verify/frame_digests.hpp"
#include "core/exact_math.hpp"

namespace pelt {
namespace {

constexpr uint32_t kFramesAfterReturn = 3;
// Frames of each part of the camera's course.
constexpr uint32_t kTurning = 13, kNodding = 11, kNear = 6, kFar = 6, kLast = 2;
constexpr uint32_t kCourseFrames = kTurning + kNodding + kNear + kFar + kLast;

void LookAside(Camera& camera, double turn_rad, double nod_rad, double distance) {
  double forward[3];
  for (int i = 0; i < 3; ++i) forward[i] = (double(camera.target[i]) - camera.eye[i]) / distance;
  const double s = exact::Sin(turn_rad), c = exact::Cos(turn_rad);
  const double turned[3] = {c * forward[0] + s * forward[2], forward[1],
                            c * forward[2] - s * forward[0]};
  // Nods by lifting the target: never straight up.
  const double lift = exact::Sin(nod_rad) / exact::Cos(nod_rad);
  for (int i = 0; i < 3; ++i)
    camera.target[i] = float(camera.eye[i] + distance * (turned[i] + (i == 1 ? lift : 0.0)));
}

// The frame's camera instead of the scene's.
void AimCamera(uint32_t frame, Camera& camera) {
  double d2 = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double along = double(camera.target[i]) - camera.eye[i];
    d2 += along * along;
  }
  const double distance = std::sqrt(d2);
  constexpr double kStepRad = 0.12;
  if (frame < kTurning + kNodding) {
    camera.vertical_fov_rad = 0.3f;
    if (frame < kTurning)
      LookAside(camera, (double(frame) - kTurning / 2) * kStepRad, 0.0, distance);
    else
      LookAside(camera, 0.0, (double(frame - kTurning) - kNodding / 2) * kStepRad, distance);
    return;
  }
  uint32_t step = frame - kTurning - kNodding;
  if (step < kNear) {
    camera.near_m = float(distance * (0.4 + 0.25 * step));
  } else if (step -= kNear; step < kFar) {
    camera.far_m = float(distance * (1.5 - 0.2 * step));
  }
}

class CullingCheck {
 public:
  CullingCheck(Scenario& scenario, const VerifyOptions& options)
      : scenario_(scenario),
        options_(options),
        culled_(scenario, Best(), {}, options.tamper),
        seen_(scenario, Best(), {NoSkips(), {}}, {}),
        since_(culled_.scene().shape().layer_count, 0) {
    in_view_ = NewResult("no layer in view is culled");
    stayed_ = NewResult("layers that stay in view");
    returned_ = NewResult("layers that return");
    drawn_ = NewResult("what is out of view is not drawn");
    tips_ = NewResult("no layer is culled whose tips alone are in view");
  }

  void Run(VerifyReport& report) {
    for (uint32_t f = 0; f < kCourseFrames; ++f) {
      Camera camera;
      const auto aim = [&](FrameInput& input, FurScene&) {
        AimCamera(f, input.camera);
        camera = input.camera;
      };
      culled_.RunFrame(f, aim);
      seen_.RunFrame(f, aim);
      StartFresh(f);
      for (Fresh& fresh : fresh_) fresh.run->RunFrame(f, aim);
      JudgeFrame(f, ViewTest(camera));
      std::erase_if(fresh_, [&](const Fresh& x) { return f + 1 >= x.from + kFramesAfterReturn; });
    }
    JudgeTips();
    if (returned_.seen == 0)
      returned_.LeaveOut("no layer left the view and came back on this course");
    for (CheckResult* result : {&in_view_, &stayed_, &returned_, &drawn_, &tips_})
      report.checks.push_back(*result);
    for (const ExecutorKind kind : {"tbb", "permuted", "local-store"})
      report.checks.push_back(CompareExecutor(kind));
  }

 private:
  struct Fresh {
    uint32_t from;
    std::unique_ptr<CaseRun> run;
  };
  static constexpr uint32_t kHidden = ~0u;

  static VerifyCase Best() { return {.isa = BestIsa()}; }
  static CheckResult NewResult(std::string name) {
    CheckResult result;
    result.section = "culling";
    result.name = std::move(name);
    return result;
  }
  static bool IsVisible(const FurScene& scene, uint32_t layer) {
    return scene.memory().Of<&Streams::lod>(layer)->visible != 0;
  }
  std::string NameLayer(uint32_t layer) {
    return fmt::format("layer '{}' of character {}", culled_.scene().LayerName(layer),
                       culled_.scene().shape().layer_character[layer]);
  }
  static void FailOnce(CheckResult& result, std::string_view stage, std::string_view stream,
                       std::string text) {
    if (result.passed)
      result.Fail({FindingKind::kCull, std::string(stage), std::string(stream), std::move(text)});
  }

  // What each patch and chunk of the layer does in the frame just run, but for paint: what was on it
  // before is on it still, and may be all there can be.
  static std::vector<uint32_t> FlagsOf(const FurScene& scene, uint32_t layer) {
    const SceneShape& shape = scene.shape();
    std::vector<uint32_t> flags;
    for (uint32_t p = shape.layer_first_patch[layer]; p < shape.layer_first_patch[layer + 1]; ++p)
      flags.push_back(scene.memory().Of<&Streams::patch_state>(p)->flags);
    for (uint32_t c = shape.layer_first_chunk[layer]; c < shape.layer_first_chunk[layer + 1]; ++c)
      flags.push_back(scene.memory().Of<&Streams::chunk_state>(c)->flags & ~kChunkPainted);
    return flags;
  }

  // A scene that begins in this frame, if some layer returns in it.
  void StartFresh(uint32_t frame) {
    bool any = false;
    for (uint32_t l = 0; l < since_.size(); ++l) {
      if (!IsVisible(culled_.scene(), l)) {
        since_[l] = kHidden;
      } else if (since_[l] == kHidden) {
        since_[l] = frame;
        any = true;
      }
    }
    if (!any) return;
    auto run = std::make_unique<CaseRun>(scenario_, Best(), FrameSettings{NoSkips(), {}},
                                         std::function<void(const VerifyCase&, Plan&)>{});
    fresh_.push_back({frame, std::move(run)});
  }

  void JudgeFrame(uint32_t frame, const ViewTest& view) {
    for (uint32_t l = 0; l < since_.size(); ++l) {
      const auto point = FindPointInView(l, view);
      in_view_.seen += point.has_value();
      if (since_[l] == kHidden) {
        if (point) FailInView(in_view_, frame, l, *point);
        JudgeHidden(frame, l);
      } else if (since_[l] == 0) {
        ++stayed_.seen;
        if (DigestLayer(culled_.scene(), l) != DigestLayer(seen_.scene(), l))
          FailOnce(stayed_, "", "",
                   fmt::format("frame {}: {} was in view from the first frame on, and is not what "
                               "it is without culling",
                               frame, NameLayer(l)));
      } else {
        JudgeReturned(frame, l);
      }
    }
    JudgeDrawList(frame);
  }

  struct Point {
    uint32_t piece, strand, number;  // chunk in its layer; of shells patch, vertex
    float at[3];
  };
  static constexpr uint32_t kRoot = 0;

  // Of the scene that culls nothing: each point that is no farther from its root than the layer's
  // box is promised to hold, until `visit` returns true.
  template <class Visit>
  void ForEachPoint(uint32_t layer, Visit visit) {
    const FurScene& scene = seen_.scene();
    if (!IsVisible(scene, layer)) return;  // switched off, or without strands
    const SceneShape& shape = scene.shape();
    const float reach = scene.memory().Of<&Streams::layers>(layer)->length_max;
    const std::array<double, 3> from = scene.OriginOfLayer(layer);
    if (shape.layer_kind[layer] & kLayerShells) return ForEachShellPoint(layer, visit);
    WithPoints(StrandPointsOf(shape.layer_kind[layer]),
               [&]<uint32_t kPoints> { ForEachStrandPoint<kPoints>(layer, reach, from, visit); });
  }

  template <uint32_t kPoints, class Visit>
  void ForEachStrandPoint(uint32_t layer, float reach, const std::array<double, 3>& from,
                          Visit visit) {
    const FurScene& scene = seen_.scene();
    const SceneShape& shape = scene.shape();
    for (uint32_t c = shape.layer_first_chunk[layer]; c < shape.layer_first_chunk[layer + 1]; ++c) {
      const auto& roots = *scene.memory().Of<&Streams::roots>(c);
      const auto& points = *scene.memory().Of<ChainStreams<kPoints, false>::kPosition>(c);
      const uint32_t strands = scene.memory().Of<&Streams::strands>(c)->strand_count;
      for (uint32_t s = 0; s < strands; ++s)
        for (uint32_t p = 0; p < kPoints; ++p) {
          Point point{c - shape.layer_first_chunk[layer], s, p, {}};
          double away2 = 0.0;
          for (int axis = 0; axis < 3; ++axis) {
            const float root = roots.position[axis][s];
            point.at[axis] = p == kRoot ? root : points.position[p - 1][axis][s];
            away2 += (double(point.at[axis]) - root) * (double(point.at[axis]) - root);
            point.at[axis] = float(point.at[axis] + from[size_t(axis)]);
          }
          if (away2 < double(reach) * reach && visit(point)) return;
        }
    }
  }

  // Of every vertex, on the skin and at the tips.
  template <class Visit>
  void ForEachShellPoint(uint32_t layer, Visit visit) {
    const FurScene& scene = seen_.scene();
    const SceneShape& shape = scene.shape();
    const std::array<double, 3> from = scene.OriginOfLayer(layer);
    for (uint32_t p = shape.layer_first_patch[layer]; p < shape.layer_first_patch[layer + 1]; ++p) {
      const auto& vertices = *scene.memory().Of<&Streams::shell_vertices>(p);
      const uint32_t count = scene.memory().Of<&Streams::patch_state>(p)->live_vertices;
      for (uint32_t v = 0; v < count; ++v)
        for (uint32_t end = 0; end < 2; ++end) {
          const ShellVertex& vertex = vertices.vertex[v];
          Point point{p - shape.layer_first_patch[layer], v, end, {}};
          for (int axis = 0; axis < 3; ++axis)
            point.at[axis] =
                float(vertex.position[axis] +
                      float(end) * (vertex.groom[axis] + vertex.force[axis]) + from[size_t(axis)]);
          if (visit(point)) return;
        }
    }
  }

  std::optional<Point> FindPointInView(uint32_t layer, const ViewTest& view) {
    std::optional<Point> found;
    ForEachPoint(layer, [&](const Point& point) {
      if (view.IsClearlyInside(point.at)) found = point;
      return found.has_value();
    });
    return found;
  }

  // A camera before the layer's outermost point, looking at the layer, that sees no farther.
  static void AimAtTip(const Point& tip, int axis, float inwards, float reach, Camera& camera) {
    for (int i = 0; i < 3; ++i) {
      camera.target[i] = tip.at[i];
      camera.eye[i] = tip.at[i] - (i == axis ? inwards * reach : 0.0f);
      camera.up[i] = i == (axis + 1) % 3 ? 1.0f : 0.0f;
    }
    camera.vertical_fov_rad = 0.3f;
    camera.near_m = 0.5f * reach;
    camera.far_m = 1.001f * reach;
  }

  // All of one frame of the pose: the boxes depend on nothing else. In the rest pose no joint's box
  // is turned, so that those of the skin alone are as small as they can be.
  void JudgeTips() {
    const std::vector<Actor> actors = scenario_.actors;
    for (Actor& actor : scenario_.actors) actor.clip = -1;
    seen_.RunFrame(kCourseFrames);
    for (uint32_t l = 0; l < since_.size(); ++l) {
      Point outermost[3][2] = {};
      bool any = false;
      ForEachPoint(l, [&](const Point& point) {
        for (int axis = 0; axis < 3; ++axis) {
          auto& [low, high] = outermost[axis];
          if (!any || point.at[axis] < low.at[axis]) low = point;
          if (!any || point.at[axis] > high.at[axis]) high = point;
        }
        any = true;
        return false;
      });
      const float reach = seen_.scene().memory().Of<&Streams::layers>(l)->length_max;
      for (int side = 0; any && side < 6; ++side)
        JudgeTip(l, outermost[side / 2][side % 2], side / 2, side % 2 ? -1.0f : 1.0f, reach);
    }
    scenario_.actors = actors;
    if (tips_.seen == 0) tips_.LeaveOut("no layer has a strand");
  }

  void JudgeTip(uint32_t layer, const Point& tip, int axis, float inwards, float reach) {
    Camera camera;
    culled_.RunFrame(kCourseFrames, [&](FrameInput& input, FurScene&) {
      AimAtTip(tip, axis, inwards, reach, input.camera);
      camera = input.camera;
    });
    if (!ViewTest(camera).IsClearlyInside(tip.at)) return;
    ++tips_.seen;
    if (!IsVisible(culled_.scene(), layer)) FailInView(tips_, kCourseFrames, layer, tip);
  }

  void FailInView(CheckResult& result, uint32_t frame, uint32_t layer, const Point& p) {
    FailOnce(result, "select_lod", "lod",
             fmt::format(
                 "frame {}: {} is culled, and point {} of strand {} of its chunk {} (of shells: "
                 "vertex, patch) stands in view at ({:.4g}, {:.4g}, {:.4g})",
                 frame, NameLayer(layer), p.number, p.strand, p.piece, p.at[0], p.at[1], p.at[2]));
  }

  void JudgeHidden(uint32_t frame, uint32_t layer) {
    const FurScene& scene = culled_.scene();
    const SceneShape& shape = scene.shape();
    ++drawn_.seen;
    uint32_t left = scene.memory().Of<&Streams::layer_sort>(layer)->visible_count;
    for (uint32_t c = shape.layer_first_chunk[layer]; c < shape.layer_first_chunk[layer + 1]; ++c) {
      const auto& state = *scene.memory().Of<&Streams::chunk_state>(c);
      left |= state.flags | state.live_strands | state.visible_strands;
    }
    for (uint32_t p = shape.layer_first_patch[layer]; p < shape.layer_first_patch[layer + 1]; ++p) {
      const auto& state = *scene.memory().Of<&Streams::patch_state>(p);
      left |= state.flags | state.live_vertices;
    }
    if (left)
      FailOnce(drawn_, "activate", "chunk_state",
               fmt::format("frame {}: {} is out of view and something of it still lives", frame,
                           NameLayer(layer)));
  }

  void JudgeReturned(uint32_t frame, uint32_t layer) {
    for (Fresh& fresh : fresh_) {
      if (fresh.from != since_[layer]) continue;
      ++returned_.seen;
      if (frame == fresh.from &&
          FlagsOf(culled_.scene(), layer) != FlagsOf(fresh.run->scene(), layer))
        FailOnce(returned_, "activate", "chunk_state",
                 fmt::format("frame {}: {} came back into view, and does not start as in a first "
                             "frame",
                             frame, NameLayer(layer)));
      if (DigestLayer(culled_.scene(), layer, LayerPart::kWithoutPaint) !=
          DigestLayer(fresh.run->scene(), layer, LayerPart::kWithoutPaint))
        FailOnce(returned_, "", "",
                 fmt::format("frame {}: {} came back into view in frame {}, and is not what it is "
                             "in a scene that begins there",
                             frame, NameLayer(layer), fresh.from));
    }
  }

  // Every layer in view with a strand to draw, once, and no other.
  void JudgeDrawList(uint32_t frame) {
    const FurScene& scene = culled_.scene();
    const auto& list = *scene.memory().Of<&Streams::draw_list>(0);
    std::vector<uint32_t> wanted,
        listed(list.layer, list.layer + std::min(list.count, kLayersPerScene));
    for (uint32_t l = 0; l < since_.size(); ++l)
      if (since_[l] != kHidden && scene.memory().Of<&Streams::layer_sort>(l)->visible_count > 0)
        wanted.push_back(l);
    std::sort(listed.begin(), listed.end());
    if (listed != wanted)
      FailOnce(drawn_, "order_layers", "draw_list",
               fmt::format("frame {}: the draw list is not the layers in view", frame));
  }

  CheckResult CompareExecutor(ExecutorKind kind) {
    VerifyCase what = Best();
    what.executor = kind;
    what.workers = kind->HasWorkers() ? 2 : 1;
    CheckResult result = NewResult("the same with " + std::string(kind->name));
    CaseRun serial(scenario_, Best(), {}, {}), other(scenario_, what, {}, options_.tamper);
    for (uint32_t f = 0; f < kCourseFrames && result.passed; ++f) {
      const auto aim = [&](FrameInput& input, FurScene&) { AimCamera(f, input.camera); };
      serial.RunFrame(f, aim);
      other.RunFrame(f, aim);
      ++result.seen;
      if (SameDigests(DigestsOf(serial.scene()), DigestsOf(other.scene()), {})) continue;
      if (const auto mismatch = FindMismatch(serial, other, f, true))
        result.Fail(
            kind->order == ItemOrder::kAscending ? FindingKind::kValue : FindingKind::kOrder,
            *mismatch);
    }
    return result;
  }

  Scenario& scenario_;
  const VerifyOptions& options_;
  CaseRun culled_, seen_;
  std::vector<uint32_t> since_;  // by layer: in view from this frame on, or kHidden
  std::vector<Fresh> fresh_;
  CheckResult in_view_, stayed_, returned_, drawn_, tips_;
};

// Nothing moves but the camera: away, and back to where it was. What returns has the keys it had,
// and must say all the same that they are new: its order may be from any time.
CheckResult CheckSamePicture(Scenario& scenario, const VerifyOptions& options) {
  CheckResult result;
  result.section = "culling";
  result.name = "layers that return to the same picture";
  const uint32_t rest_before = std::exchange(scenario.rest_from_frame, 0);
  CaseRun run(scenario, {.isa = BestIsa()}, {}, options.tamper);
  for (uint32_t f = 0; f < 3; ++f)
    run.RunFrame(f, [&](FrameInput& input, FurScene&) {
      Camera& c = input.camera;
      for (int i = 0; f == 1 && i < 3; ++i) c.target[i] = 2.0f * c.eye[i] - c.target[i];
    });
  scenario.rest_from_frame = rest_before;
  for (uint32_t c = 0; c < run.scene().shape().chunk_count; ++c) {
    const auto& state = *run.scene().memory().Of<&Streams::chunk_state>(c);
    if (!(state.flags & kChunkRestart)) continue;
    if (!run.scene().memory().Of<&Streams::sort_keys>(c)) continue;  // shells are in no order
    ++result.seen;
    if (!state.keys_changed && result.passed)
      result.Fail({FindingKind::kCull, "sort_key", "chunk_state",
                   fmt::format("chunk {} came back into view and did not report its keys as "
                               "changed, so that it would not be sorted",
                               c)});
  }
  if (result.seen == 0) result.LeaveOut("no layer left the view and came back");
  return result;
}

}  // namespace

void CheckCulling(Scenario& scenario, const VerifyOptions& options, VerifyReport& report) {
  CullingCheck(scenario, options).Run(report);
  report.checks.push_back(CheckSamePicture(scenario, options));
}

}  // namespace pelt
