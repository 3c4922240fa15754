// A scene of furry characters: memory, state and plan for any number of frames.
//
//   auto made = FurScene::Create(grooms, options, memory);   // a scene, or the reason as a text
//   FurScene& scene = **made;
//   ... fill scene.Pose(c) ...
//   scene.BeginFrame(input);                                 // the caller's thread
//   executor.Run(scene.CurrentFrame());                      // any executor, the same bits
//   for (const LayerDraw& draw : scene.Draws()) ...          // what there is to draw
//
// Invariant: after construction nothing allocates. BeginFrame refuses input that is not finite and
// leaves the scene as it was; state never becomes non-finite. Calls out of order (a frame begun
// twice, run twice, or begun while it runs) are refused too, on any thread, and change nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "core/frame_input.hpp"
#include "core/groom/groom.hpp"
#include "core/isa.hpp"
#include "core/streams.hpp"
#include "jobs/carried_state.hpp"
#include "jobs/colliders.hpp"
#include "jobs/draws.hpp"
#include "jobs/frame.hpp"
#include "jobs/lod_budget.hpp"
#include "jobs/origins.hpp"
#include "jobs/pose_gate.hpp"
#include "traces/digest.hpp"

namespace pelt {

enum class Air : uint8_t;
class ModalCourse;
struct FrameParams;
struct FrameTable;
struct ScreenQuality;
struct SelectLodParams;

struct SceneOptions {
  Isa isa = BestIsa();
  PlanOptions plan{.must_fit = false};  // true for a scene that runs in a local store
  VertexOrder vertex_order = VertexOrder::kSorted;
  // Layers of more chunks than this sort in pieces, over many chunks; 0: those whose sort must fit
  // a local store and does not.
  uint32_t piecewise_sort_chunks = 0;
  // Poses may come with velocities (FurScene::PoseRates); layers with the modal solver take them.
  bool velocities = false;
  // Each character has an origin of its own (FurScene::Origin), which its pose, its state and what
  // is drawn of it are relative to: as fine 10 km away as at the world's.
  bool origins = false;
  // What the scene's block may have. A scene that needs more is refused when it is measured, with
  // the largest ranges and what would help. 0: no budget.
  uint64_t memory_budget_bytes = 0;
  // The most of FrameInput::strands, for which there is room outside the block.
  uint32_t strand_writes = 0;
  // Characters are meant to be of any size beside their groom's: no note of it (NextNote).
  bool any_scale = false;
};

// One named piece of a scene's memory.
struct MemoryRange {
  std::string_view name;
  uint64_t bytes;
  uint32_t blocks;
  Role role;
  friend bool operator==(const MemoryRange&, const MemoryRange&) = default;
};

struct SceneLayout {
  SceneShape shape;
  // One for each stream, in stream order, back to back; empty streams have 0 bytes.
  std::vector<MemoryRange> ranges;
  uint64_t total_bytes = 0;  // what the caller's block must hold, aligned to kBlockAlignment
  uint64_t strand_count = 0;
  // Bytes of simulation state (present and last points of every chain) for a strand.
  double StateBytesPerStrand() const;
  friend bool operator==(const SceneLayout&, const SceneLayout&) = default;
};

// Layout of a scene of these grooms, one for each character (a groom may serve several). Fails when
// one holds what no groom file may (FindGroomFault), when they do not fit together (no strands, too
// many layers) or the scene is over its budget. FurScene::Create measures for itself.
Result<SceneLayout> MeasureScene(std::span<const Groom* const> grooms, const SceneOptions& options);

// How a block of `budget_bytes` falls short of the layout: by how much, the largest ranges, and
// what would help. Empty when it does not.
std::string FindBudgetFault(const SceneLayout& layout, uint64_t budget_bytes);

// A table of the ranges: name, blocks, bytes, role; the sum, and bytes per strand.
std::string DescribeMemory(const SceneLayout& layout);

// A block of memory for a scene, for callers without an allocator of their own.
class SceneBlock {
 public:
  explicit SceneBlock(uint64_t bytes);
  std::span<std::byte> bytes() { return {memory_.get(), size_t(bytes_)}; }

