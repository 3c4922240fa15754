// Idea, units and sources: see pose.hpp.
#include "core/character/pose.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/character/clips.hpp"
#include "core/character/mesh_repair.hpp"
#include "core/exact_math.hpp"
#include "core/float_environment.hpp"
#include "core/float_rules.hpp"
#include "core/format.hpp"

namespace pelt {
namespace {

// One channel of one joint: four keys of n numbers, and their weights.
struct KeyBlend {
  glm::vec4 key[4] = {};
  float weight[4] = {1.0f, 0.0f, 0.0f, 0.0f};
};

// Keys are unit quaternions. Weights of the shorter arc; key 3 is turned to key 0's side.
void BlendSlerp(const glm::vec4& a, const glm::vec4& b, double share, KeyBlend* blend) {
  double dot = double(a.x) * b.x + double(a.y) * b.y + double(a.z) * b.z + double(a.w) * b.w;
  const float side = dot < 0.0 ? -1.0f : 1.0f;
  dot = dot < 0.0 ? -dot : dot;
  blend->key[0] = a;
  blend->key[3] = b * side;
  double from = 1.0 - share, to = share;
  // Below 1.8 degrees the normalised sum of the lerp differs from slerp by less than a float.
  if (dot < 0.9995) {
    const double angle = exact::Acos(dot);
    const double scale = 1.0 / exact::Sin(angle);
    from = exact::Sin(from * angle) * scale;
    to = exact::Sin(to * angle) * scale;
  }
  blend->weight[0] = float(from);
  blend->weight[3] = float(to);
}

// Hermite: value, out tangent * dt, in tangent * dt of the next, value of the next.
void BlendCubic(const Track& track, const TrackPlace& at, KeyBlend* blend) {
  const float span = float(at.span_s);
  blend->key[0] = track.value[3 * at.low + 1];
  blend->key[1] = track.value[3 * at.low + 2] * span;
  blend->key[2] = track.value[3 * at.high] * span;
  blend->key[3] = track.value[3 * at.high + 1];
  const double s = at.share, s2 = s * s, s3 = s2 * s;
  blend->weight[0] = float(2.0 * s3 - 3.0 * s2 + 1.0);
  blend->weight[1] = float(s3 - 2.0 * s2 + s);
  blend->weight[2] = float(s3 - s2);
  blend->weight[3] = float(3.0 * s2 - 2.0 * s3);
}

KeyBlend SampleTrack(const Track& track, double t) {
  KeyBlend blend;
  const TrackPlace at = FindPlace(track, t);
  const bool cubic = track.interpolation == Interpolation::kCubicSpline;
  if (IsHeld(track, at)) {
    blend.key[0] = track.value[cubic ? 3 * at.low + 1 : at.low];
  } else if (cubic) {
    BlendCubic(track, at, &blend);
  } else if (track.channel == Channel::kRotation) {
    BlendSlerp(track.value[at.low], track.value[at.high], at.share, &blend);
  } else {
    blend.key[0] = track.value[at.low];
    blend.key[3] = track.value[at.high];
    blend.weight[0] = float(1.0 - at.share);
    blend.weight[3] = float(at.share);
  }
  return blend;
}

template <size_t kNumbers>
void Store(const KeyBlend& blend, uint32_t joint, float (&key)[4][kNumbers][kJointsPerCharacter],
           float (&weight)[4][kJointsPerCharacter]) {
  for (size_t k = 0; k < 4; ++k) {
    for (size_t c = 0; c < kNumbers; ++c) key[k][c][joint] = blend.key[k][int(c)];
    weight[k][joint] = blend.weight[k];
  }
}

KeyBlend Constant(const glm::vec4& value) {
  KeyBlend blend;
  blend.key[0] = value;
  return blend;
}

void StoreRest(const JointPose& rest, uint32_t joint, PoseBlock* pose) {
  const glm::quat& q = rest.rotation;
  Store(Constant(glm::vec4(rest.translation, 0.0f)), joint, pose->translation_key,
        pose->translation_weight);
  Store(Constant(glm::vec4(q.x, q.y, q.z, q.w)), joint, pose->rotation_key, pose->rotation_weight);
  Store(Constant(glm::vec4(rest.scale, 0.0f)), joint, pose->scale_key, pose->scale_weight);
}

void StoreTrack(const Track& track, double t, PoseBlock* pose) {
  const KeyBlend blend = SampleTrack(track, t);
  switch (track.channel) {
    case Channel::kTranslation:
      Store(blend, track.joint, pose->translation_key, pose->translation_weight);
      break;
    case Channel::kRotation:
      Store(blend, track.joint, pose->rotation_key, pose->rotation_weight);
      break;
    case Channel::kScale:
      Store(blend, track.joint, pose->scale_key, pose->scale_weight);
      break;
  }
}

template <size_t kNumbers>
void CopyLane(float (&key)[4][kNumbers][kJointsPerCharacter],
              float (&weight)[4][kJointsPerCharacter], uint32_t from, uint32_t to) {
  for (size_t k = 0; k < 4; ++k) {
    for (size_t c = 0; c < kNumbers; ++c) key[k][c][to] = key[k][c][from];
    weight[k][to] = weight[k][from];
  }
}

glm::dvec3 Unit(const glm::dvec3& v, const glm::dvec3& otherwise) {
  const double length = std::sqrt(glm::dot(v, v));
  return length > 1e-150 && length < 1e150 ? v / length : otherwise;
}

}  // namespace

void FillPose(const Skeleton& skeleton, const Clip* clip, double time_s, bool loop,
              const glm::mat4& root, PoseBlock* pose) {
  const FloatEnvironment guard;
  const uint32_t count = uint32_t(skeleton.rest.size());
  for (uint32_t j = 0; j < count; ++j) StoreRest(skeleton.rest[j], j, pose);
  if (clip) {
    const double t = WrapTime(*clip, time_s, loop);
    for (const Track& track : clip->tracks) StoreTrack(track, t, pose);
  }
  const uint32_t padded = RoundUpToLaneGroups(count);
  for (uint32_t j = count; j < padded; ++j) {
    CopyLane(pose->translation_key, pose->translation_weight, count - 1, j);
    CopyLane(pose->rotation_key, pose->rotation_weight, count - 1, j);
    CopyLane(pose->scale_key, pose->scale_weight, count - 1, j);
  }
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) pose->root[4 * r + c] = root[c][r];
  pose->joint_count = count;
}

