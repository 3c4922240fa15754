#include "bench/scenarios/scenarios.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <glm/gtc/matrix_transform.hpp>

#include "bench/scenarios/embedded_files.hpp"
#include "bench/scenarios/layer_plan.hpp"
#include "bench/scenarios/made_scenes.hpp"
#include "core/character/builtin_character.hpp"
#include "core/character/clips.hpp"
#include "core/character/gltf_import.hpp"
#include "core/character/pose.hpp"
#include "core/error.hpp"
#include "core/file_bytes.hpp"
#include "core/format.hpp"
#include "core/groom/bake.hpp"
#include "core/groom/groom_file.hpp"
#include "core/groom/nearest_word.hpp"
#include "core/groom/setup_names.hpp"
#include "core/random.hpp"

namespace pelt {
namespace {

struct BuiltInCharacter {
  std::string_view name;
  BuiltinBody body;
};
constexpr BuiltInCharacter kCharacters[] = {{"builtin", BuiltinBody::kMonster},
                                            {"scorpion", BuiltinBody::kScorpion}};

// The first of them.
std::string ListClips(std::span<const Clip> clips) {
  constexpr size_t kNamed = 8;
  std::string names;
  for (const Clip& clip : clips.first(std::min(clips.size(), kNamed)))
    names += (names.empty() ? "" : ", ") + Printable(clip.name);
  if (clips.size() > kNamed) names += fmt::format(" and {} more", clips.size() - kNamed);
  return names.empty() ? "none" : names;
}

// The clip a scenario plays: the one asked for, else the setup's, else the file's first.
int32_t ChooseClip(const Character& character, const std::string& wanted, const FurSetup& setup) {
  const std::string& name = wanted.empty() ? setup.clip : wanted;
  for (size_t i = 0; i < character.clips.size(); ++i)
    if (character.clips[i].name == name) return int32_t(i);
  if (wanted.empty() && !setup.clip.empty()) {
    throw Error(fmt::format("{}: clip '{}' is not in {}; it has: {}", setup.path, setup.clip,
                            character.name, ListClips(character.clips)));
  }
  return character.clips.empty() ? -1 : 0;
}

Actor MakeActor(const Scenario& scenario, const FurSetup& setup, const std::string& clip,
                float unit_scale) {
  Actor actor{};
  actor.character = uint32_t(scenario.characters.size()) - 1;
  actor.groom = uint32_t(scenario.grooms.size()) - 1;
  actor.clip = ChooseClip(scenario.characters.back(), clip, setup);
  actor.unit_scale = unit_scale;
  return actor;
}

// Imports, bakes and places one character that plays `clip`.
void AddActor(Scenario& scenario, Character character, const FurSetup& setup,
              const std::string& clip) {
  const float unit_scale = ChooseUnitScale(setup, character, scenario.notes);
  std::vector<LayerDensity> densities;
  scenario.grooms.push_back(BakeGroom(character, ComputeRestGeometry(character, unit_scale), setup,
                                      unit_scale, nullptr, nullptr, &densities, &scenario.notes));
  scenario.setups.push_back(setup);
  if (const std::string bare = DescribeBare(character.mesh, setup); !bare.empty())
    scenario.notes.push_back(bare);
  for (std::string& warning : WarnOfBaldness(densities))
    scenario.notes.push_back(std::move(warning));
  scenario.characters.push_back(std::move(character));
  scenario.actors.push_back(MakeActor(scenario, setup, clip, unit_scale));
  if (setup.lights) scenario.base.lighting = MakeLighting(*setup.lights);
}

WindSetup Breeze() {
  return {.velocity = {1.6f, 0.0f, 0.7f},
          .gust_strength = 0.6f,
          .gust_period_s = 3.0f,
          .turbulence = 1.0f,
          .turbulence_scale_m = 0.5f};
}

constexpr CameraOrbit kMonsterCamera{.target = {0.0f, 0.63f, 0.0f},
                                     .radius_m = 2.5,
                                     .height_m = 0.25,
                                     .start_rad = -0.35,
                                     .vertical_fov_rad = 0.62};

// One of our characters, which walks in a breeze.
Scenario MakeWalk(Character character, const std::string& setup, const ScenarioRequest& request) {
  Scenario scenario;
  AddActor(scenario, std::move(character), LoadSetup(setup, request.seed, request.SetupText(0)),
           "walk");
  scenario.base.wind = Breeze();
  return scenario;
}

Scenario MakeMonster(const ScenarioRequest& request, const LoadProgress&) {
  Scenario scenario = MakeWalk(LoadCharacter("builtin"), "monster", request);
  scenario.camera = kMonsterCamera;
  return scenario;
}

Scenario MakeEyePet(const ScenarioRequest& request, const LoadProgress&) {
  Scenario scenario = MakeWalk(LoadCharacter("builtin"), "eyepet", request);
  scenario.base.use_ground = true;
  scenario.camera = kMonsterCamera;
  scenario.spheres.push_back({{0.0f, 0.75f, 0.42f}, {0.3f, 0.0f, 0.0f}, 2.5, 0.15f});
  return scenario;
}

Scenario MakeScorpion(const ScenarioRequest& request, const LoadProgress&) {
  Scenario scenario = MakeWalk(LoadCharacter("scorpion"), "scorpion", request);
  scenario.base.use_ground = true;
  scenario.camera = {.target = {0.0f, 0.34f, 0.0f},
                     .radius_m = 2.1,
                     .height_m = 0.75,
                     .start_rad = 0.6,
                     .vertical_fov_rad = 0.62};
  return scenario;
}

Scenario MakeTiny(const ScenarioRequest& request, const LoadProgress&) {
  Scenario scenario = MakeWalk(MakeBuiltinCharacter({.tiny = true}), "tiny", request);
  scenario.default_frames = 60;
  scenario.base.use_ground = true;
  scenario.spheres.push_back({{0.0f, 0.9f, 0.3f}, {0.25f, 0.0f, 0.1f}, 0.7, 0.2f});
  scenario.weather_course = {0.7f, 0.4f, 8};
  scenario.actors[0].teleport_frame = 20;
  scenario.actors[0].teleport_by = {0.4f, 0.0f, -0.3f};
  return scenario;
}

// Far enough away to see the whole character in its rest pose.
void PointCameraAt(Scenario& scenario) {
  const RestGeometry rest =
      ComputeRestGeometry(scenario.characters[0], scenario.actors[0].unit_scale);
  const BoundingBox box = BoundPlaces(rest.position);
  scenario.camera.target = (box.low + box.high) * 0.5f;
  scenario.camera.radius_m = 1.8 * std::max(box.LargestSide(), double(1e-3f));
  scenario.camera.height_m = 0.2 * scenario.camera.radius_m;
}

bool IsOwn(const ScenarioRequest& request) {
  const bool files =
      request.scene.empty() && !(IsBuiltInName(request.setup) && IsBuiltInName(request.character));
  return !files && request.setup_texts.empty();
}

Scenario MakeFromFiles(const ScenarioRequest& request) {
  Scenario scenario;
  scenario.base.wind = Breeze();
  Character character = LoadCharacter(request.character);
  FurSetup setup;
  if (request.groom.empty()) setup = LoadSetup(request.setup, request.seed, request.SetupText(0));
  if (request.check_files_read) request.check_files_read(FilesReadFor(character, setup));
  if (setup.clip_smoothing) SmoothClips(character);
  if (request.groom.empty()) {
    AddActor(scenario, std::move(character), setup, request.clip);
  } else {
    scenario.characters.push_back(std::move(character));
    scenario.grooms.push_back(ReadGroomFile(request.groom).OrThrow());
    scenario.setups.emplace_back();
    CheckGroomFits(scenario.grooms[0], request.groom, scenario.characters[0]);
    scenario.actors.push_back(MakeActor(scenario, FurSetup{}, "", scenario.grooms[0].unit_scale));
  }
  for (const std::string& note : scenario.characters[0].notes) scenario.notes.push_back(note);
  PointCameraAt(scenario);
  return scenario;
}

void ChooseClips(const ScenarioRequest& request, Scenario& scenario) {
  scenario.once = request.once;
  bool known = request.clip.empty();
  for (Actor& actor : scenario.actors) {
    const Character& character = scenario.characters[actor.character];
    const auto clip = std::ranges::find(character.clips, request.clip, &Clip::name);
    if (!request.clip.empty() && clip != character.clips.end()) {
      actor.clip = int32_t(clip - character.clips.begin());
      known = true;
    }
    actor.jumps =
        actor.clip >= 0 && JumpsWhereItLoops(character, character.clips[size_t(actor.clip)]);
    if (actor.jumps && !request.once && request.scene.empty())
      scenario.notes.push_back(fmt::format(
          "clip '{}' of {} does not end where it begins; fur starts anew where it loops",
          Printable(character.clips[size_t(actor.clip)].name), Printable(character.name)));
  }
  if (!known)
    throw Error(fmt::format("no clip '{}'; {} has: {}", Printable(request.clip),
                            Printable(scenario.characters.front().name),
                            ListClips(scenario.characters.front().clips)));
}

void OverrideSolver(const ScenarioRequest& request, Scenario& scenario) {
  for (Groom& groom : scenario.grooms)
    for (size_t l = 0; l < groom.layers.size(); ++l) {
      const auto bad = ChangeSimulation(groom, l, {request.solver, request.quality, {}});
      if (!bad) continue;
      GroomLayer& layer = groom.layers[l];
      scenario.notes.push_back(
          fmt::format("layer '{}' keeps its {}: {}", layer.name, bad->key, bad->reason));
      layer.params.quality = request.quality.value_or(layer.params.quality);
    }
}

// What a scene is lit by: its setup's [lights], lights of the user's own, or a studio's.

constexpr std::string_view kStudioLights = "lamps";

bool IsBlack(const float (&rgb)[3]) { return !(rgb[0] || rgb[1] || rgb[2]); }

bool IsDark(const Lighting& in) {
  const std::span lights(in.light, in.light_count);
  const std::span samples(in.sample, in.sample_count);
  return IsBlack(in.sun_rgb) && IsBlack(in.rim_rgb) &&
         std::ranges::all_of(lights, [](const SphereLight& l) { return IsBlack(l.rgb); }) &&
         std::ranges::all_of(samples, [](const IrradianceSample& s) {
           return IsBlack(s.sky) && IsBlack(s.ground);
         });
}

bool HasLitLayer(const Groom& groom) {
  return std::ranges::any_of(groom.layers, [](const GroomLayer& l) { return l.params.lit; });
}

// [lights] of a built-in file by name, or of the TOML file at this path; of a whole setup or alone. Throws Error, for
// lights that are all black too.
Lighting LoadLights(const std::string& name_or_path) {
  const EmbeddedFile* found = NamedOrPath(EmbeddedLights(), "lights", name_or_path);
  const Lighting lights = MakeLighting(found ? ReadLights(found->text, name_or_path + ".toml")
                                             : ReadLightsFile(name_or_path));
  if (IsDark(lights)) throw Error(fmt::format("{}: all of its [lights] are black", name_or_path));
  return lights;
}

// Has every layer lit, by these instead of the scene's own.
void LightAll(Scenario& scenario, const Lighting& lights) {
  scenario.base.lighting = lights;
  for (Groom& groom : scenario.grooms)
    for (GroomLayer& layer : groom.layers) layer.params.lit = true;
}

// Where layers are lit and nothing says by what, a studio's lights; a note where there are lights and no lit layer.
void CompleteLights(Scenario& scenario) {
  const bool is_lit = std::ranges::any_of(scenario.grooms, HasLitLayer);
  const bool is_dark = IsDark(scenario.base.lighting);
  if (is_lit && is_dark) scenario.base.lighting = LoadLights(std::string(kStudioLights));
  if (!is_lit && !is_dark)
    scenario.notes.push_back("[lights] light no layer: none of the setup has lit = true");
}

struct BuiltInScene {
  std::string_view name;
  Scenario (*make)(const ScenarioRequest& request, const LoadProgress& progress);
};
constexpr BuiltInScene kScenes[] = {
    {"monster", MakeMonster},      {"stage", MakeStage},       {"cast", MakeCast},
    {"eyepet", MakeEyePet},        {"scorpion", MakeScorpion}, {"tiny", MakeTiny},
    {"everything", MakeEverything}};

constexpr auto NamesOfScenes() {
  std::array<std::string_view, std::size(kScenes)> names;
  for (size_t i = 0; i < names.size(); ++i) names[i] = kScenes[i].name;
  return names;
}

}  // namespace

std::span<const std::string_view> ScenarioNames() {
  static constexpr auto kNames = NamesOfScenes();
  return kNames;
}

Character LoadCharacter(const std::string& name_or_path) {
  for (const BuiltInCharacter& character : kCharacters)
    if (name_or_path == character.name) return MakeBuiltinCharacter({.body = character.body});
  // A file may be without an ending. Not by <filesystem>, which a page has not.
  if (name_or_path.find_first_of("./") == std::string::npos &&
      access(name_or_path.c_str(), F_OK) != 0) {
    std::vector<std::string_view> names;
    for (const BuiltInCharacter& character : kCharacters) names.push_back(character.name);
    throw Error(fmt::format(
        "no built-in character '{}' (there are: {}); a file's path ends in .glb or .gltf{}",
        name_or_path, fmt::join(names, ", "), DidYouMean(name_or_path, names)));
  }
  return ImportGltfFile(name_or_path);
}

bool IsBuiltInName(std::string_view value) {
  return std::ranges::count(kCharacters, value, &BuiltInCharacter::name) ||
         FindEmbedded(EmbeddedSetups(), value) || FindEmbedded(EmbeddedLights(), value);
}

std::vector<std::string> FilesReadFor(const Character& character, const FurSetup& setup) {
  std::vector<std::string> files = character.files_read;
  files.insert(files.end(), setup.files_read.begin(), setup.files_read.end());
  return files;
}

std::string SetupText(const std::string& name_or_path) {
  if (const EmbeddedFile* found = NamedOrPath(EmbeddedSetups(), "setup", name_or_path))
    return std::string(found->text);
  return ReadSetupText(name_or_path);
}

FurSetup LoadSetup(const std::string& name_or_path, uint64_t seed, std::string_view text) {
  const bool built_in = NamedOrPath(EmbeddedSetups(), "setup", name_or_path);
  const std::string own = text.empty() ? SetupText(name_or_path) : std::string(text);
  FurSetup setup = built_in ? ReadFurSetup(own, name_or_path + ".toml", "")
                            : ReadFurSetup(own, name_or_path, FolderOf(name_or_path));
  if (seed != 0)
    for (LayerSetup& layer : setup.layers) layer.seed = MixSeed(layer.seed, seed);
  return setup;
}

float ChooseUnitScale(const FurSetup& setup, const Character& character,
                      std::vector<std::string>& notes) {
  if (setup.unit_scale) {
    notes.push_back(fmt::format("unit_scale {} m a file unit, from the setup", *setup.unit_scale));
    return *setup.unit_scale;
  }
  UnitScale guess = DefaultUnitScale(character);
  notes.push_back(std::move(guess.sentence));
  return guess.metres_per_unit;
}

// A groom fits a character when it was baked for the same joints in the same order.
void CheckGroomFits(const Groom& groom, const std::string& path, const Character& character) {
  const std::vector<std::string>& have = character.skeleton.name;
  if (groom.joint_names == have) return;
  const auto at = size_t(std::ranges::mismatch(groom.joint_names, have).in2 - have.begin());
  const auto name = [&](const std::vector<std::string>& names) {
    return at < names.size() ? fmt::format("'{}'", names[at]) : std::string("nothing");
  };
  throw Error(fmt::format(
      "{}: baked for another character than {}: joint {} is {} in the groom and {} in the "
      "character; bake it again for this one",
      path, character.name, at, name(groom.joint_names), name(have)));
}

Scenario LoadScenario(const ScenarioRequest& request, const LoadProgress& progress) {
  // Before the bake, so that a mistake in them is reported at once.
  std::optional<Lighting> lights;
  if (!request.lights.empty()) lights = LoadLights(request.lights);
  std::vector<LayerChoice> plan;
  if (!request.plan.empty()) plan = ReadLayerPlan(request.plan);
  Scenario scenario;
  const auto scene = std::ranges::find(kScenes, request.scene, &BuiltInScene::name);
  if (request.scene.empty())
    scenario = MakeFromFiles(request);
  else if (scene != std::end(kScenes))
    scenario = scene->make(request, progress);
  else
    throw Error(fmt::format("no scene '{}'; there are: {}{}", request.scene,
                            fmt::join(ScenarioNames(), ", "),
                            DidYouMean(request.scene, ScenarioNames())));
  // What is guessed and bare in our own is as it is meant; a setup that the user gives keeps its notes.
  if (IsOwn(request)) scenario.notes.clear();
  ChooseClips(request, scenario);
  OverrideSolver(request, scenario);
  ApplyLayerPlan(plan, request.plan, scenario);
  if (lights) LightAll(scenario, *lights);
  CompleteLights(scenario);
  scenario.name = !request.scene.empty() ? request.scene : scenario.characters[0].name;
  return scenario;
}

void CutHair(Scenario& scenario, const std::string& path) {
  const ControlMap stencil = ReadControlMapFile(path);
  scenario.cut.clear();
  for (const Actor& actor : scenario.actors) {
    const Character& character = scenario.characters[actor.character];
    if (character.mesh.uv.empty())
      throw Error(fmt::format("{}: a haircut lies over texture coordinates, and {} has none", path,
                              character.name));
    const std::vector<uint8_t> cut = CutByStencil(scenario.grooms[actor.groom], stencil);
    scenario.cut.insert(scenario.cut.end(), cut.begin(), cut.end());
  }
}

void PaintAll(Scenario& scenario, const PaintAmounts& amounts) {
  constexpr float kAround_m = 1000.0f;
  for (Groom& groom : scenario.grooms)
    for (GroomLayer& layer : groom.layers)
      layer.params.lit = layer.params.painted = layer.params.output != Output::kShells;
  for (uint32_t c = 0; c < kPaintChannels; ++c)
    if (amounts[c] > 0.0f) scenario.first_brushes.push_back({{}, kAround_m, 1.0f, c, amounts[c]});
}

}  // namespace pelt