 private:
  struct Delete {
    void operator()(std::byte* block) const;
  };
  std::unique_ptr<std::byte, Delete> memory_;
  uint64_t bytes_;
};

// Where a scene's one block comes from. With nothing said, the scene has a SceneBlock of its own.
struct SceneMemory {
  // The caller's, aligned to kBlockAlignment; the scene takes what it needs from its front.
  std::span<std::byte> block = {};
  // Or: asked once, for exactly the bytes the scene needs. Null is a refusal.
  std::byte* (*allocate)(uint64_t bytes, void* user) = nullptr;
  void* user = nullptr;
};

class FurScene {
 public:
  // Grooms are copied into the scene's block, which must outlive it. Fails as MeasureScene does,
  // and when the memory is too small or not aligned, there are no kernels of the instruction set,
  // or the plan cannot be made.
  static Result<std::unique_ptr<FurScene>> Create(std::span<const Groom* const> grooms,
                                                  const SceneOptions& options = {},
                                                  const SceneMemory& memory = {});
  FurScene(const FurScene&) = delete;
  FurScene& operator=(const FurScene&) = delete;
  ~FurScene();

  // To be filled before every BeginFrame, and not from there to the end of Run: the frame reads it.
  PoseBlock& Pose(uint32_t character) { return *memory_.Of<&Streams::pose>(character); }

  // How fast the pose's joints move, beside it: see PoseRateBlock. Null, unless the scene was made
  // with SceneOptions::velocities and some layer has the modal solver. With `given` 0, as it is at
  // first, the frame is what it would be without. Frames with and without may follow each other.
  PoseRateBlock* PoseRates(uint32_t character) {
    return memory_.Of<&Streams::pose_rates>(character);
  }

  // What the pose is relative to, world, m; three of them, 0 at first. To be moved with the
  // character, in every frame or now and then: what it moved by is part of the character's motion.
  // Velocities (PoseRates) are the world's all the same. Null, unless the scene was made with
  // SceneOptions::origins.
  double* Origin(uint32_t character) {
    return given_origins_.empty() ? nullptr : &given_origins_[3 * size_t(character)];
  }

  // What the places of a layer are relative to in the last frame begun, world, m: as LayerDraw has it.
  std::array<double, 3> OriginOfLayer(uint32_t layer) const {
    if (origins_.empty()) return {};
    return std::to_array(origins_[layout_.shape.layer_character[layer]].used);
  }

  // Fills every parameter of the frame, which must then be run, once. Returns null, or the reason
  // the frame must not run: what is not finite or out of range, and where; or that the last frame
  // was begun and not run, or is running. The scene is then as it was. The text lives until the
  // next call.
  //
  // A pose that cannot be used stops only its own character: see RefusedPoses.
  //
  // A frame of dt_s 0 is a pause: nothing moves and nothing is forgotten, poses, weather, obstacles,
  // lights, brushes, level of detail and lists of layers and strands are not looked at, and the frame
  // after it is what it would have been without. Only the view counts: what was visible is sorted and
  // written for it. As a scene's first frame it lays the fur on its groom.
  const char* BeginFrame(const FrameInput& input);

  // The poses that the last BeginFrame did not use, one for each such character, and why
  // (jobs/pose_gate.hpp): those characters keep their last accepted pose. Empty in good frames.
  std::span<const RefusedPose> RefusedPoses() const {
    return memory_.paused ? std::span<const RefusedPose>() : pose_gate_.refused();
  }

  // What looks like a mistake in frames that were begun and is computed all the same: that a character
  // is placed over 10 times larger or smaller than its groom was baked for, as one is whose placement
  // forgets the groom's unit_scale. Reported once for each character; null: nothing more. The text lives
  // until the next call.
  const char* NextNote();

  // Takes over the other scene's state, as it is between two frames: from here on both give the
  // same bits for the same input. For going back to an earlier frame, or trying one out. False, and
  // nothing done, when the other is not of the same grooms and options that shape its memory, or
  // one of the two is not between two frames; the reason, a literal, in `why`.
  bool CopyStateFrom(const FurScene& other, const char** why = nullptr);

  // The same as bytes (jobs/scene_snapshot.cpp): state and nothing else, the same on every machine, to
  // be kept, sent, or put back here or in another scene of the same grooms. Always SnapshotBytes() of
  // them, of which `to` must have room; nothing allocates. Null, or why it was not done: a literal.
  uint64_t SnapshotBytes() const { return snapshot_bytes_; }
  const char* Snapshot(std::span<std::byte> to) const;
  // From here on the scene gives the bits of the one that the snapshot is of, for the same input.
  // There is nothing to draw until its next frame, a pause will do, has run. Null; or why the bytes
  // are not of such a scene, or damaged, and then nothing has changed.
  const char* Restore(std::span<const std::byte> from);

  // Goes on with other grooms from the state that there is: for a setup that is tuned, or a groom that
  // is loaded again, while fur moves. False, and nothing done, when the scene is not between two
  // frames, or they are not of the same skeletons, layers, kinds and chunks, with every strand at
  // its place on the skin: a scene of other strands is to be made anew. The reason, a literal, in `why`.
  bool ReplaceGrooms(std::span<const Groom* const> grooms, const char** why = nullptr);

