#include "jobs/scene.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <new>
#include <utility>

#include "core/float_environment.hpp"
#include "core/float_rules.hpp"
#include "core/format.hpp"
#include "core/groom/patch_index.hpp"
#include "core/kernels/frame_params.hpp"
#include "core/kernels/frame_table.hpp"
#include "core/layer_block.hpp"
#include "core/outputs.hpp"
#include "jobs/input_check.hpp"

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace pelt {
namespace {

constexpr size_t kPageBytes = size_t(2) << 20;  // a huge page

}  // namespace

SceneBlock::SceneBlock(uint64_t bytes)
    : memory_(static_cast<std::byte*>(::operator new(bytes, std::align_val_t(kPageBytes)))),
      bytes_(bytes) {
#if defined(__linux__)
  // A frame walks through tens of megabytes once: with small pages it waits for address
  // translation. Advice only; the bits and the caller's own memory do not depend on it.
  if (bytes >= kPageBytes) ::madvise(memory_.get(), bytes, MADV_HUGEPAGE);
#endif
}

void SceneBlock::Delete::operator()(std::byte* block) const {
  ::operator delete(block, std::align_val_t(kPageBytes));
}

Result<std::unique_ptr<FurScene>> FurScene::Create(std::span<const Groom* const> grooms,
                                                   const SceneOptions& options,
                                                   const SceneMemory& memory) {
  const FloatEnvironment guard;
  Result<SceneLayout> layout = MeasureScene(grooms, options);
  if (!layout) return Failure{layout.error()};
  const FrameTable* kernels = FindKernels(options.isa);
  if (!kernels)
    return Failure{Format("this processor or build has no {} kernels", IsaName(options.isa))};
  std::unique_ptr<FurScene> scene(new FurScene(options, *std::move(layout)));
  std::string fault = scene->MakePlan(*kernels);
  if (!fault.empty()) return Failure{std::move(fault)};
  std::span<std::byte> block;
  fault = scene->TakeMemory(memory, block);
  if (!fault.empty()) return Failure{std::move(fault)};
  scene->Place(block);
  scene->CopyGrooms(grooms);
  scene->pose_gate_ = PoseGate(grooms, *kernels);
  scene->memory_.held[size_t(Domain::kCharacter)] = scene->pose_gate_.holds_pose();
  scene->MeasureSnapshot(grooms);
  return scene;
}

FurScene::FurScene(const SceneOptions& options, SceneLayout layout)
    : options_(options),
      layout_(std::move(layout)),
      params_(options.origins ? layout_.shape.character_count : 1),
      relights_(params_.size(), 0),
      force_changes_(params_.size(), 0),
      colliders_(params_.size()),
      given_origins_(options.origins ? 3 * size_t(layout_.shape.character_count) : 0),
      origins_(options.origins ? layout_.shape.character_count : 0),
      scales_(layout_.shape.character_count, 1.0f),
      scale_notes_(layout_.shape.character_count, 0.0f) {
  draws_.reserve(layout_.shape.layer_count);
  written_.reserve(options.strand_writes);
  replaced_.reserve(options.strand_writes);
  fault_.reserve(256);
}

FurScene::~FurScene() = default;

std::string FurScene::MakePlan(const FrameTable& kernels) {
  Result<Plan> plan = CompilePlan(MakeStages(kernels, params_[0], options_.vertex_order),
                                  layout_.shape, options_.plan);
  if (!plan) return plan.error();
  plan_ = *std::move(plan);
  return {};
}

std::string FurScene::TakeMemory(const SceneMemory& memory, std::span<std::byte>& block) {
  const uint64_t needed = layout_.total_bytes;
  block = memory.block;
  if (memory.allocate) {
    std::byte* const given = memory.allocate(needed, memory.user);
    if (!given) return Format("the scene needs {} bytes, and its allocator gave none", needed);
    block = {given, size_t(needed)};
  } else if (block.empty()) {
    block = own_block_.emplace(needed).bytes();
  }
  if (block.size() < needed)
    return Format("the scene needs {} bytes and was given {}", needed, block.size());
  if (reinterpret_cast<uintptr_t>(block.data()) % kBlockAlignment != 0)
    return Format("the scene's memory must be aligned to {} bytes", kBlockAlignment);
  return {};
}

void FurScene::Place(std::span<std::byte> memory) {
  std::memset(memory.data(), 0, layout_.total_bytes);
  memory_ = PlaceStreams(TableOf<Streams>(), layout_.shape, memory.data());
  if (options_.vertex_order == VertexOrder::kIndexBuffer) memory_.marks = kInStrandOrder;
  if (options_.origins) memory_.params_step = sizeof(FrameParams);
}

namespace {

bool SameBytes(const auto& a, const auto& b) { return std::memcmp(&a, &b, sizeof(a)) == 0; }

// With what lies between members, so that they compare. Says whether something changed.
template <class Block>
bool Put(Block& to, const Block& from) {
  static_assert(std::is_trivially_copyable_v<Block>);
  const bool changed = !SameBytes(to, from);
  std::memcpy(&to, &from, sizeof(to));
  return changed;
}

}  // namespace

// Blocks of one character's groom on their way into the streams.
struct FurScene::GroomCopy {
  // Of a list that not every patch or chunk has a block in, one after the other.
  template <class Block>
  class Taken {
   public:
    explicit Taken(const std::vector<Block>& blocks) : next_(blocks.data()) {}
    const Block& Next() { return *next_++; }

   private:
    const Block* next_;
  };

  explicit GroomCopy(const Groom& from)
      : groom(from),
        vertex_rest(from.vertex_rest),
        vertex_down(from.vertex_down),
        strand_down(from.strand_down),
        vertex_traits(from.vertex_traits),
        strand_traits(from.strand_traits),
        shell_skin(from.shell_skin),
        fin_edges(from.fin_edges) {}
  const Groom& groom;
  Taken<RestBlock<4>> vertex_rest;
  Taken<DownBlock> vertex_down, strand_down;
  Taken<TraitBlock> vertex_traits, strand_traits;
  Taken<ShellSkinBlock> shell_skin;
  Taken<FinEdgeBlock> fin_edges;
  uint32_t strand_rest[kMostStrandPoints + 1] = {};  // taken, by points
};

// No patch or chunk sleeps through it. Patches and chunks that changed are taken to have moved; those that get what
// they have are not, as their strands' clocks go on (modal_frame.hpp).
void FurScene::CopyGrooms(std::span<const Groom* const> grooms) {
  written_.clear();
  replaced_.clear();
  layer_names_.clear();
  layer_params_.clear();
  strand_textures_.clear();
  layer_length_max_.clear();
  layer_strands_.clear();
  layer_vertices_.clear();
  modal_.resize(shape().layer_count);
  demands_.resize(shape().layer_count);
  demand_order_.reserve(shape().layer_count);
  layer_simulates_.assign(shape().layer_count, 0);
  layer_curled_.assign(shape().layer_count, 0);
  uint32_t index = 0;
  for (uint32_t c = 0; c < grooms.size(); ++c) {
    GroomCopy copy(*grooms[c]);
    *memory_.Of<&Streams::skeleton>(c) = copy.groom.skeleton;
    for (size_t l = 0; l < copy.groom.layers.size(); ++l, ++index) {
      *memory_.Of<&Streams::layer_joints>(index) = copy.groom.layer_joints[l];
      CopyLayer(copy, copy.groom.layers[l], index);
    }
  }
  plan_.graph = BuildGraph(plan_, shape(), &memory_);  // lists of other grooms name other patches
}

void FurScene::CopyLayer(GroomCopy& copy, const GroomLayer& layer, uint32_t index) {
  layer_names_.push_back(layer.name);
  layer_params_.push_back(layer.params);
  strand_textures_.push_back(layer.strand_texture);
  layer_length_max_.push_back(layer.length_max);
  layer_strands_.push_back(layer.strand_count);
  layer_vertices_.push_back(0);
  for (uint32_t p = 0; p < layer.patch_count; ++p)
    layer_vertices_.back() += copy.groom.mesh[layer.first_patch + p].vertex_count;
  const bool shells = layer.params.output == Output::kShells;
  const bool changed = shells && Put(*memory_.Of<&Streams::shell_layers>(index),
                                     FillShellLayer(layer.params, layer.length_max));
  const PatchIndex patches = IndexPatches(copy.groom, layer);
  for (uint32_t i = 0; i < layer.patch_count; ++i) {
    const uint32_t patch = shape().layer_first_patch[index] + i;
    *memory_.Of<&Streams::patches>(patch) = patches.patches[i];
    if (auto* parents = memory_.Of<&Streams::chain_parents>(patch)) *parents = patches.parents[i];
    const bool moved = CopyPatch(copy, layer, layer.first_patch + i, patch) || changed;
    ChunkStateBlock& state = *memory_.Of<&Streams::patch_state>(patch);
    state.state_changed = 1;
    if (moved) state.moved = 1;
  }
  for (uint32_t i = 0; i < layer.chunk_count; ++i) {
    const uint32_t chunk = shape().layer_first_chunk[index] + i;
    if (auto* list = memory_.Of<&Streams::patch_list>(chunk)) *list = patches.chunks[i];
    const bool moved = CopyChunk(copy, layer, layer.first_chunk + i, chunk) || changed;
    ChunkStateBlock& state = *memory_.Of<&Streams::chunk_state>(chunk);
    state.state_changed = 1;
    if (moved) state.moved = 1;
  }
}

// `chains`: of those that are simulated; `drawn`: of what is drawn.
template <class Rest>
bool FurScene::CopyRest(const Rest& from, uint32_t layer, bool chains, bool drawn, Rest& to) {
  if (chains && !layer_curled_[layer]) layer_curled_[layer] = HasCurl(from);
  const auto is_above_0 = [](float strength) { return strength > 0.0f; };
  if (drawn && !layer_simulates_[layer])
    layer_simulates_[layer] =
        std::any_of(std::begin(from.strength), std::end(from.strength), is_above_0);
  return Put(to, from);
}

// Says whether something changed.
bool FurScene::CopyPatch(GroomCopy& copy, const GroomLayer& layer, uint32_t from, uint32_t to) {
  const bool shells = layer.params.output == Output::kShells;
  bool changed = Put(*memory_.Of<&Streams::mesh>(to), copy.groom.mesh[from]);
  if (layer.params.chain == ChainKind::kVertex) {
    changed |= CopyRest(copy.vertex_rest.Next(), shape().patch_layer[to], true, shells,
                        *memory_.Of<&Streams::vertex_rest>(to));
    if (layer.params.sag_free)
      changed |= Put(*memory_.Of<&Streams::vertex_down>(to), copy.vertex_down.Next());
    if (layer.params.traits)
      changed |= Put(*memory_.Of<&Streams::vertex_traits>(to), copy.vertex_traits.Next());
  }
  if (shells) changed |= Put(*memory_.Of<&Streams::shell_skin>(to), copy.shell_skin.Next());
  return changed;
}

bool FurScene::CopyChunk(GroomCopy& copy, const GroomLayer& layer, uint32_t from, uint32_t to) {
  const LayerParams& params = layer.params;
  const bool on_vertices = params.chain == ChainKind::kVertex;
  bool changed = Put(*memory_.Of<&Streams::strands>(to), copy.groom.strands[from]);
  changed |= Put(*memory_.Of<&Streams::halo>(to), copy.groom.halo[from]);
  if (params.fins) changed |= Put(*memory_.Of<&Streams::fin_edges>(to), copy.fin_edges.Next());
  if (params.output == Output::kShells) return changed;
  if (params.lit) changed |= Put(*memory_.Of<&Streams::strand_uv>(to), copy.groom.strand_uv[from]);
  WithPoints(params.points, [&]<uint32_t kPoints> {
    changed |= CopyRest(StrandRestOf<kPoints>(copy.groom)[copy.strand_rest[kPoints]++],
                        shape().chunk_layer[to], !on_vertices, true,
                        *memory_.Of<ChainStreams<kPoints, false>::kRest>(to));
  });
  if (params.sag_free && !on_vertices)
    changed |= Put(*memory_.Of<&Streams::strand_down>(to), copy.strand_down.Next());
  if (params.traits)
    changed |= Put(*memory_.Of<&Streams::strand_traits>(to), copy.strand_traits.Next());
  return changed;
}

const char* FurScene::BeginFrame(const FrameInput& input) {
  const FloatEnvironment guard;  // parameters are part of the bits
  if (const char* fault = phase_.StartFilling()) return fault;
  const char* fault = FindInputFault(input, shape(), pose_gate_, fault_);
  if (!fault) fault = FindStrandFault(input);
  if (!fault) FillFrame(input);
  phase_.EndFilling(!fault);
  return fault;
}

const char* FurScene::NextNote() {
  const auto next =
      std::find_if(scale_notes_.begin(), scale_notes_.end(), [](float s) { return s > 0.0f; });
  if (next == scale_notes_.end()) return nullptr;
  const float scale = std::exchange(*next, -1.0f);
  const auto character = uint32_t(next - scale_notes_.begin());
  fault_.clear();
  FormatTo(
      fault_,
      "character {} is placed {:.3g} times {} than its groom was baked for: a placement of its "
      "own size has the groom's unit_scale, {:.6g}, as scale. If it is meant: any_scale",
      character, scale > 1.0f ? scale : 1.0f / scale, scale > 1.0f ? "larger" : "smaller",
      pose_gate_.UnitScale(character));
  return fault_.c_str();
}

namespace {

// What a call says that does not do what it was asked for.
bool Refuse(const char* fault, const char** why) {
  if (why) *why = fault;
  return false;
}

}  // namespace

bool FurScene::CopyStateFrom(const FurScene& other, const char** why) {
  const BetweenFrames between(phase_);
  if (between.fault()) return Refuse(between.fault(), why);
  if (this == &other) return true;
  const BetweenFrames other_between(other.phase_);
  if (other_between.fault()) return Refuse(other_between.fault(), why);
  const SceneShape &mine = layout_.shape, &its = other.layout_.shape;
  if (layout_.total_bytes != other.layout_.total_bytes ||
      options_.strand_writes != other.options_.strand_writes ||
      mine.layer_character != its.layer_character ||
      mine.layer_first_patch != its.layer_first_patch ||
      mine.layer_first_chunk != its.layer_first_chunk || mine.layer_kind != its.layer_kind)
    return Refuse("the other scene is of other grooms, or of options that shape memory otherwise",
                  why);
  // Ranges lie back to back from the first stream on, in the same places of both blocks.
  std::memcpy(memory_.streams[0].base, other.memory_.streams[0].base, layout_.total_bytes);
  params_ = other.params_;
  given_origins_ = other.given_origins_;
  origins_ = other.origins_;
  scales_ = other.scales_;
  layer_params_ = other.layer_params_;
  modal_ = other.modal_;
  layer_length_max_ = other.layer_length_max_;
  layer_strands_ = other.layer_strands_;
  layer_vertices_ = other.layer_vertices_;
  layer_simulates_ = other.layer_simulates_;
  layer_curled_ = other.layer_curled_;
  is_cut_ = other.is_cut_;
  written_ = other.written_;
  replaced_ = other.replaced_;
  pose_gate_.CopyStateFrom(other.pose_gate_);
  colliders_ = other.colliders_;
  memory_.paused = other.memory_.paused;
  restored_ = other.restored_;
  first_frame_ = other.first_frame_;
  last_dt_s_ = other.last_dt_s_;
  return true;
}

namespace {

// What follows from where strands stand on the skin.
bool SameRoots(const StrandBlock& a, const StrandBlock& b) {
  return SameBytes(a.bary, b.bary) && SameBytes(a.vertex, b.vertex) &&
         SameBytes(a.joint_mask, b.joint_mask) && a.strand_count == b.strand_count &&
         a.vertex_count == b.vertex_count;
}

}  // namespace

bool FurScene::HasRootsOf(std::span<const Groom* const> grooms) const {
  uint32_t patch = 0, chunk = 0;
  for (uint32_t c = 0; c < grooms.size(); ++c) {
    const Groom& groom = *grooms[c];
    if (!SameBytes(*memory_.Of<&Streams::skeleton>(c), groom.skeleton)) return false;
    for (const MeshBlock& mesh : groom.mesh)
      if (!SameBytes(*memory_.Of<&Streams::mesh>(patch++), mesh)) return false;
    for (size_t i = 0; i < groom.strands.size(); ++i, ++chunk)
      if (!SameRoots(*memory_.Of<&Streams::strands>(chunk), groom.strands[i]) ||
          !SameBytes(*memory_.Of<&Streams::halo>(chunk), groom.halo[i]))
        return false;
  }
  return true;
}

bool FurScene::ReplaceGrooms(std::span<const Groom* const> grooms, const char** why) {
  const FloatEnvironment guard;
  const BetweenFrames between(phase_);
  if (between.fault()) return Refuse(between.fault(), why);
  const Result<SceneLayout> layout = MeasureScene(grooms, options_);
  if (!layout) return Refuse("a scene of these grooms cannot be made", why);
  if (*layout != layout_ || !HasRootsOf(grooms))
    return Refuse("the grooms are of other strands, layers or kinds: the scene is to be made anew",
                  why);
  CopyGrooms(grooms);
  pose_gate_.TakeUnitScales(grooms);
  return true;
}

uint64_t FurScene::HeapBytes() const {
  const auto bytes = [](const auto& v) { return uint64_t(v.capacity()) * sizeof(v[0]); };
  const SceneShape& shape = layout_.shape;
  uint64_t sum = sizeof(FurScene) + bytes(params_) + bytes(relights_) + bytes(colliders_) +
                 bytes(given_origins_) + bytes(origins_) + bytes(scales_) + bytes(scale_notes_) +
                 bytes(shape.layer_character) + bytes(shape.layer_first_patch) +
                 bytes(shape.layer_first_chunk) + bytes(shape.layer_kind) +
                 bytes(shape.patch_layer) + bytes(shape.chunk_layer) + bytes(layout_.ranges) +
                 bytes(memory_.streams) + bytes(plan_.stages) + bytes(plan_.passes) +
                 plan_.graph.HeapBytes() + bytes(layer_names_) + bytes(layer_params_) +
                 bytes(modal_) + bytes(layer_length_max_) + bytes(layer_strands_) +
                 bytes(layer_vertices_) + bytes(demands_) + bytes(demand_order_) +
                 bytes(layer_simulates_) + bytes(layer_curled_) + bytes(written_) +
                 bytes(replaced_) + bytes(draws_) + bytes(fault_) + bytes(strand_textures_) +
                 bytes(force_changes_) + carried_.HeapBytes() + pose_gate_.HeapBytes();
  for (const StreamPlace& place : memory_.streams) sum += bytes(place.slot);
  for (const Pass& pass : plan_.passes) sum += bytes(pass.streams) + bytes(pass.waits);
  for (const std::string& name : layer_names_) sum += bytes(name);
  for (auto at = strand_textures_.begin(); at != strand_textures_.end(); ++at)  // shared ones once
    if (*at && std::find(strand_textures_.begin(), at, *at) == at)
      sum += sizeof(StrandTexture) + bytes((*at)->rgba);
  return sum;
}

std::span<const LayerDraw> FurScene::Draws() const {
  draws_.clear();
  if (phase_.IsDone() && !restored_) FindDraws(memory_, options_.vertex_order, draws_);
  for (LayerDraw& draw : draws_) {
    const std::array<double, 3> origin = OriginOfLayer(draw.layer);
    std::copy(origin.begin(), origin.end(), draw.origin);
    draw.look = &Look(draw.layer);
    draw.strand_texture = StrandTextureOf(draw.layer).get();
    draw.pieces = CurvePieces(LongestOnScreenPx(draw.layer));
  }
  return draws_;
}

uint32_t FurScene::CopyCurves(uint32_t layer, std::span<StrandCurve> out) const {
  const FloatEnvironment guard;
  return phase_.IsDone() && !restored_ ? pelt::CopyCurves(memory_, layer, out) : 0;
}

uint32_t FurScene::ShadowPlaces(uint32_t layer, std::span<uint32_t> places) const {
  if (!phase_.IsDone() || restored_ || layer >= shape().layer_count) return 0;
  const FloatEnvironment guard;
  return FindShadowPlaces(memory_, options_.vertex_order, layer, ShadowShare(layer), places);
}

std::vector<uint8_t> FurScene::FurTexture(uint32_t layer, uint32_t& side) const {
  side = 0;
  if (layer >= layer_params_.size() || layer_params_[layer].output != Output::kShells) return {};
  const FloatEnvironment guard;
  side = layer_params_[layer].fur_texture_size;
  return MakeFurTexture(layer_params_[layer]);
}

uint32_t FurScene::LiveStrands() const {
  uint32_t live = 0;
  for (uint32_t c = 0; c < shape().chunk_count; ++c)
    live += memory_.Of<&Streams::chunk_state>(c)->live_strands;
  return live;
}

uint32_t FurScene::DrawnStrands() const {
  uint32_t drawn = 0;
  for (uint32_t l = 0; l < shape().layer_count; ++l)
    drawn += memory_.Of<&Streams::layer_sort>(l)->visible_count;
  return drawn;
}

}  // namespace pelt
