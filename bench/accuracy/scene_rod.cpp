// A scene's strands off their rods.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "bench/accuracy/scene_precision.hpp"
#include "core/error.hpp"
#include "core/layer_block.hpp"

namespace pelt::accuracy {
namespace {

constexpr uint32_t kMostOfLayer = 24;

// Most that steps twice as long may change a rod that counts. They change one that swings by 0.1 %, one that is thrown
// over by as much as it moves; a strand that is 3 % off its rod is then anywhere.
constexpr double kMostChange = 0.01;

Double3 LaneOf(const float (&rows)[3][kStrandsPerChunk], uint32_t lane) {
  return {rows[0][lane], rows[1][lane], rows[2][lane]};
}

// What a layer has that a rod has not; empty: nothing.
std::string_view WhyNoRod(const LayerParams& params) {
  if (params.max_distance > 0.0f) return "max_distance";
  if (params.inertia != 1.0f || params.inertia_turn != 1.0f || params.inertia_speed > 0.0f)
    return "inertia that is not felt";
  if (params.sag_free && params.chain == ChainKind::kVertex) return "chains at vertices held up";
  if (params.traits) return "traits of single strands";
  if (!(LayerRod(params, {}, 1.0f, false).frequency_hz > 0.0)) return "no stiffness";
  return {};
}

void MakeBare(Scenario& scenario) {
  RemoveContact(scenario);
  scenario.base.wind = {};
  for (Groom& groom : scenario.grooms) {
    for (GroomLayer& layer : groom.layers) layer.params.clump = 0.0f;
    const auto fill = [](auto& blocks) {
      for (auto& block : blocks)
        for (float& strength : block.strength) strength = strength > 0.0f ? 1.0f : 0.0f;
    };
    fill(groom.vertex_rest), fill(groom.strand_rest4);
    fill(groom.strand_rest5), fill(groom.strand_rest9);
  }
}

template <uint32_t kPoints>
const RestBlock<kPoints>& RestOf(const FurScene& scene, uint32_t chunk) {
  return *scene.memory().Of<ChainStreams<kPoints, false>::kRest>(chunk);
}

// As FurScene has it of the chains that it simulates.
bool IsCurled(const FurScene& scene, uint32_t layer) {
  const SceneShape& shape = scene.shape();
  const bool on_vertices = (shape.layer_kind[layer] & kLayerVertexChains) != 0;
  const Domain domain = on_vertices ? Domain::kPatch : Domain::kChunk;
  const uint32_t first = shape.LayerFirst(domain, layer);
  for (uint32_t i = first; i < first + shape.LayerItems(domain, layer); ++i) {
    const bool curled =
        on_vertices ? HasCurl(*scene.memory().Of<&Streams::vertex_rest>(i))
                    : WithPoints(StrandPointsOf(shape.layer_kind[layer]), [&]<uint32_t kPoints> {
                        return HasCurl(RestOf<kPoints>(scene, i));
                      });
    if (curled) return true;
  }
  return false;
}

Double3 OriginOf(const FurScene& scene, uint32_t layer) {
  const std::array<double, 3> at = scene.OriginOfLayer(layer);
  return {at[0], at[1], at[2]};
}

}  // namespace

void SceneRods::Sum::Add(const Rod& rod, Double3 at, Double3 exact) {
  const Double3 away = at - exact;
  off += rod.strands * Dot(away, away);
  moved += rod.strands * Dot(exact, exact);
}
double SceneRods::Sum::Share() const { return std::sqrt(off / moved); }

bool SceneRods::IsComparable(const SceneWay& way) {
  return way.simulate && !way.halved && !way.sleep && !way.on_screen && way.strand_share == 1.0;
}

SceneRods::SceneRods(const Scenario& scene, uint32_t rate, uint32_t warm_up, uint32_t most)
    : bare_(scene), rate_(rate), warm_up_(warm_up), most_(most) {
  MakeBare(bare_);
  own_chains_ = bare_;
  for (Groom& groom : own_chains_.grooms) GiveOwnChains(groom);
  std::map<std::string_view, std::vector<std::string>> left_out;  // names, by reason
  uint32_t number = 0;
  for (const Actor& actor : scene.actors)
    for (const GroomLayer& layer : scene.grooms[actor.groom].layers) {
      const uint32_t own = number++;
      if (!layer.params.enabled || layer.params.output == Output::kShells) continue;
      const std::string_view why =
          scene.more ? "a course of more than motion" : WhyNoRod(layer.params);
      std::vector<std::string>& names = left_out[why];
      if (why.empty())
        layers_.push_back({layer.name, own, layer.params, layer.length_max});
      else if (std::find(names.begin(), names.end(), layer.name) == names.end())
        names.push_back(layer.name);
    }
  for (const auto& [why, names] : left_out)
    if (!why.empty())
      notes_.push_back(fmt::format("no rod to be off for {}: {}", fmt::join(names, ", "), why));
}

SceneRods::Rod SceneRods::MakeRod(const FurScene& scene, uint32_t layer, uint32_t chunk,
                                  uint32_t lane) const {
  const Layer& own = layers_[layer];
  const LayerBlock& block = *scene.memory().Of<&Streams::layers>(own.number);
  const RodMaterial material =
      LayerRod(own.params, {}, own.length_max, IsCurled(scene, own.number));
  Rod rod{layer, chunk, lane, 0.0, {kZero3}, {}, CurlModel::kRoot, {}};
  double length = 0.0;
  WithPoints(own.params.points, [&]<uint32_t kPoints> {
    const RestBlock<kPoints>& rest = RestOf<kPoints>(scene, chunk);
    for (const auto& point : rest.offset)
      rod.groom.push_back(LaneOf(point, lane) * double(block.scale));
    length = double(rest.segment_length[lane]) * double(block.scale) * (kPoints - 1);
  });
  rod.material = {"", length, material.frequency_hz, material.drag_per_s, material.damping_ratio};
  if (material.parent_curl) rod.curl = CurlModel::kParent;
  rod.weight.gravity = {block.gravity[0], block.gravity[1], block.gravity[2]};
  if (own.params.sag_free)
    rod.weight.held = LaneOf(scene.memory().Of<&Streams::strand_down>(chunk)->down, lane) *
                      double(block.modal.rest_gravity);
  return rod;
}

// Evenly among the strands of each layer.
void SceneRods::ChooseStrands(const FurScene& scene) {
  const uint32_t each = std::clamp(most_ / uint32_t(layers_.size()), 1u, kMostOfLayer);
  const SceneShape& shape = scene.shape();
  for (uint32_t l = 0; l < layers_.size(); ++l) {
    Layer& layer = layers_[l];
    const uint32_t first = shape.layer_first_chunk[layer.number];
    std::vector<std::pair<uint32_t, uint32_t>> strands;  // chunk, lane
    for (uint32_t c = first; c < shape.layer_first_chunk[layer.number + 1]; ++c)
      WithPoints(layer.params.points, [&]<uint32_t kPoints> {
        const uint32_t live = scene.memory().Of<&Streams::chunk_state>(c)->live_strands;
        for (uint32_t lane = 0; lane < live; ++lane)
          if (RestOf<kPoints>(scene, c).strength[lane] > 0.0f) strands.push_back({c, lane});
      });
    layer.strands = strands.size();
    const size_t count = std::min<size_t>(each, strands.size());
    for (size_t i = 0; i < count; ++i) {
      const auto [chunk, lane] = strands[(2 * i + 1) * strands.size() / (2 * count)];
      rods_.push_back(MakeRod(scene, l, chunk, lane));
      rods_.back().strands = double(strands.size()) / double(count);
    }
  }
}

void SceneRods::Record(const FurScene& scene) {
  if (layers_.empty()) return;
  if (rods_.empty()) ChooseStrands(scene);
  for (Rod& rod : rods_) {
    const RootBlock& roots = *scene.memory().Of<&Streams::roots>(rod.chunk);
    const uint32_t flags = scene.memory().Of<&Streams::chunk_state>(rod.chunk)->flags;
    rod.roots.push_back(
        {LaneOf(roots.position, rod.lane) + OriginOf(scene, layers_[rod.layer].number),
         LaneOf(roots.normal, rod.lane), LaneOf(roots.tangent, rod.lane),
         rod.roots.empty() || (flags & kChunkRestart)});
  }
}

// Rates are differences of the poses before and after; where it starts it has none, as for the ways.
BodyPose SceneRods::PoseAt(const Rod& rod, size_t frame, size_t stride) const {
  const std::vector<Root>& roots = rod.roots;
  const auto starts = [&](size_t end) {  // since the frame before
    for (size_t i = end; i + stride > end; --i)
      if (roots[i].starts) return true;
    return false;
  };
  BodyPose pose = StillPose();
  const auto axes = [](const Root& root, Double3(&axis)[3]) {
    axis[0] = root.tangent, axis[1] = Cross(root.normal, root.tangent), axis[2] = root.normal;
  };
  pose.position = roots[frame].position;
  axes(roots[frame], pose.axis);
  if (frame < stride || starts(frame)) return pose;
  const size_t before = frame - stride;
  const size_t after =
      frame + stride < roots.size() && !starts(frame + stride) ? frame + stride : frame;
  const double per_s = double(rate_) / (bare_.dt_s * double(after - before));
  pose.velocity = (roots[after].position - roots[before].position) * per_s;
  Double3 from[3], to[3];
  axes(roots[before], from), axes(roots[after], to);
  for (int k = 0; k < 3; ++k) pose.axis_rate[k] = (to[k] - from[k]) * per_s;
  return pose;
}

std::vector<Double3> SceneRods::Move(const Rod& rod, size_t stride) const {
  const CurveDynamics dynamics(RodOfStrand(), rod.material, ThroughPoints(rod.groom), rod.curl,
                               rod.weight);
  const size_t parts = rod.groom.size() - 1;
  std::vector<UnknownRow> places;
  for (size_t k = 1; k <= parts; ++k) places.push_back(RodPlaceAt(double(k) / double(parts)));
  const double step_s = bare_.dt_s * double(stride) / double(rate_);
  std::vector<Double3> moved;
  std::optional<CurveMotion> motion;
  bool starts = false;
  for (size_t frame = 0; frame < rod.roots.size(); ++frame) {
    starts = starts || rod.roots[frame].starts;
    if (frame % stride != 0) continue;
    const BodyPose pose = PoseAt(rod, frame, stride);
    UnknownVectors groomed{};
    for (size_t i = 0; i < dynamics.count(); ++i) groomed[i] = pose.Turn(dynamics.rest()[i]);
    if (starts)
      motion.emplace(dynamics, pose, step_s, groomed);
    else
      motion->Step(pose);
    starts = false;
    if (frame % rate_ != 0 || frame / rate_ < warm_up_) continue;
    for (const UnknownRow& place : places) {
      Double3 off = kZero3;
      for (size_t i = 0; i < dynamics.count(); ++i)
        off = off + (motion->directions()[i] - groomed[i]) * (place[i] * rod.material.length);
      moved.push_back(off);
    }
  }
  return moved;
}

void SceneRods::MoveAll(SceneRodErrors& errors) {
  Sum sum;
  double points = 0.0;
  std::vector<Rod> found;
  for (Rod& rod : rods_) {
    std::vector<Double3> coarse;
    try {
      rod.moved = Move(rod, 1);
      coarse = Move(rod, 2);
    } catch (const Error&) {  // one of them is too long
      continue;
    }
    Sum own;
    for (size_t i = 0; i < coarse.size(); ++i) own.Add(rod, coarse[i], rod.moved[i]);
    if (own.off > kMostChange * kMostChange * own.moved) continue;
    sum.Add(own);
    points += rod.strands * double(coarse.size());
    found.push_back(std::move(rod));
  }
  if (found.size() < rods_.size())
    errors.notes.push_back(fmt::format(
        "{} of {} rods are left out, which steps twice as long change by over {:.0f} %: "
        "no way can follow what is as chaotic",
        rods_.size() - found.size(), rods_.size(), 100.0 * kMostChange));
  rods_ = std::move(found);
  if (rods_.empty()) return;
  errors.self_error = sum.Share();
  errors.secondary_m = std::sqrt(sum.moved / points);
}

SceneRods::Sums SceneRods::Run(const SceneWay& way, Scenario& scenario, Isa isa,
                               const std::function<void()>& progress) {
  SetWay(way, way.own_chains ? own_chains_ : bare_, scenario);
  SceneRun run(way, scenario, isa);
  Sums sums(layers_.size());
  const uint32_t frames = uint32_t((rods_[0].roots.size() - 1) / rate_ + 1);
  for (uint32_t f = 0; f < frames; ++f, progress()) {
    run.RunFrame(f);
    if (f < warm_up_) continue;
    for (const Rod& rod : rods_) {
      const size_t parts = rod.groom.size() - 1;
      const BodyPose pose = PoseAt(rod, size_t(f) * rate_, 1);
      const Double3 origin = OriginOf(run.scene(), layers_[rod.layer].number);
      WithPoints(uint32_t(parts + 1), [&]<uint32_t kPoints> {
        const auto& points =
            *run.scene().memory().Of<ChainStreams<kPoints, false>::kPosition>(rod.chunk);
        for (size_t k = 0; k < parts; ++k)
          sums[rod.layer].Add(
              rod, LaneOf(points.position[k], rod.lane) + origin - pose.Place(rod.groom[k + 1]),
              rod.moved[(f - warm_up_) * parts + k]);
      });
    }
  }
  return sums;
}

std::vector<RodLayerRow> SceneRods::RowsOf(std::span<const SceneWay> ways,
                                           const std::vector<Sums>& sums) const {
  std::vector<RodLayerRow> rows;
  std::vector<Sum> all;
  for (uint32_t l = 0; l < layers_.size(); ++l) {
    const Layer& layer = layers_[l];
    const auto way = std::find_if(ways.begin(), ways.end(), [&](const SceneWay& w) {
      return IsComparable(w) && !w.own_chains && w.solver == layer.params.solver &&
             (w.solver != Solver::kModal || w.quality == layer.params.quality);
    });
    if (way == ways.end()) continue;
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const RodLayerRow& r) {
      return r.layer == layer.name && r.way == way->label;
    });
    const size_t at = size_t(row - rows.begin());
    if (row == rows.end()) rows.push_back({layer.name, way->label}), all.emplace_back();
    rows[at].strands += layer.strands;
    rows[at].sampled += uint64_t(
        std::count_if(rods_.begin(), rods_.end(), [&](const Rod& rod) { return rod.layer == l; }));
    all[at].Add(sums[size_t(way - ways.begin())][l]);
    rows[at].error = all[at].Share();
  }
  return rows;
}

SceneRodErrors SceneRods::Compare(std::span<const SceneWay> ways, Isa isa,
                                  const std::function<void()>& progress) {
  SceneRodErrors errors;
  errors.ways.resize(ways.size());
  errors.notes = notes_;
  if (!rods_.empty()) MoveAll(errors);
  if (rods_.empty()) return errors;
  Scenario scenario = bare_, own = own_chains_;
  std::vector<Sums> sums(ways.size(), Sums(layers_.size()));
  for (size_t w = 0; w < ways.size(); ++w) {
    if (!IsComparable(ways[w])) continue;
    sums[w] = Run(ways[w], ways[w].own_chains ? own : scenario, isa, progress);
    Sum all;
    for (const Sum& sum : sums[w]) all.Add(sum);
    errors.ways[w] = all.Share();
  }
  errors.layers = RowsOf(ways, sums);
  return errors;
}

}  // namespace pelt::accuracy
