// jobs/pelt.h over FurScene. Nothing here decides anything: it checks what C cannot say in types
// (null, ranges) and hands on.
#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>

#include "core/bind_pose.hpp"
#include "core/float_rules.hpp"
#include "core/groom/groom_file.hpp"
#include "core/ribbon_indices.hpp"
#include "jobs/c_frame.hpp"
#include "jobs/engine_door.hpp"
#include "jobs/pelt.h"
#include "jobs/scene.hpp"

struct PeltScene {
  std::vector<pelt::Groom> grooms;
  std::vector<uint32_t> character_groom;
  std::unique_ptr<pelt::FurScene> scene;
  std::optional<pelt::DoorExecutor> executor;
  PeltDoor door{};
  pelt::PullExecutor pull;
  std::string text;
  std::vector<pelt::Weather> weather;
  std::vector<uint8_t> has_rates;  // of each character, for the frame that comes

  const pelt::Groom* GroomOf(uint32_t character) const {
    return character < character_groom.size() ? &grooms[character_groom[character]] : nullptr;
  }
  // The input of a frame is not written while the frame runs on it.
  pelt::FramePhase& Phase() const { return *scene->CurrentFrame().phase; }
};

namespace {

using pelt::Failure;
using pelt::Result;
using pelt::c_frame::Copy;

constexpr const char* kNoScene = "the scene is null";

static_assert(PELT_SORTED == int(pelt::VertexOrder::kSorted));
static_assert(PELT_INDEX_BUFFER == int(pelt::VertexOrder::kIndexBuffer));
static_assert(PELT_INSTANCES == int(pelt::Output::kInstances));
static_assert(PELT_RIBBONS == int(pelt::Output::kRibbons));
static_assert(PELT_LINES == int(pelt::Output::kLines));
static_assert(PELT_SHELLS == int(pelt::Output::kShells) && PELT_SHELLS + 1 == pelt::kOutputCount);
static_assert(sizeof(PeltShell) == sizeof(pelt::Shell));
static_assert(offsetof(PeltShell, threshold) == offsetof(pelt::Shell, threshold));
static_assert(sizeof(PeltFin) == sizeof(pelt::Fin));
static_assert(offsetof(PeltFin, fade) == offsetof(pelt::Fin, fade));
static_assert(PELT_RAN == int(pelt::PullResult::kRan));
static_assert(PELT_NOTHING_READY == int(pelt::PullResult::kNothingReady));
static_assert(PELT_IDLE == int(pelt::PullResult::kIdle));
static_assert(sizeof(PeltStrandCurve) == sizeof(pelt::StrandCurve));
static_assert(offsetof(PeltStrandCurve, strand) == offsetof(pelt::StrandCurve, strand));

static_assert(sizeof(PeltLook) == sizeof(pelt::LookRecord));
static_assert(offsetof(PeltLook, amounts) == offsetof(pelt::LookRecord, amounts));
static_assert(sizeof(PeltLayerLook) == sizeof(pelt::LayerLook));
static_assert(offsetof(PeltLayerLook, shadow_alpha) == offsetof(pelt::LayerLook, shadow_alpha));
static_assert(PELT_STRAND_LOOK == int(pelt::StrandChannels::kLook));
static_assert(PELT_STRAND_WEATHER == int(pelt::StrandChannels::kWeather));
static_assert(sizeof(PeltLayerLight) == sizeof(pelt::LayerLightBlock));
static_assert(offsetof(PeltLayerLight, rim_rgb) == offsetof(pelt::LayerLightBlock, rim_rgb));

// Characters that share bytes share a groom.
Result<> ReadGrooms(const PeltBytes* files, uint32_t count, PeltScene& scene) {
  std::vector<std::pair<const void*, size_t>> read;
  for (uint32_t c = 0; c < count; ++c) {
    const std::string name = "of character " + std::to_string(c);
    if (!files[c].data) return Failure{"groom '" + name + "' is null"};
    const std::pair<const void*, size_t> file{files[c].data, files[c].bytes};
    const auto found = std::find(read.begin(), read.end(), file);
    scene.character_groom.push_back(uint32_t(found - read.begin()));
    if (found != read.end()) continue;
    Result<pelt::Groom> groom =
        pelt::ReadGroom({static_cast<const std::byte*>(files[c].data), files[c].bytes}, name);
    if (!groom) return Failure{groom.error()};
    read.push_back(file);
    scene.grooms.push_back(*std::move(groom));
  }
  return pelt::Done{};
}

Result<std::unique_ptr<PeltScene>> Create(const PeltBytes* files, uint32_t count,
                                          const PeltSceneOptions& wanted) {
  if (!files || count == 0) return Failure{"a scene needs at least one groom"};
  pelt::SceneOptions options;
  if (wanted.vertex_order > PELT_INDEX_BUFFER) return Failure{"there is no such vertex order"};
  options.vertex_order = pelt::VertexOrder(wanted.vertex_order);
  options.memory_budget_bytes = wanted.memory_budget_bytes;
  options.velocities = wanted.velocities != 0;
  options.origins = wanted.origins != 0;
  options.any_scale = wanted.any_scale != 0;
  options.strand_writes = wanted.strand_writes;

  auto made = std::make_unique<PeltScene>();
  if (const auto read = ReadGrooms(files, count, *made); !read) return Failure{read.error()};
  std::vector<const pelt::Groom*> grooms;
  for (uint32_t c = 0; c < count; ++c) grooms.push_back(made->GroomOf(c));
  pelt::SceneMemory memory;
  if (wanted.allocate) {
    memory.allocate = [](uint64_t bytes, void* user) {
      const auto& asked = *static_cast<const PeltSceneOptions*>(user);
      return static_cast<std::byte*>(asked.allocate(bytes, asked.user));
    };
    memory.user = const_cast<PeltSceneOptions*>(&wanted);
  }
  auto scene = pelt::FurScene::Create(grooms, options, memory);
  if (!scene) return Failure{scene.error()};
  made->scene = *std::move(scene);
  for (uint32_t c = 0; c < count; ++c) pelt::FillBindPose(*grooms[c], made->scene->Pose(c));
  made->weather.resize(count);
  made->has_rates.resize(count);
  return made;
}

void PutText(const std::string& text, char* to, size_t bytes) {
  if (!to || bytes == 0) return;
  const size_t size = std::min(text.size(), bytes - 1);
  std::memcpy(to, text.data(), size);
  to[size] = '\0';
}

// The velocities of the frame that comes, for a character that is there; null: the scene has none.
pelt::PoseRateBlock* RatesOf(PeltScene& scene, uint32_t character) {
  pelt::PoseRateBlock* rates = scene.scene->PoseRates(character);
  if (rates && !scene.has_rates[character]) {
    *rates = {};
    rates->given = 1;
    scene.has_rates[character] = 1;
  }
  return rates;
}

constexpr const char* kNoRates =
    "the scene takes no velocities: it was made without, or has no layer with the modal solver";

bool SameDoor(const PeltDoor& a, const PeltDoor& b) {
  return a.enqueue == b.enqueue && a.finish == b.finish && a.user == b.user &&
         a.worker_count == b.worker_count;
}

}  // namespace

