#include "jobs/scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <new>

#include "core/float_rules.hpp"
#include "core/format.hpp"
#include "core/groom/fur_texture.hpp"
#include "core/kernels/frame_params.hpp"
#include "core/kernels/frame_table.hpp"
#include "core/layer_block.hpp"
#include "core/modal/quality_on_screen.hpp"
#include "core/modal/rest_curl.hpp"
#include "core/outputs.hpp"
#include "jobs/float_environment.hpp"
#include "jobs/input_check.hpp"
#include "jobs/place_capsules.hpp"

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace pelt {
namespace {

constexpr size_t kPageBytes = size_t(2) << 20;  // a huge page

// Copies `value` over `target` and says whether a bit of it changed. Both are zero-initialised
// plain data without padding.
template <class T>
bool Replace(T& target, const T& value) {
  if (std::memcmp(&target, &value, sizeof(T)) == 0) return false;
  target = value;
  return true;
}

uint32_t SwitchesOf(const SkipSettings& skip) {
  return (skip.sleep ? kSwitchSleep : 0u) | (skip.unmoved ? kSwitchSkipUnmoved : 0u) |
         (skip.sort ? kSwitchSkipSort : 0u);
}

// A first frame of no time lays the fur on its groom (no layer simulates in it): what is divided by
// the step's length needs one all the same.
double StepOf(const FrameInput& input) { return input.dt_s > 0.0 ? input.dt_s : 1.0 / 60.0; }

// Of a placement, over `unit_scale`: the mean of its three axes'. Roundings of a turn are no reason
// for strands to change their length: what is as good as 1, or as the last frame's, is that.
float ScaleOf(const float (&root)[12], float unit_scale, float last) {
  constexpr double kSame = 1.0e-4, kLeast = 1.0e-3, kMost = 1.0e3;
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double x = root[axis], y = root[4 + axis], z = root[8 + axis];
    sum += std::sqrt(x * x + y * y + z * z);
  }
  const double scale = std::clamp(sum / (3.0 * double(unit_scale)), kLeast, kMost);
  if (std::abs(scale - 1.0) <= kSame) return 1.0f;
  return std::abs(scale - double(last)) <= kSame * double(last) ? last : float(scale);
}

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
  return scene;
}

