#include "core/groom/attributes.hpp"

#include <algorithm>
#include <cmath>

#include "core/block_rows.hpp"
#include "core/exact_math.hpp"
#include "core/float_rules.hpp"
#include "core/groom/growth.hpp"
#include "core/groom/setup_names.hpp"
#include "core/random.hpp"

namespace pelt {

namespace {

double Square(const glm::dvec3& v) { return glm::dot(v, v); }

glm::dvec3 UnitOr(const glm::dvec3& v, const glm::dvec3& fallback) {
  const double square = Square(v);
  return square > 1e-24 ? v / std::sqrt(square) : fallback;
}

// Rest-pose origin of a skeleton node in file units.
std::vector<glm::dvec3> FindJointOrigins(const Skeleton& skeleton) {
  std::vector<glm::dvec3> origin(skeleton.parent.size());
  std::vector<glm::dmat4> global(skeleton.parent.size());
  for (size_t j = 0; j < global.size(); ++j) {
    const JointPose& pose = skeleton.rest[j];
    const glm::dmat3 rotation(glm::mat3_cast(glm::dquat(pose.rotation)));
    glm::dmat4 local(1.0);
    for (int axis = 0; axis < 3; ++axis) {
      local[axis] = glm::dvec4(rotation[axis] * double(pose.scale[axis]), 0.0);
    }
    local[3] = glm::dvec4(glm::dvec3(pose.translation), 1.0);
    const int32_t parent = skeleton.parent[j];
    global[j] = parent >= 0 ? global[size_t(parent)] * local : local;
    origin[j] = glm::dvec3(global[j][3]);
  }
  return origin;
}

// From the joint to its first child; for the last of a limb from its parent.
glm::dvec3 FindJointDirection(const Skeleton& skeleton, size_t joint) {
  const std::vector<glm::dvec3> origin = FindJointOrigins(skeleton);
  for (size_t j = joint + 1; j < origin.size(); ++j) {
    if (skeleton.parent[j] != int32_t(joint)) continue;
    const glm::dvec3 direction = UnitOr(origin[j] - origin[joint], glm::dvec3(0.0));
    if (Square(direction) > 0.0) return direction;
  }
  const int32_t parent = skeleton.parent[joint];
  if (parent < 0) return glm::dvec3(0.0);
  return UnitOr(origin[joint] - origin[size_t(parent)], glm::dvec3(0.0));
}

}  // namespace

RootFrame MakeRootFrame(const glm::dvec3& normal, const glm::dvec3& tangent) {
  RootFrame frame;
  frame.normal = UnitOr(normal, glm::dvec3(0.0, 1.0, 0.0));
  const glm::dvec3 n = frame.normal;
  const glm::dvec3 across =
      std::abs(n.x) < 0.7 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 0.0, 1.0);
  const glm::dvec3 fallback = UnitOr(across - n * glm::dot(n, across), across);
  frame.tangent = UnitOr(tangent - n * glm::dot(n, tangent), fallback);
  frame.bitangent = glm::cross(frame.normal, frame.tangent);
  return frame;
}

Comb::Comb(const Character& character, const RestGeometry& rest, const FurSetup& setup,
           const LayerSetup& layer)
    : normal_weight_(std::clamp(double(layer.comb_normal_weight), 0.0, 1.0)) {
  for (const CombVector& vector : layer.comb) {
    const glm::dvec3 position(vector.position);
    // A comb vector belongs to the nearest surface.
    glm::dvec3 normal(0.0);
    double nearest = 1e300;
    for (size_t v = 0; v < rest.position.size(); ++v) {
      const double square = Square(glm::dvec3(rest.position[v]) - position);
      if (square < nearest) {
        nearest = square;
        normal = glm::dvec3(rest.normal[v]);
      }
    }
    const glm::dvec3 direction = UnitOr(glm::dvec3(vector.direction), glm::dvec3(0.0));
    if (vector.reach > 0.0f && Square(direction) > 0.0) {
      vectors_.push_back({position, direction, normal, double(vector.reach)});
    }
  }
  if (layer.comb_joint.empty()) return;
  const auto named = FindJoints(character.skeleton, setup, layer, "comb_joint", layer.comb_joint,
                                /*subtree=*/false);
  const size_t joint = size_t(std::find(named.begin(), named.end(), 1) - named.begin());
  joint_direction_ = FindJointDirection(character.skeleton, joint);
  if (Square(joint_direction_) == 0.0) {
    FailLayerKey(setup, layer, "comb_joint",
                 "joint '" + layer.comb_joint +
                     "' has neither a child nor a parent at another place, so no direction; name "
                     "another joint, or leave it out and use azimuth and elevation");
  }
  has_joint_ = true;
}

