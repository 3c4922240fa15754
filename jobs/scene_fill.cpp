// What a frame is given: every parameter of its kernels, from the caller's input and what the scene
// was given before.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

#include "core/float_rules.hpp"
#include "core/kernels/frame_params.hpp"
#include "core/layer_block.hpp"
#include "core/modal/modal_quality.hpp"
#include "jobs/colliders.hpp"
#include "jobs/scene.hpp"

namespace pelt {
namespace {

// Copies `value` over `target` and says whether a bit of it changed. Both are zero-initialised
// plain data without padding.
template <class T>
bool Replace(T& target, const T& value) {
  if (std::memcmp(&target, &value, sizeof(T)) == 0) return false;
  target = value;
  return true;
}

uint32_t SwitchBits(const SkipSettings& skip) {
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

// Over 10 times larger or smaller than baked, and not by a rounding, nor to hide it: by 0.
bool LooksMistaken(const float (&root)[12], float scale) {
  bool hidden = true;
  for (int i = 0; i < 12; ++i) hidden = hidden && (i % 4 == 3 || root[i] == 0.0f);
  return !hidden && (scale > 10.001f || scale < 0.09999f);
}

}  // namespace

void FurScene::FillFrame(const FrameInput& input) {
  memory_.paused = input.dt_s == 0.0 && !first_frame_;
  memory_.restored = restored_;
  restored_ = false;
  if (!memory_.paused || memory_.restored) {  // a snapshot has none of them
    CutStrands(input.cut);
    WriteStrands(input.strands);
  }
  if (memory_.paused) return FillPausedFrame(input);
  pose_gate_.Judge(memory_, given_origins_);
  FillOrigins();
  FillScales();
  const WindSetup& w = input.wind;
  const bool still = w.velocity[0] == 0.0f && w.velocity[1] == 0.0f && w.velocity[2] == 0.0f &&
                     w.turbulence == 0.0f;
  const Air air = !still ? Air::kBlows : input.skip.wind ? Air::kLeftOut : Air::kStill;
  ForEachSet(input, [this](uint32_t s, const FrameInput& in) {
    params_[s].paint_strands = MakePaintStrandsParams({in.brush, in.brush_count});
    relights_[s] = FillLights(s, in);
    force_changes_[s] =
        Replace(params_[s].wind.forces, PlaceForces(in, memory_, pose_gate_, origins_, s));
  });
  FindBudget(input);
  FillLayers(input, air);
  const float scale = StrandScale(input.lod);
  ForEachSet(input,
             [&](uint32_t s, const FrameInput& in) { FillParams(s, input, in, air, scale); });
  first_frame_ = false;
  last_dt_s_ = StepOf(input);
}

// What both budgets leave (select_lod.hpp).
float FurScene::StrandScale(const LodSettings& lod) const {
  const float scale =
      BudgetScale({memory_.Of<&Streams::lod>(0), shape().layer_count},
                  {memory_.Of<&Streams::layers>(0), shape().layer_count}, lod.strand_budget);
  return lod.budget_us > 0 ? std::min(budget_.scale, scale) : scale;
}

// Nothing is left out of a frame to which state was put back.
uint32_t FurScene::SwitchesOf(const SkipSettings& skip) const {
  return memory_.restored ? 0u : SwitchBits(skip);
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

// What the characters' poses are relative to in this frame.
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
  for (uint32_t c = 0; c < scales_.size(); ++c) {
    if (pose_gate_.holds_pose()[c]) continue;
    const auto& root = memory_.Of<&Streams::pose>(c)->root;
    scales_[c] = ScaleOf(root, pose_gate_.UnitScale(c), scales_[c]);
    if (!options_.any_scale && scale_notes_[c] == 0.0f && LooksMistaken(root, scales_[c]))
      scale_notes_[c] = scales_[c];
  }
}

// Time stands still: state, layers, poses and level of detail stay what they are, and so does what
// the next frame is compared with. What is left is to draw the same strands from another eye.
void FurScene::FillPausedFrame(const FrameInput& in) {
  for (uint32_t s = 0; s < params_.size(); ++s) {
    SelectLodParams lod = params_[s].select_lod;
    lod.view = ViewFrom(s, in);
    FillView(s, in, lod);
  }
  // As the frame before had it, all of what follows from the state.
  const auto follows = [&](const ChunkStateBlock& state) {
    return memory_.restored
               ? kChunkSkin | kChunkSimulate | kChunkFit | (state.flags & kChunkRestart)
               : 0u;
  };
  for (uint32_t p = 0; p < shape().patch_count; ++p) {
    auto& state = *memory_.Of<&Streams::patch_state>(p);
    const uint32_t visible = state.flags & kChunkVisible;
    state.flags = visible ? visible | follows(state) : 0u;
  }
  for (uint32_t c = 0; c < shape().chunk_count; ++c) {
    auto& state = *memory_.Of<&Streams::chunk_state>(c);
    const uint32_t visible = state.flags & kChunkVisible;
    const CollectChangesParams& view = params_[SetOf(shape().chunk_layer[c])].collect_changes;
    const bool keys = view.view_changed != 0 || !in.skip.sort || memory_.restored;
    state.flags = visible | (visible && keys ? kChunkKeys | follows(state) : 0u);
    state.keys_changed = state.records_changed = 0;
  }
}

// Says whether every lit layer has to be lit again.
bool FurScene::FillLights(uint32_t s, const FrameInput& input) {
  LightLayerParams lights{input.lighting};
  Lighting& all = lights.lighting;
  std::fill(all.light + all.light_count, std::end(all.light), SphereLight{});
  std::fill(all.sample + all.sample_count, std::end(all.sample), IrradianceSample{});
  return Replace(params_[s].light_layer, lights) || first_frame_ || !input.skip.light ||
         memory_.restored;
}

// By the box of the last frame, as this frame's is made in it: fur that is carried into a volume feels it a frame
// later.
bool FurScene::IsPushed(uint32_t layer) const {
  const ForceParams& forces = params_[SetOf(layer)].wind.forces;
  if (forces.count == 0 || first_frame_) return false;
  BoundsBlock box = *memory_.Of<&Streams::bounds>(layer);
  if (!origins_.empty())
    for (int k = 0; k < 3; ++k) {
      box.low[k] -= origins_[SetOf(layer)].shift[k];
      box.high[k] -= origins_[SetOf(layer)].shift[k];
    }
  return std::any_of(forces.force, forces.force + forces.count,
                     [&box](const PlacedForce& force) { return Touches(force, box); });
}

void FurScene::FillLayers(const FrameInput& input, Air air) {
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
      table_changed = modal_[l].Advance(
          LayerRod(layer_params_[l], weather, layer_length_max_[l], layer_curled_[l] != 0),
          LayerQuality(l, input), dt_s, rates, {modal_.data(), l}, tables, tables + l);
      push_ratio = modal_[l].push_ratio();
    }
    const bool pushed = IsPushed(l);
    block = FillLayerBlock(layer_params_[l], weather, float(dt_s), input.gravity, air,
                           layer_strands_[l], layer_length_max_[l],
                           layer_simulates_[l] != 0 && input.dt_s > 0.0,
                           first_frame_ ? nullptr : &block, scales_[character], push_ratio, pushed);
    const uint32_t set = SetOf(l);
    if (table_changed || (pushed && force_changes_[set])) block.changed = 1;
    if (relights_[set] && (block.flags & kLayerLit)) block.flags |= kLayerRelight;
    if (params_[set].paint_strands.count > 0 && (block.flags & kLayerPainted))
      block.flags |= kLayerBrushed;
    if (rates) {
      block.flags |= kLayerRatesGiven;
    }
    block.importance = ImportanceOf(l, input);
    if (block.importance == 0.0f) block.flags &= ~uint32_t(kLayerEnabled);
    if (block.flags & kLayerModal) {
      block.frame_ratio = float(last_dt_s_ > 0.0 ? dt_s / FrameInHistory(last_dt_s_) : 1.0);
    }
  }
}