PeltScene* pelt_create(const PeltBytes* grooms, uint32_t count, const PeltSceneOptions* options,
                       char* why, size_t why_bytes) {
  auto made = Create(grooms, count, options ? *options : PeltSceneOptions{});
  PutText(made.error(), why, why_bytes);
  return made ? made->release() : nullptr;
}

void pelt_destroy(PeltScene* scene) { delete scene; }

uint32_t pelt_layer_count(const PeltScene* scene) {
  return scene ? scene->scene->shape().layer_count : 0;
}

const char* pelt_layer_name(const PeltScene* scene, uint32_t layer) {
  return layer < pelt_layer_count(scene) ? scene->scene->LayerName(layer).data() : nullptr;
}

uint32_t pelt_joint_count(const PeltScene* scene, uint32_t character) {
  const pelt::Groom* groom = scene ? scene->GroomOf(character) : nullptr;
  return groom ? groom->joint_count : 0;
}

const char* pelt_joint_name(const PeltScene* scene, uint32_t character, uint32_t joint) {
  if (joint >= pelt_joint_count(scene, character)) return nullptr;
  return scene->GroomOf(character)->joint_names[joint].c_str();
}

uint32_t pelt_strand_count(const PeltScene* scene, uint32_t layer) {
  return layer < pelt_layer_count(scene) ? scene->scene->StrandCount(layer) : 0;
}

