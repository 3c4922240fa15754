// How far the strands of a scene are off the rods that they stand for (curve_strand.hpp's), each clamped in its own
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
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/accuracy/curve_motion.hpp"
#include "bench/accuracy/scene_way.hpp"

namespace pelt::accuracy {

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

}  // namespace pelt::accuracy
