#include "core/view.hpp"

#include <cmath>

#include "core/exact_math.hpp"
#include "core/float_environment.hpp"
#include "core/float_rules.hpp"

namespace pelt {
namespace {

struct Double3 {
  double x, y, z;
};

Double3 operator+(Double3 a, Double3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Double3 operator-(Double3 a, Double3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Double3 operator*(Double3 a, double s) { return {a.x * s, a.y * s, a.z * s}; }
double Dot(Double3 a, Double3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Double3 Cross(Double3 a, Double3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double Length(Double3 a) { return std::sqrt(Dot(a, a)); }

// Unit vector along a, or `fallback` when a has no direction.
Double3 NormalizeOr(Double3 a, Double3 fallback) {
  const double length = Length(a);
  return length > 1e-12 ? a * (1.0 / length) : fallback;
}

double FiniteOr(double a, double fallback) { return std::isfinite(a) ? a : fallback; }

Double3 ToDouble(const float (&a)[3]) {
  return {FiniteOr(a[0], 0.0), FiniteOr(a[1], 0.0), FiniteOr(a[2], 0.0)};
}

double ClampOr(double a, double low, double high, double fallback) {
  if (!std::isfinite(a)) return fallback;
  return a < low ? low : a > high ? high : a;
}

// The world axis farthest from `direction`.
Double3 FarthestAxis(Double3 direction) {
  const double x = std::abs(direction.x), y = std::abs(direction.y), z = std::abs(direction.z);
  if (y <= x && y <= z) return {0.0, 1.0, 0.0};
  return z <= x ? Double3{0.0, 0.0, 1.0} : Double3{1.0, 0.0, 0.0};
}

void StorePlane(float (&plane)[4], Double3 inward, Double3 through) {
  plane[0] = float(inward.x);
  plane[1] = float(inward.y);
  plane[2] = float(inward.z);
  plane[3] = float(-Dot(inward, through));
}

void Store(float (&out)[3], Double3 a) {
  out[0] = float(a.x);
  out[1] = float(a.y);
  out[2] = float(a.z);
}

constexpr double kSmallestFov = 1e-3, kLargestFov = 3.1;

bool AllFinite(const Camera& c) {
  const float values[] = {c.eye[0],
                          c.eye[1],
                          c.eye[2],
                          c.target[0],
                          c.target[1],
                          c.target[2],
                          c.up[0],
                          c.up[1],
                          c.up[2],
                          c.vertical_fov_rad,
                          c.near_m,
                          c.far_m,
                          c.viewport_width_px,
                          c.viewport_height_px};
  for (float v : values)
    if (!std::isfinite(v)) return false;
  return true;
}

}  // namespace

const char* FindCameraFault(const Camera& c) {
  const FloatEnvironment guard;
  if (!AllFinite(c)) return "a camera value is not finite";
  if (!(Length(ToDouble(c.target) - ToDouble(c.eye)) > 1e-12))
    return "the camera's target is its eye";
  if (!(c.vertical_fov_rad >= kSmallestFov && c.vertical_fov_rad <= kLargestFov))
    return "the camera's field of view must be between 0.001 and 3.1 radians";
  if (!(c.viewport_width_px >= 1.0f && c.viewport_height_px >= 1.0f))
    return "the viewport must be at least one pixel wide and high";
  if (!(c.near_m >= 1e-4f && c.far_m > c.near_m))
    return "the camera's near plane must be at least 0.0001 m and its far plane beyond it";
  return nullptr;
}

View MakeView(const Camera& camera) {
  const FloatEnvironment guard;
  const Double3 eye = ToDouble(camera.eye);
  const Double3 forward = NormalizeOr(ToDouble(camera.target) - eye, {0.0, 0.0, -1.0});
  const Double3 wanted_up = NormalizeOr(ToDouble(camera.up), FarthestAxis(forward));
  Double3 right = Cross(forward, wanted_up);
  if (Length(right) < 1e-6) right = Cross(forward, FarthestAxis(forward));
  right = NormalizeOr(right, {1.0, 0.0, 0.0});
  const Double3 up = Cross(right, forward);

  const double fov = ClampOr(camera.vertical_fov_rad, kSmallestFov, kLargestFov, 0.9);
  const double width = ClampOr(camera.viewport_width_px, 1.0, 1e6, 1280.0);
  const double height = ClampOr(camera.viewport_height_px, 1.0, 1e6, 720.0);
  const double near_m = ClampOr(camera.near_m, 1e-4, 1e6, 0.05);
  const double far_m = ClampOr(camera.far_m, near_m * 1.001, 1e9, 1e9);
  const double tan_y = exact::Tan(0.5 * fov);
  const double tan_x = tan_y * width / height;

  View view{};
  Store(view.eye, eye);
  Store(view.forward, forward);
  // A side plane holds the eye and a frustum edge: its normal leans from the side axis to forward.
  const double scale_x = 1.0 / std::sqrt(1.0 + tan_x * tan_x);
  const double scale_y = 1.0 / std::sqrt(1.0 + tan_y * tan_y);
  StorePlane(view.planes[0], (right + forward * tan_x) * scale_x, eye);
  StorePlane(view.planes[1], (forward * tan_x - right) * scale_x, eye);
  StorePlane(view.planes[2], (up + forward * tan_y) * scale_y, eye);
  StorePlane(view.planes[3], (forward * tan_y - up) * scale_y, eye);
  StorePlane(view.planes[4], forward, eye + forward * near_m);
  StorePlane(view.planes[5], forward * -1.0, eye + forward * far_m);
  view.pixels_per_unit_at_1m = float(height / (2.0 * tan_y));
  view.near_m = float(near_m);
  return view;
}

}  // namespace pelt