uint32_t pelt_strand_places(const PeltScene* scene, uint32_t layer) {
  return layer < pelt_layer_count(scene) ? scene->scene->StrandPlaces(layer) : 0;
}

uint32_t pelt_layer_character(const PeltScene* scene, uint32_t layer) {
  return layer < pelt_layer_count(scene) ? scene->scene->shape().layer_character[layer]
                                         : UINT32_MAX;
}

float pelt_unit_scale(const PeltScene* scene, uint32_t character) {
  const pelt::Groom* groom = scene ? scene->GroomOf(character) : nullptr;
  return groom ? groom->unit_scale : 0.0f;
}

const char* pelt_set_joint(PeltScene* scene, uint32_t character, uint32_t joint,
                           const PeltJoint* local) {
  if (!scene) return kNoScene;
  if (!local) return "the joint's transform is null";
  if (joint >= pelt_joint_count(scene, character)) return "there is no such joint";
  const pelt::BetweenFrames between(scene->Phase());
  if (between.fault()) return between.fault();
  pelt::JointTransform transform;
  Copy(local->translation, transform.translation);
  Copy(local->rotation, transform.rotation);
  Copy(local->scale, transform.scale);
  pelt::SetJoint(scene->scene->Pose(character), joint, transform);
  return nullptr;
}

const char* pelt_place(PeltScene* scene, uint32_t character, const float root[12], int teleported) {
  if (!scene) return kNoScene;
  if (!root) return "the placement is null";
  if (!scene->GroomOf(character)) return "there is no such character";
  const pelt::BetweenFrames between(scene->Phase());
  if (between.fault()) return between.fault();
  pelt::PoseBlock& pose = scene->scene->Pose(character);
  std::copy_n(root, 12, pose.root);
  pose.teleported = teleported != 0;
  return nullptr;
}

const char* pelt_set_joint_velocity(PeltScene* scene, uint32_t character, uint32_t joint,
                                    const PeltJointVelocity* velocity) {
  if (!scene) return kNoScene;
  if (!velocity) return "the joint's velocity is null";
  if (joint >= pelt_joint_count(scene, character)) return "there is no such joint";
  const pelt::BetweenFrames between(scene->Phase());
  if (between.fault()) return between.fault();
  pelt::PoseRateBlock* rates = RatesOf(*scene, character);
  if (!rates) return kNoRates;
  for (int c = 0; c < 3; ++c) {
    rates->translation[c][joint] = velocity->translation[c];
    rates->spin[c][joint] = velocity->spin[c];
    rates->scale[c][joint] = velocity->scale[c];
  }
  return nullptr;
}

const char* pelt_place_velocity(PeltScene* scene, uint32_t character, const float root[12]) {
  if (!scene) return kNoScene;
  if (!root) return "the placement's velocity is null";
  if (!scene->GroomOf(character)) return "there is no such character";
  const pelt::BetweenFrames between(scene->Phase());
  if (between.fault()) return between.fault();
  pelt::PoseRateBlock* rates = RatesOf(*scene, character);
  if (!rates) return kNoRates;
  std::copy_n(root, 12, rates->root);
  return nullptr;
}

const char* pelt_set_origin(PeltScene* scene, uint32_t character, const double origin[3]) {
  if (!scene) return kNoScene;
  if (!origin) return "the origin is null";
  if (!scene->GroomOf(character)) return "there is no such character";
  double* const to = scene->scene->Origin(character);
  if (!to) return "the scene was made without origins";
  const pelt::BetweenFrames between(scene->Phase());
  if (between.fault()) return between.fault();
  std::copy_n(origin, 3, to);
  return nullptr;
}

