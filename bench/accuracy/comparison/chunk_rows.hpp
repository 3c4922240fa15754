// The blocks of one chunk that every simulation kernel of core reads, filled from a batch's rows:
// no frame around them.
//
// Rest shapes are given in the root's frame, whose normal is the first link's rest direction and
// whose tangent leans towards the second's; it turns with the rest directions.
#pragma once

#include <cmath>
#include <cstring>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "bench/accuracy/strand_solver.hpp"
#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/kernels/simulate_params.hpp"
#include "core/streams.hpp"

namespace pelt::accuracy {

// A zeroed, aligned block.
template <class Block>
struct Owned {
  Block* block = static_cast<Block*>(::operator new(sizeof(Block), std::align_val_t(128)));
  Owned() { std::memset(static_cast<void*>(block), 0, sizeof(Block)); }
  ~Owned() { ::operator delete(block, std::align_val_t(128)); }
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;
  Block* operator->() const { return block; }
};

template <uint32_t kPoints>
struct ChunkRows {
  static constexpr int kLinks = kPoints - 1;

  Owned<ChunkStateBlock> state;
  Owned<RestBlock<kPoints>> rest;
  Owned<RootBlock> roots;
  Owned<WindBlock> wind;
  Owned<StrandBlock> strands;
  Owned<PointBlock<kPoints>> position;

  // The block of a stream that every solver's kernel has; null for others.
  void* Find(Stream stream) {
    using Of = ChainStreams<kPoints, false>;
    const std::pair<Stream, void*> blocks[] = {{StreamOf<&Streams::chunk_state>, state.block},
                                               {StreamOf<Of::kRest>, rest.block},
                                               {StreamOf<Of::kRoots>, roots.block},
                                               {StreamOf<&Streams::wind>, wind.block},
                                               {StreamOf<&Streams::strands>, strands.block},
                                               {StreamOf<Of::kPosition>, position.block}};
    for (const auto& [of, block] : blocks)
      if (of == stream) return block;
    return nullptr;
  }

  // Lane `lane` of the batch at rest in the world, links along `start`; lanes in ascending order.
  void Start(const FrameRows& frame, uint32_t lane, float link, const float* const (*start)[3]) {
    const uint32_t at = lane % kStrandsPerChunk;
    LoadRoots(frame, lane, 0.0f);
    state->live_strands = state->first_new_strand = at + 1;
    state->flags = kChunkVisible | kChunkSimulate;
    rest->segment_length[at] = link;
    rest->strength[at] = 1.0f;
    SetRest(frame, lane, double(link));
    for (int k = 0; k < 3; ++k) {
      float place = frame.position[k][lane];
      for (int i = 0; i < kLinks; ++i) {
        place += start[i][k][lane] * link;
        position->position[i][k][at] = place;
      }
    }
  }

  // Point i of lane `lane` of the batch, from the root.
  void ReadPoint(int i, uint32_t lane, float* const (&rows)[3]) const {
    const uint32_t at = lane % kStrandsPerChunk;
    for (int k = 0; k < 3; ++k)
      rows[k][lane] = position->position[i][k][at] - roots->position[k][at];
  }

  // `wind_response`: acceleration a m/s of wind, 1/s. A straight strand's tangent is any.
  void LoadRoots(const FrameRows& frame, uint32_t lane, float wind_response) {
    const uint32_t at = lane % kStrandsPerChunk;
    const Double3 normal = RestOf(frame, 0, lane);
    Double3 across = RestOf(frame, 1, lane);
    across = across - normal * Dot(normal, across);
    if (Length(across) < 1e-3)
      across = Cross(normal, std::abs(normal.y) < 0.9 ? Double3{0, 1, 0} : Double3{1, 0, 0});
    across = Unit(across);
    const double n[3] = {normal.x, normal.y, normal.z}, t[3] = {across.x, across.y, across.z};
    for (int k = 0; k < 3; ++k) {
      roots->position[k][at] = frame.position[k][lane];
      roots->motion[k][at] = frame.motion[k][lane];
      roots->normal[k][at] = float(n[k]);
      roots->tangent[k][at] = float(t[k]);
      wind->acceleration[k][at] = frame.wind[k][lane] * wind_response;
    }
  }

 private:
  void SetRest(const FrameRows& frame, uint32_t lane, double link) {
    const uint32_t at = lane % kStrandsPerChunk;
    const auto axis = [&](const float(&rows)[3][kStrandsPerChunk]) {
      return Double3{rows[0][at], rows[1][at], rows[2][at]};
    };
    const Double3 normal = axis(roots->normal), tangent = axis(roots->tangent);
    Double3 offset = kZero3;
    for (int i = 0; i < kLinks; ++i) {
      offset = offset + RestOf(frame, i, lane) * link;
      rest->offset[i][0][at] = float(Dot(offset, tangent));
      rest->offset[i][1][at] = float(Dot(offset, Cross(normal, tangent)));
      rest->offset[i][2][at] = float(Dot(offset, normal));
    }
  }
  static Double3 RestOf(const FrameRows& frame, int link, uint32_t lane) {
    const auto& rows = frame.rest[link];
    return Unit({rows[0][lane], rows[1][lane], rows[2][lane]});
  }
};

// Of solvers whose strands lie in chunks, of kinds of ChunkRows.
template <class Blocks>
class ChunkedSolver : public StrandSolver {
 public:
  void Points(int i, float* const (&rows)[3]) const final {
    for (uint32_t lane = 0; lane < lanes_; ++lane) ChunkOf(lane).ReadPoint(i, lane, rows);
  }

 protected:
  explicit ChunkedSolver(uint32_t lanes) : lanes_(lanes) {
    for (uint32_t first = 0; first < lanes_; first += kStrandsPerChunk)
      chunks_.push_back(std::make_unique<Blocks>());
  }
  Blocks& ChunkOf(uint32_t lane) const { return *chunks_[lane / kStrandsPerChunk]; }

  uint32_t lanes_;
  std::vector<std::unique_ptr<Blocks>> chunks_;
};

// Runs a kernel on one chunk; find(stream) gives the block of a stream.
template <class Find>
void RunOnChunk(const KernelDesc& kernel, const SimulateParams& params, Find&& find) {
  Binding bindings[kMaxPorts];
  for (size_t p = 0; p < kernel.ports.size(); ++p)
    bindings[p] = {find(kernel.ports[p].stream), nullptr, 1};
  kernel.run(&params, bindings);
}

}  // namespace pelt::accuracy
