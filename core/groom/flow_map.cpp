#include "core/groom/flow_map.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/error.hpp"
#include "core/exact_math.hpp"
#include "core/float_rules.hpp"
#include "core/format.hpp"
#include "core/groom/attributes.hpp"
#include "core/groom/setup_names.hpp"
#include "core/groom/surface_colour.hpp"

namespace pelt {
namespace {

constexpr uint32_t kNobody = std::numeric_limits<uint32_t>::max();
// An island may lose so much of itself to one before it, as at a shared edge, and still lie on its sheet.
constexpr uint64_t kOverlapShare = 64;

struct Texel {
  uint32_t triangle = kNobody;
  glm::vec3 bary{0.0f};
};
using Sheet = std::vector<Texel>;

void CheckTexture(const Mesh& mesh, uint32_t side, const std::string& place) {
  if (side < 1 || side > kMostFlowSide)
    throw Error(Format("{}{} texels a side; 1 to {} are allowed", place, side, kMostFlowSide));
  if (mesh.uv.empty()) throw Error(place + "the character has no texture coordinates");
}

size_t WrapTexel(int64_t i, int64_t side) {
  const int64_t left = i % side;
  return size_t(left < 0 ? left + side : left);
}

// Calls visit(texel, bary) for each texel whose middle lies within the triangle.
template <class Visit>
void VisitTexels(const Mesh& mesh, uint32_t side, const std::string& place, uint32_t triangle,
                 const Visit& visit) {
  glm::dvec2 p[3];
  for (int k = 0; k < 3; ++k)
    p[k] = glm::dvec2(mesh.uv[mesh.triangles[triangle][size_t(k)]]) * double(side);
  const glm::dvec2 low = glm::min(glm::min(p[0], p[1]), p[2]);
  const glm::dvec2 high = glm::max(glm::max(p[0], p[1]), p[2]);
  const double most = 2.0 * double(side);
  if (!(high.x - low.x <= most && high.y - low.y <= most && std::abs(low.x) < 1e12 &&
        std::abs(low.y) < 1e12))
    throw Error(Format("{}triangle {} goes round the texture more than twice, or lies too far out",
                       place, triangle));
  const glm::dvec2 a = p[1] - p[0], b = p[2] - p[0];
  const double area = a.x * b.y - a.y * b.x;
  if (area == 0.0) return;
  const int64_t x_end = int64_t(exact::Floor(high.x)), y_end = int64_t(exact::Floor(high.y));
  for (int64_t y = int64_t(exact::Floor(low.y)); y <= y_end; ++y)
    for (int64_t x = int64_t(exact::Floor(low.x)); x <= x_end; ++x) {
      const glm::dvec2 s = glm::dvec2(double(x) + 0.5, double(y) + 0.5) - p[0];
      const double v = (s.x * b.y - s.y * b.x) / area, w = (a.x * s.y - a.y * s.x) / area;
      const double u = 1.0 - v - w;
      if (u >= 0.0 && v >= 0.0 && w >= 0.0)
        visit(WrapTexel(y, side) * side + WrapTexel(x, side), glm::dvec3(u, v, w));
    }
}

// Texels of so many bytes get what the nearest filled one has, counted along rows and columns; the first of several.
void FillFromNearest(size_t side, size_t bytes, std::vector<uint8_t>& filled, uint8_t* first) {
  std::vector<uint32_t> reached;  // in the order of their distance
  for (size_t i = 0; i < filled.size(); ++i)
    if (filled[i]) reached.push_back(uint32_t(i));
  for (size_t k = 0; k < reached.size(); ++k) {
    const size_t from = reached[k], x = from % side, y = from / side;
    for (const size_t to : {y * side + (x + side - 1) % side, y * side + (x + 1) % side,
                            (y + side - 1) % side * side + x, (y + 1) % side * side + x}) {
      if (filled[to]) continue;
      filled[to] = 1;
      std::copy_n(first + bytes * from, bytes, first + bytes * to);
      reached.push_back(uint32_t(to));
    }
  }
}

// Two edges of a triangle in the rest pose and in the texture.
class TriangleAxes {
 public:
  TriangleAxes(const Mesh& mesh, const RestGeometry& rest, uint32_t triangle) {
    const auto& v = mesh.triangles[triangle];
    const glm::dvec3 first(rest.position[v[0]]);
    const glm::dvec2 uv(mesh.uv[v[0]]);
    a_ = glm::dvec3(rest.position[v[1]]) - first;
    b_ = glm::dvec3(rest.position[v[2]]) - first;
    uv_a_ = glm::dvec2(mesh.uv[v[1]]) - uv;
    uv_b_ = glm::dvec2(mesh.uv[v[2]]) - uv;
  }

