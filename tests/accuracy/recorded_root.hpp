// A recorded root as a motion of the yardstick: one pose per frame, as a table that any tool can write.
//
//     time,x,y,z,qx,qy,qz,qw
//     0,0,0,0,0,0,0,1
//     0.016667,0.001,0,0,0,0.0087,0,0.99996
//
// time: s, rising, frames need not be equally long; x y z: where the body's origin is, m; q: its rotation, a unit
// quaternion.
//
// Between samples the pose is unknown. It is taken as cubic splines with continuous acceleration: of the position, and
// of the quaternion's parts, signs made to agree and the result normalised. They begin at rest, as the body stood still
// before, and end without acceleration.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <istream>
#include <sstream>
#include <string>
#include <vector>

#include "bench/accuracy/body_angles.hpp"
#include "bench/accuracy/body_motion.hpp"
#include "core/error.hpp"

namespace pelt::accuracy {

using RootParts = std::array<double, 7>;  // x y z qx qy qz qw

struct RecordedRoot {
  std::vector<double> seconds;
  std::vector<RootParts> parts;
};

// Throws Error with the line and the reason.
inline RecordedRoot ReadRecordedRoot(std::istream& in) {
  constexpr const char* kHeader = "time,x,y,z,qx,qy,qz,qw";
  RecordedRoot root;
  int number = 1;
  std::string line;
  const auto refuse_unless = [&](bool good, const char* why) {
    if (!good) throw Error(fmt::format("line {}: {}", number, why));
  };
  refuse_unless(std::getline(in, line) && line == kHeader, "expected time,x,y,z,qx,qy,qz,qw");
  while (std::getline(in, line)) {
    ++number;
    std::istringstream cells(line);
    double time = 0.0;
    RootParts p{};
    cells >> time;
    for (double& part : p) {
      char comma = 0;
      cells >> comma >> part;
      refuse_unless(comma == ',', "expected 8 numbers");
    }
    refuse_unless(!cells.fail() && (cells >> std::ws).eof(), "expected 8 numbers");
    refuse_unless(root.seconds.empty() ? time == 0.0 : time > root.seconds.back(),
                  "times begin at 0 and rise");
    const double length = std::hypot(std::hypot(p[3], p[4]), std::hypot(p[5], p[6]));
    refuse_unless(std::abs(length - 1.0) < 1e-3, "the quaternion's length is not 1");
    // q and -q are one rotation: the nearer one.
    double along = 0.0;
    for (size_t k = 3; k < 7 && !root.parts.empty(); ++k) along += p[k] * root.parts.back()[k];
    for (size_t k = 3; k < 7; ++k) p[k] /= along < 0.0 ? -length : length;
    root.seconds.push_back(time);
    root.parts.push_back(p);
  }
  refuse_unless(root.seconds.size() >= 2, "expected two poses at least");
  return root;
}

// The columns of the rotation of a quaternion of any length.
inline void TurnBy(const Jet (&q)[4], BodyPose& pose) {
  const Jet &x = q[0], &y = q[1], &z = q[2], &w = q[3];
  const Jet square = x * x + y * y + z * z + w * w;
  const double f = 1.0 / square.value;
  const Jet one = 1.0, two = Jet(2.0) * Chain(square, f, -f * f, 2.0 * f * f * f);
  const Jet column[3][3] = {
      {one - two * (y * y + z * z), two * (x * y + w * z), two * (x * z - w * y)},
      {two * (x * y - w * z), one - two * (x * x + z * z), two * (y * z + w * x)},
      {two * (x * z + w * y), two * (y * z - w * x), one - two * (x * x + y * y)}};
  for (int k = 0; k < 3; ++k) {
    pose.axis[k] = {column[k][0].value, column[k][1].value, column[k][2].value};
    pose.axis_rate[k] = {column[k][0].rate, column[k][1].rate, column[k][2].rate};
    pose.axis_bend[k] = {column[k][0].bend, column[k][1].bend, column[k][2].bend};
  }
}

// Second derivatives of the parts at the samples: a tridiagonal system.
inline std::vector<RootParts> FindBends(const RecordedRoot& root) {
  const size_t count = root.seconds.size();
  std::vector<RootParts> bend(count, RootParts{});
  std::vector<double> upper(count, 0.0);
  const auto dt = [&](size_t frame) { return root.seconds[frame] - root.seconds[frame - 1]; };
  const auto slope = [&](size_t frame, size_t k) {
    return (root.parts[frame][k] - root.parts[frame - 1][k]) / dt(frame);
  };
  upper[0] = 0.5;
  for (size_t k = 0; k < 7; ++k) bend[0][k] = 3.0 * slope(1, k) / dt(1);
  for (size_t i = 1; i + 1 < count; ++i) {
    const double left = dt(i), right = dt(i + 1);
    const double pivot = 2.0 * (left + right) - left * upper[i - 1];
    upper[i] = right / pivot;
    for (size_t k = 0; k < 7; ++k)
      bend[i][k] = (6.0 * (slope(i + 1, k) - slope(i, k)) - left * bend[i - 1][k]) / pivot;
  }
  for (size_t i = count - 1; i-- > 0;)
    for (size_t k = 0; k < 7; ++k) bend[i][k] -= upper[i] * bend[i + 1][k];
  return bend;
}

// Before the first sample and after the last one the body stands still.
inline BodyMotion MotionOf(const RecordedRoot& root) {
  return [root, bends = FindBends(root)](double seconds) {
    const auto after = std::upper_bound(root.seconds.begin(), root.seconds.end(), seconds);
    const size_t frame =
        std::clamp<size_t>(size_t(after - root.seconds.begin()), 1, root.seconds.size() - 1);
    const double h = root.seconds[frame] - root.seconds[frame - 1];
    const double b = std::clamp((seconds - root.seconds[frame - 1]) / h, 0.0, 1.0), a = 1.0 - b;
    const bool moves = seconds >= 0.0 && seconds <= root.seconds.back();
    Jet part[7];
    for (size_t k = 0; k < 7; ++k) {
      const double from = root.parts[frame - 1][k], to = root.parts[frame][k];
      const double m = bends[frame - 1][k], n = bends[frame][k];
      part[k] = a * from + b * to + ((a * a * a - a) * m + (b * b * b - b) * n) * h * h / 6.0;
      if (!moves) continue;
      part[k].rate =
          (to - from) / h + ((1.0 - 3.0 * a * a) * m + (3.0 * b * b - 1.0) * n) * h / 6.0;
      part[k].bend = a * m + b * n;
    }
    BodyPose pose{};
    pose.position = {part[0].value, part[1].value, part[2].value};
    pose.velocity = {part[0].rate, part[1].rate, part[2].rate};
    pose.acceleration = {part[0].bend, part[1].bend, part[2].bend};
    const Jet q[4] = {part[3], part[4], part[5], part[6]};
    TurnBy(q, pose);
    return pose;
  };
}

}  // namespace pelt::accuracy
