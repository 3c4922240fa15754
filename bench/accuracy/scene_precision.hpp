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
// Nor does that reference know a rod: SceneRods has how far each way is off the rods that strands stand for
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
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/accuracy/curve_motion.hpp"
#include "bench/accuracy/scene_points.hpp"
#include "bench/accuracy/scene_way.hpp"

namespace pelt::accuracy {

// ---- Strands off their rods ------------------------------------------------------------------

// How far the strands of a scene are off the rods that they stand for (CurveStrand), each clamped in its own
// root: what no frame rate of the scene's own solver can show.
//
// Roots of a sample of strands are recorded from the reference's run; each one's rod has its layer's material, the
// strand's length and a smooth rest curve through its groomed points, starts on the groom when the strand does, and is
// moved exactly (curve_motion.hpp) in steps of the recording's frames. Every second of them is a measure of what steps
// are good to (self_error), and shows which rods are chaotic: nothing can follow those, and they are left out.
//
// A rod touches nothing, is in no wind and in no clump. So the ways to run the scene go through its frames once more
// without those, every strand at full strength. The error is a share of the rod's secondary motion, over
// the sample's free points in the frames that count, each layer with the weight of its strands:
//
//     error = RMS((x - rigid) - (rod - rigid)) / RMS(rod - rigid)
//
// Ways know roots at their frames only, so this holds the input error too; and, of strands that follow
// chains at mesh vertices, that they do.
//
// Invariant: as ScenePrecision's errors, nothing but arithmetic.

// Layers of one name, in the solver and quality that their setup has.
struct RodLayerRow {
  std::string layer, way;             // SceneWay::label
  uint64_t strands = 0, sampled = 0;  // simulated ones; rods that count
  double error = 0.0;
};

struct SceneRodErrors {
  std::vector<std::optional<double>> ways;  // as asked; none: not comparable, or no layer has a rod
  double self_error = 0.0;                  // of the rods: in steps twice as long
  double secondary_m = 0.0;                 // RMS of rod - rigid
  std::vector<RodLayerRow> layers;
  std::vector<std::string> notes;  // what is left out, and why
};

class SceneRods {
 public:
  // `scene`: as the ways run it. `rate`: recorded frames for one of it. Frames before `warm_up` do not count. `most`
  // rods at most, but one of each layer.
  SceneRods(const Scenario& scene, uint32_t rate, uint32_t warm_up, uint32_t most);

  // After each frame of a run at the recording's rate in which every strand lives.
  void Record(const FurScene& scene);
  // `progress` is called once for each way and frame.
  SceneRodErrors Compare(std::span<const SceneWay> ways, Isa isa,
                         const std::function<void()>& progress);
  // Whether a way shows what the solver does in every frame.
  static bool IsComparable(const SceneWay& way);

 private:
  struct Layer {
    std::string name;
    uint32_t number;  // in the scene
    LayerParams params;
    float length_max;  // m
    uint64_t strands = 0;
  };
  struct Root {
    Double3 position, normal, tangent;  // world, m
    bool starts;                        // afresh: there is no motion up to here
  };
  struct Rod {
    uint32_t layer;  // in layers_
    uint32_t chunk, lane;
    double strands;              // that it stands for
    std::vector<Double3> groom;  // points in the root's frame, m, the root first
    Preset material;
    CurlModel curl;
    StrandWeight weight;
    std::vector<Root> roots = {};     // [recorded frame]
    std::vector<Double3> moved = {};  // free points beside the groom, m, of each frame that counts
  };
  // Sums of squares over points and frames, m^2, by layer.
  struct Sum {
    double off = 0.0, moved = 0.0;
    void Add(const Rod& rod, Double3 at, Double3 exact);
    void Add(const Sum& other) { off += other.off, moved += other.moved; }
    double Share() const;
  };
  using Sums = std::vector<Sum>;

  void ChooseStrands(const FurScene& scene);
  Rod MakeRod(const FurScene& scene, uint32_t layer, uint32_t chunk, uint32_t lane) const;
  BodyPose PoseAt(const Rod& rod, size_t frame, size_t stride) const;
  std::vector<Double3> Move(const Rod& rod, size_t stride) const;
  void MoveAll(SceneRodErrors& errors);
  Sums Run(const SceneWay& way, Scenario& scenario, Isa isa, const std::function<void()>& progress);
  std::vector<RodLayerRow> RowsOf(std::span<const SceneWay> ways,
                                  const std::vector<Sums>& sums) const;

  Scenario bare_, own_chains_;  // without what a rod has not
  uint32_t rate_, warm_up_, most_;
  std::vector<Layer> layers_;  // that have rods
  std::vector<std::string> notes_;
  std::vector<Rod> rods_;
};

// ---- Tips off the reference ------------------------------------------------------------------

// How far the tips of a scene's strands are off the reference, compared with the bound that their quality states
// (ErrorShare, core/modal/modal_quality.hpp).
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

// ---- Frames ----------------------------------------------------------------------------------

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
  std::optional<double> rod_error = {};  // SceneRodErrors::ways; none: no rod, or not compared
  double live_share = 1.0;               // of the strands
  double simulate_runs = 0.0;            // of those stages on a chunk, per frame
  uint64_t points_digest = 0;            // of all points of all frames
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