glm::dvec3 Comb::Direction(const glm::vec3& position, const RootFrame& frame, double azimuth,
                           double elevation, const glm::dvec3* said) const {
  const glm::dvec3 up(0.0, 0.0, 1.0);
  glm::dvec3 heading;  // along the surface
  if (has_joint_) {
    // Not made unit: where the joint points out of the surface, the heading fades and the strand
    // stands up, instead of turning abruptly.
    heading = frame.ToFrame(joint_direction_);
    heading.z = 0.0;
  } else {
    heading = {exact::Cos(azimuth * exact::kRadiansPerDegree),
               exact::Sin(azimuth * exact::kRadiansPerDegree), 0.0};
  }
  const double raise = elevation * exact::kRadiansPerDegree;
  const glm::dvec3 fallback =
      said ? *said : UnitOr(heading * exact::Cos(raise) + up * exact::Sin(raise), up);

  glm::dvec3 combed(0.0);
  double left = 1.0;  // share of the direction that no vector has taken
  for (const Vector& vector : vectors_) {
    const double square = Square(glm::dvec3(position) - vector.position);
    if (square >= vector.reach * vector.reach) continue;
    const double near = 1.0 - square / (vector.reach * vector.reach);
    const double facing = std::max(0.0, glm::dot(vector.normal, frame.normal));
    const double weight = near * near * (1.0 - normal_weight_ * (1.0 - facing));
    combed += frame.ToFrame(vector.direction) * weight;
    left *= 1.0 - weight;
  }
  if (left == 1.0) return fallback;
  return UnitOr(UnitOr(combed, fallback) * (1.0 - left) + fallback * left, fallback);
}

namespace {

// What a random number is for, besides the attributes' own. The values are part of what a groom
// looks like: never renumber.
enum Purpose : uint64_t { kFrizzTilt = 12, kBrightness, kFilmStrip, kDirectionAxes = 41 };

constexpr bool DrawsByNumbersOfTheirOwn() {
  for (const StrandAttribute& entry : kStrandAttributes) {
    if (entry.random >= kFrizzTilt && entry.random <= kFilmStrip) return false;
    if (entry.random >= kDirectionAxes && entry.random < kDirectionAxes + 3) return false;
    for (const StrandAttribute& other : kStrandAttributes)
      if (&other != &entry && other.random == entry.random) return false;
  }
  return true;
}
static_assert(DrawsByNumbersOfTheirOwn());

Random RandomFor(uint64_t seed, uint64_t purpose, uint32_t owner) {
  return Random(MixSeed(MixSeed(seed, purpose), owner));
}

struct Place {
  glm::vec2 uv;
  std::array<Wrap, 2> wrap;
  uint64_t seed;
  uint32_t owner;      // strand or vertex
  bool varies = true;  // else what is drawn at random counts as its middle
};

// `said`: in place of value and map.
double Evaluate(const LayerSetup& layer, const StrandAttribute& entry, const Place& place,
                std::optional<float> said = std::nullopt) {
  const Attribute& attribute = layer.*entry.member;
  double value = double(said.value_or(attribute.value));
  if (attribute.map.map && !said) {
    value *= double(attribute.map.At(place.uv, place.wrap));
  }
  if (place.varies && attribute.randomise != 0.0f) {
    value *= 1.0 + double(attribute.randomise) *
                       RandomFor(place.seed, entry.random, place.owner).Uniform(-1.0, 1.0);
  }
  if (const auto& range = attribute.range) {
    value = std::clamp(value, double(range->x), double(range->y));
  }
  return value;
}

// Held to the bounds of the member that stores it.
float Stored(const StrandAttribute& entry, double value) {
  ForEachMember<StrandBlock>([&](const auto& member) {
    if constexpr (std::is_same_v<decltype(member.member), const decltype(entry.stored)>)
      if (member.member == entry.stored)
        value = std::clamp(value, double(member.low), double(member.high));
  });
  return float(value);
}

glm::dvec3 Unit(const glm::dvec3& v) { return v / std::sqrt(glm::dot(v, v)); }

// Tilts by up to `limit` radians towards any side, evenly over the disk of tilts.
glm::dvec3 Tilt(const glm::dvec3& direction, double limit, Random random) {
  const double angle = limit * std::sqrt(random.Uniform());
  const double around = 2.0 * exact::kPi * random.Uniform();
  const glm::dvec3 helper =
      std::abs(direction.x) < 0.7 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 1.0, 0.0);
  const glm::dvec3 side = Unit(glm::cross(direction, helper));
  const glm::dvec3 other = glm::cross(direction, side);
  const glm::dvec3 towards = side * exact::Cos(around) + other * exact::Sin(around);
  return direction * exact::Cos(angle) + towards * exact::Sin(angle);
}

