// The chunk: a fixed-capacity SoA piece of one layer. The unit of work, of DMA, of locality and of
// LOD.
//
// A chunk holds the strands of a part of the skin in progressive order, so any prefix of its lanes
// covers the part evenly. What they share, the mesh's vertices and the chains on these, lies in the
// layer's patches: as many lanes, each vertex once. A chunk lists those that its strands use, its
// halo, and its strands count in that list.
//
//      lanes ->  0        1        2              S-1
//   point 1  x [ x0       x1       x2      ...    x(S-1) ]   one row: S floats, 128-byte aligned
//            y [ y0       y1       ...                   ]
//            z [ z0       ...                            ]
//   point 2  x [ ...                                     ]
//
// Invariants: every block is a trivially copyable struct whose size is a multiple of 128 bytes (its
// size is the DMA size); unused lanes hold a copy of the last used lane, so kernels need no
// remainder loop and padding never produces infinities.
//
// Units: metres, seconds, radians; colours are sRGB bytes.
#pragma once

#include <cstdint>

#include "core/stream_table.hpp"

namespace pelt {

#ifndef PELT_CHUNK_STRANDS
#define PELT_CHUNK_STRANDS 128
#endif

inline constexpr uint32_t kStrandsPerChunk = PELT_CHUNK_STRANDS;
inline constexpr uint32_t kVerticesPerChunk = kStrandsPerChunk;  // of a patch, and of a halo
static_assert(kStrandsPerChunk == 64 || kStrandsPerChunk == 128 || kStrandsPerChunk == 256,
              "strands address their chunk's vertices with 8 bits");

// Blocks of another capacity are other types of the same names. So every file that knows blocks
// refers to a symbol that has its capacity in the name, and the library has the one it was built
// for: a program compiled for another does not link.
#define PELT_JOIN(a, b, c) a##b##c
#define PELT_CAPACITY_SYMBOL(strands) PELT_JOIN(pelt_is_built_for_chunks_of_, strands, _strands)
extern "C" const char PELT_CAPACITY_SYMBOL(PELT_CHUNK_STRANDS);
namespace {
[[gnu::used]] const char* const kLibraryCapacity = &PELT_CAPACITY_SYMBOL(PELT_CHUNK_STRANDS);
}

// Widest vector any kernel is built for; lane counts are rounded up to it.
inline constexpr uint32_t kLaneGroup = 16;
// Always inline, as what is called within kernels: no copy of it that needs an instruction set.
[[gnu::always_inline]] constexpr uint32_t RoundUpToLaneGroups(uint32_t lanes) {
  return (lanes + kLaneGroup - 1) / kLaneGroup * kLaneGroup;
}
inline constexpr uint32_t kJointsPerCharacter = 256;
// Dense weight rows of one patch: on average 8 joints for each group of 16 vertices.
inline constexpr uint32_t kVertexGroups = kVerticesPerChunk / kLaneGroup;
inline constexpr uint32_t kInfluenceRows = kVertexGroups * 8;
inline constexpr uint32_t kSpheresPerScene = 8;
inline constexpr uint32_t kCapsulesPerScene = 8;
inline constexpr uint32_t kBrushesPerScene = 16;
inline constexpr uint32_t kForceVolumesPerScene = 8;
inline constexpr uint32_t kRibbonPoints = 5;

// Strands have 4, 5 or 9 points, the root too.
inline constexpr uint32_t kMostStrandPoints = 9;
// Calls visit<points>().
template <class Visit>
constexpr decltype(auto) WithPoints(uint32_t points, Visit&& visit) {
  if (points == 9) return visit.template operator()<9>();
  if (points == 5) return visit.template operator()<5>();
  return visit.template operator()<4>();
}

// ---- Character, once per frame ------------------------------------------------------------------

// Pose input, filled on the caller's thread: for each joint up to four keys of every channel and
// the weights that blend them (step 1,0,0,0; linear and slerp a,0,0,b; cubic spline: value, out
// tangent * dt, in tangent * dt, value, with Hermite weights). Rotations are xyzw quaternions, made
// neighbours (dot >= 0) by the caller for slerp; the sum is normalised by the kernel.
PELT_BLOCK PoseBlock {
  float translation_key[4][3][kJointsPerCharacter];
  float rotation_key[4][4][kJointsPerCharacter];
  float scale_key[4][3][kJointsPerCharacter];
  float translation_weight[4][kJointsPerCharacter];
  float rotation_weight[4][kJointsPerCharacter];
  float scale_weight[4][kJointsPerCharacter];
  float root[12];        // world placement of the character: row-major 3x4
  uint32_t joint_count;  // skeleton nodes in use
  uint32_t teleported;   // not 0: fur starts from its groom this frame
  uint32_t pad[18];
};

// How fast a pose's joints move at its time: derivatives of their transforms relative to their
// parents. Where a velocity jumps there, the mean of both sides.
PELT_BLOCK PoseRateBlock {
  float translation[3][kJointsPerCharacter];  // units of the character file, 1/s
  float spin[3][kJointsPerCharacter];         // rad/s, in the parent's axes
  float scale[3][kJointsPerCharacter];        // 1/s
  float root[12];                             // of PoseBlock::root, 1/s
  uint32_t given;                             // 0: nothing is known in this frame
  uint32_t pad[19];
};

// Skeleton nodes in parent-first order: skin joints and every ancestor of one.
PELT_BLOCK SkeletonBlock {
  int32_t parent[kJointsPerCharacter];  // -1 for a root; always below its own index
  float inverse_bind[kJointsPerCharacter][12];
};

PELT_BLOCK LocalPoseBlock {
  float translation[3][kJointsPerCharacter];
  float rotation[4][kJointsPerCharacter];  // unit xyzw
  float scale[3][kJointsPerCharacter];
};

// Mesh space to world, row-major 3x4: row r of joint j is matrix[j][4*r .. 4*r+3].
PELT_BLOCK PaletteBlock {
  float matrix[kJointsPerCharacter][12];
  uint32_t
      moved[kJointsPerCharacter / 32];  // bit j: matrix j differs from last frame's in some bit
  uint32_t teleported;
  uint32_t pad[23];
};

// Derivatives of PaletteBlock's matrices, 1/s.
PELT_BLOCK PaletteRateBlock { float matrix[kJointsPerCharacter][12]; };

// ---- Patch and chunk, baked ---------------------------------------------------------------------

// What is known of a patch's vertices.
PELT_BLOCK PatchBlock {
  uint32_t joint_mask[kJointsPerCharacter / 32];  // joints that move any of them
  // Of each group of kLaneGroup: some strand uses one from it on once more than this share of the
  // layer's strands live. Ascending.
  float live_from[kVertexGroups];
  uint32_t vertex_count;
  uint32_t pad[23 - kVertexGroups];
};

// A patch's chains thin by halves. Those left out at a level follow three that are kept.
inline constexpr uint32_t kChainLevels = 4;

// The prefix of a patch's chains that is simulated at a level: all, half, a quarter, an eighth, in
// whole groups of lanes.
constexpr uint32_t CountChains(uint32_t vertices, uint32_t level) {
  const uint32_t share = (vertices + (1u << level) - 1) >> level;
  const uint32_t count = (share + kLaneGroup - 1) / kLaneGroup * kLaneGroup;
  return count < vertices ? count : vertices;
}

// Whom a chain follows that its patch's level leaves out: lanes of the coarser prefix that ends before
// it, byte k of a word and share k, which sum to 1. Of the first prefix 0.
PELT_BLOCK ChainParentBlock {
  uint32_t lanes[kVerticesPerChunk];
  float share[3][kVerticesPerChunk];
};

// The patch's mesh vertices in mesh (bind) space. Skinning is dense in groups of 16 vertices: a
// group lists the joints any of its vertices uses, ascending, with one row of 16 weights each (0
// where unused). No gather is needed; the sum over joints runs in ascending joint order for every
// vertex, so it does not depend on whom a vertex shares its patch with.
PELT_BLOCK MeshBlock {
  float position[3][kVerticesPerChunk];
  float normal[3][kVerticesPerChunk];
  float tangent[3][kVerticesPerChunk];
  float weight[kInfluenceRows][kLaneGroup];
  uint8_t row_joint[kInfluenceRows];
  // Weight rows of group g: [group_first_row[g], group_first_row[g + 1]).
  uint16_t group_first_row[kVertexGroups + 1];
  uint16_t vertex_count;
  uint8_t pad[(128 - (2 * (kVertexGroups + 2) + kInfluenceRows) % 128) % 128];
};

// What every strand of the chunk was given by the groom. The root frame is (tangent, bitangent,
// normal) with bitangent = normal x tangent.
PELT_BLOCK StrandBlock {
  float bary[3][kStrandsPerChunk];         // of the three vertices; sums to 1
  float length[kStrandsPerChunk];          // root to tip along the strand, m
  float width[kStrandsPerChunk];           // full width at the root, m
  uint32_t base_colour[kStrandsPerChunk];  // 0xAABBGGRR
  uint32_t tip_colour[kStrandsPerChunk];
  uint8_t vertex[3][kStrandsPerChunk];            // places in the chunk's halo
  uint8_t control[kStrandsPerChunk];              // chunk-local clump control strand
  uint8_t film_strip[kStrandsPerChunk];           // texture index
  uint32_t joint_mask[kJointsPerCharacter / 32];  // joints that move any vertex of the halo
  uint32_t strand_count;
  uint32_t vertex_count;  // of the halo
  // Strands [0, control_count) are the clump controls, a multiple of kLaneGroup (or 0): they are
  // solved first and never clump, so the result cannot depend on the lane count.
  uint32_t control_count;
  uint32_t
      first_strand;  // layer-wide index of lane 0: chunk's place in its layer * kStrandsPerChunk
  uint32_t pad[20];
};

// The mesh vertices that the chunk's strands use, in the order of their first use, as places in the
// layer: patch in layer * kVerticesPerChunk + lane. Behind them ~0.
PELT_BLOCK HaloBlock { uint32_t vertex[kVerticesPerChunk]; };

// The patches that those lie in, numbered in the layer, ascending, and behind them ~0. Where the last
// entry is another, there are more.
inline constexpr uint32_t kListedPatches = 31;
PELT_BLOCK PatchListBlock { uint32_t patch[kListedPatches + 1]; };

// Where on the skin's texture each strand stands: u in the low 16 bits, v above, of 65535, repeated
// beyond.
PELT_BLOCK StrandUvBlock { uint32_t uv[kStrandsPerChunk]; };

// Rest shape of a chain or strand of kPoints points: offsets of points 1.. from the root, in the
// root frame (x along tangent, y bitangent, z normal), m. All segments of a lane have the same
// length.
template <uint32_t kPoints>
PELT_BLOCK RestBlock {
  float offset[kPoints - 1][3][kStrandsPerChunk];
  float segment_length[kStrandsPerChunk];
  float strength[kStrandsPerChunk];  // simulation strength: 0 follows the skin rigidly, 1 fully
                                     // simulated
};

// Of layers that are sag-free, whose groomed shape is where their chains rest under gravity: which
// way is down at each chain's root in the rest pose, in its root frame; unit.
PELT_BLOCK DownBlock { float down[3][kStrandsPerChunk]; };

// Of layers whose strands have traits: what a chain or strand has of its own. The modal solver takes clump, weight
// and bounce.
inline constexpr uint32_t kTraitLinks = 4;
PELT_BLOCK TraitBlock {
  // Factor on the hardness of each link's joint, root first.
  float stiffness[kTraitLinks][kStrandsPerChunk];
  float drag[kStrandsPerChunk];   // more than the layer's, 1/s
  float clump[kStrandsPerChunk];  // factor on the layer's, as are weight and bounce
  float weight[kStrandsPerChunk];
  float bounce[kStrandsPerChunk];
  // Least cosine between a link and where the one above it would carry it from the groom; below -1: any.
  float least_cosine[kStrandsPerChunk];
};

// ---- Patch and chunk, every frame ---------------------------------------------------------------

enum ChunkFlag : uint32_t {
  kChunkVisible = 1u << 0,   // something of it lives, and is in view
  kChunkSkin = 1u << 1,      // skin and anchors run; roots
  kChunkSimulate = 1u << 2,  // wind and simulate run
  kChunkFit = 1u << 3,       // interpolate and fit run; what bends shells
  kChunkKeys = 1u << 4,      // sort keys run
  kChunkRestart =
      1u << 5,  // no last frame to take motion from: motion is 0, chains start from the groom
  kChunkPainted = 1u << 6,  // a brush changed the paint of some strand in this frame
  kChunkSteady = 1u << 7,   // what simulate reads is as in the last frame, but for its own state
};

// What of a patch or chunk runs this frame, and why. Written by `activate_patch` and `activate`, but for `cut`;
// simulate, sort_key and paint_strands report back. Of a patch what is about strands is 0.
PELT_BLOCK ChunkStateBlock {
  uint32_t flags;          // ChunkFlag
  uint32_t live_strands;   // prefix of strands that live; 0 when culled
  uint32_t live_vertices;  // prefix of vertices that live, of the patch; of the halo: those in use
  uint32_t first_new_strand;  // lanes from here on (below live_strands) start from the groom
  uint32_t first_new_vertex;
  float live_exact;        // fraction * strand_count before rounding up: fades the last strands
  float fade_count;        // strands over which the fade runs; 0: no fade
  uint32_t moved;          // some joint of its own moved this frame
  uint32_t was_moved;      // the same, last frame
  uint32_t state_changed;  // simulate: some live lane's state differs from last frame's in some bit
  uint32_t keys_changed;   // sort_key: some key differs from last frame's
  uint32_t records_changed;  // fit ran this frame
  uint32_t first_place;      // the chunk's place in its layer * kStrandsPerChunk
  uint32_t visible_strands;  // sort_key: lanes not keyed kCulledKey; of shells all; 0 when culled
  // Of a patch: of the living vertices those whose chains are simulated; from which on such start from
  // the groom; before which all keep their loads, and what share those behind take from their parents.
  uint32_t live_chains;
  uint32_t first_new_chain;
  uint32_t whole_chains;
  float parent_share;
  uint32_t cut[kStrandsPerChunk / 32];  // bit l of all: strand l is cut off. Set by the caller
  uint32_t pad[14 - kStrandsPerChunk / 32];
};

constexpr bool IsCut(const ChunkStateBlock& chunk, uint32_t lane) {
  return (chunk.cut[lane / 32] >> lane % 32 & 1) != 0;
}

// Skinned vertices as four 16-byte records each: position, normal, tangent (unit), motion since
// last frame. The fourth float of every record is 0.
struct SkinnedVertex {
  float position[4];
  float normal[4];
  float tangent[4];
  float motion[4];
};
PELT_BLOCK SkinnedBlock { SkinnedVertex vertex[kVerticesPerChunk]; };

// Where chains are fixed: strand roots or vertex anchors. Normal and tangent are unit and
// orthogonal.
PELT_BLOCK RootBlock {
  float position[3][kStrandsPerChunk];
  float normal[3][kStrandsPerChunk];
  float tangent[3][kStrandsPerChunk];
  float motion[3][kStrandsPerChunk];  // since last frame, m
};

// How fast they go at the frame's end: derivatives of RootBlock's rows by time.
PELT_BLOCK RootRateBlock {
  float velocity[3][kStrandsPerChunk];  // m/s
  float spin[3][kStrandsPerChunk];      // of normal and tangent, rad/s, world
};

// The same of mesh vertices whose strands have chains of their own, as records that these blend:
// velocity, m/s, and how fast normal and tangent change, 1/s.
struct VertexRates {
  float velocity[4];
  float normal[4];
  float tangent[4];
};
PELT_BLOCK VertexRateBlock { VertexRates vertex[kVerticesPerChunk]; };

// Wind acceleration at the chain's root, m/s^2 (response included).
PELT_BLOCK WindBlock { float acceleration[3][kStrandsPerChunk]; };

// World positions of points 1 .. kPoints-1; point 0 is the root. Used for the present and the last
// frame.
template <uint32_t kPoints>
PELT_BLOCK PointBlock {
  float position[kPoints - 1][3][kStrandsPerChunk];
};

// What the strands take of the chain at a mesh vertex, as records. Modal: of each node the load on it
// and the multiplier of its length, times a part's length; m/s^2 (kernels/modal_load.hpp). Else of
// each point how far it is from the groom, m per metre of chain.
struct ChainLoad {
  float part[3][4];
};
PELT_BLOCK LoadBlock { ChainLoad vertex[kVerticesPerChunk]; };

// One strand, ready to draw, in one 64-byte DMA element: P(t) = c0 + t (c1 + t (c2 + t c3)), t in
// [0, 1].
struct alignas(16) CurveRecord {
  float curve[4][3];     // c0 (the root), c1, c2, c3; m, world
  uint32_t base_colour;  // 0xAABBGGRR; alpha carries the LOD fade
  uint32_t tip_colour;
  float width;   // full width at the root, m
  uint32_t tag;  // strand in layer (low 24 bits), film strip (high 8)
};
PELT_BLOCK CurveBlock { CurveRecord record[kStrandsPerChunk]; };

// One strand of a ribbon layer: five of its points at equal parameters (fit_ribbon.hpp).
struct alignas(16) RibbonRecord {
  float point[kRibbonPoints][3];
  uint32_t base_colour;
  uint32_t tip_colour;
  float width;
  uint32_t tag;
  uint32_t pad;
};
PELT_BLOCK RibbonBlock { RibbonRecord record[kStrandsPerChunk]; };

// ---- Sorting ------------------------------------------------------------------------------------

inline constexpr uint32_t kCulledKey = 0xffffffffu;

// Ascending keys are far to near; back-facing and dead strands are keyed kCulledKey. Ties by strand
// index.
PELT_BLOCK SortKeyBlock { uint32_t key[kStrandsPerChunk]; };

// Layer-wide strand indices (chunk in layer * kStrandsPerChunk + lane) in draw order; piece i of
// the layer holds places [i * kStrandsPerChunk, (i + 1) * kStrandsPerChunk).
PELT_BLOCK OrderBlock { uint32_t strand[kStrandsPerChunk]; };

struct SortPair {
  uint32_t key;
  uint32_t strand;
};
PELT_BLOCK SortPairBlock { SortPair pair[kStrandsPerChunk]; };
inline constexpr uint32_t kDigitBins = 256;
PELT_BLOCK DigitBlock { uint32_t bin[kDigitBins]; };

// ---- Output -------------------------------------------------------------------------------------

PELT_BLOCK InstanceBlock { CurveRecord instance[kStrandsPerChunk]; };

struct RibbonVertex {
  float position[3];
  float tangent[3];  // unit, root to tip
  uint32_t colour;   // 0xAABBGGRR
  // Bits 0-7: u across the hair, 0 or 255; 8-15: film strip; 16-31: v from root to tip, unorm.
  uint32_t texture;
};
static_assert(sizeof(RibbonVertex) == 32);
PELT_BLOCK RibbonVertexBlock { RibbonVertex vertex[kStrandsPerChunk][kRibbonPoints][2]; };

// A point of a strand, as many as ribbons have, root first.
struct LineVertex {
  float position[3];
  float width;  // full, m
  // Unit, root to tip, and v, 0 at the root and 1 at the tip: x, y, z, v, each 16 bits signed
  // normalised, x and z in the low half of their word.
  uint32_t tangent_v[2];
  uint32_t colour;  // 0xAABBGGRR
  uint32_t tag;     // CurveRecord::tag
};
static_assert(sizeof(LineVertex) == 32);
PELT_BLOCK LineVertexBlock { LineVertex vertex[kStrandsPerChunk][kRibbonPoints]; };

// What can be on a strand, as bytes of a word from the low one up.
enum class PaintChannel : uint32_t { kMud, kSnow, kWet, kDust };
inline constexpr uint32_t kPaintChannels = 4;

// What brushes have left on each strand: an amount of 255 for each channel. State, as the points
// are.
PELT_BLOCK PaintBlock { uint32_t amounts[kStrandsPerChunk]; };

// What a strand of a lit layer is shaded with.
struct alignas(16) LookRecord {
  uint32_t normal;  // of the skin, world: octahedral, x low, y high, 16 bits signed normalised each
  uint32_t uv;      // StrandUvBlock
  uint32_t amounts;  // of 255 for each PaintChannel; weather included
  uint32_t random;   // the same in every frame
};
PELT_BLOCK LookBlock { LookRecord record[kStrandsPerChunk]; };

// ---- Shells -------------------------------------------------------------------------------------
//
// Fur as copies of the skin, one above the other, each drawn where a texture says that hair reaches
// so high. A vertex at height h, 0 at the skin and 1 at the tips, is at P(h) = p + h g + h^2 f.
// The strands of such a layer are its triangles, all of which live: StrandBlock::vertex has their
// corners. The rest of the frame then treats a chunk of skin as it does any other.

// Baked, of a chunk's vertices.
PELT_BLOCK ShellSkinBlock {
  float uv[kVerticesPerChunk][2];           // on the skin's texture
  uint32_t base_colour[kVerticesPerChunk];  // 0xAABBGGRR; alpha is the stencil: share of the fur
  uint32_t tip_colour[kVerticesPerChunk];
};

struct alignas(16) ShellVertex {
  float position[3];     // p, m, world
  uint32_t base_colour;  // 0xAABBGGRR; alpha is the stencil
  float groom[3];        // g, m
  uint32_t tip_colour;
  float force[3];   // f, m
  uint32_t normal;  // of the skin: as LookRecord has it
};
static_assert(sizeof(ShellVertex) == 48);
PELT_BLOCK ShellVertexBlock { ShellVertex vertex[kVerticesPerChunk]; };

// Fins: where the skin is seen from the side one looks between its shells, so the triangles' edges
// there are drawn out along their hairs. Edge k of a triangle goes from its corner k to the next.
//
// Baked: byte k of a triangle's word is 255 where it owns its edge k, else 0. Of the triangles that
// share an edge one owns it, in whichever chunks they are.
PELT_BLOCK FinEdgeBlock { uint32_t owned[kStrandsPerChunk]; };

// Byte k of a triangle's word: how much of the fin on its edge k is seen, of 255; 0: none is drawn.
PELT_BLOCK FinBlock { uint32_t fade[kStrandsPerChunk]; };

// Blocks are whole transfers.

static_assert(sizeof(PoseBlock) % 128 == 0 && sizeof(PaletteBlock) % 128 == 0);
static_assert(sizeof(MeshBlock) % 128 == 0 && sizeof(StrandBlock) % 128 == 0);
static_assert(sizeof(ChunkStateBlock) == 128);
static_assert(sizeof(CurveRecord) == 64 && sizeof(RibbonRecord) == 80);

}  // namespace pelt