const char* pelt_begin(PeltScene* scene, const PeltFrame* frame) {
  if (!scene) return kNoScene;
  if (!frame) return "the frame is null";
  pelt::FrameInput input;
  {
    const pelt::BetweenFrames between(scene->Phase());
    if (between.fault()) return between.fault();
    if (const char* fault =
            pelt::c_frame::Translate(*frame, scene->scene->shape(), scene->weather, input))
      return fault;
    for (uint32_t c = 0; c < scene->has_rates.size(); ++c)
      if (pelt::PoseRateBlock* rates = scene->scene->PoseRates(c))
        if (!scene->has_rates[c]) rates->given = 0;
  }
  if (const char* fault = scene->scene->BeginFrame(input)) return fault;
  std::fill(scene->has_rates.begin(), scene->has_rates.end(), uint8_t{0});
  return nullptr;
}

const char* pelt_refused_pose(PeltScene* scene, uint32_t character) {
  if (!scene) return kNoScene;
  for (const pelt::RefusedPose& refused : scene->scene->RefusedPoses())
    if (refused.character == character)
      return (scene->text = pelt::DescribeRefusedPose(refused)).c_str();
  return nullptr;
}

const char* pelt_note(PeltScene* scene) { return scene ? scene->scene->NextNote() : kNoScene; }

const char* pelt_run(PeltScene* scene, const PeltDoor* door) {
  if (!scene) return kNoScene;
  const pelt::Frame frame = scene->scene->CurrentFrame();
  if (!door) return pelt::SerialExecutor().Run(frame);
  if (const char* fault = pelt::FindDoorFault(*door)) return fault;
  // Ours before the executor is touched: another thread's frame may be running in it.
  if (const char* fault = frame.phase->StartRun()) return fault;
  if (!scene->executor || !SameDoor(scene->door, *door))
    scene->executor.emplace(scene->door = *door);
  scene->executor->Run({frame.plan, frame.memory});
  frame.phase->EndRun();
  return nullptr;
}

const char* pelt_door_faults(PeltScene* scene) {
  if (!scene) return kNoScene;
  if (!scene->executor || !scene->executor->faults().Any()) return nullptr;
  return (scene->text = scene->executor->faults().Text()).c_str();
}

const char* pelt_open(PeltScene* scene) {
  if (!scene) return kNoScene;
  const char* why = "another frame is open";
  return scene->pull.Begin(scene->scene->CurrentFrame(), &why) ? nullptr : why;
}

int pelt_pull(PeltScene* scene) { return pelt_pull_as(scene, 0); }

int pelt_pull_as(PeltScene* scene, uint32_t worker) {
  return scene ? int(scene->pull.TryRun(worker)) : PELT_IDLE;
}

uint64_t pelt_snapshot_bytes(const PeltScene* scene) {
  return scene ? scene->scene->SnapshotBytes() : 0;
}

const char* pelt_snapshot(PeltScene* scene, void* to, size_t room) {
  if (!scene) return kNoScene;
  if (!to) return "the snapshot's place is null";
  return scene->scene->Snapshot({static_cast<std::byte*>(to), room});
}

const char* pelt_restore(PeltScene* scene, const void* from, size_t bytes) {
  if (!scene) return kNoScene;
  if (!from) return "the snapshot is null";
  if (const char* fault = scene->scene->Restore({static_cast<const std::byte*>(from), bytes}))
    return fault;
  std::fill(scene->has_rates.begin(), scene->has_rates.end(), uint8_t{0});
  return nullptr;
}

uint32_t pelt_draws(PeltScene* scene, PeltDraw* draws, uint32_t room) {
  if (!scene) return 0;
  const std::span<const pelt::LayerDraw> all = scene->scene->Draws();
  for (size_t i = 0; draws && i < all.size() && i < room; ++i) {
    const pelt::LayerDraw& from = all[i];
    const pelt::OutputEntry& format = from.format();
    PeltDraw& to = draws[i];
    to = {.layer = from.layer,
          .output = uint32_t(from.output),
          .output_name = format.name.data(),
          .vertices = from.vertices.data(),
          .vertices_bytes = from.vertices.size(),
          .vertex_bytes = format.vertex_bytes,
          .vertices_per_strand = format.vertices_per_strand,
          .strand_count = from.strand_count,
          .order = from.order.data(),
          .live_strands = from.live_strands,
          .low = {},
          .high = {},
          .tip_width = from.tip_width,
          .pieces = from.pieces,
          .looks = reinterpret_cast<const PeltLook*>(from.looks.data()),
          .look_count = uint32_t(from.looks.size()),
          .light = reinterpret_cast<const PeltLayerLight*>(from.light),
          .shells = reinterpret_cast<const PeltShell*>(from.shells.shell.data()),
          .shell_count = uint32_t(from.shells.shell.size()),
          .texture_repeat = from.shells.texture_repeat,
          .fur_shadow = from.shells.shadow,
          .wet_darken = from.wet_darken,
          .mud_colour = {},
          .origin = {},
          .look = reinterpret_cast<const PeltLayerLook*>(from.look)};
    Copy(from.low, to.low);
    Copy(from.high, to.high);
    Copy(from.mud_colour, to.mud_colour);
    std::copy_n(from.origin, 3, to.origin);
  }
  return uint32_t(all.size());
}

