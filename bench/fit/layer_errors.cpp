#include "bench/fit/layer_errors.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "bench/accuracy/scene_points.hpp"
#include "bench/accuracy/scene_way.hpp"
#include "core/view.hpp"

namespace pelt {
namespace {

using accuracy::ScenePoints;
using accuracy::ScenePointsLayout;

constexpr uint32_t kReferenceRate = 4;
// Of the frames that count; the first of them among them.
constexpr uint32_t kComparedEvery = 4;
constexpr double kMostMicropixels = 1e9;

class Run {
 public:
  explicit Run(Scenario& scenario) : running_(scenario, {}), lod_(scenario.base.lod) {
    skip_.cull = skip_.sleep = false;
    skip_.lod = scenario.base.skip.lod;
  }

  void RunFrame(uint32_t frame) {
    input_ = running_.Prepare(frame, skip_, lod_);
    if (!running_.TryBegin(input_)) throw Error(running_.RefusalText(frame));
    executor_.Run(running_.scene().CurrentFrame());
  }
  const FurScene& scene() const { return running_.scene(); }
  const FrameInput& input() const { return input_; }

 private:
  RunningScenario running_;
  SerialExecutor executor_;
  FrameInput input_;
  SkipSettings skip_;
  LodSettings lod_;
};

// What a frame's camera makes of a tip that is off.
class Screen {
 public:
  explicit Screen(const FrameInput& input) : view_(MakeView(input.camera)) {
    std::copy_n(input.origin, 3, origin_);
  }

  // `at`: in the world. Below 0: out of view.
  double Micropixels(const double (&at)[3], const double (&off)[3]) const {
    double depth = 0.0, along = 0.0, square = 0.0, place[3];
    for (int k = 0; k < 3; ++k) place[k] = at[k] - origin_[k];
    for (const auto& plane : view_.planes) {
      double inside = double(plane[3]);
      for (int k = 0; k < 3; ++k) inside += double(plane[k]) * place[k];
      if (inside < 0.0) return -1.0;
    }
    for (int k = 0; k < 3; ++k) {
      depth += double(view_.forward[k]) * (place[k] - double(view_.eye[k]));
      along += double(view_.forward[k]) * off[k];
      square += off[k] * off[k];
    }
    const double across = std::sqrt(std::max(square - along * along, 0.0));
    return std::min(1e6 * across * double(view_.pixels_per_unit_at_1m) / depth, kMostMicropixels);
  }

 private:
  View view_;
  double origin_[3];
};

struct Sum {
  double square = 0.0;
  uint64_t tips = 0;
  std::vector<uint32_t> micropixels = {};

  TipError Take() {
    TipError error{.tips = tips};
    if (tips) error.off_m = std::sqrt(square / double(tips));
    if (micropixels.empty()) return error;
    const auto at = micropixels.begin() + ptrdiff_t((micropixels.size() - 1) * 99 / 100);
    std::nth_element(micropixels.begin(), at, micropixels.end());
    error.p99_micropixels = *at;
    return error;
  }
};

// Of the strands that live in `scene`.
void Compare(const FurScene& scene, const ScenePointsLayout& layout, const Screen& screen,
             const ScenePoints& points, const ScenePoints& reference, std::vector<Sum>& sums) {
  for (const ScenePointsLayout::Piece& piece : layout.pieces()) {
    const uint32_t layer = scene.shape().chunk_layer[piece.chunk];
    const std::array<double, 3> origin = scene.OriginOfLayer(layer);
    const uint32_t live = scene.memory().Of<&Streams::chunk_state>(piece.chunk)->live_strands;
    for (uint32_t lane = 0; lane < live; ++lane) {
      double at[3], off[3], square = 0.0;
      for (uint32_t k = 0; k < 3; ++k) {
        const size_t place = piece.PlaceOfTip(k, lane);
        at[k] = double(reference[place]) + origin[k];
        off[k] = double(points[place]) - double(reference[place]);
        square += off[k] * off[k];
      }
      const double micropixels = screen.Micropixels(at, off);
      for (Sum* sum : {&sums[layer], &sums.back()}) {
        sum->square += square;
        ++sum->tips;
        if (micropixels >= 0.0) sum->micropixels.push_back(uint32_t(micropixels + 0.5));
      }
    }
  }
}

}  // namespace

void RequireAccuracy() {}

std::vector<std::vector<TipError>> MeasureTipErrors(const Scenario& scene, std::span<Scenario> ways,
                                                    const ErrorFrames& frames) {
  Scenario dry = scene;
  dry.weather_course = {};
  Scenario reference_scenario = accuracy::AtRate(dry, kReferenceRate, 1);
  accuracy::SetWay({.name = "", .label = "", .quality = ModalQuality::kBest}, dry,
                   reference_scenario);
  reference_scenario.base.skip.lod = false;
  Run reference(reference_scenario);
  std::vector<std::unique_ptr<Run>> runs;
  for (Scenario& way : ways) {
    way.weather_course = {};
    runs.push_back(std::make_unique<Run>(way));
  }
  const FurScene& shown = reference.scene();
  std::vector<std::vector<Sum>> sums(ways.size(), std::vector<Sum>(shown.shape().layer_count + 1));
  std::unique_ptr<ScenePointsLayout> layout;
  ScenePoints points, exact;
  for (uint32_t f = 0; f < frames.warm_up + frames.frames; ++f) {
    if (frames.progress) frames.progress(f, frames.warm_up + frames.frames);
    for (uint32_t sub = f == 0 ? 0 : (f - 1) * kReferenceRate + 1; sub <= f * kReferenceRate; ++sub)
      reference.RunFrame(sub);
    for (const auto& run : runs) run->RunFrame(f);
    if (f < frames.warm_up || (f - frames.warm_up) % kComparedEvery != 0) continue;
    if (!layout) layout = std::make_unique<ScenePointsLayout>(shown);
    layout->Read(shown, exact);
    const Screen screen(reference.input());
    for (size_t w = 0; w < runs.size(); ++w) {
      layout->Read(runs[w]->scene(), points);
      Compare(runs[w]->scene(), *layout, screen, points, exact, sums[w]);
    }
  }
  std::vector<std::vector<TipError>> errors;
  for (std::vector<Sum>& way : sums) {
    std::vector<TipError>& of_way = errors.emplace_back();
    for (Sum& sum : way) of_way.push_back(sum.Take());
  }
  return errors;
}

}  // namespace pelt