  // For any executor, once for each BeginFrame.
  Frame CurrentFrame() const { return {&plan_, &memory_, nullptr, &phase_}; }

  const Plan& plan() const { return plan_; }
  const FrameMemory& memory() const { return memory_; }
  const SceneLayout& layout() const { return layout_; }
  const SceneShape& shape() const { return layout_.shape; }
  // What the scene holds outside the caller's block (plan, tables, names): taken when it is made,
  // unchanged by frames.
  uint64_t HeapBytes() const;
  std::string_view LayerName(uint32_t layer) const { return layer_names_[layer]; }
  // The most that a draw of the layer can have, as long as the scene lives; 0 of shells.
  uint32_t StrandCount(uint32_t layer) const {
    return layer_params_[layer].output == Output::kShells ? 0 : layer_strands_[layer];
  }

  // A layer's strands have numbers below it; what FrameInput::cut has of each layer.
  uint32_t StrandPlaces(uint32_t layer) const {
    return shape().LayerChunks(layer) * kStrandsPerChunk;
  }

  float ShadowShare(uint32_t layer) const { return layer_params_[layer].shadow_share; }
  // How the layer takes light, as long as the scene lives; another groom's may be another.
  const LayerLook& Look(uint32_t layer) const { return layer_params_[layer].look; }

  // The artist's texture of the layer's strands, which is its groom's; null: none.
  const std::shared_ptr<const StrandTexture>& StrandTextureOf(uint32_t layer) const {
    return strand_textures_[layer];
  }

  // What to draw of the last frame that was run, in drawing order: jobs/draws.hpp. Empty while a
  // frame is begun or runs. The list is the scene's, and good until the next call.
  std::span<const LayerDraw> Draws() const;
  // The points of a layer's living strands, as many as `out` has room for, in strand order. Returns
  // how many were written: none of a layer that is not in Draws().
  uint32_t CopyCurves(uint32_t layer, std::span<StrandCurve> out) const;

  // What a shadow pass draws of the layer, whose setup says `shadow_share`: places of strands in
  // LayerDraw::vertices, in drawing order, each to be as many times wider as there are fewer than
  // LayerDraw::strand_count. Returns how many there are, none of a layer that is not in Draws(), and
  // writes those there is room for.
  uint32_t ShadowPlaces(uint32_t layer, std::span<uint32_t> places) const;

  // The texture that a layer's shells are cut from: texels of one byte, `side` in each row; empty for
  // other layers. The same whenever it is asked for: once, when the scene is made.
  std::vector<uint8_t> FurTexture(uint32_t layer, uint32_t& side) const;

  // Lanes of the block of `item` that hold values of the last frame run.
  uint32_t LiveLanes(Stream stream, uint32_t item) const { return memory_.LiveLanes(stream, item); }
  uint64_t DigestStream(Stream stream) const { return pelt::DigestStream(memory_, stream); }
  // Of all value streams: what `pelt verify` compares.
  uint64_t DigestFrame() const { return pelt::DigestFrame(memory_); }

  uint32_t LiveStrands() const;   // over all visible layers
  uint32_t DrawnStrands() const;  // of those, in front of the camera's back-face test
  // Of a layer with the modal solver, after a frame: the quality that ran, and how wrong that may look
  // from where the frame's camera is (core/modal/modal_quality.hpp).
  ScreenQuality QualityOf(uint32_t layer) const;
  // What LodSettings::budget_us made of the last frame.
  const LodBudget& budget() const { return budget_; }

