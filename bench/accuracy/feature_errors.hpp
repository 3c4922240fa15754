// What the modal solver's features cost and how wrong they are: contact with the surface plane, a
// sphere that stands or moves, and the ground, bounce, a limit to the motion, clumps, strength, wind.
//
// One measure is the kernel itself, best quality, with sixteen times the frames and the exact pose
// at each; the same again with half as many frames shows what that reference is good to
// (self_error). It knows all features, but its contact is the kernel's own. So where strands touch
// spheres, capsules and the ground there is another, which shares nothing with the kernel
// (ContactReference). As with free strands, an error is a share of the secondary motion:
// RMS(x - reference) / RMS(reference - rigid). What overlaps from the start has no motion that is
// right: there the row says how fast strands are.
//
// Invariant: a feature that is switched on but never acts leaves every bit of the motion as it was
// (RunDigest); one that is off costs nothing, because it is then the same run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/accuracy/modal_solver.hpp"
#include "bench/accuracy/solver_timing.hpp"

namespace pelt::accuracy {

// What is promised where no motion is the right one.
enum class Promise : uint8_t { kNone, kLeavesSlowly, kComesToRest };

// A feature on strands that feel it.
struct FeatureProblem {
  std::string name;
  ChainMaterial material;
  std::vector<Strand> strands;
  Motion motion;
  ModalFeatures features;
  double seconds = 0.0;  // that it lasts at most; 0: any
  Promise promise = Promise::kNone;
  // Steps of the reference of contact for each of the others': what is fast moves that much further in one.
  int contact_scale = 1;
};
// Bare (no feature) and one for each feature. links: 3 or 4.
std::vector<FeatureProblem> FeatureProblems(int links);
// Whether its contact has a reference of its own.
bool HasContactReference(const FeatureProblem& problem);
// How far the best quality with `scale` times the frames is from that.
double ContactError(const ModalKernels& kernels, const FeatureProblem& problem, int scale,
                    int steps_per_second, double seconds);
// How far that reference is from one with twice the steps.
double ContactSelfError(const FeatureProblem& problem, int steps_per_second, double seconds);

struct FeatureError {
  std::string name;
  ModalQuality quality;
  double error;        // at 60 Hz, share of the secondary motion
  double penetration;  // deepest point inside what it may not enter, over the strand's length
  double nanoseconds;  // per strand and frame, more than the same motion without the feature
  double self_error;   // of the reference: its distance to one with half the frames
  // Against the reference of contact, and that against one with half the steps.
  std::optional<double> contact_error, contact_self_error;
  std::optional<double> fastest;  // point: of all, or of those that should be at rest, m/s
};

struct FeatureOptions {
  int links = 3;
  double seconds = 4.0;
  int reference_scale = 16;  // frames of the reference over those at 60 Hz
  int contact_rate = 48000;  // steps a second of the reference of contact
  TimingOptions timing{.strands = 2048, .frames = 30, .repeats = 5};  // 0 frames: not timed
};
std::vector<FeatureError> MeasureFeatures(const ModalKernels& kernels,
                                          const FeatureOptions& options = {});

// A hash of every point of every frame at 60 Hz.
uint64_t RunDigest(const ModalKernels& kernels, ModalQuality quality, const FeatureProblem& problem,
                   double seconds);

}  // namespace pelt::accuracy
