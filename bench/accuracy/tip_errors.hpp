// How far the tips of a scene's strands are off the reference, held against the bound that their quality states
// (ErrorShare, core/modal/quality_on_screen.hpp).
//
// Both are shares of the layer's longest strand, as the bound is a length before it is in pixels: no tip is nearer to
// the eye than its layer's box, so what holds in shares holds on the screen.
//
// Only of layers whose setup has the modal solver: what PBD's or Verlet's parameters do in another is nobody's fur.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bench/accuracy/scene_points.hpp"
#include "bench/accuracy/scene_way.hpp"

namespace pelt::accuracy {

struct TipRow {
  std::string way;  // SceneWay::name
  uint32_t layer = 0, character = 0;
  std::string name;  // of the layer
  uint64_t tips = 0, within = 0;
  double p99 = 0.0;  // to 3 %, from above
};

class TipErrors {
 public:
  // `scene`: with the layers' own solvers.
  TipErrors(const Scenario& scene, std::span<const SceneWay> ways);

  // After a frame of way `w`.
  void Add(size_t w, const FurScene& scene, const ScenePointsLayout& layout,
           const ScenePoints& points, const ScenePoints& reference);

  std::vector<TipRow> Layers() const;  // by way, then by layer
  std::vector<TipRow> Ways() const;    // all layers together

 private:
  // Counts by the top bits of the share: 32 bins to each doubling.
  struct Counts {
    std::vector<uint32_t> bins;
    uint64_t within = 0;
    void Add(double share, double bound);
    void Add(const Counts& other);
  };
  struct Layer {
    std::string name;
    uint32_t character;
    bool modal;
  };
  TipRow RowOf(size_t w, const Counts& counts) const;

  std::vector<Layer> layers_;
  std::vector<std::string> ways_;            // empty: not one quality's
  std::vector<std::vector<Counts>> counts_;  // [way][layer]
};

}  // namespace pelt::accuracy