// This frame's view, relative to last frame's origin, as the last boxes are: this frame's come with its poses, in
// the frame. The last eye is not used, or a pause's would change what comes after it. Sizes are times the
// layer's importance.
View FurScene::LayerView(uint32_t layer, const FrameInput& in) const {
  const uint32_t set = SetOf(layer);
  View view = ViewFrom(set, in);
  if (!origins_.empty())
    for (int k = 0; k < 3; ++k) view.eye[k] = view.eye[k] + origins_[set].shift[k];
  const float importance = ImportanceOf(layer, in);
  if (importance > 0.0f) view.pixels_per_unit_at_1m *= importance;
  return view;
}

ModalQuality FurScene::LayerQuality(uint32_t layer, const FrameInput& in) const {
  const ModalQuality asked = layer_params_[layer].quality, last = modal_[layer].quality();
  if (first_frame_) return asked;
  return QualityOnScreen(asked, last, LayerView(layer, in), *memory_.Of<&Streams::bounds>(layer),
                         scales_[shape().layer_character[layer]] * layer_length_max_[layer],
                         last == ModalQuality::kFast ? budget_.keep_fast_px : budget_.fast_px);
}

// Of layers in view in the last frame; shells have no strands that could be fewer.
void FurScene::FindBudget(const FrameInput& in) {
  if (in.lod.budget_us > 0)
    for (uint32_t l = 0; l < shape().layer_count; ++l) {
      const LodBlock& lod = *memory_.Of<&Streams::lod>(l);
      const LayerParams& params = layer_params_[l];
      demands_[l] = {.patches = shape().LayerItems(Domain::kPatch, l),
                     .chunks = shape().LayerItems(Domain::kChunk, l),
                     .vertices = layer_vertices_[l],
                     .strands = StrandCount(l),
                     .nodes = params.points - 1,
                     .on_vertices = params.chain == ChainKind::kVertex,
                     .chain_level = LeastChainLevel(params),
                     .solver = params.solver,
                     .quality = params.quality,
                     .wanted = lod.visible && ImportanceOf(l, in) > 0.0f ? lod.wanted : 0.0f,
                     .importance = ImportanceOf(l, in)};
      if (lod.visible && params.quality == ModalQuality::kFine)
        demands_[l].fast_px2 =
            FastErrorPx2(LayerView(l, in), *memory_.Of<&Streams::bounds>(l),
                         scales_[shape().layer_character[l]] * layer_length_max_[l]);
    }
  budget_ = FindLodBudget(demands_, in.lod, in.skip.lod, demand_order_);
}