 private:
  FurScene(const SceneOptions& options, SceneLayout layout);
  float LongestOnScreenPx(uint32_t layer) const;  // of its strands
  // Both return why not; empty when it is done.
  std::string TakeMemory(const SceneMemory& memory, std::span<std::byte>& block);
  std::string MakePlan(const FrameTable& kernels);
  void Place(std::span<std::byte> memory);
  struct GroomCopy;
  void CopyGrooms(std::span<const Groom* const> grooms);
  void CopyLayer(GroomCopy& copy, const GroomLayer& layer, uint32_t index);
  bool CopyPatch(GroomCopy& copy, const GroomLayer& layer, uint32_t from, uint32_t to);
  bool CopyChunk(GroomCopy& copy, const GroomLayer& layer, uint32_t from, uint32_t to);
  template <class Rest>
  bool CopyRest(const Rest& from, uint32_t layer, bool chains, bool drawn, Rest& to);
  bool HasRootsOf(std::span<const Groom* const> grooms) const;
  void FillFrame(const FrameInput& input);
  void FillPausedFrame(const FrameInput& input);
  // Of set `s` of parameters, for an input that is relative to its characters' origin.
  bool FillLights(uint32_t s, const FrameInput& input);
  void FillParams(uint32_t s, const FrameInput& given, const FrameInput& input, Air air,
                  float budget_scale);
  float StrandScale(const LodSettings& lod) const;
  static float ImportanceOf(uint32_t layer, const FrameInput& input) {
    return input.importance.empty() ? 1.0f : input.importance[layer];
  }
  bool FillView(uint32_t s, const FrameInput& input, const SelectLodParams& lod);
  void FillLayers(const FrameInput& input, Air air);
  bool IsPushed(uint32_t layer) const;
  ModalQuality LayerQuality(uint32_t layer, const FrameInput& input) const;
  View LayerView(uint32_t layer, const FrameInput& input) const;
  void FindBudget(const FrameInput& input);
  // Calls fill(s, input) for each set, with the input relative to the set's origin.
  void ForEachSet(const FrameInput& input, auto&& fill);
  View ViewFrom(uint32_t s, const FrameInput& input) const;
  // Of the strand, which is there.
  uint32_t ChunkOf(const StrandWrite& write) const {
    return shape().layer_first_chunk[write.layer] + write.strand / kStrandsPerChunk;
  }
  const StrandBlock* BlockOf(const StrandWrite& write) const;
  const char* FindStrandFault(const FrameInput& input);
  void CutStrands(std::span<const uint8_t> cut);
  void WriteStrands(std::span<const StrandWrite> writes);
  void FillOrigins();
  void FillScales();
  void MeasureSnapshot(std::span<const Groom* const> grooms);
  // Calls list(value) for every value of the state that is not in streams.
  static void ListState(auto& io, auto& self);
  uint32_t SaveBlock(const CarriedBlock& block, std::byte* to) const;
  void LoadBlock(const CarriedBlock& block, const std::byte* from);
  const char* FindSnapshotFault(std::span<const std::byte> from) const;
  const char* FindStateFault(std::span<const std::byte> from) const;
  uint32_t SwitchesOf(const SkipSettings& skip) const;
  // Which of them a layer's items take.
  uint32_t SetOf(uint32_t layer) const {
    return origins_.empty() ? 0 : layout_.shape.layer_character[layer];
  }

  SceneOptions options_;
  SceneLayout layout_;
  std::optional<SceneBlock> own_block_;
  FrameMemory memory_;
  std::vector<FrameParams>
      params_;                     // one for all characters, or, where they have origins, for each
  std::vector<uint8_t> relights_;  // of each, in this frame: every lit layer is lit again
  std::vector<uint8_t> force_changes_;     // of each: force volumes are not where they were
  std::vector<ColliderCourse> colliders_;  // of each
  std::vector<double> given_origins_;      // of characters, three each; empty: they have none
  std::vector<CharacterOrigin> origins_;   // likewise
  std::vector<float> scales_;              // of each character, over its groom's
  std::vector<float> scale_notes_;         // of each: the scale to report; 0: none; below: reported
  Plan plan_;
  std::vector<std::string> layer_names_;
  std::vector<LayerParams> layer_params_;
  std::vector<std::shared_ptr<const StrandTexture>> strand_textures_;  // of every layer
  std::vector<ModalCourse> modal_;  // of every layer; used by those with the modal solver
  std::vector<float> layer_length_max_;
  std::vector<uint32_t> layer_strands_, layer_vertices_;
  std::vector<uint8_t> layer_simulates_;
  std::vector<uint8_t> layer_curled_;            // some chain rests bent
  bool is_cut_ = false;                          // some strand may be cut off
  std::vector<StrandWrite> written_, replaced_;  // in the last frame; what the groom has there
  PoseGate pose_gate_;
  mutable FramePhase phase_;  // of a frame that runs through CurrentFrame
  bool first_frame_ = true;
  double last_dt_s_ = 0.0;  // 0: there was no frame
  bool restored_ = false;   // since the last frame: what follows from the state is not there
  CarriedState carried_;
  uint64_t snapshot_bytes_ = 0, value_words_ = 0, strands_digest_ = 0;
  uint32_t state_layout_ = 0;
  std::vector<LayerDemand> demands_;  // of each layer
  std::vector<uint32_t> demand_order_;
  LodBudget budget_;  // of the last frame
  mutable std::vector<LayerDraw> draws_;
  std::string fault_;
};

}  // namespace pelt