PoseBlock MakePose(const Skeleton& skeleton, const Clip* clip, double time_s, bool loop,
                   const glm::mat4& root) {
  PoseBlock pose{};
  FillPose(skeleton, clip, time_s, loop, root, &pose);
  return pose;
}

glm::mat4 PlaceCharacter(const glm::mat4& placement, float unit_scale) {
  const FloatEnvironment guard;
  glm::mat4 root = placement;
  for (int c = 0; c < 3; ++c) root[c] *= unit_scale;
  return root;
}

glm::dmat4 MatrixOf(const JointPose& pose) {
  const glm::dquat q(pose.rotation);
  const glm::dvec3 s(pose.scale);
  const double x = q.x, y = q.y, z = q.z, w = q.w;
  glm::dmat4 m(1.0);
  m[0] = glm::dvec4(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0) * s.x;
  m[1] = glm::dvec4(2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x), 0) * s.y;
  m[2] = glm::dvec4(2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y), 0) * s.z;
  m[3] = glm::dvec4(glm::dvec3(pose.translation), 1.0);
  return m;
}

SkeletonBlock MakeSkeletonBlock(const Skeleton& skeleton) {
  SkeletonBlock block{};
  for (uint32_t j = 0; j < kJointsPerCharacter; ++j) {
    const bool used = j < skeleton.parent.size();
    block.parent[j] = used ? skeleton.parent[j] : -1;
    const glm::mat4 m = used ? skeleton.inverse_bind[j] : glm::mat4(1.0f);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c) block.inverse_bind[j][4 * r + c] = m[c][r];
  }
  return block;
}

const Clip* FindClip(const Character& character, const std::string& name) {
  for (const Clip& clip : character.clips)
    if (clip.name == name) return &clip;
  return nullptr;
}

namespace {

// From bind space to where each joint rests.
std::vector<glm::dmat4> MakeRestPalette(const Skeleton& skeleton) {
  std::vector<glm::dmat4> global(skeleton.rest.size()), palette(skeleton.rest.size());
  for (size_t j = 0; j < global.size(); ++j) {
    const glm::dmat4 local = MatrixOf(skeleton.rest[j]);
    global[j] = skeleton.parent[j] < 0 ? local : global[size_t(skeleton.parent[j])] * local;
    palette[j] = global[j] * glm::dmat4(skeleton.inverse_bind[j]);
  }
  return palette;
}

glm::dmat4 BlendOf(const Mesh& mesh, size_t v, const std::vector<glm::dmat4>& palette) {
  glm::dmat4 m(0.0);
  for (int i = 0; i < 4; ++i)
    if (mesh.weights[v][i] > 0.0f)
      m += palette[mesh.joints[v][size_t(i)]] * double(mesh.weights[v][i]);
  return m;
}

}  // namespace

