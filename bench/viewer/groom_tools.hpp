// What an artist does to a setup on the page: comb vectors drawn on the skin, and maps painted over it. Places of the
// pointer are shares of the picture as it was drawn last, from the left and from the top. Setups are the scene's, by
// number.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/viewer/map_brush.hpp"
#include "bench/viewer/viewer.hpp"

namespace pelt {

class GroomTools {
 public:
  // Which must outlive it.
  explicit GroomTools(Viewer& viewer) : viewer_(viewer) {}

  // JSON of a layer's comb vectors on the first character that has the setup: `position`, `direction` and `reach` as
  // the setup has them, `root` and `tip` in the picture, `ring` (the reach in heights of the picture), `lift` above the
  // skin in degrees, and whether the skin `faces` the eye.
  std::string DescribeCombs(size_t setup, std::string_view layer);
  // One of them, {position, direction, reach}, changed by the pointer: its root follows, or its tip, which gives
  // direction and reach; so many degrees above the skin. "null" where a root would be beside the skin.
  enum class CombPart { kRoot, kTip };
  std::string MoveComb(size_t setup, std::string_view vector, CombPart part, double x, double y,
                       double lift);

  // Takes a layer's map to be painted, in so many texels a side; where it has none one that is `empty`, 0 to 1. Returns
  // why that cannot be, or nothing.
  std::string BeginMap(size_t setup, std::string_view layer, std::string_view key, uint32_t side,
                       double empty);
  // Paints on the way from one place to another. Returns the brush's radius in heights of the picture; 0: no skin is
  // there, or no map was begun.
  double PaintMap(const glm::dvec2& from, const glm::dvec2& to, double radius, double hardness,
                  double value);
  // As a grey PNG of 8 bits.
  std::string MapPng() const;
  // Has the layer's key lead to a map of that name in the setup's folder, and the scene made of it.
  void TakeMap(size_t setup, std::string_view layer, std::string_view key, std::string_view name);

  // The path of a name in the setup's folder.
  std::string PathOf(size_t setup, std::string_view name) const;
  // JSON: the setup's `file`, its `maps`, each by its `name` in the setup and its `path`, and the `digest` that
  // `pelt bake` prints of it.
  std::string DescribeFiles(size_t setup) const;

 private:
  struct Painted {
    size_t setup;
    std::vector<glm::vec3> rest;  // of the mesh's vertices
    MapBrush brush;
    std::vector<uint8_t> texels;
  };
  const LayerSetup* FindLayer(size_t setup, std::string_view layer) const;
  // The first that has the setup; null: none has.
  const Actor* FindActor(size_t setup) const;
  const RestGeometry& RestOf(const Actor& actor);

  Viewer& viewer_;
  std::optional<Painted> painted_;
  RestGeometry rest_;  // of one actor of one scenario
  const Actor* rest_of_ = nullptr;
  uint64_t rest_load_ = 0;
};

}  // namespace pelt
