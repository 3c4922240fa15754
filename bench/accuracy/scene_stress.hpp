// What whole scenes survive: hitches, characters of any size and size that changes, places far from
// the world's origin, obstacles that go through the fur.
//
// Every row runs the scene `tiny` with the modal solver beside the same scene as it should have
// been (the hitch stepped through at 60 Hz, the character at home, or grown from the start), lets
// both come to rest, and says how far apart they were.
//
// Invariant: rows are deterministic; bounds are checked, not fitted (BrokenPromises).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/isa.hpp"

namespace pelt::accuracy {

struct SceneStressResult {
  std::string name;
  uint64_t strands = 0;
  uint64_t non_finite = 0;     // values of points, over all frames
  double worst_stretch = 0.0;  // of a link over its length, less 1
  uint64_t unsettled = 0;  // strands that move by over 1e-4 of their length per frame at the end
  // From the scene as it should have been, RMS over all points of the half second from the
  // disturbance on, shares of the strands' lengths; of strands that lie on their groom likewise.
  std::optional<double> apart, rigid_apart;
  // When both have come to rest, what 99 % of the points are within: some strands stand on edges, and
  // fall either way.
  std::optional<double> apart_at_end;
  // What is promised; none: shown for comparison.
  std::optional<double> most_apart, most_at_end;
  bool promised = true;
  friend bool operator==(const SceneStressResult&, const SceneStressResult&) = default;
};

// Empty: nothing is.
std::vector<std::string> BrokenPromises(const SceneStressResult& result);
inline constexpr double kMostSceneStretch = 1e-4;  // points are floats a metre from their origin
// Of a scene's strands, five seconds after it came to rest: a few of its longest swing on, of tiny as
// it is 3.
inline constexpr double kMostUnsettled = 0.03;

std::vector<SceneStressResult> RunSceneStress(Isa isa);

}  // namespace pelt::accuracy