uint32_t pelt_copy_curves(PeltScene* scene, uint32_t layer, PeltStrandCurve* curves,
                          uint32_t room) {
  if (!scene || !curves) return 0;
  return scene->scene->CopyCurves(layer, {reinterpret_cast<pelt::StrandCurve*>(curves), room});
}

uint32_t pelt_shadow_places(PeltScene* scene, uint32_t layer, uint32_t* places, uint32_t room) {
  return scene ? scene->scene->ShadowPlaces(layer, {places, places ? room : 0}) : 0;
}

uint32_t pelt_ribbon_indices(const uint32_t* order, uint32_t strand_count, uint32_t* indices,
                             uint32_t room) {
  if (!indices) return 0;
  const uint64_t wanted = uint64_t(strand_count) * pelt::kRibbonIndicesPerHair;
  const std::span<uint32_t> all(indices, size_t(std::min<uint64_t>(wanted, room)));
  if (order) return pelt::WriteSortedRibbonIndices({order, strand_count}, 0, all);
  pelt::WriteRibbonIndices(all);
  return uint32_t(all.size() / pelt::kRibbonIndicesPerHair * pelt::kRibbonIndicesPerHair);
}

uint32_t pelt_shell_indices(const PeltScene* scene, uint32_t layer, uint32_t* indices,
                            uint32_t room) {
  if (!scene) return 0;
  const pelt::ShellDraw shells = pelt::FindShells(scene->scene->memory(), layer);
  return pelt::WriteShellIndices(shells, {indices, indices ? room : 0});
}

uint32_t pelt_shell_uvs(const PeltScene* scene, uint32_t layer, float (*uvs)[2], uint32_t room) {
  if (!scene) return 0;
  uint32_t count = 0;
  for (const pelt::ShellSkinBlock& skin : pelt::FindShells(scene->scene->memory(), layer).skin)
    for (const auto& uv : skin.uv) {
      if (uvs && count < room) std::copy_n(uv, 2, uvs[count]);
      ++count;
    }
  return count;
}

uint32_t pelt_fins(PeltScene* scene, uint32_t layer, PeltFin* fins, uint32_t room) {
  if (!scene) return 0;
  for (const pelt::LayerDraw& draw : scene->scene->Draws())
    if (draw.layer == layer)
      return pelt::WriteFins(draw.shells, {reinterpret_cast<pelt::Fin*>(fins), fins ? room : 0});
  return 0;
}

uint32_t pelt_fur_texture(const PeltScene* scene, uint32_t layer, uint8_t* texels, size_t room) {
  uint32_t side = 0;
  if (!scene) return side;
  const std::vector<uint8_t> all = scene->scene->FurTexture(layer, side);
  if (texels) std::copy_n(all.begin(), std::min(room, all.size()), texels);
  return side;
}

int pelt_strand_texture(const PeltScene* scene, uint32_t layer, PeltStrandTexture* texture) {
  if (!scene || !texture || layer >= scene->scene->shape().layer_count) return 0;
  const pelt::StrandTexture* from = scene->scene->StrandTextureOf(layer).get();
  if (!from) return 0;
  *texture = {from->width, from->height, from->strips, uint32_t(from->channels), from->rgba.data()};
  return 1;
}

uint64_t pelt_digest(const PeltScene* scene) { return scene ? scene->scene->DigestFrame() : 0; }