// Hair does not grow into the skin: at least about two degrees above it.
constexpr double kLowest = 0.035;

glm::dvec3 KeepAboveSurface(glm::dvec3 direction) {
  if (direction.z >= kLowest) return direction;
  direction.z = 0.0;
  const double square = glm::dot(direction, direction);
  if (square < 1e-12) return {0.0, 0.0, 1.0};
  direction *= std::sqrt((1.0 - kLowest * kLowest) / square);
  direction.z = kLowest;
  return direction;
}

// Raises each point by its share of `raise`, but lowers none below the skin; then segments are equal again, of the
// length that the strand then has, which is returned.
double RaiseTip(double raise, uint32_t points, RestShape& shape) {
  const uint32_t segments = points - 1;
  const double least = kLowest * std::sqrt(Square(shape.offset[0]));
  glm::dvec3 last(0.0);
  double length = 0.0;
  for (uint32_t i = 0; i < segments; ++i) {
    glm::dvec3& at = shape.offset[i];
    at.z = std::max(at.z + raise * double(i + 1) / double(segments), std::min(at.z, least));
    length += std::sqrt(Square(at - last));
    last = at;
  }
  length = std::max(length, double(kShortestStrand));
  shape = MakeEqualSegments(shape, length, points, glm::dvec3(0.0, 0.0, 1.0));
  return length;
}

// One of `strips`, each as much of the map's range as the others; a texel of 8 bits is never between two.
uint8_t StripAt(const MapChannel& map, const Place& place, uint32_t strips) {
  const float read = map.map->Nearest(place.uv, map.channel, place.wrap);
  const float share = std::clamp(map.low + (map.high - map.low) * read, 0.0f, 1.0f);
  return uint8_t((share * 255.0f + 0.5f) * float(strips) / 256.0f);
}

constexpr float kRootShade = 0.6f;  // of fur that is coloured as the surface

bool IsSaid(uint32_t colour) { return colour >> 24 != 0; }

uint32_t ScaleColour(uint32_t colour, const glm::vec3& factor) {
  uint32_t scaled = colour & 0xff000000u;
  for (int i = 0; i < 3; ++i) {
    const float byte = float((colour >> (8 * i)) & 255u) * factor[i];
    scaled |= uint32_t(std::clamp(byte, 0.0f, 255.0f) + 0.5f) << (8 * i);
  }
  return scaled;
}

}  // namespace

RestShape MakeRestShape(const glm::dvec3& direction, double length, double curl, double twist,
                        uint32_t points, const glm::dvec3& profile) {
  const double segment = length / double(points - 1);
  glm::dvec3 along = Unit(direction);
  // About normal x direction: bends away from the normal. A strand that stands up bends towards the
  // tangent.
  glm::dvec3 axis(-along.y, along.x, 0.0);
  axis = glm::dot(axis, axis) > 1e-12 ? Unit(axis) : glm::dvec3(0.0, 1.0, 0.0);
  const double turn_sin = exact::Sin(twist * segment), turn_cos = exact::Cos(twist * segment);
  RestShape shape{};
  glm::dvec3 end(0.0);
  for (uint32_t i = 0; i + 1 < points; ++i) {
    if (i > 0 && curl != 0.0) {
      const double t = double(i) / double(points - 1);
      const double bend = curl * (profile.x + (profile.y + profile.z * t) * t) * segment;
      const double bend_sin = exact::Sin(bend), bend_cos = exact::Cos(bend);
      along = Unit(along * bend_cos + glm::cross(axis, along) * bend_sin);
      axis = axis * turn_cos + glm::cross(along, axis) * turn_sin;
      axis = Unit(axis - along * glm::dot(axis, along));
    }
    end += along * segment;
    shape.offset[i] = end;
  }
  return shape;
}

RestShape MakeEqualSegments(const RestShape& places, double length, uint32_t points,
                            const glm::dvec3& first) {
  RestShape made{};
  const double segment = length / double(points - 1);
  glm::dvec3 last(0.0), end(0.0), along = first;
  for (uint32_t i = 0; i + 1 < points; ++i) {
    const glm::dvec3 step = places.offset[i] - last;
    last = places.offset[i];
    const double size = std::sqrt(glm::dot(step, step));
    if (size > 1e-3 * segment) along = step / size;
    end += along * segment;
    made.offset[i] = end;
  }
  return made;
}

