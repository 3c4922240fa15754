// All input of a frame besides the poses: time, camera, wind, obstacles, weather, lights,
// brushes, force volumes, and what may be left out. Plain data, so that it can be recorded and replayed (traces/).
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "core/chunk.hpp"
#include "core/surroundings.hpp"
#include "core/view.hpp"

namespace pelt {

// How wet and how dirty a character is, each 0 (dry, clean) to 1; values outside are clamped.
struct Weather {
  float wetness = 0.0f;
  float dirt = 0.0f;
};

// Level of detail: a layer's share of strands follows the size of its box on the screen, where
// skip.lod is on (core/kernels/select_lod.hpp).
// What is simulated how: PBD, Verlet, and the modal solver by ModalQuality.
inline constexpr uint32_t kSolverTiers = 5;

inline constexpr float kLeastImportance = 0.01f, kMostImportance = 100.0f;

// Core time that fur in view takes, ns: of a machine (`pelt calibrate`), or of an engine's own profile.
struct FurCosts {
  float chunk_ns = 0.0f;   // of a chunk of strands and of a patch of vertices, alive or not
  float vertex_ns = 0.0f;  // of a mesh vertex under fur: skinning, air
  float strand_ns = 0.0f;  // of a living strand: all but its chain
  float node_ns[kSolverTiers] = {};  // of a chain, for each of its points but the root
};

struct LodSettings {
  float full_detail_px = 400.0f;  // box diagonal on the screen from which all strands live, px
  float min_fraction = 0.05f;     // least share of a layer in view before the budget, 0 to 1
  float hysteresis = 0.1f;        // change of the share, over the share, that it follows, 0 to 1
  float fade_share = 0.1f;        // of the living strands, the last, that fade out, 0 to 1
  // Least share of a layer's chains at mesh vertices that is simulated, 0 to 1: they thin with the strands
  // and twice as fast, by halves, to an eighth. 1: never.
  float least_chains = 0.0f;
  uint32_t strand_budget = 0;  // living strands over all layers in view; 0: no budget
  // Modal layers of quality `fine` are simulated in `fast` while its typical error is at most this on the
  // screen (modal/modal_quality.hpp); whether skip.lod is on or not. 0: never.
  float fast_quality_px = 0.5f;
  // Core time of the fur in view, us; 0: no budget. What `costs` say is over it is taken from what is least seen:
  // `fast` for `fine`, beginning with the smallest error, while that is at most worst_px; then, with skip.lod, strands.
  uint32_t budget_us = 0;
  float worst_px = 2.0f;
  FurCosts costs;
};

// What may be left out. LOD changes the picture. Culling changes it for a layer that comes back
// into view: it starts from its groom. All others, and culling while every layer is seen, change no
// bit.
struct SkipSettings {
  bool sleep = true;    // chunks at rest are not simulated
  bool unmoved = true;  // what no joint moved is not skinned
  bool sort = true;     // layers are not sorted and written again where nothing changed
  bool cull = true;     // layers outside the view are not computed
  bool wind = true;     // still air is not computed
  bool light = true;    // layers are not lit again where nothing changed
  bool lod = false;     // strands, and shells, that are too far to be distinguished (LodSettings)
};

// An arm, a collar, a hand: what a ball covers on its way from one point to another. Free, or bound
// to a joint and carried along by that character's pose.
struct CapsuleCollider {
  static constexpr uint32_t kFree = ~0u;
  // Ends of the axis. Free: in the world, m. Bound: where the joint's own space has them, in the
  // units of the character file.
  float from[3] = {}, to[3] = {};
  float radius = 0.0f;     // m, bound or free
  uint32_t character = 0;  // whose joint it is; nothing to a free one
  uint32_t joint = kFree;  // as in Groom::joint_names
  // Of a free one's ends, m/s in the world, in the frame that ends where they are. A bound one's are
  // those of its joint, by the last two poses.
  float from_velocity[3] = {}, to_velocity[3] = {};
};

// By PaintChannel.
inline constexpr std::string_view kPaintChannelNames[kPaintChannels] = {"mud", "snow", "wet",
                                                                        "dust"};

// Values of one strand in place of its groom's, in the frames whose input has them.
struct StrandWrite {
  uint32_t layer = 0, strand = 0;  // by its number in the layer, as LayerDraw::order has it
  uint32_t base_colour = 0, tip_colour = 0;  // 0xAABBGGRR
  float width = 0.0f;                        // at the root, 0 to kWidestWrite, m
  uint32_t film_strip = 0;                   // texture index, below 256
};
inline constexpr float kWidestWrite = 0.1f;

// Places and directions are the world's: right-handed, metres, y up by the defaults alone. No value
// is beyond 1e6; BeginFrame says which one is. jobs/README.md has all, with their names in C.
struct FrameInput {
  // The time that passes in the frame, at whose end its input holds: 1e-6 to 1 s; or 0: a pause.
  double dt_s = 1.0 / 60.0;
  double time_s = 0.0;  // at its end, 0 to 1e9 s: where the wind is in its course
  // What the places below are relative to, world, m. Not 0 only in scenes whose characters have
  // origins (SceneOptions::origins).
  double origin[3] = {};
  Camera camera;
  WindSetup wind;
  float gravity[3] = {0.0f, -9.81f, 0.0f};  // m/s^2
  bool use_ground = false;
  // A plane that strands stay above: a unit normal n and d, m; n . x + d >= 0 is above.
  float ground[4] = {0.0f, 1.0f, 0.0f, 0.0f};
  float ground_velocity[3] = {};  // m/s, as a sphere's
  uint32_t sphere_count = 0;      // of `sphere` and its velocities; the rest is not looked at
  float sphere[kSpheresPerScene][4] = {};  // centre, radius; m
  // m/s, in the frame that ends where the sphere is: there it moves along, meets what is in its way
  // and takes it with it. 0: it stands where it is, for layers with the modal solver as for others.
  float sphere_velocity[kSpheresPerScene][3] = {};
  uint32_t capsule_count = 0;  // of `capsule`
  CapsuleCollider capsule[kCapsulesPerScene];
  std::span<const Weather> weather;  // one a character; empty: dry and clean
  // One a layer; empty: 1 each. A factor on its size on the screen as level of detail and budgets see it, which
  // take from what is less important first: kLeastImportance to kMostImportance. 0: the layer is off, as if out
  // of view; it starts from its groom when it is on again.
  std::span<const float> importance;
  // Haircuts: a byte for each place of a strand, FurScene::StrandPlaces of each layer, one layer after the other;
  // empty: 0 each. Where it is not 0 the strand is cut off: it goes on, and is not drawn. Nothing to shells.
  std::span<const uint8_t> cut;
  // At most SceneOptions::strand_writes, of several for one strand the last. A strand that is not listed, or no
  // longer, is as its groom has it.
  std::span<const StrandWrite> strands;
  Lighting lighting;
  uint32_t brush_count = 0;            // of `brush`
  PaintBrush brush[kBrushesPerScene];  // one after the other: the last has the last word
  uint32_t force_count = 0;            // of `force`
  ForceVolume force[kForceVolumesPerScene];
  LodSettings lod;
  SkipSettings skip;
};

}  // namespace pelt