float FurScene::LongestOnScreenPx(uint32_t layer) const {
  return LengthOnScreenPx(params_[SetOf(layer)].select_lod.view,
                          *memory_.Of<&Streams::bounds>(layer),
                          scales_[shape().layer_character[layer]] * layer_length_max_[layer]);
}

ScreenQuality FurScene::QualityOf(uint32_t layer) const {
  const ModalQuality ran = modal_[layer].quality();
  const LodBlock& lod = *memory_.Of<&Streams::lod>(layer);
  const bool on_vertices = (shape().layer_kind[layer] & kLayerVertexChains) != 0;
  // One that comes or goes counts as gone.
  const uint32_t level = on_vertices ? lod.chain_level + (lod.parent_share > 0.0f) : 0;
  return {ran, level, ErrorShare(ran, level) * LongestOnScreenPx(layer)};
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

void FurScene::FillParams(uint32_t s, const FrameInput& given, const FrameInput& in, Air air,
                          float budget_scale) {
  FrameParams& to = params_[s];
  SelectLodParams lod{};
  lod.view = ViewFrom(s, in);
  lod.full_detail_pixels = in.lod.full_detail_px;
  lod.min_fraction = in.lod.min_fraction;
  lod.hysteresis = in.lod.hysteresis;
  lod.fade_share = in.lod.fade_share;
  lod.least_chains = in.lod.least_chains;
  lod.flags = (in.skip.lod ? kLodOn : 0u) | (in.skip.cull ? kCullOn : 0u);
  lod.budget_scale = budget_scale;
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
  colliders_[s].Advance(given, memory_, sources, first_frame_ ? nullptr : &to.simulate,
                        origins_.empty() ? nullptr : origins_[s].shift, simulate);
  const bool simulate_changed = Replace(to.simulate, simulate);

  const bool apart = !origins_.empty();
  // Still air has to be there where forces push.
  if (const ForceParams forces = to.wind.forces; air != Air::kLeftOut || forces.count > 0) {
    to.wind = apart ? MakeWindParams(in.wind, in.time_s, origins_[s].used)
                    : MakeWindParams(in.wind, in.time_s);
    to.wind.forces = forces;
  }
  // A character may stand still where its origin moves, and what is left out of a frame is relative to
  // last frame's origin.
  const bool shifts = apart && (origins_[s].shifted || origins_[s].was_shifted);
  const uint32_t kept = shifts ? ~uint32_t(kSwitchSleep | kSwitchSkipUnmoved) : ~0u;
  to.activate = {SwitchesOf(in.skip) & kept, simulate_changed, view_changed, first_frame_};
}

}  // namespace pelt