RestGeometry ComputeRestGeometry(const Character& character, float unit_scale) {
  const FloatEnvironment guard;
  const Mesh& mesh = character.mesh;
  const std::vector<glm::dmat4> palette = MakeRestPalette(character.skeleton);
  RestGeometry rest;
  for (size_t v = 0; v < mesh.position.size(); ++v) {
    const glm::dmat4 m = BlendOf(mesh, v, palette);
    const glm::dmat3 linear(m);
    const glm::dvec3 position(m * glm::dvec4(glm::dvec3(mesh.position[v]), 1.0));
    const glm::dvec3 normal = Unit(linear * glm::dvec3(mesh.normal[v]), glm::dvec3(0.0, 1.0, 0.0));
    const glm::dvec3 t = linear * glm::dvec3(mesh.tangent[v]);
    const glm::dvec3 across = Unit(t, PickTangent(normal));
    const glm::dvec3 orthogonal = across - normal * glm::dot(normal, across);
    const bool usable = glm::dot(orthogonal, orthogonal) > 1e-12;
    rest.position.push_back(glm::vec3(position * double(unit_scale)));
    rest.normal.push_back(glm::vec3(normal));
    rest.tangent.push_back(
        glm::vec3(usable ? Unit(orthogonal, PickTangent(normal)) : PickTangent(normal)));
  }
  return rest;
}

double BoundingBox::LargestSide() const {
  const glm::vec3 size = Size();
  return double(std::max({size.x, size.y, size.z}));
}

BoundingBox BoundPlaces(std::span<const glm::vec3> places) {
  BoundingBox box{places.front(), places.front()};
  for (const glm::vec3& at : places) {
    box.low = glm::min(box.low, at);
    box.high = glm::max(box.high, at);
  }
  return box;
}

size_t FitNormalsToRest(Character* character) {
  const FloatEnvironment guard;
  constexpr double kLeastTurn = 1e-5;  // 1 - cosine: a quarter of a degree
  Mesh& mesh = character->mesh;
  const std::vector<glm::dmat4> palette = MakeRestPalette(character->skeleton);
  size_t turned = 0;
  for (size_t v = 0; v < mesh.position.size(); ++v) {
    const glm::dmat3 linear(BlendOf(mesh, v, palette));
    const glm::dvec3 normal(mesh.normal[v]), none(0.0);
    // Scaled first: a file's units must not decide what is too flat to be turned back.
    const double size = std::sqrt(glm::dot(linear[0], linear[0]) + glm::dot(linear[1], linear[1]) +
                                  glm::dot(linear[2], linear[2]));
    if (!(size > 1e-150)) continue;
    const glm::dmat3 shape = linear * (1.0 / size);
    if (!(std::abs(glm::determinant(shape)) > 1e-9)) continue;
    const glm::dmat3 back = glm::inverse(shape);
    const glm::dvec3 wanted = Unit(glm::transpose(back) * normal, none);
    const glm::dvec3 drawn = Unit(shape * normal, none);
    if (glm::dot(wanted, drawn) > 1.0 - kLeastTurn) continue;
    mesh.normal[v] = glm::vec3(Unit(back * wanted, normal));
    ++turned;
  }
  if (turned) GenerateTangents(&mesh);
  return turned;
}

UnitScale DefaultUnitScale(const Character& character) {
  const FloatEnvironment guard;
  const RestGeometry rest = ComputeRestGeometry(character, 1.0f);
  glm::dvec3 low(1e300), high(-1e300);
  for (const glm::vec3& p : rest.position) {
    low = glm::min(low, glm::dvec3(p));
    high = glm::max(high, glm::dvec3(p));
  }
  const glm::dvec3 size = high - low;
  const double extent = rest.position.empty() ? 0.0 : std::max({size.x, size.y, size.z});
  if (!(extent > 1e-18)) return {1.0f, "Unit scale 1: the rest pose has no extent."};
  // Powers of ten as whole numbers: exact up to 10^22, so the division is rounded once.
  double power = 1.0;
  const bool large = extent >= 3.0;
  while (large ? extent / power >= 3.0 : extent * power < 0.3) power *= 10.0;
  const double scale = large ? 1.0 / power : power;
  return {float(scale),
          Format("Unit scale {:g} (metres a file unit), worked out from the rest pose: its largest "
                 "extent, {:.4g} units, is taken as {:.4g} m. Set unit_scale in the fur setup to "
                 "change it.",
                 scale, extent, extent * scale)};
}

// ---- How fast poses move ------------------------------------------------------------------------