  // The direction in the surface as one in texture space, as long as it is.
  glm::dvec2 ToTexture(const glm::dvec3& along) const {
    const double aa = glm::dot(a_, a_), ab = glm::dot(a_, b_), bb = glm::dot(b_, b_);
    const double det = aa * bb - ab * ab;
    if (!(det > 0.0)) return glm::dvec2(0.0);
    const double pa = glm::dot(a_, along), pb = glm::dot(b_, along);
    const glm::dvec2 to = uv_a_ * ((pa * bb - pb * ab) / det) + uv_b_ * ((pb * aa - pa * ab) / det);
    const double size = std::sqrt(glm::dot(to, to));
    if (!(size > 0.0)) return glm::dvec2(0.0);
    return to * (std::sqrt(glm::dot(along, along)) / size);
  }

  // The other way, for a direction across `normal`; 0 where there is none.
  glm::dvec3 FromTexture(const glm::dvec2& lean, const glm::dvec3& normal) const {
    constexpr double kLeastFacing = 0.1;
    const double det = uv_a_.x * uv_b_.y - uv_a_.y * uv_b_.x;
    const glm::dvec3 face = glm::cross(a_, b_);
    const double area = std::sqrt(glm::dot(face, face));
    if (det == 0.0 || !(area > 0.0)) return glm::dvec3(0.0);
    const glm::dvec3 flat = a_ * ((lean.x * uv_b_.y - lean.y * uv_b_.x) / det) +
                            b_ * ((uv_a_.x * lean.y - uv_a_.y * lean.x) / det);
    // What lies in the triangle is raised along its own normal, as ToTexture dropped it.
    const double facing = glm::dot(normal, face) / area;
    const glm::dvec3 raise = std::abs(facing) > kLeastFacing ? face / (area * facing) : normal;
    const glm::dvec3 along = flat - raise * glm::dot(normal, flat);
    const double size = std::sqrt(glm::dot(along, along));
    return size > 0.0 ? along * (std::sqrt(glm::dot(lean, lean)) / size) : glm::dvec3(0.0);
  }

 private:
  glm::dvec3 a_, b_;
  glm::dvec2 uv_a_, uv_b_;
};

// Triangles that share vertices; UV seams have vertices of their own on both sides.
class Islands {
 public:
  explicit Islands(size_t vertices) : parent_(vertices) {
    for (uint32_t v = 0; v < vertices; ++v) parent_[v] = v;
  }
  void Join(uint32_t a, uint32_t b) {
    a = Find(a);
    b = Find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }
  uint32_t Find(uint32_t v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }

 private:
  std::vector<uint32_t> parent_;
};

// Which triangle, and which place on it, each texel of each sheet has.
class SheetMaker {
 public:
  SheetMaker(const Character& character, const RestGeometry& rest, const FurSetup& setup,
             const LayerSetup& layer, uint32_t side,
             std::shared_ptr<const SurfaceColour> surface = nullptr)
      : mesh_(character.mesh),
        rest_(rest),
        place_(Format("{}: layer '{}': flow map: ", setup.path, layer.name)),
        growth_(character, rest, setup, layer, std::move(surface)) {
    map_.side = side;
    CheckTexture(mesh_, side, place_);
    map_.sheet.assign(mesh_.triangles.size(), FlowMap::kNoSheet);
    for (const std::vector<uint32_t>& island : FindIslands()) Lay(island);
    if (sheets_.empty()) sheets_.emplace_back(size_t(map_.side) * map_.side);
    map_.sheets = uint32_t(sheets_.size());
  }

  FlowMap MakeFlow(const AttributeMaker& maker) {
    Evaluate(maker);
    for (size_t s = 0; s < sheets_.size(); ++s) Fill(s, 4, map_.rgba);
    return std::move(map_);
  }

  GrowthMap MakeGrowth() {
    const size_t texels = size_t(map_.side) * map_.side;
    GrowthMap made{map_.side, map_.sheets, std::vector<uint8_t>(texels * map_.sheets), {}};
    for (size_t s = 0; s < sheets_.size(); ++s) {
      for (size_t i = 0; i < texels; ++i)
        if (const Texel& texel = sheets_[s][i]; texel.triangle != kNobody)
          made.share[s * texels + i] = ShareByte({texel.triangle, texel.bary});
      Fill(s, 1, made.share);
    }
    made.sheet = std::move(map_.sheet);
    return made;
  }

