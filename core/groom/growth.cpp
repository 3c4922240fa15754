#include "core/groom/growth.hpp"

#include <algorithm>
#include <cmath>

#include "core/float_rules.hpp"
#include "core/format.hpp"
#include "core/groom/setup_names.hpp"
#include "core/groom/surface_colour.hpp"
#include "core/random.hpp"

namespace pelt {
namespace {

constexpr uint64_t kDensitySeed = 0x64656e73;  // "dens"

float SmoothRamp(float low, float high, float x) {
  if (!(high > low)) return x >= high ? 1.0f : 0.0f;
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

// Of the nearest point of the triangle, m^2.
float SquaredDistance(const glm::vec3& p, const std::array<glm::vec3, 3>& corner) {
  const glm::vec3 ab = corner[1] - corner[0], ac = corner[2] - corner[0];
  const glm::vec3 normal = glm::cross(ab, ac), to = p - corner[0];
  const float area2 = glm::dot(normal, normal);
  if (area2 > 0.0f) {
    const float v = glm::dot(glm::cross(to, ac), normal), w = glm::dot(glm::cross(ab, to), normal);
    const float height = glm::dot(to, normal);
    if (v >= 0.0f && w >= 0.0f && v + w <= area2) return height * height / area2;
  }
  float least = glm::dot(to, to);
  for (size_t i = 0; i < 3; ++i) {
    const glm::vec3 from = corner[i], edge = corner[(i + 1) % 3] - from;
    const float length2 = glm::dot(edge, edge);
    const float along =
        length2 > 0.0f ? std::clamp(glm::dot(p - from, edge) / length2, 0.0f, 1.0f) : 0.0f;
    const glm::vec3 away = p - (from + edge * along);
    least = std::min(least, glm::dot(away, away));
  }
  return least;
}

}  // namespace

bool GrowsByImages(const Mesh& mesh, const LayerSetup& layer) {
  return !layer.mask.colours.empty() ||
         std::any_of(mesh.looks.begin(), mesh.looks.end(),
                     [](const MaterialLook& look) { return look.IsCut(); });
}

Growth::Growth(const Character& character, const RestGeometry& rest, const FurSetup& setup,
               const LayerSetup& layer, std::shared_ptr<const SurfaceColour> surface)
    : mesh_(character.mesh), rest_(rest), layer_(layer) {
  CheckMapsHaveUvs(mesh_, setup, layer);
  if (GrowsByImages(mesh_, layer))
    surface_ = surface ? std::move(surface) : std::make_shared<const SurfaceColour>(character);
  CheckColoursAreKnown(surface_.get(), mesh_, setup, layer);
  densest_ = layer.density * (1.0f + std::max(layer.density_randomise, -layer.density_randomise));
  if (const MapChannel& map = layer.density_map; map.map) densest_ *= std::max(map.low, map.high);
  if (const auto& range = layer.density_range) densest_ = std::clamp(densest_, range->x, range->y);
  box_low_ = glm::vec3(0.0f);
  box_extent_ = glm::vec3(0.0f);
  if (!rest.position.empty()) {
    glm::vec3 high = box_low_ = rest.position[0];
    for (const glm::vec3& p : rest.position) {
      box_low_ = glm::min(box_low_, p);
      high = glm::max(high, p);
    }
    box_extent_ = high - box_low_;
  }
  material_grows_ = FindMaterials(mesh_, setup, layer);
  if (const auto& margin = layer.mask.away_from) {
    const std::vector<uint8_t> found =
        FindNamedMaterials(mesh_, setup, layer, "mask.away_from.materials", margin->materials);
    for (size_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (!found[mesh_.triangle_material[t]]) continue;
      auto& corner = away_.emplace_back();
      for (size_t i = 0; i < 3; ++i) {
        corner[i] = rest.position[mesh_.triangles[t][i]];
        const bool first = away_.size() == 1 && i == 0;
        away_low_ = first ? corner[i] : glm::min(away_low_, corner[i]);
        away_high_ = first ? corner[i] : glm::max(away_high_, corner[i]);
      }
    }
    away_low_ -= margin->distance;
    away_high_ += margin->distance;
  }
  for (const Mask::JointWeight& mask : layer.mask.joints) {
    const auto counts =
        FindJoints(character.skeleton, setup, layer, "mask.joints.joint", mask.joint, mask.subtree);
    std::vector<float>& sum = joint_weight_.emplace_back(mesh_.position.size(), 0.0f);
    for (size_t v = 0; v < sum.size(); ++v) {
      for (int i = 0; i < 4; ++i) {
        if (mesh_.weights[v][i] > 0.0f && counts[mesh_.joints[v][size_t(i)]]) {
          sum[v] += mesh_.weights[v][i];
        }
      }
    }
  }
}

std::optional<UvScale> MeasureUvScale(const Mesh& mesh, const RestGeometry& rest) {
  struct Part {
    double scale, area;
  };
  std::vector<Part> parts;
  double whole = 0.0;
  for (const auto& v : mesh.triangles) {
    if (mesh.uv.empty()) break;
    const glm::dvec3 a = rest.position[v[0]], b = rest.position[v[1]], c = rest.position[v[2]];
    const glm::dvec2 s(mesh.uv[v[1]] - mesh.uv[v[0]]), t(mesh.uv[v[2]] - mesh.uv[v[0]]);
    const double area = 0.5 * glm::length(glm::cross(b - a, c - a));
    const double covered = 0.5 * std::abs(s.x * t.y - s.y * t.x);
    if (!(area > 0.0 && covered > 0.0)) continue;
    parts.push_back({std::sqrt(area / covered), area});
    whole += area;
  }
  if (parts.empty()) return std::nullopt;
  std::ranges::stable_sort(parts, {}, &Part::scale);
  UvScale found{parts.front().scale, parts.back().scale};
  double passed = 0.0;
  for (const Part& part : parts) {
    if (passed <= 0.05 * whole) found.finest = part.scale;
    if (passed <= 0.95 * whole) found.coarsest = part.scale;
    passed += part.area;
  }
  return found;
}

float Growth::JointLimit(uint32_t triangle) const {
  if (joint_weight_.empty()) return 1.0f;
  float limit = 0.0f;
  for (size_t i = 0; i < joint_weight_.size(); ++i) {
    float most = 0.0f;
    for (const uint32_t v : mesh_.triangles[triangle]) most = std::max(most, joint_weight_[i][v]);
    // Rounding may carry an interpolated weight past all three.
    limit = std::max(
        limit, SmoothRamp(layer_.mask.joints[i].low, layer_.mask.joints[i].high, most + 1e-5f));
  }
  return limit;
}

float Growth::TriangleLimit(uint32_t triangle) const {
  if (!material_grows_.empty() && !material_grows_[mesh_.triangle_material[triangle]]) return 0.0f;
  if (layer_.mask.range) {
    const auto& v = mesh_.triangles[triangle];
    const glm::vec3 a = BoxShare(rest_.position[v[0]]), b = BoxShare(rest_.position[v[1]]),
                    c = BoxShare(rest_.position[v[2]]);
    const glm::vec3 low = glm::min(glm::min(a, b), c) - 1e-5f,
                    high = glm::max(glm::max(a, b), c) + 1e-5f;
    for (int axis = 0; axis < 3; ++axis) {
      if (high[axis] < layer_.mask.range->low[axis]) return 0.0f;
      if (low[axis] > layer_.mask.range->high[axis]) return 0.0f;
    }
  }
  return JointLimit(triangle);
}

glm::vec3 Growth::BoxShare(const glm::vec3& position) const {
  glm::vec3 share(0.5f);
  for (int axis = 0; axis < 3; ++axis) {
    if (box_extent_[axis] > 0.0f) {
      share[axis] = (position[axis] - box_low_[axis]) / box_extent_[axis];
    }
  }
  return share;
}

float Growth::DensityShare(const SurfacePoint& point) const {
  if (!(densest_ > 0.0f)) return 0.0f;
  float density = layer_.density;
  if (layer_.density_map.map) {
    density *= SampleMap(layer_.density_map, point);
  }
  if (layer_.density_randomise != 0.0f) {
    Random random(MixSeed(MixSeed(layer_.seed, kDensitySeed), point.triangle));
    density *= 1.0f + layer_.density_randomise * float(random.Uniform(-1.0, 1.0));
  }
  if (const auto& range = layer_.density_range) density = std::clamp(density, range->x, range->y);
  return std::clamp(density / densest_, 0.0f, 1.0f);
}

float Growth::JointShare(const SurfacePoint& point) const {
  if (joint_weight_.empty()) return 1.0f;
  float share = 0.0f;
  for (size_t i = 0; i < joint_weight_.size(); ++i) {
    const Mask::JointWeight& mask = layer_.mask.joints[i];
    share = std::max(share,
                     SmoothRamp(mask.low, mask.high, Interpolate(joint_weight_[i], mesh_, point)));
  }
  return share;
}

float Growth::SampleMap(const MapChannel& map, const SurfacePoint& point) const {
  return map.At(Interpolate(mesh_.uv, mesh_, point), WrapOn(mesh_, point.triangle));
}

bool Growth::HasMaskedColour(const SurfacePoint& point) const {
  if (layer_.mask.colours.empty()) return false;
  const std::optional<glm::vec3> seen = surface_->SrgbAt(point);
  if (!seen) return false;
  const auto is_near = [&](uint32_t colour) {
    for (int c = 0; c < 3; ++c)
      if (!(std::abs((*seen)[c] - float(colour >> (8 * c) & 255u) / 255.0f) <=
            layer_.mask.colour_tolerance))
        return false;
    return true;
  };
  return std::any_of(layer_.mask.colours.begin(), layer_.mask.colours.end(), is_near);
}

bool Growth::IsInMargin(const glm::vec3& position) const {
  for (int axis = 0; axis < 3; ++axis)
    if (position[axis] < away_low_[axis] || position[axis] > away_high_[axis]) return false;
  const float reach = layer_.mask.away_from->distance;
  return std::ranges::any_of(
      away_, [&](const auto& corner) { return SquaredDistance(position, corner) < reach * reach; });
}

float Growth::Evaluate(Factor factor, const SurfacePoint& point) const {
  const Mask& mask = layer_.mask;
  switch (factor) {
    case kDensity:
      return DensityShare(point);
    case kMaterials:
      if (material_grows_.empty()) return 1.0f;
      return material_grows_[mesh_.triangle_material[point.triangle]] ? 1.0f : 0.0f;
    case kJoints:
      return JointShare(point);
    case kBox: {
      // Seen along the axis; rows of the picture run downwards, and from behind to the front when
      // seen from above.
      if (!mask.box || !mask.box->map.map) return 1.0f;
      const glm::vec3 at = BoxShare(Interpolate(rest_.position, mesh_, point));
      const glm::vec2 uv = mask.box->axis == 'x'   ? glm::vec2(at.z, 1.0f - at.y)
                           : mask.box->axis == 'y' ? glm::vec2(at.x, at.z)
                                                   : glm::vec2(at.x, 1.0f - at.y);
      // Half a texel inside: maps repeat, and the top of a character is not its feet.
      const ControlMap& map = *mask.box->map.map;
      const glm::vec2 edge(0.5f / float(map.width), 0.5f / float(map.height));
      return std::clamp(mask.box->map.At(glm::clamp(uv, edge, 1.0f - edge)), 0.0f, 1.0f);
    }
    case kRange: {
      if (!mask.range) return 1.0f;
      const glm::vec3 at = BoxShare(Interpolate(rest_.position, mesh_, point));
      for (int axis = 0; axis < 3; ++axis) {
        if (at[axis] < mask.range->low[axis] || at[axis] > mask.range->high[axis]) return 0.0f;
      }
      return 1.0f;
    }
    case kAwayFrom:
      if (away_.empty()) return 1.0f;
      return IsInMargin(Interpolate(rest_.position, mesh_, point)) ? 0.0f : 1.0f;
    case kStencil:
      if (!mask.uv.map) return 1.0f;
      return std::clamp(SampleMap(mask.uv, point), 0.0f, 1.0f);
    case kBald:
      if (!mask.bald.map) return 1.0f;
      return 1.0f - std::clamp(SampleMap(mask.bald, point), 0.0f, 1.0f);
    case kHoles:
      return surface_ && surface_->IsHole(point) ? 0.0f : 1.0f;
    case kColours:
      return HasMaskedColour(point) ? 0.0f : 1.0f;
    case kFactorCount:
      break;
  }
  return 1.0f;
}

float Growth::Share(const SurfacePoint& point) const {
  float share = 1.0f;
  for (int factor = 0; factor < kFactorCount && share > 0.0f; ++factor) {
    share *= Evaluate(Factor(factor), point);
  }
  return share;
}

std::string Growth::ExplainEmpty() const {
  const char* const keys[kFactorCount] = {"density",     "mask.materials", "mask.joints",
                                          "mask.box",    "mask.range",     "mask.away_from",
                                          "mask.uv",     "mask.bald",      "its materials' alpha",
                                          "mask.colours"};
  const glm::vec3 places[] = {{0.34f, 0.33f, 0.33f}, {0.8f, 0.1f, 0.1f},   {0.1f, 0.8f, 0.1f},
                              {0.1f, 0.1f, 0.8f},    {0.45f, 0.45f, 0.1f}, {0.45f, 0.1f, 0.45f},
                              {0.1f, 0.45f, 0.45f}};
  float most[kFactorCount] = {};
  float most_together = 0.0f;
  for (uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
    for (const glm::vec3& place : places) {
      float together = 1.0f;
      for (int factor = 0; factor < kFactorCount; ++factor) {
        const float share = Evaluate(Factor(factor), {t, place});
        most[factor] = std::max(most[factor], share);
        together *= share;
      }
      most_together = std::max(most_together, together);
    }
  }
  std::string alone, involved;
  for (int factor = 0; factor < kFactorCount; ++factor) {
    if (most[factor] <= 0.0f) alone += Format("{}'{}'", alone.empty() ? "" : ", ", keys[factor]);
  }
  if (!alone.empty()) return Format("{} alone leaves nothing of the surface", alone);
  if (most_together > 0.0f) {
    return "the area that its masks leave is too small for one strand at this density";
  }
  return "its masks do not overlap anywhere: each leaves some of the surface, all together none";
}

}  // namespace pelt
