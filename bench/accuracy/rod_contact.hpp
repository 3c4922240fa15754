// How far strands of the modal solver rest from a rod that touches the same thing: a ball that they lie over,
// ground with friction, a limit to their motion, wind.
//
// Strands are clamped level and hang, some with a curl to the side, begin as the rod rests, or are dropped from their
// groom, and come to their own rest at 60 frames a second. An error is the RMS distance of the drawn points from the same
// places of the rod (rod_reference.hpp) over the length. Only cases count in which the rod itself is held by
// what it touches, by kLeastHeld of its weight.
//
// Where friction holds a strand there is not one shape of rest. Then an error is the distance from the nearest of the
// shapes from a rod about to slip inwards to one about to slip outwards, all its contacts held alike.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/accuracy/modal_solver.hpp"
#include "bench/accuracy/rod_reference.hpp"
#include "core/isa.hpp"
#include "core/modal/modal_quality.hpp"

namespace pelt::accuracy {

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

}  // namespace pelt::accuracy
