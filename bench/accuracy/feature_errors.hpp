// What the modal solver's features cost and how wrong they are: contact with the surface plane, a
// sphere that stands or moves, and the ground, bounce, a limit to the motion, clumps, strength, wind.
//
// No exact motion is known once a strand touches something, so the measure is the kernel itself,
// best quality, with sixteen times the frames and the exact pose at each; the same again with half
// as many frames tells what that reference is good to (self_error). As with free strands, an error
// is a share of the secondary motion: RMS(x - reference) / RMS(reference - rigid).
//
// Invariant: a feature that is switched on but never acts leaves every bit of the motion as it was
// (RunDigest); one that is off costs nothing, because it is then the same run.
#pragma once

#include <string>
#include <vector>

#include "bench/accuracy/modal_solver.hpp"
#include "bench/accuracy/solver_timing.hpp"

namespace pelt::accuracy {

// A feature on strands that feel it.
struct FeatureProblem {
  std::string name;
  ChainMaterial material;
  std::vector<Strand> strands;
  Motion motion;
  ModalFeatures features;
};
// Bare (no feature), surface, sphere, moving sphere, ground, bounce, limit, clump, strength, wind. links: 3 or 4.
std::vector<FeatureProblem> FeatureProblems(int links);

struct FeatureError {
  std::string name;
  ModalQuality quality;
  double error;        // at 60 Hz, share of the secondary motion
  double penetration;  // deepest point inside what it may not enter, over the strand's length
  double nanoseconds;  // a strand and frame, more than the same motion without the feature
  double self_error;   // of the reference: its distance to one with half the frames
};

struct FeatureOptions {
  int links = 3;
  double seconds = 4.0;
  int reference_scale = 16;  // frames of the reference over those at 60 Hz
  TimingOptions timing{.strands = 2048, .frames = 30, .repeats = 5};  // 0 frames: not timed
};
std::vector<FeatureError> MeasureFeatures(const ModalKernels& kernels,
                                          const FeatureOptions& options = {});

// A hash of every point of every frame at 60 Hz.
uint64_t RunDigest(const ModalKernels& kernels, ModalQuality quality, const FeatureProblem& problem,
                   double seconds);

}  // namespace pelt::accuracy
