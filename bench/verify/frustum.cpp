// What a camera sees, without the formulas of culling.
#include <cmath>

#include "bench/verify/checks.hpp"

namespace pelt {
namespace {

constexpr double kMargin = 1.0e-4;  // of the distance

void CrossInto(const double (&a)[3], const double (&b)[3], double (&out)[3]) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    out[i] = a[j] * b[k] - a[k] * b[j];
  }
}
double DotOf(const double (&a)[3], const double (&b)[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
void MakeUnit(double (&a)[3]) {
  const double length = std::hypot(a[0], a[1], a[2]);
  for (double& x : a) x /= length;
}

}  // namespace

ViewTest::ViewTest(const Camera& camera)
    : half_height_(std::tan(0.5 * double(camera.vertical_fov_rad))),
      near_m_(camera.near_m),
      far_m_(camera.far_m) {
  half_width_ = half_height_ * double(camera.viewport_width_px) / camera.viewport_height_px;
  double upright[3];
  for (int i = 0; i < 3; ++i) {
    eye_[i] = camera.eye[i];
    forward_[i] = double(camera.target[i]) - camera.eye[i];
    upright[i] = camera.up[i];
  }
  MakeUnit(forward_);
  CrossInto(forward_, upright, right_);
  MakeUnit(right_);
  CrossInto(right_, forward_, up_);
}

bool ViewTest::IsClearlyInside(const float (&point)[3]) const {
  double from_eye[3];
  for (int i = 0; i < 3; ++i) from_eye[i] = double(point[i]) - eye_[i];
  const double ahead = DotOf(from_eye, forward_);
  if (ahead * (1.0 - kMargin) <= near_m_ || ahead * (1.0 + kMargin) >= far_m_) return false;
  const double room = ahead * (1.0 - kMargin);
  return std::abs(DotOf(from_eye, right_)) < room * half_width_ - kMargin * ahead &&
         std::abs(DotOf(from_eye, up_)) < room * half_height_ - kMargin * ahead;
}

}  // namespace pelt
