// How far strands of the modal solver are off a rod that touches the same thing: at rest on a ball that they lie
// over, on ground with friction, in a limit to their motion or in wind; and struck by a ball.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/accuracy/curve_motion.hpp"
#include "bench/accuracy/modal_solver.hpp"
#include "core/isa.hpp"
#include "core/modal/modal_quality.hpp"

namespace pelt::accuracy {

// ---- The rod ---------------------------------------------------------------------------------

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
// with ContactReference.
//
// Units: length of the rod 1, mass 1, bending stiffness 1; so a weight is Gamma of SolveElastica, and the first
// frequency kRodFrequency[0].

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

// ---- At rest ---------------------------------------------------------------------------------

// Strands are clamped level and hang, some with a curl to the side, begin as the rod rests, or are dropped from their
// groom, and come to their own rest at 60 frames a second. An error is the RMS distance of the drawn points from the
// same places of the rod over the length. Only cases count in which the rod itself is held by what it touches, by
// kLeastHeld of its weight.
//
// Where friction holds a strand there is not one shape of rest. Then an error is the distance from the nearest of the
// shapes from a rod about to slip inwards to one about to slip outwards, all its contacts held alike.

inline constexpr double kLeastHeld = 0.05;

struct RestCase {
  Preset preset;
  RodAmongWalls rod;  // its load is a weight's; with walls
  Double3 root;       // lengths
};

// What acts on all of its cases.
struct RestScene {
  std::string name;
  std::vector<RestCase> cases;
  std::function<ModalFeatures(double length)> features;  // of a strand so long, m
  double friction = 0.0;                                 // along x
  Double3 wind = kZero3;                                 // m/s
};

// Balls of .15, .30 and .60 of the length, .03 below the root at .35, .55 and .75 of it.
std::vector<RestScene> BallScenes();
// Ground .3 of the length below the root, friction .4; at most .2 of their distance along the strand from the
// groom; wind across of which the push is as large as the weight.
std::vector<RestScene> OtherRestScenes();

struct RestModel {
  std::string name;
  int parts;   // of its layer's strands
  bool nodes;  // not links
};
std::vector<RestModel> RestModels();

struct RestErrorRow {
  std::string scene, model;
  ModalQuality quality;
  std::vector<double> errors;  // share of the length, of the cases that count
  double speed;                // of its fastest drawn point in the end, lengths/s
};
struct RestErrorTable {
  std::vector<RestErrorRow> rows;  // scene after scene, model after model
  // Of each scene's cases: how far a rod of half the links is from the rod, at thirds; its weight for its stiffness.
  std::vector<std::vector<double>> self_errors;
  std::vector<std::vector<double>> gammas;
};

struct RestErrorOptions {
  std::vector<RestModel> models = RestModels();
  int links = 48;
  double seconds = 8.0;
  bool dropped = false;  // they begin along their rest curves and fall on what is below
};
// Throws Error where a rod finds no rest.
RestErrorTable MeasureRest(const std::vector<RestScene>& scenes, Isa isa,
                           const RestErrorOptions& options = {});

// ---- Struck ----------------------------------------------------------------------------------

// How far strands go other ways than a rod that the same ball strikes.
//
// A strand is clamped level and hangs at rest. A ball of kStrikeRadius comes across, its middle half its radius
// below the place it hits, lifts the strand and goes on; the strand slides off it and swings. An error
// is the RMS distance of the tip from the rod's over the RMS of how far that one has gone from
// where it hung, 60 times a second.

inline constexpr double kStrikeRadius = 0.3;  // lengths

struct StrikeCase {
  Preset preset;
  double at;     // where it hits, 0 to 1 along the strand at rest
  double speed;  // of the ball, m/s
};
// Dangly, soft and medium strands, at .5 and .8, at 0.5 and 1.5 m/s.
std::vector<StrikeCase> StrikeCases();

struct StrikeErrorRow {
  std::string model;
  ModalQuality quality;
  int rate;                    // frames a second
  std::vector<double> errors;  // share of the way, case after case
};
struct StrikeErrorTable {
  std::vector<StrikeErrorRow> rows;  // model after model, quality after quality
  // Of each case: how far the rod is from one of steps twice as long, and from one of three quarters of the links.
  std::vector<double> step_errors, link_errors;
};

struct StrikeOptions {
  std::vector<RestModel> models = RestModels();
  std::vector<int> rates = {60};  // frames a second, multiples of 60
  int links = 20;
  int steps_per_second = 15360;  // of the rod, a multiple of 120
  double seconds = 0.5;
  bool self_errors = true;
};
StrikeErrorTable MeasureStrikes(const std::vector<StrikeCase>& cases, Isa isa,
                                const StrikeOptions& options = {});

}  // namespace pelt::accuracy