 private:
  // Each one's triangles, ascending, in the order of the first.
  std::vector<std::vector<uint32_t>> FindIslands() {
    Islands islands(mesh_.position.size());
    std::vector<uint32_t> growing;
    for (uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (growth_.TriangleLimit(t) <= 0.0f) continue;
      growing.push_back(t);
      islands.Join(mesh_.triangles[t][0], mesh_.triangles[t][1]);
      islands.Join(mesh_.triangles[t][0], mesh_.triangles[t][2]);
    }
    std::vector<std::vector<uint32_t>> found;
    std::map<uint32_t, size_t> number;
    for (const uint32_t t : growing) {
      const auto [at, is_new] = number.emplace(islands.Find(mesh_.triangles[t][0]), number.size());
      if (is_new) found.emplace_back();
      found[at->second].push_back(t);
    }
    return found;
  }

  template <class Visit>
  void ForEachTexel(uint32_t triangle, const Visit& visit) const {
    VisitTexels(mesh_, map_.side, place_, triangle, visit);
  }

  void Lay(const std::vector<uint32_t>& island) {
    std::vector<size_t> texels;
    for (const uint32_t t : island)
      ForEachTexel(t, [&](size_t texel, const glm::dvec3&) { texels.push_back(texel); });
    const auto has_room = [&](const Sheet& sheet) {
      const auto taken = std::count_if(texels.begin(), texels.end(), [&](size_t texel) {
        return sheet[texel].triangle != kNobody;
      });
      return uint64_t(taken) * kOverlapShare <= texels.size();
    };
    const size_t number =
        size_t(std::find_if(sheets_.begin(), sheets_.end(), has_room) - sheets_.begin());
    if (number == kMostFlowSheets)
      throw Error(Format("{}more than {} parts of the surface have one place in the texture",
                         place_, kMostFlowSheets));
    if (number == sheets_.size()) sheets_.emplace_back(size_t(map_.side) * map_.side);
    for (const uint32_t t : island) Take(t, uint16_t(number));
  }

  void Take(uint32_t triangle, uint16_t number) {
    map_.sheet[triangle] = number;
    ForEachTexel(triangle, [&](size_t at, const glm::dvec3& bary) {
      Texel& texel = sheets_[number][at];
      if (texel.triangle == kNobody) {
        texel = {triangle, glm::vec3(bary)};
        ++map_.covered;
      } else {  // on an edge both have it
        constexpr double kInside = 1e-6;
        map_.contested += bary.x > kInside && bary.y > kInside && bary.z > kInside;
      }
    });
  }

  uint8_t ShareByte(const SurfacePoint& at) const {
    return uint8_t(0.5f + 255.0f * std::clamp(growth_.Share(at), 0.0f, 1.0f));
  }

  void Evaluate(const AttributeMaker& maker) {
    const size_t texels = size_t(map_.side) * map_.side;
    std::vector<float> length(texels * sheets_.size());
    map_.rgba.assign(length.size() * 4, 0);
    for (size_t s = 0; s < sheets_.size(); ++s)
      for (size_t i = 0; i < texels; ++i) {
        const Texel& texel = sheets_[s][i];
        if (texel.triangle == kNobody) continue;
        const SurfacePoint at{texel.triangle, texel.bary};
        const StrandLie lie = maker.MeanLie(at);
        const glm::dvec3 along = lie.towards - lie.normal * glm::dot(lie.towards, lie.normal);
        const glm::dvec2 lean = TriangleAxes(mesh_, rest_, texel.triangle).ToTexture(along);
        uint8_t* to = &map_.rgba[(s * texels + i) * 4];
        for (int c = 0; c < 2; ++c) to[c] = uint8_t(128.5 + 127.0 * std::clamp(lean[c], -1.0, 1.0));
        to[3] = ShareByte(at);
        length[s * texels + i] = float(lie.length);
        map_.longest_m = std::max(map_.longest_m, float(lie.length));
      }
    for (size_t i = 0; i < length.size(); ++i)
      if (length[i] > 0.0f)
        map_.rgba[4 * i + 2] = uint8_t(std::max(1.0f, 0.5f + 255.0f * length[i] / map_.longest_m));
  }

  void Fill(size_t sheet, size_t bytes, std::vector<uint8_t>& map) const {
    std::vector<uint8_t> filled;
    for (const Texel& texel : sheets_[sheet]) filled.push_back(texel.triangle != kNobody);
    FillFromNearest(map_.side, bytes, filled, &map[sheet * filled.size() * bytes]);
  }

