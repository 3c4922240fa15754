#include "core/groom/fewer_points.hpp"

#include <algorithm>

#include "core/float_rules.hpp"
#include "core/groom/attributes.hpp"

namespace pelt {
namespace {

constexpr uint32_t kTo = 4;

template <uint32_t kPoints>
glm::dvec3 PointOf(const RestBlock<kPoints>& block, uint32_t point, uint32_t lane) {
  if (point == 0) return glm::dvec3(0.0);
  const auto& row = block.offset[point - 1];
  return {row[0][lane], row[1][lane], row[2][lane]};
}

// At a share of the way from root to tip, along segments of equal lengths.
template <uint32_t kPoints>
glm::dvec3 PlaceAt(const RestBlock<kPoints>& block, double share, uint32_t lane) {
  const double at = share * double(kPoints - 1);
  const uint32_t segment = std::min(uint32_t(at), kPoints - 2);
  return glm::mix(PointOf(block, segment, lane), PointOf(block, segment + 1, lane),
                  at - double(segment));
}

template <uint32_t kFrom>
RestBlock<kTo> Resample(const RestBlock<kFrom>& from) {
  if constexpr (kFrom == kTo) return from;
  RestBlock<kTo> to{};
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    RestShape places{};
    for (uint32_t i = 1; i < kTo; ++i)
      places.offset[i - 1] = PlaceAt(from, double(i) / double(kTo - 1), lane);
    const double length = double(from.segment_length[lane]) * double(kFrom - 1);
    // The cut corners' length goes back into the segments.
    const glm::dvec3 first = PointOf(from, 1, lane) / double(from.segment_length[lane]);
    const RestShape shape = MakeEqualSegments(places, length, kTo, first);
    for (uint32_t i = 0; i + 1 < kTo; ++i)
      for (int axis = 0; axis < 3; ++axis) to.offset[i][axis][lane] = float(shape.offset[i][axis]);
    to.segment_length[lane] = float(length / double(kTo - 1));
    to.strength[lane] = from.strength[lane];
  }
  return to;
}

}  // namespace

uint32_t FewestPoints() { return uint32_t(LayerParamRowOf(&LayerParams::points).low); }

bool HasMorePoints(const Groom& groom) {
  return std::ranges::any_of(groom.layers,
                             [](const GroomLayer& l) { return l.params.points > FewestPoints(); });
}

Groom ResampleToFewestPoints(const Groom& groom) {
  Groom out = groom;
  out.strand_rest4.clear();
  out.strand_rest5.clear();
  out.strand_rest9.clear();
  size_t taken[kMostStrandPoints + 1] = {};  // by points
  for (GroomLayer& layer : out.layers) {
    if (layer.params.output == Output::kShells) continue;  // has no strands' chains
    WithPoints(layer.params.points, [&]<uint32_t kFrom> {
      for (uint32_t c = 0; c < layer.chunk_count; ++c)
        out.strand_rest4.push_back(Resample(StrandRestOf<kFrom>(groom)[taken[kFrom]++]));
    });
    layer.params.points = kTo;
  }
  return out;
}

}  // namespace pelt