namespace {

// What a track's keys blend to, before a rotation is made unit, and its derivative by time.
struct Moving {
  glm::dvec4 value, rate;
};

// The great circle that FillPose takes, by the share of the way.
Moving AlongCircle(const glm::dvec4& a, glm::dvec4 b, double share) {
  double dot = glm::dot(a, b);
  if (dot < 0.0) b = -b, dot = -dot;
  if (dot >= 0.9995) return {a + (b - a) * share, b - a};
  const double angle = exact::Acos(dot), scale = 1.0 / exact::Sin(angle);
  const double from = (1.0 - share) * angle, to = share * angle;
  return {(a * exact::Sin(from) + b * exact::Sin(to)) * scale,
          (b * exact::Cos(to) - a * exact::Cos(from)) * (angle * scale)};
}

Moving AlongSpline(const Track& track, const TrackPlace& at) {
  const glm::dvec4 a(track.value[3 * at.low + 1]), b(track.value[3 * at.high + 1]);
  const glm::dvec4 out = glm::dvec4(track.value[3 * at.low + 2]) * at.span_s;
  const glm::dvec4 in = glm::dvec4(track.value[3 * at.high]) * at.span_s;
  const double s = at.share, s2 = s * s, s3 = s2 * s;
  return {a * (2.0 * s3 - 3.0 * s2 + 1.0) + out * (s3 - 2.0 * s2 + s) + in * (s3 - s2) +
              b * (3.0 * s2 - 2.0 * s3),
          a * (6.0 * s2 - 6.0 * s) + out * (3.0 * s2 - 4.0 * s + 1.0) + in * (3.0 * s2 - 2.0 * s) +
              b * (6.0 * s - 6.0 * s2)};
}

glm::dvec3 SpinOf(const Moving& q) {
  const double square = glm::dot(q.value, q.value);
  if (!(square > 1e-30)) return glm::dvec3(0.0);
  // What changes the length alone turns nothing: it falls out of q' q*.
  const glm::dvec3 v(q.value), dv(q.rate);
  return (dv * q.value.w - v * q.rate.w + glm::cross(v, dv)) * (2.0 / square);
}

// Between two keys.
glm::dvec3 RateBetween(const Track& track, const TrackPlace& at) {
  if (IsHeld(track, at)) return glm::dvec3(0.0);
  const bool cubic = track.interpolation == Interpolation::kCubicSpline;
  const bool turns = track.channel == Channel::kRotation;
  Moving moving;
  if (cubic) {
    moving = AlongSpline(track, at);
  } else {
    const glm::dvec4 a(track.value[at.low]), b(track.value[at.high]);
    moving = turns ? AlongCircle(a, b, at.share) : Moving{a, b - a};
  }
  moving.rate /= at.span_s;
  return turns ? SpinOf(moving) : glm::dvec3(moving.rate);
}

// Of the keys `low` and the one behind it.
TrackPlace PlaceAfter(const Track& track, size_t low, double share) {
  return {low, low + 1, share, double(track.time_s[low + 1]) - double(track.time_s[low])};
}

glm::dvec3 RateAt(const Track& track, double t) {
  const size_t last = track.time_s.size() - 1;
  const double begin = double(track.time_s.front()), end = double(track.time_s.back());
  if (last == 0 || t < begin || t > end) return glm::dvec3(0.0);
  if (t == begin) return RateBetween(track, PlaceAfter(track, 0, 0.0));
  if (t == end) return RateBetween(track, PlaceAfter(track, last - 1, 1.0));
  const TrackPlace at = FindPlace(track, t);
  const glm::dvec3 after = RateBetween(track, at);
  if (at.share != 0.0) return after;
  return (RateBetween(track, PlaceAfter(track, at.low - 1, 1.0)) + after) * 0.5;
}

}  // namespace

void FillPoseRates(const Clip* clip, double time_s, bool loop, double speed,
                   const glm::mat4& root_rate, PoseRateBlock* rates) {
  const FloatEnvironment guard;
  *rates = {};
  rates->given = 1;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) rates->root[4 * r + c] = root_rate[c][r];
  if (!clip) return;
  const double t = WrapTime(*clip, time_s, loop);
  for (const Track& track : clip->tracks) {
    const glm::dvec3 rate = RateAt(track, t) * speed;
    auto& rows = track.channel == Channel::kTranslation ? rates->translation
                 : track.channel == Channel::kRotation  ? rates->spin
                                                        : rates->scale;
    for (int c = 0; c < 3; ++c) rows[c][track.joint] = float(rate[c]);
  }
}

}  // namespace pelt
