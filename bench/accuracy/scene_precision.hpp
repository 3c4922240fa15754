// Whole frames of a scene, run in every way there is to pay less for them, from no simulation at
// all to the best quality: what each costs and how wrong it is.
//
// The measure is the scene itself, modal solver at its best, with more frames per second and so the
// exact pose in between; the same with half as many shows what that reference is good to
// (self_error). An error is a share of the secondary motion, over all strands, free points and
// frames after the warm-up (the first frames start from the groom): RMS(x - reference) /
// RMS(reference - rigid), rigid being the scene with simulation switched off, whose error is
// therefore 1. The reference knows where roots are between the frames and the ways do not: their
// error holds the input error (work_precision.hpp) as a game has it.
//
// Nor does that reference know a rod: scene_rod.hpp has how far each way is off the rods that strands stand for
// (rod_error).
//
// Strands that follow chains at mesh vertices are wrong by more than their chains are: a second
// reference, the same with a chain for each strand, says by how much (own_error).
//
// All ways, the rigid run and the references go through the frames in lockstep, in one thread, so
// that what a busy machine does to one it does to all, and no run has to be stored. Of each frame
// the fastest round counts.
//
// Invariant: errors depend on nothing but the arithmetic, which is the same on every instruction
// set. The scene is dry (its wetting counts frames, not seconds) and nothing is culled.
//
// After the frames that are compared nothing moves. Ways that sleep go on through still frames,
// which count in their time: what they save is a matter of how many there are. That they do the
// same as the way that does not sleep is shown by the digests of all points of all frames.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "bench/accuracy/scene_points.hpp"
#include "bench/accuracy/scene_rod.hpp"
#include "bench/accuracy/scene_way.hpp"

namespace pelt::accuracy {

// How far the tips of a scene's strands are off the reference, compared with the bound that their quality states
// (ErrorShare, core/modal/quality_on_screen.hpp).
//
// Both are shares of the layer's longest strand, as the bound is a length before it is in pixels: no tip is nearer to
// the eye than its layer's box, so what holds in shares holds on the screen.
//
// Only of layers whose setup has the modal solver: no setup runs PBD's or Verlet's parameters in another solver.

struct TipRow {
  std::string way;  // SceneWay::name
  uint32_t layer = 0, character = 0;
  std::string name;  // of the layer
  uint64_t tips = 0, within = 0;
  double p99 = 0.0;  // to 3 %, from above
};

class TipErrors {
 public:
  // `scene`: with the layers' own solvers.
  TipErrors(const Scenario& scene, std::span<const SceneWay> ways);

  // After a frame of way `w`.
  void Add(size_t w, const FurScene& scene, const ScenePointsLayout& layout,
           const ScenePoints& points, const ScenePoints& reference);

  std::vector<TipRow> Layers() const;  // by way, then by layer
  std::vector<TipRow> Ways() const;    // all layers together

 private:
  // Counts by the top bits of the share: 32 bins to each doubling.
  struct Counts {
    std::vector<uint32_t> bins;
    uint64_t within = 0;
    void Add(double share, double bound);
    void Add(const Counts& other);
  };
  struct Layer {
    std::string name;
    uint32_t character;
    bool modal;
  };
  TipRow RowOf(size_t w, const Counts& counts) const;

  std::vector<Layer> layers_;
  std::vector<std::string> ways_;            // empty: not one quality's
  std::vector<std::vector<Counts>> counts_;  // [way][layer]
};

struct ScenePrecisionOptions {
  uint32_t frames = 0;          // even; 0: by `quick`
  double warm_up_share = 0.5;   // of the frames: not counted
  uint32_t still_frames = 480;  // after them, for ways that sleep
  uint32_t reference_rate = 8;  // frames of the reference for one; a power of two from 2 on
  int rounds = 3;               // of the timing
  Isa isa = BestIsa();
  bool contact = true;  // else no surface, ground or spheres
  bool quick = false;
  bool planned = false;  // also with solvers and qualities as the scene's layers have them
  std::function<void(size_t done, size_t total)> progress;
};

struct ScenePrecisionRow {
  SceneWay way;
  double simulate_ns = 0.0;  // per strand of the scene and frame, in wind and simulation stages
  double frame_ns = 0.0;     // the same of the whole frame
  double of_pbd = 0.0, frame_of_pbd = 0.0;  // over the same of PBD in every frame
  double error = 0.0;                       // share of the secondary motion
  double off_m = 0.0;                       // RMS distance to the reference
  // As `error`, against a chain for each strand; the same where the scene has no others.
  double own_error = 0.0;
  std::optional<double> rod_error =
      {};                      // of the rods' (scene_rod.hpp); none: no rod, or not compared
  double live_share = 1.0;     // of the strands
  double simulate_runs = 0.0;  // of those stages on a chunk, per frame
  uint64_t points_digest = 0;  // of all points of all frames
};

// ScenePrecisionRow::simulate_ns or ::frame_ns.
using SceneTime = double ScenePrecisionRow::*;

struct ScenePrecision {
  ScenePrecisionOptions options;  // as used
  std::string scene;              // its name
  uint64_t strands = 0;
  uint32_t layers = 0, warm_up = 0;
  double frames_per_second = 0.0;
  double self_error = 0.0;   // of the reference: its distance to one of half its rate
  double secondary_m = 0.0;  // RMS of reference - rigid
  bool has_vertex_chains = false;
  double chain_error = 0.0;              // of the reference itself, against a chain for each strand
  SceneRodErrors rods;                   // its notes are below
  std::vector<TipRow> tips, layer_tips;  // of all layers together; of each
  std::vector<ScenePrecisionRow> rows;   // cheapest first
  std::vector<std::string> notes;  // ways that the scene has no layer for; layers without rods
  uint64_t error_digest = 0;

  // Nothing as cheap, by that time, is more exact. Only among ways to choose from.
  bool IsParetoOptimal(const ScenePrecisionRow& row, SceneTime time) const;
  const ScenePrecisionRow* Find(std::string_view way) const;
};

// Throws Error for a scene without strands.
ScenePrecision MeasureScenePrecision(const Scenario& scene, const ScenePrecisionOptions& options);

}  // namespace pelt::accuracy
