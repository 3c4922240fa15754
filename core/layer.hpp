// The layer: a region of fur with one set of parameters, and what a frame knows of it as a whole. Its
// strands and vertices are in its chunks and patches (core/chunk.hpp).
#pragma once

#include <cstdint>

#include "core/chunk.hpp"

namespace pelt {

inline constexpr uint32_t kLayersPerScene = 1024;
inline constexpr uint32_t kHarmonics = 16;  // spherical ones, of degrees 0 to 3

enum LayerFlag : uint32_t {
  kLayerEnabled = 1u << 0,
  kLayerVertexChains =
      1u << 1,  // chains at mesh vertices (4 points), strands interpolate; else a chain per strand
  kLayerFivePoints = 1u << 2,  // 5 points per chain; else 4 or 9. Never with kLayerVertexChains
  kLayerVerlet = 1u << 3,      // else PBD
  kLayerRibbons = 1u << 4,
  kLayerClump = 1u << 5,
  kLayerBackFaceCull = 1u << 6,
  kLayerWind = 1u << 7,      // it responds to wind, which blows or is not left out; or kLayerPushed
  kLayerSimulate = 1u << 8,  // some strand of the layer has simulation strength
  kLayerModal = 1u << 9,     // the modal solver; never with kLayerVerlet
  kLayerWindEnds = 1u << 10,  // modal: kLayerBlows or kLayerPushed of the last frame is gone
  kLayerLines = 1u << 11,
  kLayerLit = 1u << 12,      // has a LayerLightBlock
  kLayerRelight = 1u << 13,  // the scene's lights are not last frame's, or nothing may be left out
  kLayerShells = 1u << 14,  // its strands are triangles of the skin; always with kLayerVertexChains
  kLayerPainted = 1u << 15,     // has a PaintBlock; only with kLayerLit
  kLayerBrushed = 1u << 16,     // there are brushes in this frame, wherever they are
  kLayerFins = 1u << 17,        // has fins on its edges; only with kLayerShells
  kLayerRates = 1u << 18,       // modal, and has a RootRateBlock
  kLayerRatesGiven = 1u << 19,  // the character's pose came with velocities in this frame
  kLayerSagFree = 1u << 20,     // modal, and has a DownBlock
  kLayerNinePoints = 1u << 21,  // 9 points per chain; only with kLayerModal, a chain per strand
  kLayerBlows = 1u << 22,       // wind blows and the layer responds, regardless of what is left out
  kLayerTraits = 1u << 23,      // has a TraitBlock; never with kLayerShells
  kLayerApart = 1u << 24,       // has a LayerOriginBlock: its character has an origin of its own
  kLayerChainLevel = 3u << 25,  // the least of its LodBlock::chain_level
  kLayerPushed = 1u << 27,      // a force volume touches the layer's box; always with kLayerWind
};
inline constexpr uint32_t kLayerChainLevelShift = 25;
// What a layer's vertices are: at most one; none: instances (core/outputs.hpp).
inline constexpr uint32_t kLayerOutputFlags = kLayerRibbons | kLayerLines | kLayerShells;
// The flags that are fixed when the scene is made are its kind: they decide which streams and
// stages a layer has.
inline constexpr uint32_t kLayerKindFlags =
    kLayerVertexChains | kLayerFivePoints | kLayerNinePoints | kLayerVerlet | kLayerModal |
    kLayerOutputFlags | kLayerLit | kLayerPainted | kLayerFins | kLayerRates | kLayerSagFree |
    kLayerTraits | kLayerApart;
// Of a kind besides its kLayerKindFlags: the layer's sort does not fit the local store.
inline constexpr uint32_t kLayerSortInPieces = 1u << 31;

// Of a layer of such a kind.
constexpr uint32_t StrandPointsOf(uint32_t kind) {
  return kind & kLayerNinePoints ? 9 : kind & kLayerFivePoints ? 5 : 4;
}

// What the Verlet and PBD solvers read of a layer; and shells: stiffness, share of a pull that does not bend them.
struct LinkTerms {
  float velocity_keep;     // exp(-velocity_damping * dt): share of a velocity kept this frame
  float segment_hardness;  // share of a segment's length error removed per iteration
  float angular_middle;    // share of the angle to the rest direction removed per iteration: inner
                           // joints
  float angular_end;       // the same at the last joint
  float stiffness;         // verlet: share of the way to the rest point per iteration
  uint32_t iterations;
};
// What the modal solver reads in their place.
struct ModalTerms {
  float shrink;          // last frame's scale over this one's
  float fastest_felt;    // a root's motion beyond it, m in this frame, is not felt
  float rest_gravity;    // kLayerSagFree: dry weight * gravity that the groom rests under, m/s^2
  float friction;        // coefficient, of contacts with colliders
  float turn_follow;     // share of the root's turns that turns the strand as it is
  float drawn_hardness;  // of what is drawn off its chain, the same share at any frame rate
};

// Parameters of a layer for this frame, filled on the caller's thread from the setup, wetness and
// dirt. All hardness and factor values are in [0, 1]; `keep` factors are already for this frame's
// dt.
PELT_BLOCK LayerBlock {
  uint32_t flags;
  uint32_t changed;     // not 0: some value differs from last frame's
  float gravity[3];     // weight * gravity, m/s^2
  float bounce;         // share of the normal velocity returned by a contact
  float motion_follow;  // share of the root's motion given to the points directly (motion damping;
                        // modal: what is not inertia)
  union {
    LinkTerms link;
    ModalTerms modal;  // kLayerModal
  };
  float surface_hardness;    // share of the depth below the root's tangent plane removed per
                             // iteration (modal: substep)
  float clump;               // share of the way to the control strand at the tip (0 at the root)
  float wind_response;       // acceleration per wind speed, 1/s
  float backface_tolerance;  // a strand is culled when normal . to_eye < -tolerance
  float scale;       // of the character over that of its groom: of every strand's length and width
  float tip_width;   // width at the tip over width at the root
  float sort_bias;   // layers are drawn in ascending bias
  float length_max;  // longest strand, m: widens the bounds
  float darken;      // multiplies the colours (wet); painted: of a soaked strand's, what is left
  float dirt_colour[3];  // mixed into the colours, sRGB-encoded 0..1
  float dirt;            // how much; painted: at least, of each strand
  uint32_t strand_count;
  float max_distance;  // modal: of a point from the groom, share of its distance along the strand;
                       // 0: no limit
  float wetness;       // lit layers: 0 dry to 1 soaked
  float importance;    // factor on the size on the screen that LOD sees; 0: off
  float sort_place;    // of the point whose depth is the sort key, from root 0 to tip 1
  float frame_ratio;   // modal: this frame's length over the last one's
};

// Where a layer is whose character has an origin of its own: all of the layer's places are relative
// to that. Filled on the caller's thread, from differences of doubles that are rounded once.
PELT_BLOCK LayerOriginBlock {
  float shift[3];    // of the origin since last frame, m
  uint32_t shifted;  // not 0: some of it is not 0
  float eye[3];      // the eye, m
  uint32_t pad[25];
};

// Bind-space boxes of the layer's vertices, one for each joint that moves any of them. A skinned
// vertex is a convex combination of its joints' images, so the union of the transformed boxes
// bounds the layer.
PELT_BLOCK LayerJointBlock {
  uint32_t joint[kJointsPerCharacter];
  float low[3][kJointsPerCharacter];
  float high[3][kJointsPerCharacter];
  uint32_t count;
  uint32_t pad[31];
};

PELT_BLOCK BoundsBlock {
  float low[3];
  float high[3];
  uint32_t pad[26];
};

PELT_BLOCK LodBlock {
  float fraction;        // share of every chunk's strands that live this frame, [0, 1]
  float fade;            // share of every chunk's strands, at the end of the prefix, that fade out
  uint32_t visible;      // 0: outside the view; the layer does nothing
  uint32_t was_visible;  // last frame's
  float wanted;          // fraction before hysteresis and budget
  uint32_t chain_level;  // of every patch CountChains(vertices, chain_level) chains are simulated
  float parent_share;    // of the loads of those of them that the next level leaves out
  uint32_t pad[25];
};

PELT_BLOCK LayerSortBlock {
  uint32_t visible_count;  // strands in front of everything keyed kCulledKey
  uint32_t keys_changed;   // some chunk's keys differ from last frame's: the layer is sorted again
  uint32_t records_changed;  // some chunk's records were written: vertices are generated again
  uint32_t pad[29];
};

// What lights a layer: its surroundings as spherical harmonics of the radiance, and what is shaded
// with by itself (core/surroundings.hpp). Colours are linear.
PELT_BLOCK LayerLightBlock {
  float harmonics[3][kHarmonics];  // red, green, blue; order 00, 1-1, 10, 11, 2-2 .. 22, 3-3 .. 33
  float ambient[3];                // mean radiance
  float sun_direction[3];
  float sun_rgb[3];
  float rim_direction[3];
  float rim_rgb[3];
  float rim_exponent;
};

// ---- Shells (core/chunk.hpp) --------------------------------------------------------------------

inline constexpr uint32_t kMaxShells = 40;

enum class ConeKind : uint8_t { kExact, kPublished };

// What a layer of shells is given by its setup; does not change.
PELT_BLOCK ShellLayerBlock {
  uint32_t most;         // shells, up close
  float shadow;          // light left at the skin, 0..1
  float texture_repeat;  // of the fur's texture, along 0..1 of the skin's coordinates
  float cone;            // least cosine between force and normal
  uint32_t cone_kind;    // ConeKind
  uint32_t pad[27];
};

// One shell, as it is drawn.
struct Shell {
  float height;     // h
  float shadow;     // share of the light that gets down to it
  float threshold;  // drawn where the texture, times the stencil, is above
  float fade;       // alpha: below 1 where the last shell is about to go
};
PELT_BLOCK ShellLodBlock {
  Shell shell[kMaxShells];  // `count` of them; zero behind
  uint32_t count;
  float texture_repeat;
  uint32_t pad[30];
};

// ---- Scene --------------------------------------------------------------------------------------

// Layers in draw order.
PELT_BLOCK DrawListBlock {
  uint32_t layer[kLayersPerScene];
  uint32_t count;
  uint32_t pad[31];
};

// Blocks are whole transfers.

static_assert(sizeof(LayerBlock) == 128);
static_assert(sizeof(LayerOriginBlock) == 128);
static_assert(sizeof(LayerJointBlock) % 128 == 0 && sizeof(BoundsBlock) == 128);
static_assert(sizeof(LodBlock) == 128 && sizeof(LayerSortBlock) == 128);
static_assert(sizeof(LayerLightBlock) == 256);
static_assert(sizeof(ShellLayerBlock) == 128 && sizeof(ShellLodBlock) == 768);

}  // namespace pelt
