// A clamped elastic rod among walls, at rest and in motion: what strands that touch things are measured from.
//
// The rod is n links d_i, |d_i| = 1, by the midpoint rule: each joint bends as the rod does between the middles
// of its two links (the clamp: half a link). It rests where
//
//     E = 1/2 (d - r) . K (d - r) - b . d
//
// is least while no joint and no middle of a link is beyond a wall: Newton's method on unit vectors, the
// walls' pushes by the method of multipliers. To find its rest it is lowered, its load from nothing to
// all of it in stages, not dropped: it stays on the side of a wall that it came from.
//
// In motion it goes by implicit Euler, where a step's end is the same minimum with the mass over the step's square
// beside K. Walls are hard and give nothing back: what meets one loses its speed along the normal.
//
// Invariant: of second order in 1/n at rest, of first in the step in motion: twice the links, half the step change
// less than what is measured (tests/accuracy/rod_contact_test.cpp). Nothing of this is shared with core or
// with contact_reference.hpp.
//
// Units: length of the rod 1, mass 1, bending stiffness 1; so a weight is Gamma of elastica.hpp, and the first
// frequency kRodFrequency1.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "bench/accuracy/curve_motion.hpp"

namespace pelt::accuracy {

// How a place stands to a wall: below a gap of 0 it is beyond it.
struct WallGap {
  double gap;
  Double3 normal;  // of the gap's slope; unit
  double bend;     // the gap's second derivative across the normal
};
// Of the place x of the rod that is s from the root.
using RodWall = std::function<WallGap(double s, Double3 x)>;
RodWall OutsideBall(Double3 centre, double radius);
// normal . x + offset >= 0; normal: unit.
RodWall AbovePlane(Double3 normal, double offset);
// Within `share` times s of where the rest curve, whose root is 0, has that place.
RodWall NearRest(const RestCurve& rest, double share);

struct RodAmongWalls {
  RestCurve rest;  // root is not used: 0
  Double3 load;    // on the whole rod: its weight, wind's push
  std::vector<RodWall> walls = {};
  // What a wall pushes with, times this, acts along it: friction of a rod about to slip. Only 0 across.
  Double3 rub = kZero3;
};

struct RodShape {
  std::vector<Double3> point;  // of n joints after the root; the last is the tip
  double pushed = 0.0;         // sum of what the walls push with
  double deepest = 0.0;        // of places beyond a wall
  bool rests = false;          // forces balance

  // s in [0, 1]; between joints along their link.
  Double3 At(double s) const;
};

// links: at most a hundred or so; the time grows with their cube.
RodShape FindRest(const RodAmongWalls& rod, int links);

struct RodDamping {
  double drag;     // c: of the mass
  double bending;  // beta: of the stiffness
};

class RodMotion {
 public:
  // Begins at rest without walls, on a clamp that stands.
  RodMotion(const RodAmongWalls& rod, const RodDamping& damping, int links, double step);
  ~RodMotion();
  // One step; `walls` are as they stand at its end. As many, in the same order, in every step.
  void Step(const std::vector<RodWall>& walls);
  RodShape Shape() const;

 private:
  class Body;
  std::unique_ptr<Body> body_;
};

}  // namespace pelt::accuracy
