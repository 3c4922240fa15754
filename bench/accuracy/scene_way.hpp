// A way to run a scene's frames, and a run of one: solver, quality, and what is skipped.
//
// A scene is run at another frame rate by a copy of its scenario: its events (a teleport, the rest)
// stay where they are in time, and frames whose times coincide have the same input.
#pragma once

#include <string>
#include <vector>

#include "bench/scenarios/scenarios.hpp"
#include "jobs/frame_recording.hpp"

namespace pelt::accuracy {

// One way to run a scene's frames.
struct SceneWay {
  std::string name;   // "fast-halved"
  std::string label;  // "modal fast, at half rate"
  Solver solver = Solver::kModal;
  ModalQuality quality = ModalQuality::kFine;
  bool simulate = true;       // else every strand follows the skin
  bool halved = false;        // every second frame is simulated; the others are carried
  bool sleep = false;         // chunks that came to rest are skipped
  double strand_share = 1.0;  // LOD's budget
  bool on_screen = false;     // quality `fine`, `fast` where that is not seen, as frames have it
  bool planned = false;       // solver and quality: each layer's own
  bool own_chains = false;    // a chain for each strand, where the setup has them at vertices

  // Else its error is a difference of materials: PBD and Verlet have parameters of their own, which
  // no exact motion belongs to.
  bool OnReferenceMaterial() const { return !simulate || (solver == Solver::kModal && !planned); }
  // Sleeping is none: it changes no bit, goes with every way, and saves what the scene lets it.
  // Nor are other chains, whose error is against a reference of their own.
  bool IsChoice() const { return OnReferenceMaterial() && !sleep && !own_chains; }
};
std::vector<SceneWay> AllSceneWays();
// Every strand follows the skin, with the solver that has least to do then.
SceneWay RigidWay();

// `multiply` frames for every `divide` of the scene.
Scenario AtRate(const Scenario& base, uint32_t multiply, uint32_t divide);
// Gives the layers of `scenario` what the way wants; those that cannot have its solver keep that of
// `base`. Says whether any has it.
bool SetWay(const SceneWay& way, const Scenario& base, Scenario& scenario);
// Surface, ground and colliders.
void RemoveContact(Scenario& scenario);
void RemoveStrength(Groom& groom);
// Gives every strand a chain of its own in place of those at mesh vertices. Says whether any lacked
// one.
bool GiveOwnChains(Groom& groom);

// One way through the frames, with its clock.
class SceneRun {
 public:
  // `scenario` is at the run's rate and outlives it; its layers, as SetWay left them, are copied.
  SceneRun(const SceneWay& way, Scenario& scenario, Isa isa);

  void RunFrame(uint32_t frame);

  const FurScene& scene() const { return running_.scene(); }
  // Of the last frame: all of it; in the stages of wind and solvers.
  double frame_ns() const { return frame_ns_; }
  struct Simulation {
    double ns = 0.0;
    uint32_t runs = 0;  // of a stage on a chunk; what sleeps has none
  };
  Simulation Simulated() const;

 private:
  const Plan& plan() const { return running_.scene().plan(); }

  RunningScenario running_;
  FrameRecording recording_;
  SerialExecutor executor_;
  SkipSettings skip_;
  LodSettings lod_;
  std::vector<uint32_t> simulation_;  // stages
  double frame_ns_ = 0.0;
};

}  // namespace pelt::accuracy
