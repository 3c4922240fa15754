// Where the chains of a vertex-chain layer are fixed: the skinned vertices, as rows.
//
// Skinned vertices are records because strands fetch them in any order; simulation wants rows. This
// kernel only turns one into the other, so an anchor has the vertex's bits.
#pragma once

#include <string_view>

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/streams.hpp"

namespace pelt {

template <class V>
struct Anchors {
  static constexpr std::string_view kName = "anchors";
  struct Ports {
    In<&Streams::patch_state> state;
    In<&Streams::skinned> skinned;
    Out<&Streams::anchors> anchors;
  };

  static void Run(const Ports& ports) {
    const uint32_t lanes = RoundUpToLaneGroups(ports.state->live_chains);
    RootBlock& anchors = *ports.anchors;
    for (uint32_t v = 0; v < lanes; v += V::kLanes) {
      const SkinnedVertex* const in = ports.skinned->vertex + v;
      CopyColumns([in](int lane) { return in[lane].position; }, anchors.position, v);
      CopyColumns([in](int lane) { return in[lane].normal; }, anchors.normal, v);
      CopyColumns([in](int lane) { return in[lane].tangent; }, anchors.tangent, v);
      CopyColumns([in](int lane) { return in[lane].motion; }, anchors.motion, v);
    }
  }

 private:
  template <class AddressOfLane>
  static PELT_INLINE void CopyColumns(AddressOfLane address, float (&rows)[3][kStrandsPerChunk],
                                      uint32_t lane) {
    V x = LoadRecords<V, 0>(address), y = LoadRecords<V, 1>(address);
    V z = LoadRecords<V, 2>(address), w = LoadRecords<V, 3>(address);
    TransposeFours(x, y, z, w);
    Store3<V>(rows, lane, {x, y, z});
  }
};

}  // namespace pelt
