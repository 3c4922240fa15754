// Which way a layer's fur lies, as a texture over the character's UVs: what shades fur as relief on the skin, or combs
// shells. Made from comb, attributes and maps, without what is drawn at random.
//
// A texel has four bytes. Red and green: the direction from root to tip, seen from above, in texture space, as
// 128 + 127 x for u and for v; its length is the share of the strand that lies along the skin, so that flat fur has 1
// and fur that stands up 0. Blue: the strand's length over longest_m, 1 to 255. Alpha: how densely fur grows, of the
// layer's densest; 0 is bald. Rows from v = 0, as glTF's images; the texture repeats.
//
// UVs may give one place of the texture to several of the surface. Parts of the surface that hang together ("islands")
// are laid down in the order of their first triangles, each on the first sheet that has room for it; sheets lie below
// each other. Texels that no triangle has get the nearest one's, so that no seam is seen when texels are mixed.
//
// Invariant: the same bytes on every machine.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "core/character/character.hpp"
#include "core/groom/fur_setup.hpp"

namespace pelt {

class SurfaceColour;
struct SurfacePoint;

struct FlowMap {
  static constexpr uint16_t kNoSheet = std::numeric_limits<uint16_t>::max();

  uint32_t side = 0, sheets = 0;  // texels a side of a sheet
  float longest_m = 0.0f;
  std::vector<uint8_t> rgba;  // side x (side * sheets)
  std::vector<uint16_t>
      sheet;               // of each triangle of the mesh; kNoSheet where the layer cannot grow
  uint64_t covered = 0;    // texels that triangles have
  uint64_t contested = 0;  // of these, texels that two of one sheet have: they got the first one's
};

inline constexpr uint32_t kMostFlowSide = 4096, kMostFlowSheets = 64;

// `side` is 1 to kMostFlowSide. Throws pelt::Error "path: layer 'x': flow map: reason" for a mesh without UVs, for UVs that
// go round the texture more than twice within a triangle, and for ones that need more than kMostFlowSheets.
FlowMap MakeFlowMap(const Character&, const RestGeometry&, const FurSetup&, const LayerSetup&,
                    uint32_t side);

// How densely the layer grows and nothing else: the flow map's alpha, on the same sheets.
struct GrowthMap {
  uint32_t side = 0, sheets = 0;
  std::vector<uint8_t> share;   // side x (side * sheets)
  std::vector<uint16_t> sheet;  // as FlowMap's
};

// `surface` as Growth has it. Throws as MakeFlowMap.
GrowthMap MakeGrowthMap(const Character&, const RestGeometry&, const FurSetup&, const LayerSetup&,
                        uint32_t side, std::shared_ptr<const SurfaceColour> surface = nullptr);

// The layer's own `flow_map`, read back: what MakeFlowMap wrote, or a picture of an artist's. Nothing without one.
class PaintedFlow {
 public:
  // `surface` as Growth has it. References are kept. Throws as MakeFlowMap, where the map has several sheets, and for
  // another number of them than this layer's.
  PaintedFlow(const Character&, const RestGeometry&, const FurSetup&, const LayerSetup&,
              std::shared_ptr<const SurfaceColour> surface);

  // Unit, in the rest pose; none where the map holds a vector of no direction, or the triangle has no area in it.
  std::optional<glm::dvec3> Direction(const SurfacePoint&, const glm::dvec3& normal) const;
  // In metres; none where the map has no lengths.
  std::optional<float> Length(const SurfacePoint&) const;

 private:
  const ControlMap* SheetAt(uint32_t triangle) const;

  const Mesh& mesh_;
  const RestGeometry& rest_;
  const FlowMapSetup* setup_ = nullptr;
  std::vector<ControlMap> cut_;  // where there is more than one sheet
  std::vector<uint16_t> sheet_;  // likewise, of each triangle
};

// value(place) at each texel of the character's texture, side x side, rows from v = 0. Where the UVs give it to several
// places the least of them, and where to none the nearest one's, so that no seam is seen. `place` is for messages.
// Throws pelt::Error as MakeFlowMap, but knows no sheets.
std::vector<uint8_t> MakeSkinTexels(const Mesh&, uint32_t side, const std::string& place,
                                    const std::function<uint8_t(const SurfacePoint&)>& value);

// Where fur grows at all, for an engine's shader: the largest share that any enabled layer has (GrowthMap::share).
std::vector<uint8_t> MakeStencil(const Character&, const RestGeometry&, const FurSetup&,
                                 uint32_t side);

}  // namespace pelt