FurScene::FurScene(const SceneOptions& options, SceneLayout layout)
    : options_(options),
      layout_(std::move(layout)),
      params_(options.origins ? layout_.shape.character_count : 1),
      relights_(params_.size(), 0),
      colliders_(params_.size()),
      given_origins_(options.origins ? 3 * size_t(layout_.shape.character_count) : 0),
      origins_(options.origins ? layout_.shape.character_count : 0),
      scales_(layout_.shape.character_count, 1.0f) {
  draws_.reserve(layout_.shape.layer_count);
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
    block = {given, needed};
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

void FurScene::CopyGrooms(std::span<const Groom* const> grooms) {
  uint32_t layer_index = 0, chunk = 0;
  for (uint32_t c = 0; c < grooms.size(); ++c) {
    const Groom& groom = *grooms[c];
    *memory_.Of<&Streams::skeleton>(c) = groom.skeleton;
    uint32_t vertex_rest = 0, rest4 = 0, rest5 = 0, shell_skin = 0, fin_edges = 0, rest_down = 0;
    for (size_t l = 0; l < groom.layers.size(); ++l, ++layer_index) {
      const GroomLayer& layer = groom.layers[l];
      *memory_.Of<&Streams::layer_joints>(layer_index) = groom.layer_joints[l];
      layer_names_.push_back(layer.name);
      layer_params_.push_back(layer.params);
      modal_.emplace_back();
      layer_length_max_.push_back(layer.length_max);
      layer_strands_.push_back(layer.strand_count);
      layer_simulates_.push_back(0);
      layer_curled_.push_back(0);
      const bool shells = layer.params.output == Output::kShells;
      if (shells) *memory_.Of<&Streams::shell_layers>(layer_index) = FillShellLayer(layer.params);
      for (uint32_t i = 0; i < layer.chunk_count; ++i, ++chunk) {
        *memory_.Of<&Streams::mesh>(chunk) = groom.mesh[layer.first_chunk + i];
        *memory_.Of<&Streams::strands>(chunk) = groom.strands[layer.first_chunk + i];
        if (layer.params.lit && !shells)
          *memory_.Of<&Streams::strand_uv>(chunk) = groom.strand_uv[layer.first_chunk + i];
        const bool on_vertices = layer.params.chain == ChainKind::kVertex;
        const float* strength = nullptr;
        bool curled = false;  // of the chains that are simulated
        const auto take = [&](auto& to, const auto& from, bool simulated) {
          to = from;
          strength = to.strength;
          if (simulated && !layer_curled_[layer_index]) curled = HasCurl(to);
        };
        if (on_vertices)
          take(*memory_.Of<&Streams::vertex_rest>(chunk), groom.vertex_rest[vertex_rest++], true);
        if (shells) {
          *memory_.Of<&Streams::shell_skin>(chunk) = groom.shell_skin[shell_skin++];
          if (layer.params.fins)
            *memory_.Of<&Streams::fin_edges>(chunk) = groom.fin_edges[fin_edges++];
        } else if (layer.params.points == 5) {
          take(*memory_.Of<&Streams::strand_rest5>(chunk), groom.strand_rest5[rest5++], true);
        } else {
          take(*memory_.Of<&Streams::strand_rest4>(chunk), groom.strand_rest4[rest4++],
               !on_vertices);
        }
        layer_curled_[layer_index] |= curled;
        if (layer.params.sag_free)
          *memory_.Of<&Streams::rest_down>(chunk) = groom.rest_down[rest_down++];
        layer_simulates_[layer_index] |=
            std::any_of(strength, strength + kStrandsPerChunk, [](float s) { return s > 0.0f; });
      }
    }
  }
}

const char* FurScene::BeginFrame(const FrameInput& input) {
  const FloatEnvironment float_environment;  // parameters are part of the bits
  if (const char* fault = phase_.StartFilling()) return fault;
  const char* fault = FindInputFault(input, shape(), pose_gate_, fault_);
  if (!fault) FillFrame(input);
  phase_.EndFilling(!fault);
  return fault;
}

void FurScene::FillFrame(const FrameInput& input) {
  memory_.paused = input.dt_s == 0.0 && !first_frame_;
  if (memory_.paused) return FillPausedFrame(input);
  pose_gate_.Judge(memory_, given_origins_);
  FillOrigins();
  FillScales();
  const WindSetup& w = input.wind;
  const bool still = w.velocity[0] == 0.0f && w.velocity[1] == 0.0f && w.velocity[2] == 0.0f &&
                     w.turbulence == 0.0f;
  const bool wind_blows = !(still && input.skip.wind);
  ForEachSet(input, [this](uint32_t s, const FrameInput& in) {
    params_[s].paint_strands = MakePaintStrandsParams({in.brush, in.brush_count});
    relights_[s] = FillLights(s, in);
  });
  FillLayers(input, wind_blows);
  ForEachSet(input,
             [&](uint32_t s, const FrameInput& in) { FillParams(s, input, in, wind_blows); });
  first_frame_ = false;
  last_dt_s_ = StepOf(input);
}

void FurScene::ForEachSet(const FrameInput& input, auto&& fill) {
  if (origins_.empty()) return fill(0u, input);
  for (uint32_t s = 0; s < params_.size(); ++s) {
    FrameInput moved = input;
    MovePlaces(OffsetBetween(input.origin, origins_[s].used), moved);
    fill(s, moved);
  }
}

View FurScene::ViewFrom(uint32_t s, const FrameInput& input) const {
  View view = MakeView(input.camera);
  if (!origins_.empty()) MoveView(OffsetBetween(input.origin, origins_[s].used), view);
  return view;
}

// Where the characters' poses are told from in this frame.
void FurScene::FillOrigins() {
  if (origins_.empty()) return;
  for (uint32_t c = 0; c < origins_.size(); ++c)
    origins_[c].Advance(pose_gate_.holds_pose()[c] ? nullptr : Origin(c));
  for (uint32_t l = 0; l < shape().layer_count; ++l) {
    const CharacterOrigin& from = origins_[shape().layer_character[l]];
    auto& block = *memory_.Of<&Streams::layer_origins>(l);
    std::copy_n(from.shift, 3, block.shift);
    block.shifted = from.shifted;
  }
}

// How much larger a character is than its groom.
void FurScene::FillScales() {
  for (uint32_t c = 0; c < scales_.size(); ++c)
    if (!pose_gate_.holds_pose()[c])
      scales_[c] =
          ScaleOf(memory_.Of<&Streams::pose>(c)->root, pose_gate_.UnitScale(c), scales_[c]);
}

// Time stands still: state, layers, poses and level of detail stay what they are, and so does what
// the next frame is compared with. What is left is to draw the same strands from another eye.
void FurScene::FillPausedFrame(const FrameInput& in) {
  for (uint32_t s = 0; s < params_.size(); ++s) {
    SelectLodParams lod = params_[s].select_lod;
    lod.view = ViewFrom(s, in);
    FillView(s, in, lod);
  }
  for (uint32_t c = 0; c < shape().chunk_count; ++c) {
    auto& state = *memory_.Of<&Streams::chunk_state>(c);
    const uint32_t visible = state.flags & kChunkVisible;
    const CollectChangesParams& view = params_[SetOf(shape().chunk_layer[c])].collect_changes;
    const bool keys = view.view_changed != 0 || !in.skip.sort;
    state.flags = visible | (visible && keys ? kChunkKeys : 0u);
    state.keys_changed = state.records_changed = 0;
  }
}

// Says whether every lit layer has to be lit again.
bool FurScene::FillLights(uint32_t s, const FrameInput& input) {
  LightLayerParams lights{input.lighting};
  Lighting& all = lights.lighting;
  std::fill(all.light + all.light_count, std::end(all.light), SphereLight{});
  std::fill(all.sample + all.sample_count, std::end(all.sample), IrradianceSample{});
  return Replace(params_[s].light_layer, lights) || first_frame_ || !input.skip.light;
}

void FurScene::FillLayers(const FrameInput& input, bool wind_blows) {
  const double dt_s = StepOf(input);
  for (uint32_t l = 0; l < shape().layer_count; ++l) {
    auto& block = *memory_.Of<&Streams::layers>(l);
    const Weather weather =
        input.weather.empty() ? Weather{} : input.weather[shape().layer_character[l]];
    const uint32_t character = shape().layer_character[l], kind = shape().layer_kind[l];
    const bool rates = (kind & kLayerRates) && !pose_gate_.holds_pose()[character] &&
                       memory_.Of<&Streams::pose_rates>(character)->given != 0;
    bool table_changed = false;
    double push_ratio = 0.0;
    if (kind & kLayerModal) {
      auto* tables = memory_.Of<&Streams::modal_tables>(0);
      table_changed = modal_[l].Advance(LayerRod(layer_params_[l], weather, layer_curled_[l] != 0),
                                        LayerQuality(l, input.lod.fast_quality_px), dt_s, rates,
                                        {modal_.data(), l}, tables, tables + l);
      push_ratio = modal_[l].push_ratio();
    }
    block = FillLayerBlock(layer_params_[l], weather, float(dt_s), input.gravity, wind_blows,
                           layer_strands_[l], layer_length_max_[l],
                           layer_simulates_[l] != 0 && input.dt_s > 0.0,
                           first_frame_ ? nullptr : &block, scales_[character], push_ratio);
    if (table_changed) block.changed = 1;
    const uint32_t set = SetOf(l);
    if (relights_[set] && (block.flags & kLayerLit)) block.flags |= kLayerRelight;
    if (params_[set].paint_strands.count > 0 && (block.flags & kLayerPainted))
      block.flags |= kLayerBrushed;
    if (rates) {
      block.flags |= kLayerRatesGiven;
    }
    if (block.flags & kLayerModal) {
      block.frame_ratio = float(last_dt_s_ > 0.0 ? dt_s / FrameInHistory(last_dt_s_) : 1.0);
    }
  }
}

// By what the last frame showed of it: the box of this one comes with its poses, in the frame.
ModalQuality FurScene::LayerQuality(uint32_t layer, float allowed_px) const {
  const ModalQuality asked = layer_params_[layer].quality;
  if (first_frame_) return asked;
  return QualityOnScreen(asked, modal_[layer].quality(), params_[SetOf(layer)].select_lod.view,
                         *memory_.Of<&Streams::bounds>(layer),
                         scales_[shape().layer_character[layer]] * layer_length_max_[layer],
                         allowed_px);
}

// The view's parameters of every stage. Says whether the view, or `lod`, is not last frame's.
bool FurScene::FillView(uint32_t s, const FrameInput& in, const SelectLodParams& lod) {
  FrameParams& to = params_[s];
  const bool changed = Replace(to.select_lod, lod) || first_frame_;
  const View& view = to.select_lod.view;
  std::copy_n(view.eye, 3, to.sort_key.eye);
  std::copy_n(view.forward, 3, to.sort_key.forward);
  std::copy_n(view.eye, 3, to.order_layers.eye);
  std::copy_n(view.forward, 3, to.order_layers.forward);
  std::copy_n(view.eye, 3, to.write_ribbons.eye);
  std::copy_n(view.eye, 3, to.select_fins.eye);
  to.collect_changes = {SwitchesOf(in.skip), changed};
  if (!origins_.empty())
    for (uint32_t l = 0; l < shape().layer_count; ++l)
      if (SetOf(l) == s) std::copy_n(view.eye, 3, memory_.Of<&Streams::layer_origins>(l)->eye);
  return changed;
}

void FurScene::FillParams(uint32_t s, const FrameInput& told, const FrameInput& in,
                          bool wind_blows) {
  FrameParams& to = params_[s];
  SelectLodParams lod{};
  lod.view = ViewFrom(s, in);
  lod.full_detail_pixels = in.lod.full_detail_px;
  lod.min_fraction = in.lod.min_fraction;
  lod.hysteresis = in.lod.hysteresis;
  lod.fade_share = in.lod.fade_share;
  lod.flags = (in.skip.lod ? kLodOn : 0u) | (in.skip.cull ? kCullOn : 0u);
  lod.budget_scale =
      BudgetScale({memory_.Of<&Streams::lod>(0), shape().layer_count},
                  {memory_.Of<&Streams::layers>(0), shape().layer_count}, in.lod.strand_budget);
  const bool view_changed = FillView(s, in, lod);
  std::copy_n(lod.view.eye, 3, to.select_shells.eye);
  to.select_shells.all = in.skip.lod ? 0 : 1;

  SimulateParams simulate{};
  simulate.dt = float(StepOf(in));
  simulate.rest_threshold = kRestThreshold;
  simulate.use_ground = in.use_ground;
  if (in.use_ground) std::copy_n(in.ground, 4, simulate.ground);
  simulate.sphere_count = in.sphere_count;
  std::copy_n(in.sphere[0], 4 * in.sphere_count, simulate.sphere[0]);
  const CapsuleSources sources = PlaceCapsules(in, memory_, pose_gate_, simulate, origins_, s);
  colliders_[s].Advance(told, memory_, sources, first_frame_ ? nullptr : &to.simulate,
                        origins_.empty() ? nullptr : origins_[s].shift, simulate);
  const bool simulate_changed = Replace(to.simulate, simulate);

  const bool apart = !origins_.empty();
  if (wind_blows)
    to.wind = apart ? MakeWindParams(in.wind, in.time_s, origins_[s].used)
                    : MakeWindParams(in.wind, in.time_s);
  // A character may stand still where its origin moves, and what is left out of a frame is told from
  // last frame's.
  const bool shifts = apart && (origins_[s].shifted || origins_[s].was_shifted);
  const uint32_t kept = shifts ? ~uint32_t(kSwitchSleep | kSwitchSkipUnmoved) : ~0u;
  to.activate = {SwitchesOf(in.skip) & kept, simulate_changed, view_changed, first_frame_};
}

bool FurScene::CopyStateFrom(const FurScene& other) {
  const SceneShape &mine = layout_.shape, &its = other.layout_.shape;
  if (layout_.total_bytes != other.layout_.total_bytes ||
      mine.layer_character != its.layer_character ||
      mine.layer_first_chunk != its.layer_first_chunk || mine.layer_kind != its.layer_kind)
    return false;
  if (this == &other) return true;
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
  layer_simulates_ = other.layer_simulates_;
  layer_curled_ = other.layer_curled_;
  pose_gate_.CopyStateFrom(other.pose_gate_);
  colliders_ = other.colliders_;
  memory_.paused = other.memory_.paused;
  first_frame_ = other.first_frame_;
  last_dt_s_ = other.last_dt_s_;
  return true;
}

uint64_t FurScene::HeapBytes() const {
  const auto bytes = [](const auto& v) { return uint64_t(v.capacity()) * sizeof(v[0]); };
  const SceneShape& shape = layout_.shape;
  uint64_t sum = sizeof(FurScene) + bytes(params_) + bytes(relights_) + bytes(colliders_) +
                 bytes(given_origins_) + bytes(origins_) + bytes(scales_) +
                 bytes(shape.layer_character) + bytes(shape.layer_first_chunk) +
                 bytes(shape.layer_kind) + bytes(shape.chunk_layer) + bytes(layout_.ranges) +
                 bytes(memory_.streams) + bytes(plan_.stages) + bytes(plan_.passes) +
                 bytes(layer_names_) + bytes(layer_params_) + bytes(modal_) +
                 bytes(layer_length_max_) + bytes(layer_strands_) + bytes(layer_simulates_) +
                 bytes(layer_curled_) + bytes(draws_) + bytes(fault_) + pose_gate_.HeapBytes();
  for (const StreamPlace& place : memory_.streams) sum += bytes(place.slot);
  for (const Pass& pass : plan_.passes) sum += bytes(pass.streams);
  for (const std::string& name : layer_names_) sum += bytes(name);
  return sum;
}

std::span<const LayerDraw> FurScene::Draws() const {
  draws_.clear();
  if (phase_.IsDone()) FindDraws(memory_, options_.vertex_order, draws_);
  for (LayerDraw& draw : draws_) {
    const std::array<double, 3> origin = OriginOfLayer(draw.layer);
    std::copy(origin.begin(), origin.end(), draw.origin);
  }
  return draws_;
}

uint32_t FurScene::CopyCurves(uint32_t layer, std::span<StrandCurve> out) const {
  return phase_.IsDone() ? pelt::CopyCurves(memory_, layer, out) : 0;
}

std::vector<uint8_t> FurScene::FurTexture(uint32_t layer, uint32_t& side) const {
  side = 0;
  if (layer >= layer_params_.size() || layer_params_[layer].output != Output::kShells) return {};
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
