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
  const glm::vec3 eye(camera.eye[0], camera.eye[1], camera.eye[2]);
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

// Tells where the eye is in a frame, and runs nothing.
class Cameras {
 public:
  explicit Cameras(const Scenario& scenario) : scenario_(scenario) {}
  Camera At(uint32_t frame) {
    if (!running_) running_ = std::make_unique<RunningScenario>(scenario_, SceneOptions{});
    return running_->Prepare(frame, {}, {}).camera;
  }

 private:
  Scenario scenario_;
  std::unique_ptr<RunningScenario> running_;
};

bool IsPicture(uint32_t frame) { return frame >= kFirst && (frame - kFirst) % kApart == 0; }

// What the pictures' frames leave behind.
class Gatherer {
 public:
  Gatherer(const Scenario& scenario, OrderPrecision& out) : cameras_(scenario), out_(out) {
    for (const Way& way : kWays) out_.rows.push_back({way.name});
  }

  void AddFrame(uint32_t frame, const FurScene& scene) {
    if (frame + kOldest < kFirst) return;
    const std::vector<Hair> hairs = Flatten(ReadHairs(scene, VertexOrder::kSorted));
    places_.push_back(PlacesOf(hairs));
    if (IsPicture(frame)) AddPicture(frame, hairs);
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
    const Camera camera = cameras_.At(frame);
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

  Cameras cameras_;
  OrderPrecision& out_;
  std::vector<std::vector<uint32_t>> places_;  // of the frames so far, from kOldest before kFirst
  std::array<double, kWays.size()> squares_{};
  size_t done_ = 0;
};

RunOptions OptionsOf(const OrderOptions& order) {
  RunOptions options;
  options.scene.isa = order.isa;
  options.executor = "serial";
  options.frames = kFirst + kApart * (order.pictures - 1) + 1;
  options.digest = false;
  options.skip.sort = false;  // each frame pays for its order
  return options;
}

// seen(picture's hairs, their fragments) for each picture.
template <class Seen>
Budget RunPictures(Scenario scenario, const OrderOptions& order, bool lod, const Seen& seen) {
  Cameras cameras(scenario);
  RunOptions options = OptionsOf(order);
  options.skip.lod = lod;
  options.after_frame = [&](uint32_t frame, const FurScene& scene) {
    if (!IsPicture(frame)) return;
    const std::vector<Hair> hairs = Flatten(ReadHairs(scene, VertexOrder::kSorted));
    seen(hairs, HairFragments(hairs, cameras.At(frame), order.width_px, order.height_px));
  };
  RunningScenario running(scenario, options.scene);
  return RunFrames(scenario, running, options).budget;
}

std::vector<glm::vec3> PaintAsDrawn(const std::vector<Hair>& hairs,
                                    const HairFragments& fragments) {
  Ranks rank(hairs.size());
  std::iota(rank.begin(), rank.end(), 0u);
  return fragments.PaintByRank(rank);
}

// The scene from further off, as it is and with level of detail, both against all of its strands by depth.
void AddFarRows(const Scenario& near, uint32_t times, OrderPrecision& out) {
  Scenario far = near;
  far.camera.radius_m *= times;
  far.camera.height_m *= times;
  std::vector<std::vector<glm::vec3>> fewer;
  const Budget lod_budget =
      RunPictures(far, out.options, true, [&](const auto& hairs, const HairFragments& fragments) {
        fewer.push_back(PaintAsDrawn(hairs, fragments));
      });
  OrderRow rows[2] = {{std::to_string(times) + " times as far, every frame"},
                      {std::to_string(times) + " times as far, every frame, --lod"}};
  double squares[2] = {};
  size_t picture = 0;
  const Budget budget =
      RunPictures(far, out.options, false, [&](const auto& hairs, const HairFragments& fragments) {
        const std::vector<glm::vec3> exact = fragments.PaintByDepth();
        const PictureError errors[2] = {fragments.Compare(PaintAsDrawn(hairs, fragments), exact),
                                        fragments.Compare(fewer[picture++], exact)};
        for (int i = 0; i < 2; ++i) {
          squares[i] += errors[i].mean_square / out.options.pictures;
          rows[i].wrong_pixels += errors[i].wrong_pixels / out.options.pictures;
        }
      });
  for (int i = 0; i < 2; ++i) {
    rows[i].psnr_db = PictureError{squares[i]}.PsnrDb();
    rows[i].sort_ns = SortNs(i == 0 ? budget : lod_budget);
    out.rows.push_back(rows[i]);
  }
}

}  // namespace

OrderPrecision MeasureOrderPrecision(const Scenario& start, const OrderOptions& given) {
  OrderPrecision out;
  out.options = given;
  out.scene = start.name;
  if (given.quick) {
    out.options.pictures = 2;
    out.options.width_px = 320;
    out.options.height_px = 240;
  }
  out.strands = start.StrandCount();
  Scenario scenario = start;
  RunOptions options = OptionsOf(out.options);
  Gatherer gatherer(start, out);
  options.after_frame = [&](uint32_t frame, const FurScene& scene) {
    gatherer.AddFrame(frame, scene);
  };
  RunningScenario running(scenario, options.scene);
  gatherer.Finish(RunFrames(scenario, running, options).budget);
  for (const uint32_t times : {3u, 8u}) AddFarRows(start, times, out);
  return out;
}

}  // namespace pelt::accuracy
