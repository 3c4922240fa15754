// Writes the seed corpora anew: small files of every format that use as much of it as they can.
//   make_corpus FOLDER
// Run it when a format changes, and commit what it wrote. The corpus of setups is
// bench/scenarios/setups; golden digests are digest logs, and traces/golden is a corpus of those.
// What fuzzing found stays beside the seeds, under the name of the fault.
#include <bit>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "core/character/builtin_character.hpp"
#include "core/character/gltf_import.hpp"
#include "core/character/pose.hpp"
#include "core/error.hpp"
#include "core/groom/bake.hpp"
#include "core/groom/groom_file.hpp"
#include "core/random.hpp"
#include "jobs/scene.hpp"
#include "tests/character/gltf_builder.hpp"
#include "traces/digest_log.hpp"
#include "traces/input_fields.hpp"
#include "traces/input_log.hpp"
#include "traces/input_log_format.hpp"

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

namespace pelt {
namespace {

void Write(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  if (!out.flush()) throw Error("cannot write " + path.string());
  std::printf("%s: %zu bytes\n", path.filename().c_str(), bytes.size());
}
void Write(const std::filesystem::path& path, const std::string& text) {
  Write(path, std::as_bytes(std::span(text)));
}

void WriteGltf(const std::filesystem::path& folder) {
  test::GltfBuilder quad = test::MakeQuad();
  const int input = quad.Floats("SCALAR", {0, 1});
  const int output = quad.Floats("VEC4", {0, 0, 0, 1, 0, 0, 1, 0});
  quad.animations =
      "{\"samplers\":[{\"input\":" + std::to_string(input) +
      ",\"output\":" + std::to_string(output) +
      "}],\"channels\":[{\"sampler\":0,\"target\":{\"node\":1,\"path\":\"rotation\"}}]}";
  Write(folder / "quad.glb", quad.Glb());
  Write(folder / "quad.gltf", quad.Json());
  Write(folder / "builtin.glb", MakeBuiltinCharacterGlb({.tiny = true}));
}

// Grey, colour and alpha; stb's reader branches on the number of channels.
void WriteControlMaps(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  std::vector<uint8_t> pixels;
  for (int i = 0; i < 4 * 6 * 5; ++i) pixels.push_back(uint8_t(37 * i));
  for (const int channels : {1, 2, 3, 4}) {
    const std::string path = (folder / ("channels_" + std::to_string(channels) + ".png")).string();
    if (!stbi_write_png(path.c_str(), 6, 5, channels, pixels.data(), 6 * channels))
      throw Error("cannot write " + path);
  }
}

struct Fur {
  Character character;
  float unit_scale;
  Groom groom;
};

Fur BakeLayers(const std::string& layers) {
  Fur fur{MakeBuiltinCharacter({.tiny = true}), 1.0f, {}};
  fur.unit_scale = DefaultUnitScale(fur.character).metres_per_unit;
  const FurSetup setup = ReadFurSetup("[defaults]\ndensity = 40_000\n" + layers, "seed.toml", ".");
  fur.groom = BakeGroom(fur.character, ComputeRestGeometry(fur.character, fur.unit_scale), setup,
                        fur.unit_scale);
  return fur;
}

constexpr const char* kVertexChains = R"(
[[layer]]
name = "vertex"
max_strands = 40
mask = { materials = ["head"] }
length = { value = 0.04, randomise = 0.3 }
clump = 0.3
)";
constexpr const char* kStrandChains = R"(
[[layer]]
name = "pbd"
chain = "strand"
output = "ribbons"
max_strands = 20
mask = { materials = ["tail"] }
[[layer]]
name = "verlet"
solver = "verlet"
chain = "strand"
points = 5
max_strands = 20
mask = { materials = ["tail"] }
curl = 200.0
)";

constexpr const char* kShells = R"(
[[layer]]
name = "shells"
output = "shells"
mask = { materials = ["head"] }
fur_texture_size = 16
cone_kind = "published"
fins = true
)";

// Three frames of a walk, the last of them as the one before.
std::vector<std::byte> RecordWalk(const Fur& fur, bool velocities) {
  const Groom* grooms[] = {&fur.groom};
  const auto made = FurScene::Create(grooms, {.velocities = velocities}).OrThrow();
  FurScene& scene = *made;
  const std::vector<std::byte> groom_file = WriteGroom(fur.groom).OrThrow();
  const std::span<const std::byte> files[] = {groom_file};
  InputLogWriter writer;
  const PoseRateBlock* const rates = scene.PoseRates(0);
  if (velocities && !rates) throw Error("no layer takes velocities");
  writer.Begin({"walk", "a seed for fuzzing", false, velocities}, files);
  const Weather weather[] = {{0.5f, 0.25f}};
  for (const double time_s : {0.0, 0.1, 0.1}) {
    FillPose(fur.character.skeleton, &fur.character.clips[0], time_s, true,
             PlaceCharacter(glm::mat4(1.0f), fur.unit_scale), &scene.Pose(0));
    if (rates)
      FillPoseRates(&fur.character.clips[0], time_s, true, 1.0, glm::mat4(0.0f),
                    scene.PoseRates(0));
    FrameInput input;
    input.time_s = time_s;
    input.weather = weather;
    input.sphere_count = 1;
    input.sphere[0][3] = 0.1f;
    input.lighting.light_count = 1;
    input.lighting.light[0] = {{0.0f, 2.0f, 1.0f}, 0.1f, {1.0f, 0.9f, 0.8f}, 5.0f};
    input.lighting.sample_count = 1;
    input.lighting.sample[0] = {{}, 4.0f, {0.5f, 0.6f, 0.7f}, {0.2f, 0.1f, 0.1f}, {0, 1, 0}};
    input.brush_count = 1;
    input.brush[0] = {{0.0f, 0.5f, 0.0f}, 0.5f, 0.5f, uint32_t(PaintChannel::kMud), 0.25f};
    if (const char* fault = scene.BeginFrame(input)) throw Error(fault);
    SerialExecutor().Run(scene.CurrentFrame());
    writer.AddFrame(input, {&scene.Pose(0), 1}, scene.DigestFrame(), {rates, rates ? 1u : 0u});
  }
  return writer.Finish();
}

