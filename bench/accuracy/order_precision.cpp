#include "bench/accuracy/order_precision.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "bench/picture/order_error.hpp"
#include "bench/report/run_report.hpp"

namespace pelt::accuracy {
namespace {

constexpr uint32_t kFirst = 60, kApart = 8;
constexpr uint32_t kNoRank = ~0u;
constexpr uint32_t kOldest = 7;  // of the orders that are kept, frames back

// Rank of each hair of a frame, in the order of `hairs`; the lowest is painted first.
using Ranks = std::vector<uint32_t>;

std::vector<Hair> Flatten(const std::vector<std::vector<Hair>>& layers) {
  std::vector<Hair> hairs;
  for (const std::vector<Hair>& layer : layers)
    hairs.insert(hairs.end(), layer.begin(), layer.end());
  return hairs;
}

// The place of each of the scene's strands in a frame's drawing order; kNoRank: it was not drawn.
std::vector<uint32_t> PlacesOf(const std::vector<Hair>& hairs) {
  uint32_t most = 0;
  for (const Hair& hair : hairs) most = std::max(most, hair.number);
  std::vector<uint32_t> places(hairs.empty() ? 0 : size_t(most) + 1, kNoRank);
  for (uint32_t i = 0; i < hairs.size(); ++i) places[hairs[i].number] = i;
  return places;
}

template <class Key>
Ranks RankBy(size_t count, const Key& key) {
  std::vector<uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, {}, key);
  Ranks rank(count);
  for (uint32_t place = 0; place < count; ++place) rank[order[place]] = place;
  return rank;
}

Ranks RankByPlaces(const std::vector<Hair>& hairs, const std::vector<uint32_t>& places) {
  return RankBy(hairs.size(), [&](uint32_t i) {
    return hairs[i].number < places.size() ? places[hairs[i].number] : kNoRank;
  });
}

// Far to near by one knot, whatever the layer.
Ranks RankByKnot(const std::vector<Hair>& hairs, const Camera& camera, float share) {
  const glm::vec3 eye(camera.position[0], camera.position[1], camera.position[2]);
  const glm::vec3 ahead =
      glm::normalize(glm::vec3(camera.target[0], camera.target[1], camera.target[2]) - eye);
  return RankBy(hairs.size(), [&](uint32_t i) {
    const Hair& hair = hairs[i];
    return -glm::dot(hair.knot[uint32_t(share * float(hair.knots - 1) + 0.5f)].at - eye, ahead);
  });
}

struct Way {
  const char* name;
  double sorts_per_frame;  // of Pelt's; below 0: another order
};
constexpr std::array<Way, 9> kWays = {{{"sorted every frame", 1.0},
                                       {"every 2nd frame, the older order", 0.5},
                                       {"every 4th frame, the oldest order", 0.25},
                                       {"every 8th frame, the oldest order", 0.125},
                                       {"all layers by their roots", -1.0},
                                       {"all layers by their middles", -1.0},
                                       {"all layers by their tips", -1.0},
                                       {"strand order, unsorted", 0.0},
                                       {"near to far", -1.0}}};

Ranks RanksOf(size_t way, const std::vector<Hair>& hairs, const Camera& camera,
              const std::vector<std::vector<uint32_t>>& places) {
  const uint32_t count = uint32_t(hairs.size());
  switch (way) {
    case 0:
    case 1:
    case 2:
    case 3:
      return RankByPlaces(hairs, places[places.size() - (size_t(1) << way)]);
    case 4:
    case 5:
    case 6:
      return RankByKnot(hairs, camera, 0.5f * float(way - 4));
    case 7:
      return RankBy(count, [&](uint32_t i) { return hairs[i].number; });
    default:
      return RankBy(count, [&](uint32_t i) { return count - i; });
  }
}

double SortNs(const Budget& budget) {
  double ns = 0.0;
  for (const StageBudget& stage : budget.stages)
    if (stage.name.starts_with("sort") || stage.name == "order_layers") ns += stage.ns_per_strand;
  return ns;
}

// What the pictures' frames leave behind.
class Gatherer {
 public:
  Gatherer(Scenario& scenario, OrderPrecision& out) : scenario_(scenario), out_(out) {
    for (const Way& way : kWays) out_.rows.push_back({way.name});
  }

  void AddFrame(uint32_t frame, const FurScene& scene) {
    if (frame + kOldest < kFirst) return;
    const std::vector<Hair> hairs = Flatten(ReadHairs(scene, VertexOrder::kSorted));
    places_.push_back(PlacesOf(hairs));
    if (frame < kFirst || (frame - kFirst) % kApart != 0) return;
    AddPicture(frame, hairs);
  }

  void Finish(const Budget& budget) {
    const double pictures = out_.options.pictures, sort_ns = SortNs(budget);
    for (size_t way = 0; way < kWays.size(); ++way) {
      OrderRow& row = out_.rows[way];
      row.psnr_db = PictureError{squares_[way] / pictures}.PsnrDb();
      row.wrong_pixels /= pictures;
      if (kWays[way].sorts_per_frame >= 0.0) row.sort_ns = sort_ns * kWays[way].sorts_per_frame;
    }
    out_.drawn_strands /= pictures;
  }

 private:
  void AddPicture(uint32_t frame, const std::vector<Hair>& hairs) {
    const Camera camera = CameraOf(frame);
    const HairFragments fragments(hairs, camera, out_.options.width_px, out_.options.height_px);
    const std::vector<glm::vec3> exact = fragments.PaintByDepth();
    out_.drawn_strands += double(hairs.size());
    for (size_t way = 0; way < kWays.size(); ++way) {
      const Ranks rank = RanksOf(way, hairs, camera, places_);
      const PictureError error = fragments.Compare(fragments.PaintByRank(rank), exact);
      squares_[way] += error.mean_square;
      out_.rows[way].wrong_pixels += error.wrong_pixels;
      if (out_.options.progress)
        out_.options.progress(++done_, kWays.size() * out_.options.pictures);
    }
  }

  Camera CameraOf(uint32_t frame) {
    if (!beside_) beside_ = std::make_unique<RunningScenario>(scenario_, SceneOptions{});
    return beside_->Prepare(frame, {}, {}).camera;
  }

  Scenario& scenario_;
  OrderPrecision& out_;
  std::unique_ptr<RunningScenario> beside_;    // tells the camera, and runs nothing
  std::vector<std::vector<uint32_t>> places_;  // of the frames so far, from kOldest before kFirst
  std::array<double, kWays.size()> squares_{};
  size_t done_ = 0;
};

}  // namespace

OrderPrecision MeasureOrderPrecision(const OrderOptions& given) {
  OrderPrecision out;
  out.options = given;
  if (given.quick) {
    out.options.pictures = 2;
    out.options.width_px = 320;
    out.options.height_px = 240;
  }
  Scenario scenario = LoadScenario(out.options.scene), cameras = scenario;
  out.strands = scenario.StrandCount();
  RunOptions options;
  options.scene.isa = out.options.isa;
  options.executor = "serial";
  options.frames = kFirst + kApart * (out.options.pictures - 1) + 1;
  options.digest = false;
  options.skip.sort = false;  // each frame pays for its order
  Gatherer gatherer(cameras, out);
  options.after_frame = [&](uint32_t frame, const FurScene& scene) {
    gatherer.AddFrame(frame, scene);
  };
  RunningScenario running(scenario, options.scene);
  gatherer.Finish(RunFrames(scenario, running, options).budget);
  return out;
}

}  // namespace pelt::accuracy
