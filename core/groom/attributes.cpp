#include "core/groom/attributes.hpp"

#include <algorithm>
#include <cmath>

#include "core/block_rows.hpp"
#include "core/exact_math.hpp"
#include "core/float_rules.hpp"
#include "core/random.hpp"

namespace pelt {
namespace {

// What a random number is for, besides the attributes' own. The values are part of what a groom
// looks like: never renumber.
enum Purpose : uint64_t { kFrizzTilt = 12, kBrightness, kFilmStrip };

constexpr bool DrawsByNumbersOfTheirOwn() {
  for (const StrandAttribute& row : kStrandAttributes) {
    if (row.random >= kFrizzTilt && row.random <= kFilmStrip) return false;
    for (const StrandAttribute& other : kStrandAttributes)
      if (&other != &row && other.random == row.random) return false;
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

double Evaluate(const LayerSetup& layer, const StrandAttribute& row, const Place& place) {
  const Attribute& attribute = layer.*row.member;
  double value = attribute.value;
  if (attribute.map.map) {
    value *= double(attribute.map.map->Sample(place.uv, attribute.map.channel, place.wrap));
  }
  if (place.varies && attribute.randomise != 0.0f) {
    value *= 1.0 + double(attribute.randomise) *
                       RandomFor(place.seed, row.random, place.owner).Uniform(-1.0, 1.0);
  }
  if (const auto& range = attribute.range) {
    value = std::clamp(value, double(range->x), double(range->y));
  }
  return value;
}

// Held to the bounds of the member that stores it.
float Stored(const StrandAttribute& row, double value) {
  ForEachMember<StrandBlock>([&](const auto& member) {
    if constexpr (std::is_same_v<decltype(member.member), const decltype(row.stored)>)
      if (member.member == row.stored)
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
glm::dvec3 KeepAboveSurface(glm::dvec3 direction) {
  constexpr double kLowest = 0.035;
  if (direction.z >= kLowest) return direction;
  direction.z = 0.0;
  const double square = glm::dot(direction, direction);
  if (square < 1e-12) return {0.0, 0.0, 1.0};
  direction *= std::sqrt((1.0 - kLowest * kLowest) / square);
  direction.z = kLowest;
  return direction;
}

// As comb and attributes have it, without frizz; in the root frame. value(&LayerSetup::azimuth) is an attribute's value.
template <class Value>
glm::dvec3 CombedDirection(const Comb& comb, const glm::vec3& position, const RootFrame& frame,
                           const Value& value) {
  const glm::dvec3 direction =
      comb.Direction(position, frame, value(&LayerSetup::azimuth), value(&LayerSetup::elevation));
  const double turn = value(&LayerSetup::direction) * exact::kRadiansPerDegree;
  if (turn == 0.0) return direction;
  const double s = exact::Sin(turn), c = exact::Cos(turn);
  return {direction.x * c - direction.y * s, direction.x * s + direction.y * c, direction.z};
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
                        uint32_t points) {
  const double segment = length / double(points - 1);
  glm::dvec3 along = Unit(direction);
  // About normal x direction: bends away from the normal. A strand that stands up bends towards the
  // tangent.
  glm::dvec3 axis(-along.y, along.x, 0.0);
  axis = glm::dot(axis, axis) > 1e-12 ? Unit(axis) : glm::dvec3(0.0, 1.0, 0.0);
  const double bend_sin = exact::Sin(curl * segment), bend_cos = exact::Cos(curl * segment);
  const double turn_sin = exact::Sin(twist * segment), turn_cos = exact::Cos(twist * segment);
  RestShape shape{};
  glm::dvec3 end(0.0);
  for (uint32_t i = 0; i + 1 < points; ++i) {
    if (i > 0 && curl != 0.0) {
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
    : mesh_(character.mesh), rest_(rest), layer_(layer), comb_(character, rest, setup, layer) {
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
    if (const StrandAttribute& row = kStrandAttributes[i]; row.stored)
      groomed.stored[i] = Stored(row, Evaluate(layer_, row, place));
  const auto value = [&](Attribute LayerSetup::*attribute) {
    return Evaluate(layer_, kStrandAttributes[PlaceOf(attribute)], place);
  };
  const double length = std::max(value(&LayerSetup::length), double(kShortestStrand));
  groomed.length = float(length);
  groomed.strength = float(std::clamp(value(&LayerSetup::strength), 0.0, 1.0));

  glm::dvec3 direction = CombedDirection(comb_, point.position, groomed.frame, value);
  const double frizz = value(&LayerSetup::frizz) * exact::kRadiansPerDegree;
  if (frizz != 0.0) {
    direction = Tilt(direction, frizz, RandomFor(layer_.seed, kFrizzTilt, strand));
  }
  groomed.rest = MakeRestShape(
      KeepAboveSurface(direction), length, value(&LayerSetup::curl) * exact::kRadiansPerDegree,
      value(&LayerSetup::twist) * exact::kRadiansPerDegree, layer_.params.points);

  const double variation = value(&LayerSetup::colour_variation);
  glm::vec3 tint(1.0f);
  if (layer_.colour_map.map) {
    for (int i = 0; i < 3; ++i) tint[i] = layer_.colour_map.map->Sample(uv, i, place.wrap);
  }
  tint *= float(1.0 + variation * RandomFor(layer_.seed, kBrightness, strand).Uniform(-1.0, 1.0));
  groomed.base_colour = ScaleColour(ColourAt(point.place, layer_.base_colour, kRootShade), tint);
  groomed.tip_colour = ScaleColour(ColourAt(point.place, layer_.tip_colour, 1.0f), tint);
  const uint32_t strips = std::clamp(layer_.film_strip_count, 1u, 256u);
  groomed.film_strip = uint8_t(RandomFor(layer_.seed, kFilmStrip, strand).Below(strips));
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
  const auto value = [&](Attribute LayerSetup::*attribute) {
    return Evaluate(layer_, kStrandAttributes[PlaceOf(attribute)], place);
  };
  const double length = std::max(value(&LayerSetup::length), double(kShortestStrand));
  const glm::vec3 position = Interpolate(rest_.position, mesh_, at);
  const glm::dvec3 direction = KeepAboveSurface(CombedDirection(comb_, position, frame, value));
  const RestShape shape =
      MakeRestShape(direction, length, value(&LayerSetup::curl) * exact::kRadiansPerDegree,
                    value(&LayerSetup::twist) * exact::kRadiansPerDegree, layer_.params.points);
  const glm::dvec3 tip = shape.offset[layer_.params.points - 2];
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
