// Problems that tuned nothing: motions and strands drawn from a seed.
//
// A motion is a gait that sets in and stops (waves in every axis, the vertical ones at twice the
// stride's rate), to which are added, each in about every second motion, a shake of the head, a dash
// and stop, a turn, and a hop. All of it is smooth, and about as wild as the walk, headshake and
// dash of body_motion.hpp are: 1.2 to 2.2 Hz, up to 4 cm and 0.7 rad of swing, 0.4 to 1.6 m/s reached
// in 0.1 to 0.3 s, turns of up to 120 degrees, hops of up to 20 cm.
//
// A strand stands anywhere 5 to 15 cm from the middle of the body, leaning up to 70 degrees from
// straight out, with 7 to 22 degrees of curl a joint, or as much in all as 4 links where there are
// more. Strands of one motion share a length, 0.7 to 1.4 of the preset's.
//
// Invariant: what is drawn depends on the seed and the place in the list alone, so that a longer
// list begins with the shorter one. The seed is renewed with a release, and no constant of a solver
// may be chosen on it: an error on these problems is then what a user's own problems will see.
#pragma once

#include "bench/accuracy/chain_problem.hpp"
#include "core/random.hpp"

namespace pelt::accuracy {

inline constexpr uint64_t kDrawnSeed = 20261123;  // of this release

struct DrawnOptions {
  uint64_t seed = kDrawnSeed;
  int motions = 12;
};

BodyMotion DrawMotion(uint64_t seed, int index);  // kMotionSeconds long; still at its begin
std::vector<Strand> DrawStrands(int links, int count, uint64_t seed, int motion);
double DrawLengthScale(uint64_t seed, int motion);

// Evenly over the sphere; across a unit vector, evenly about it.
Double3 DrawDirection(Random& random);
Double3 DrawAcross(Random& random, Double3 up);

}  // namespace pelt::accuracy
