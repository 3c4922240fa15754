// The way out of a frame: what there is to draw, layer by layer, far to near.
//
//   for (const LayerDraw& draw : scene.Draws())
//     Upload(draw.vertices), Draw(draw.output, draw.strand_count);
//
// `vertices` lies in the scene's memory: nothing is copied, and it is good until the next frame
// runs. Its bytes are described in jobs/DRAWING.md, with shaders that read them. Those who draw in
// a way of their own take a layer's strands as points (FurScene::CopyCurves).
//
// Invariant: layers come in drawing order, and only those with a strand to draw.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/groom/strand_texture.hpp"
#include "core/outputs.hpp"
#include "jobs/frame.hpp"

namespace pelt {

// How a layer of shells is drawn: its triangles, `shell` by `shell` from the skin up, each vertex at
// position + h groom + h^2 force; then its fins. All but the shells and the fins stays the same from
// frame to frame.
struct ShellDraw {
  std::span<const Shell> shell;
  float texture_repeat = 0.0f;
  float shadow = 1.0f;  // light left at the skin: at height h there is 1 + (shadow - 1) (1 - h)
  // For each patch of the layer its vertices' places on the skin; a patch has kVerticesPerChunk places
  // among the draw's vertices. For each chunk its triangles, and which vertices their corners are.
  std::span<const ShellSkinBlock> skin;
  std::span<const StrandBlock> triangles;
  std::span<const HaloBlock> halo;
  std::span<const FinBlock> fins;  // of its chunks too; empty of a layer without
};

// An edge of the skin that is drawn out along the fur: a quad, or as many as follow the fur's bend,
// from the skin at h = 0 up to h = 1, both ends at position + h groom + h^2 force of their vertex.
struct Fin {
  uint32_t from, to;  // among the draw's vertices
  uint32_t fade;      // of 255, above 0: what its colour and alpha are multiplied with
};

struct LayerDraw {
  uint32_t layer;  // of the scene
  Output output;   // its entry of kOutputs says what a vertex is
  // Shells: of every vertex of the layer, in the order of `shells.skin`; strand_count is 0, and no
  // strand has an order. VertexOrder::kSorted: of the strands to draw, in drawing order. kIndexBuffer: of every place
  // of the layer, in strand order, those that `order` does not name holding anything.
  std::span<const std::byte> vertices;
  // To draw: instances, or times OutputEntry::vertices_per_strand vertices.
  uint32_t strand_count;
  // The strand at each place of the drawing order, in either VertexOrder.
  std::span<const uint32_t> order;
  uint32_t live_strands;  // what CopyCurves has: culled ones too, and none that is cut off
  // What all places of the draw are relative to, world, m: 0 but in scenes whose characters have
  // origins of their own.
  double origin[3];
  float low[3], high[3];  // box around the layer's strands; m
  float tip_width;        // over the width at the root: instances do not carry it
  // Straight pieces that instances' curves are drawn with from where the camera is (CurvePieces).
  uint32_t pieces;
  // Of a lit layer: a record for each place in strand order, found by the strand's number, those of
  // strands that do not live holding anything; and what lights it. Else empty, and null.
  std::span<const LookRecord> looks;
  const LayerLightBlock* light;
  ShellDraw shells;  // of a layer of shells, else empty
  // Of a painted layer, whose colours are left dry and clean: the share of its brightness that a
  // soaked strand keeps, and the sRGB colour that mud is mixed in with. Else 1, and 0.
  float wet_darken, mud_colour[3];
  const LayerLook* look;                // how the layer takes light, as long as the scene lives
  const StrandTexture* strand_texture;  // the artist's, likewise; null: none

  const OutputEntry& format() const { return kOutputs[size_t(output)]; }
  // The vertices as what they are, CurveRecord, RibbonVertex, LineVertex or ShellVertex;
  // empty for another format's type.
  template <class Vertex>
  std::span<const Vertex> As() const {
    if (&kVertexType<Vertex> != format().vertex_type) return {};
    return {reinterpret_cast<const Vertex*>(vertices.data()), vertices.size() / sizeof(Vertex)};
  }
};

// Straight pieces, 2 to 8, of which strands of up to so many pixels are drawn: a strand that bends by 1.5 rad
// over all of its length is at most length * 1.5 / (8 n^2) off its n pieces, which is kept to a quarter of a
// pixel up to 85 px. 99 % of the strands of `monster`, `stage` and `cast` are within 0.3, 0.45 and 0.44 px.
inline constexpr uint32_t kMostPieces = 8;
constexpr uint32_t CurvePieces(float longest_px) {
  uint32_t pieces = 2;
  while (pieces < kMostPieces && 4.0f * float(pieces * pieces) < 3.0f * longest_px) ++pieces;
  return pieces;
}

// Of a frame that has run; `draws` has room for the scene's layers.
void FindDraws(const FrameMemory& memory, VertexOrder vertex_order, std::vector<LayerDraw>& draws);
uint32_t CopyCurves(const FrameMemory& memory, uint32_t layer, std::span<StrandCurve> out);
// Whether a strand of a chunk is among the share of its living ones that stand for all: their first, which cover
// the chunk evenly.
constexpr bool IsAmongFirst(const ChunkStateBlock& chunk, uint32_t strand, float share) {
  return float(strand % kStrandsPerChunk) < share * float(chunk.live_strands);
}
uint32_t FindShadowPlaces(const FrameMemory& memory, VertexOrder vertex_order, uint32_t layer,
                          float share, std::span<uint32_t> places);
// Where the points behind the roots of a patch's chains at mesh vertices are. Of modal ones the frame keeps the state
// alone, and they are worked out here.
PointBlock<4> CopyChainPoints(const FrameMemory& memory, uint32_t patch);

// Of any layer at any time: its triangles and their places on the skin do not change. Empty for layers
// of strands.
ShellDraw FindShells(const FrameMemory& memory, uint32_t layer);

// Indices of a layer's triangles among its draw's vertices, three each, counter-clockwise from
// outside as the mesh has them; the same in every frame. Returns how many there are, and writes
// those there is room for.
uint32_t WriteShellIndices(const ShellDraw& shells, std::span<uint32_t> indices);

// The fins that are seen in this frame, in the order of their triangles. Returns how many there are,
// and writes those there is room for.
uint32_t WriteFins(const ShellDraw& shells, std::span<Fin> fins);

}  // namespace pelt