bool TakesSurfaceColour(const LayerSetup& layer) {
  return !IsSaid(layer.base_colour) || !IsSaid(layer.tip_colour);
}

AttributeMaker::AttributeMaker(const Character& character, const RestGeometry& rest,
                               const FurSetup& setup, const LayerSetup& layer,
                               std::shared_ptr<const SurfaceColour> surface)
    : mesh_(character.mesh),
      rest_(rest),
      layer_(layer),
      comb_(character, rest, setup, layer),
      flow_(character, rest, setup, layer, surface) {
  if (TakesSurfaceColour(layer))
    surface_ = surface ? std::move(surface) : std::make_shared<const SurfaceColour>(character);
  if (layer.offset.map.map) {
    vertex_wrap_.resize(mesh_.position.size());
    for (uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      for (const uint32_t v : mesh_.triangles[t]) vertex_wrap_[v] = WrapOn(mesh_, t);
  }
}

uint32_t AttributeMaker::ColourAt(const SurfacePoint& place, uint32_t said, float darker) const {
  if (IsSaid(said)) return said;
  if (!surface_ || !surface_->Knows(place.triangle)) return said | 0xff000000u;
  const glm::vec3 linear = surface_->At(place) * darker;
  uint32_t colour = 0xff000000u;
  for (int c = 0; c < 3; ++c)
    colour |= uint32_t(255.0 * std::clamp(ExactSrgb(double(linear[c])), 0.0, 1.0) + 0.5) << (8 * c);
  return colour;
}

template <class Value>
glm::dvec3 AttributeMaker::CombedDirection(const SurfacePoint& at, const glm::vec3& position,
                                           const RootFrame& frame, const Value& value) const {
  std::optional<glm::dvec3> said = flow_.Direction(at, frame.normal);
  if (said)
    said = UnitOr(frame.ToFrame(*said), glm::dvec3(0.0, 0.0, 1.0));
  else if (layer_.direction_vector)
    said = UnitOr(glm::dvec3(*layer_.direction_vector), glm::dvec3(0.0, 0.0, 1.0));
  const glm::dvec3 direction =
      comb_.Direction(position, frame, value(&LayerSetup::azimuth), value(&LayerSetup::elevation),
                      said ? &*said : nullptr);
  const double turn = value(&LayerSetup::direction) * exact::kRadiansPerDegree;
  if (turn == 0.0) return direction;
  const double s = exact::Sin(turn), c = exact::Cos(turn);
  return {direction.x * c - direction.y * s, direction.x * s + direction.y * c, direction.z};
}

template <class Value>
AttributeMaker::Shaped AttributeMaker::Shape(const SurfacePoint& at, const glm::dvec3& direction,
                                             const Value& value) const {
  const double length =
      std::max(value(&LayerSetup::length, flow_.Length(at)), double(kShortestStrand));
  const uint32_t points = layer_.params.points;
  Shaped shaped{
      MakeRestShape(direction, length, value(&LayerSetup::curl) * exact::kRadiansPerDegree,
                    value(&LayerSetup::twist) * exact::kRadiansPerDegree, points,
                    glm::dvec3(layer_.curl_profile)),
      length};
  const double raise = value(&LayerSetup::offset_tip);
  if (raise != 0.0) shaped.length = RaiseTip(raise, points, shaped.rest);
  return shaped;
}

GroomedStrand AttributeMaker::Groom(const ScatterPoint& point, uint32_t strand) const {
  GroomedStrand groomed{};
  groomed.place = point.place;
  groomed.position = point.position;
  groomed.frame = MakeRootFrame(glm::dvec3(point.normal),
                                glm::dvec3(Interpolate(rest_.tangent, mesh_, point.place)));
  const glm::vec2 uv =
      mesh_.uv.empty() ? glm::vec2(0.0f) : Interpolate(mesh_.uv, mesh_, point.place);
  const Place place{uv, WrapOn(mesh_, point.place.triangle), layer_.seed, strand};

  for (size_t i = 0; i < kStrandAttributes.size(); ++i)
    if (const StrandAttribute& entry = kStrandAttributes[i]; entry.stored)
      groomed.stored[i] = Stored(entry, Evaluate(layer_, entry, place));
  for (const StrandAttribute& entry : kStrandAttributes)
    if (entry.trait)
      groomed.traits.*entry.trait =
          float(std::clamp(Evaluate(layer_, entry, place), entry.low, entry.high));
  const auto value = [&](Attribute LayerSetup::*attribute, std::optional<float> said = {}) {
    return Evaluate(layer_, kStrandAttributes[PlaceOf(attribute)], place, said);
  };
  groomed.strength = float(std::clamp(value(&LayerSetup::strength), 0.0, 1.0));

  glm::dvec3 direction = CombedDirection(point.place, point.position, groomed.frame, value);
  if (const glm::dvec3 range(layer_.direction_range); range != glm::dvec3(0.0)) {
    glm::dvec3 moved = direction;
    for (int axis = 0; axis < 3; ++axis)
      moved[axis] +=
          range[axis] *
          RandomFor(layer_.seed, kDirectionAxes + uint64_t(axis), strand).Uniform(-1.0, 1.0);
    direction = UnitOr(moved, direction);
  }
  const double frizz = value(&LayerSetup::frizz) * exact::kRadiansPerDegree;
  if (frizz != 0.0) {
    direction = Tilt(direction, frizz, RandomFor(layer_.seed, kFrizzTilt, strand));
  }
  const Shaped shaped = Shape(point.place, KeepAboveSurface(direction), value);
  groomed.rest = shaped.rest;
  groomed.length = float(shaped.length);

  const double variation = value(&LayerSetup::colour_variation);
  const auto tinted = [&](uint32_t colour, const MapChannel& own) {
    glm::vec3 tint(1.0f);
    for (MapChannel map : {layer_.colour_map, own})
      for (map.channel = 0; map.map && map.channel < 3; ++map.channel)
        tint[map.channel] *= map.At(uv, place.wrap);
    tint *= float(1.0 + variation * RandomFor(layer_.seed, kBrightness, strand).Uniform(-1.0, 1.0));
    return ScaleColour(colour, tint);
  };
  groomed.base_colour =
      tinted(ColourAt(point.place, layer_.base_colour, kRootShade), layer_.base_colour_map);
  groomed.tip_colour =
      tinted(ColourAt(point.place, layer_.tip_colour, 1.0f), layer_.tip_colour_map);
  const uint32_t strips = std::clamp(layer_.film_strip_count, 1u, 256u);
  groomed.film_strip = layer_.type_map.map
                           ? StripAt(layer_.type_map, place, strips)
                           : uint8_t(RandomFor(layer_.seed, kFilmStrip, strand).Below(strips));
  return groomed;
}

StrandLie AttributeMaker::MeanLie(const SurfacePoint& at) const {
  const RootFrame frame = MakeRootFrame(glm::dvec3(InterpolateNormal(mesh_, rest_, at)),
                                        glm::dvec3(Interpolate(rest_.tangent, mesh_, at)));
  const glm::vec2 uv = mesh_.uv.empty() ? glm::vec2(0.0f) : Interpolate(mesh_.uv, mesh_, at);
  const Place place{.uv = uv,
                    .wrap = WrapOn(mesh_, at.triangle),
                    .seed = layer_.seed,
                    .owner = 0,
                    .varies = false};
  const auto value = [&](Attribute LayerSetup::*attribute, std::optional<float> said = {}) {
    return Evaluate(layer_, kStrandAttributes[PlaceOf(attribute)], place, said);
  };
  const glm::vec3 position = Interpolate(rest_.position, mesh_, at);
  const glm::dvec3 direction = KeepAboveSurface(CombedDirection(at, position, frame, value));
  const auto [rest, length] = Shape(at, direction, value);
  const glm::dvec3 tip = rest.offset[layer_.params.points - 2];
  const double reach = std::sqrt(glm::dot(tip, tip));
  // One that curls up comes back to its root.
  const glm::dvec3 towards = reach > 1e-3 * length ? KeepAboveSurface(tip / reach) : direction;
  return {frame.normal, frame.FromFrame(towards), length};
}

float AttributeMaker::LiftVertex(uint32_t vertex) const {
  const glm::vec2 uv = mesh_.uv.empty() ? glm::vec2(0.0f) : mesh_.uv[vertex];
  const auto wrap = vertex_wrap_.empty() ? std::array<Wrap, 2>{} : vertex_wrap_[vertex];
  return float(Evaluate(layer_, kStrandAttributes[PlaceOf(&LayerSetup::offset)],
                        {uv, wrap, layer_.seed, vertex}));
}

}  // namespace pelt
