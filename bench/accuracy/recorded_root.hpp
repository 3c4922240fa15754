// A recorded root: one pose a frame, as a table that any tool can write.
//
//     time,x,y,z,qx,qy,qz,qw,wind_x,wind_y,wind_z
//     0,0,0,0,0,0,0,1,0,0,0
//     0.016667,0.001,0,0,0,0.0087,0,0.99996,0,0,0
//
// time: s, rising, frames need not be equally long; x y z: where the body's origin is, m; q: its
// rotation as a unit quaternion; wind: m/s, all three columns or none; velocity_x velocity_y
// velocity_z spin_x spin_y spin_z: how fast the origin moves, m/s, and the body turns, rad/s, world,
// all six or none. Columns stand in any order.
//
// Between the samples nobody knows the pose. A solver gets the samples alone, as in a game; the
// exact motion needs one for all times, and takes cubic splines with continuous acceleration
// through all samples: of the position, and of the quaternion's parts (signs made to agree, the
// result normalised). Before the first sample the body stood still, so both splines begin at rest;
// they end with no acceleration. With velocities they are the cubics that have those instead, and a
// solver that takes velocities gets them. Wind is linear between samples, as the solvers take it.
//
// Invariant: a RecordedRoot holds at least two samples with rising times, finite values and unit
// quaternions; whatever breaks that is an Error with file, line and reason.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "bench/accuracy/body_motion.hpp"

namespace pelt::accuracy {

struct RootSample {
  double seconds;
  Double3 position;                  // m
  std::array<double, 4> quaternion;  // x, y, z, w; unit
  Double3 wind;                      // m/s
  bool rated = false;                // the next two are known
  Double3 velocity = kZero3;         // of the origin, m/s
  Double3 spin = kZero3;             // rad/s, world
};

inline constexpr double kMostFrameSeconds = 1.0, kLeastFrameSeconds = 1e-5;
inline constexpr size_t kMostSamples = 1'000'000;

// `path` is for messages.
std::vector<RootSample> ParseRoots(std::string_view text, const std::string& path);
std::vector<RootSample> ReadRootsFile(const std::string& path);
// The table of samples, readable by ParseRoots.
std::string RootsText(const std::vector<RootSample>& samples);

// A pose of a motion as a sample; `rated`: with its velocities.
RootSample SampleOf(const BodyPose& pose, double seconds, bool rated = false);
// The pose at a sample; its velocities are the sample's, its accelerations 0 (solvers do not look at
// them).
BodyPose PoseOf(const RootSample& sample);

// The pose at all times between the samples, as above; before and after, the nearest sample's.
class RootSpline {
 public:
  explicit RootSpline(std::vector<RootSample> samples);
  BodyPose At(double seconds) const { return At(seconds, Frame(seconds)); }
  // Of the frame that ends at sample `frame`: which of two pieces holds at their common end.
  BodyPose At(double seconds, size_t frame) const;

 private:
  size_t Frame(double seconds) const;

  // Position and quaternion: values and second derivatives, or first ones, at each sample.
  using Row = std::array<double, 7>;
  void FindBends();
  std::vector<RootSample> samples_;
  std::vector<Row> value_, bend_, rate_;
};

}  // namespace pelt::accuracy
