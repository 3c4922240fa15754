// Scenarios: named, seeded, complete inputs of N frames. Tests, benchmarks and the pelt command all
// run these, so a figure or a digest from one can be compared with the others.
//
//   monster  one character, about 40,000 strands in head, brows, body, arms and tail
//   stage    six characters, 60 layers, about 36,000 strands at 4 to 5 m: what the original drew
//   cast     17 characters, 166 layers, over 100,000 strands: all that the original shipped
//   eyepet   8,000 strands of 5 points, Verlet, clumping, ground plane, ribbons
//   scorpion shells over all but eyes and sting, walking in the wind: no strands
//   tiny     every solver and chain, instances and ribbons, in under a thousand strands: for tests
//   everything  every kind of layer, and all that may happen to it: for tests
//
// Invariant: frame f of a scenario has the same input regardless of what ran before it, on every machine
// (no clock, no libm); preparing a frame does not allocate.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/character/character.hpp"
#include "core/groom/fur_setup.hpp"
#include "core/groom/groom.hpp"
#include "core/layer_block.hpp"
#include "jobs/scene.hpp"

namespace pelt {

// ---- Characters and setups -------------------------------------------------------------------

// "builtin" (the monster), "scorpion", or the path of a .glb or .gltf file. Throws Error.
Character LoadCharacter(const std::string& name_or_path);

// Whether `value` names what is built in, in place of a file: a setup, lights or a character.
bool IsBuiltInName(std::string_view value);

// The files that the two led to besides their own.
std::vector<std::string> FilesReadFor(const Character& character, const FurSetup& setup);

// Throws Error when the groom was baked for other joints than the character's; `path` is for the
// message.
void CheckGroomFits(const Groom& groom, const std::string& path, const Character& character);

// The name of a built-in setup, or the path of a TOML file. `seed` other than 0 gives every layer
// another seed of its own. Throws Error.
// `text` other than empty: what is read in place of its own.
FurSetup LoadSetup(const std::string& name_or_path, uint64_t seed = 0, std::string_view text = {});
// What LoadSetup reads. Throws Error.
std::string SetupText(const std::string& name_or_path);

// The setup's unit scale, or the guess for this character; what was assumed goes into `notes`.
float ChooseUnitScale(const FurSetup& setup, const Character& character,
                      std::vector<std::string>& notes);

// What a material has of the surface.
struct MaterialShare {
  uint32_t triangles = 0;
  double area_m2 = 0.0;
};
// Of each material of the mesh.
std::vector<MaterialShare> MeasureMaterials(const Mesh& mesh, const RestGeometry& rest);

// A fur setup to start from, for a character that has none: a layer for each of its materials that
// is not bare, long and dense enough for its size to cover the skin. TOML, with the reason for each
// choice; `rest` is in metres by `unit_scale`. It bakes for this character, and no layer of it is
// bald. Throws Error where there is nothing to grow on.
std::string StartingSetup(const Character& character, const RestGeometry& rest, float unit_scale);

// ---- Scenarios -------------------------------------------------------------------------------

// One character on the stage.
struct Actor {
  uint32_t character;  // in Scenario::characters
  uint32_t groom;      // in Scenario::grooms
  int32_t clip;        // of the character; -1: stands in its rest pose
  bool jumps = false;  // where the clip begins anew
  double phase_s;      // into the clip at frame 0
  glm::mat4 placement{1.0f};
  float unit_scale = 1.0f;
  float weather_share = 1.0f;   // of the scenario's weather
  int32_t teleport_frame = -1;  // moved by teleport_by and restarted from this frame on; -1: never
  glm::vec3 teleport_by{0.0f};  // m
};

// The camera walks round its target on a circle.
struct CameraOrbit {
  glm::vec3 target{0.0f, 0.6f, 0.0f};  // m
  double radius_m = 3.0;
  double height_m = 0.4;  // above the target
  double start_rad = 0.5;
  double rate_rad_per_s = 0.15;
  double vertical_fov_rad = 0.7;
};

// A ball that strokes the fur: it swings about its centre.
struct MovingSphere {
  glm::vec3 centre{0.0f}, swing{0.0f};  // m
  double period_s = 3.0;
  float radius = 0.1f;  // m
};

struct WeatherCourse {
  float wetness = 0.0f, dirt = 0.0f;  // 0..1, reached over half a second
  uint32_t from_frame = 0;
};

struct Scenario {
  std::string name;
  uint32_t default_frames = 300;
  double dt_s = 1.0 / 60.0;
  double clip_rate = 1.0;  // how fast clips are played
  bool once = false;       // each clip stays at its end; otherwise it begins anew
  std::vector<Character> characters;
  std::vector<Groom> grooms;
  std::vector<FurSetup>
      setups;  // that the grooms were baked from; of one that is a file no layers and no text
  std::vector<Actor> actors;
  CameraOrbit camera;
  std::vector<MovingSphere> spheres;      // at most kSpheresPerScene
  std::vector<CapsuleCollider> capsules;  // at most kCapsulesPerScene
  WeatherCourse weather_course;
  bool velocities = false;     // poses come with those of their clips (SceneOptions::velocities)
  uint32_t strand_writes = 0;  // that its frames may have (SceneOptions::strand_writes)
  // Every character has an origin near it (SceneOptions::origins), which goes its own way.
  bool origins = false;
  glm::dvec3 place{0.0};  // where all of it is in the world, m
  // From this frame on nothing moves and no wind blows, though time goes on.
  uint32_t rest_from_frame = ~0u;
  // What else its course does, until it rests; poses lie in the scene.
  std::function<void(uint32_t frame, FurScene& scene, FrameInput& input)> more;
  bool keeps_poses = false;  // some pose of the course is to be refused: its character stands still
  std::vector<uint8_t> cut;  // of every frame (FrameInput::cut); empty: none
  FrameInput base;           // what does not change from frame to frame
  std::vector<PaintBrush>
      first_brushes;  // of frame 0 alone, behind those of `base`; together at most kBrushesPerScene
  std::vector<std::string> notes;