// Records of pose_target.cpp.
void WritePoses(const std::filesystem::path& folder) {
  using input_log::PutNumber;
  const auto word = [](std::vector<std::byte>& to, size_t offset_bytes, float value) {
    PutNumber(to, uint8_t{0});
    PutNumber(to, uint16_t(offset_bytes / 4));
    PutNumber(to, std::bit_cast<uint32_t>(value));
  };
  const auto run = [](std::vector<std::byte>& to) { PutNumber(to, uint8_t{2}); };
  std::vector<std::byte> walk, stretched, hostile;
  FrameInput input;
  input.wind.velocity[0] = 3.0f;
  for (int frame = 0; frame < 4; ++frame) {
    word(walk, offsetof(PoseBlock, root) + 12, 0.05f * float(frame));
    PutNumber(walk, uint8_t{1});
    input.time_s = frame / 60.0;
    ListInputFields(input_log::Writer{walk}, input);
    for (const auto& sphere : input.sphere) input_log::Writer{walk}("sphere", sphere);
    for (const auto& capsule : input.capsule) ListCapsuleFields(input_log::Writer{walk}, capsule);
    for (const auto& light : input.lighting.light) ListLightFields(input_log::Writer{walk}, light);
    for (const auto& sample : input.lighting.sample)
      ListIrradianceFields(input_log::Writer{walk}, sample);
    for (const auto& brush : input.brush) ListBrushFields(input_log::Writer{walk}, brush);
    for (const auto& force : input.force) ListForceFields(input_log::Writer{walk}, force);
    PutNumber(walk, uint8_t{4});
    for (size_t v = 0; v < 3 * (1 + kSpheresPerScene + 2 * kCapsulesPerScene); ++v)
      PutNumber(walk, std::bit_cast<uint32_t>(0.5f * float(frame)));
    run(walk);
  }
  Write(folder / "walk.pose", walk);
  for (size_t joint = 0; joint < 24; ++joint)
    for (size_t c = 0; c < 3; ++c)
      word(stretched, offsetof(PoseBlock, scale_key) + 4 * (c * kJointsPerCharacter + joint), 1e6f);
  run(stretched);
  Write(folder / "stretched.pose", stretched);
  run(hostile);
  word(hostile, offsetof(PoseBlock, rotation_key), std::bit_cast<float>(0x7fc00000u));
  run(hostile);
  word(hostile, offsetof(PoseBlock, joint_count), std::bit_cast<float>(256u));
  run(hostile);
  Write(folder / "hostile.pose", hostile);
}

void WriteDigestLogs(const std::filesystem::path& folder) {
  DigestLog log{"seed", "", kStrandsPerChunk, "sorted", {}, {}};
  for (const char* stage : {"skin", "roots", "fit_cubic_4"}) log.columns.push_back({stage, "rows"});
  log.columns.push_back({std::string(kWholeFrameStage), "all"});
  Write(folder / "empty.digests", WriteDigestLog(log));
  for (uint64_t i = 0; i < 8; ++i) log.digests.push_back(MixSeed(7, i));
  Write(folder / "two_frames.digests", WriteDigestLog(log));
}

}  // namespace
}  // namespace pelt

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_corpus FOLDER\n");
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    pelt::WriteGltf(folder / "gltf");
    pelt::WriteControlMaps(folder / "control_map");
    const pelt::Fur vertex = pelt::BakeLayers(pelt::kVertexChains);
    const pelt::Fur strand = pelt::BakeLayers(pelt::kStrandChains);
    pelt::Write(folder / "groom" / "vertex_chains.groom", WriteGroom(vertex.groom).OrThrow());
    pelt::Write(folder / "groom" / "strand_chains.groom", WriteGroom(strand.groom).OrThrow());
    pelt::Write(folder / "groom" / "shells.groom",
                WriteGroom(pelt::BakeLayers(pelt::kShells).groom).OrThrow());
    pelt::Write(folder / "input_log" / "walk.peltinput", RecordWalk(vertex, false));
    pelt::Write(folder / "input_log" / "velocities.peltinput", RecordWalk(vertex, true));
    pelt::WritePoses(folder / "pose");
    pelt::WriteDigestLogs(folder / "digest_log");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_corpus: %s\n", error.what());
    return 1;
  }
}