  const Mesh& mesh_;
  const RestGeometry& rest_;
  std::string place_;
  Growth growth_;
  FlowMap map_;
  std::vector<Sheet> sheets_;
};

}  // namespace

FlowMap MakeFlowMap(const Character& character, const RestGeometry& rest, const FurSetup& setup,
                    const LayerSetup& layer, uint32_t side) {
  SheetMaker sheets(character, rest, setup, layer, side);
  return sheets.MakeFlow(AttributeMaker(character, rest, setup, layer));
}

GrowthMap MakeGrowthMap(const Character& character, const RestGeometry& rest, const FurSetup& setup,
                        const LayerSetup& layer, uint32_t side,
                        std::shared_ptr<const SurfaceColour> surface) {
  return SheetMaker(character, rest, setup, layer, side, std::move(surface)).MakeGrowth();
}

PaintedFlow::PaintedFlow(const Character& character, const RestGeometry& rest,
                         const FurSetup& setup, const LayerSetup& layer,
                         std::shared_ptr<const SurfaceColour> surface)
    : mesh_(character.mesh), rest_(rest), setup_(layer.flow_map ? &*layer.flow_map : nullptr) {
  if (!setup_) return;
  CheckMapsHaveUvs(mesh_, setup, layer);
  const ControlMap& map = *setup_->picture.map;
  const uint32_t sheets = map.height / map.width;
  if (setup_->blue != FlowBlue::kLength || sheets < 2) return;
  GrowthMap growth = MakeGrowthMap(character, rest, setup, layer, map.width, std::move(surface));
  if (growth.sheets != sheets)
    FailLayerKey(setup, layer, "flow_map",
                 Format("has {} sheets, where this layer's texture coordinates make {}", sheets,
                        growth.sheets));
  sheet_ = std::move(growth.sheet);
  const auto bytes = ptrdiff_t(map.width) * map.width * 4;
  for (auto at = map.rgba.begin(); cut_.size() < sheets; at += bytes)
    cut_.push_back({map.width, map.width, {at, at + bytes}});
}

const ControlMap* PaintedFlow::SheetAt(uint32_t triangle) const {
  if (!setup_ || cut_.empty()) return setup_ ? setup_->picture.map.get() : nullptr;
  return sheet_[triangle] == FlowMap::kNoSheet ? nullptr : &cut_[sheet_[triangle]];
}

std::optional<glm::dvec3> PaintedFlow::Direction(const SurfacePoint& at,
                                                 const glm::dvec3& normal) const {
  constexpr double kNoDirection = 0.1;  // length of a vector, of 1
  const ControlMap* sheet = SheetAt(at.triangle);
  if (!sheet) return std::nullopt;
  const glm::vec2 uv = Interpolate(mesh_.uv, mesh_, at);
  double v[3];
  for (int c = 0; c < 3; ++c) v[c] = (255.0 * double(sheet->Sample(uv, c)) - 128.0) / 127.0;
  glm::dvec2 lean(v[0], v[1]);
  const double flat = glm::dot(lean, lean);
  const double up = setup_->blue == FlowBlue::kUp ? v[2] : std::sqrt(std::max(0.0, 1.0 - flat));
  const double size = std::sqrt(flat + up * up);
  if (size < kNoDirection) return std::nullopt;
  lean /= size;
  if (lean == glm::dvec2(0.0)) return normal * (up / size);
  const glm::dvec3 along = TriangleAxes(mesh_, rest_, at.triangle).FromTexture(lean, normal);
  if (along == glm::dvec3(0.0)) return std::nullopt;
  return along + normal * (up / size);
}

std::optional<float> PaintedFlow::Length(const SurfacePoint& at) const {
  const ControlMap* sheet = SheetAt(at.triangle);
  if (!sheet || setup_->blue != FlowBlue::kLength) return std::nullopt;
  return setup_->longest * sheet->Sample(Interpolate(mesh_.uv, mesh_, at), 2);
}

std::vector<uint8_t> MakeSkinTexels(const Mesh& mesh, uint32_t side, const std::string& place,
                                    const std::function<uint8_t(const SurfacePoint&)>& value) {
  CheckTexture(mesh, side, place);
  std::vector<uint8_t> texels(size_t(side) * side, 255), filled(texels.size());
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
    VisitTexels(mesh, side, place, t, [&](size_t at, const glm::dvec3& bary) {
      texels[at] = std::min(texels[at], value({t, glm::vec3(bary)}));
      filled[at] = 1;
    });
  FillFromNearest(side, 1, filled, texels.data());
  return texels;
}

std::vector<uint8_t> MakeStencil(const Character& character, const RestGeometry& rest,
                                 const FurSetup& setup, uint32_t side) {
  std::shared_ptr<const SurfaceColour> surface;
  std::vector<Growth> layers;
  for (const LayerSetup& layer : setup.layers) {
    if (!layer.params.enabled) continue;
    if (!surface && GrowsByImages(character.mesh, layer))
      surface = std::make_shared<const SurfaceColour>(character);
    layers.emplace_back(character, rest, setup, layer, surface);
  }
  return MakeSkinTexels(character.mesh, side,
                        setup.path + ": stencil: ", [&](const SurfacePoint& at) {
                          float most = 0.0f;
                          for (const Growth& layer : layers) most = std::max(most, layer.Share(at));
                          return uint8_t(0.5f + 255.0f * most);
                        });
}

}  // namespace pelt
