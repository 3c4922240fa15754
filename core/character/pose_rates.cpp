// Idea: see FillPoseRates in pose.hpp.
#include "core/character/clips.hpp"
#include "core/character/pose.hpp"
#include "core/float_environment.hpp"
#include "core/float_rules.hpp"

namespace pelt {
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
