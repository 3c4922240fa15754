// One strand driven by a recorded root: by a solver, as a game would run it, or exactly.
//
// A solver sees each sample when its time has come and nothing between them; frames may differ in
// length. The exact motion is that of the rod, or of the chain where the strand is one, under the spline of
// recorded_root.hpp. Both begin at rest on a body at rest.
#pragma once

#include <string>
#include <vector>

#include "bench/accuracy/named_solver.hpp"
#include "bench/accuracy/recorded_root.hpp"
#include "bench/accuracy/strand_file.hpp"

namespace pelt::accuracy {

struct PointTrack {
  int links = 0;
  std::vector<double> seconds;
  std::vector<Double3> root;    // [frame], world, m
  std::vector<Double3> offset;  // [frame * links + point], from the root, m
};

// A rod as a layer has it, a chain as it is. Empty (links 0) where the solver does not run such a strand.
PointTrack RunSolver(const StrandFile& strand, const std::vector<RootSample>& samples,
                     const NamedSolver& solver, Isa isa);
PointTrack RunExact(const StrandFile& strand, const std::vector<RootSample>& samples);

// A row a frame, the first being the start: time,x0,y0,z0,x1,... in the world; point 0 is the root.
std::string PointsText(const PointTrack& track);

// How far a track is from the exact one.
struct TrackError {
  double share;  // of the secondary motion: RMS(x - exact) / RMS(exact - rigid); NaN: there is none
  double worst;  // m
};
TrackError CompareTracks(const std::vector<RootSample>& samples, const PointTrack& track,
                         const PointTrack& exact);

// Files to try all this with: a strand, and a head that is shaken and turned with a gust of wind in
// between, frames between 1/75 and 1/50 s long.
std::string ExampleStrand();
std::vector<RootSample> ExampleRoots();

}  // namespace pelt::accuracy