  // One groom for each actor, as FurScene::Create takes them.
  std::vector<const Groom*> ActorGrooms() const;
  uint64_t StrandCount() const;

  // Fills the poses of frame `frame` into the scene and returns its input. Does not allocate after
  // the first call; the result is valid until the next one.
  const FrameInput& PrepareFrame(uint32_t frame, FurScene& scene);

 private:
  double ClipTime(const Actor& actor, uint32_t frame) const;
  // The origin that the pose of character `actor` is relative to in a frame.
  glm::dvec3 OriginOf(uint32_t actor, uint32_t frame) const;
  void Place();

  FrameInput input_;
  std::vector<Weather> weather_;
};

// ---- Loading one -----------------------------------------------------------------------------

// Called before the bake with every file that the named ones led to: maps, buffers. May throw.
using CheckFilesReadHook = std::function<void(const std::vector<std::string>& files)>;

struct ScenarioRequest {
  std::string scene = {};  // a scenario's name; or, with this empty:
  std::string character = "builtin";
  std::string setup = {};  // name or path; or, with this empty:
  std::string groom = {};  // path of a groom file, baked for this character
  uint64_t seed = 0;       // other than 0: another groom from the same setups
  // In place of the texts of Scenario::setups, by number; what is empty or not there: their own.
  std::vector<std::string> setup_texts = {};
  std::string clip = {};  // that those who have it play, instead of what setup or scene says
  bool once = false;      // clips stay at their ends
  // Instead of what the layers say. A layer that cannot have the solver keeps its own, with a note.
  std::optional<Solver> solver = {};
  std::optional<ModalQuality> quality = {};
  std::string plan = {};  // path of a layer plan (layer_plan.hpp); empty: none
  // Name or path of lights: every layer is lit by them, instead of what scene and setup say.
  std::string lights = {};
  CheckFilesReadHook check_files_read = {};

  std::string_view SetupText(size_t setup) const {
    return setup < setup_texts.size() ? std::string_view(setup_texts[setup]) : std::string_view();
  }
};

using PaintAmounts = std::array<float, kPaintChannels>;  // 0 to 1, by PaintChannel
// Has every layer of strands lit and painted, and paints all of every character in frame 0.
void PaintAll(Scenario& scenario, const PaintAmounts& amounts);

// Cuts off what stands where the picture of this file is dark, on every character. Throws Error.
void CutHair(Scenario& scenario, const std::string& path);

std::span<const std::string_view> ScenarioNames();

// Called with the number of grooms made and wanted.
using LoadProgress = std::function<void(uint32_t done, uint32_t total)>;

// Imports, reads, bakes. Throws Error.
Scenario LoadScenario(const ScenarioRequest& request, const LoadProgress& progress = {});
inline Scenario LoadScenario(const std::string& name) {
  return LoadScenario(ScenarioRequest{.scene = name});
}

// ---- Running one -----------------------------------------------------------------------------

// A scenario with the memory and the scene that run it.
class RunningScenario {
 public:
  // The scenario must outlive this.
  RunningScenario(Scenario& scenario, SceneOptions options);

  FurScene& scene() { return *scene_; }
  const FurScene& scene() const { return *scene_; }
  // Goes on with another scenario from the state that there is; false, and nothing done, where that cannot be
  // (FurScene::ReplaceGrooms).
  bool GoOnWith(Scenario& scenario);
  // Fills the poses of a frame and returns its input, valid until the next call.
  FrameInput Prepare(uint32_t frame, const SkipSettings& skip, const LodSettings& lod);
  // False when the frame refuses the input; RefusalText() says why.
  bool TryBegin(const FrameInput& input);
  std::string RefusalText(uint32_t frame) const;
  // Prepares and begins a frame. Throws Error when the frame refuses its input.
  void Begin(uint32_t frame, const SkipSettings& skip, const LodSettings& lod);
  void Begin(uint32_t frame) { Begin(frame, scenario_->base.skip, scenario_->base.lod); }

 private:
  Scenario* scenario_;
  std::unique_ptr<FurScene> scene_;
  std::string refusal_;
};

}  // namespace pelt
