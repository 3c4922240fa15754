// Frames without a scene, for checks of executors: small kernels on a small table of streams, in
// passes that each need all of the one before, so that an item too early or too late changes the
// digest.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <string>

#include "core/kernel.hpp"
#include "jobs/frame.hpp"
#include "jobs/plan.hpp"
#include "traces/digest.hpp"

namespace pelt {
namespace conformance {

PELT_BLOCK KeyBlock { uint32_t key[64]; };
PELT_BLOCK SumBlock { uint32_t sum; };

struct Streams {
  static constexpr uint32_t kChunkLanes = 64;
  StreamRow<KeyBlock> keys{"keys", Domain::kChunk, Role::kValue};
  StreamRow<SumBlock> layer_sum{"layer_sum", Domain::kLayer, Role::kValue};
  StreamRow<SumBlock> scene_sum{"scene_sum", Domain::kScene, Role::kValue};
};

}  // namespace conformance

template <>
inline constexpr auto kBlockMembers<conformance::KeyBlock> =
    std::tuple{PELT_MEMBER(conformance::KeyBlock, key)};
template <>
inline constexpr auto kBlockMembers<conformance::SumBlock> =
    std::tuple{PELT_MEMBER(conformance::SumBlock, sum)};

namespace conformance {

inline uint32_t Mix(uint32_t a, uint32_t b) {
  uint32_t x = (a ^ b) * 2654435761u;
  for (int round = 0; round < 16; ++round) x = (x ^ (x >> 15)) * 2246822519u + b;
  return x ^ (x >> 13);
}
// Turns every key of a chunk over. Twice is not the same as once.
struct StirChunk {
  static constexpr std::string_view kName = "conformance_stir";
  struct Ports {
    InOut<&Streams::keys> keys;
  };
  static void Run(const Ports& ports) {
    for (uint32_t& key : ports.keys->key) key = Mix(key, 77);
  }
};
// A layer's number is of all keys of all its chunks: none may be early, none late.
struct SumLayer {
  static constexpr std::string_view kName = "conformance_sum_layer";
  struct Ports {
    All<&Streams::keys> keys;
    InOut<&Streams::layer_sum> layer;
  };
  static void Run(const Ports& ports) {
    uint32_t& sum = ports.layer->sum;
    for (uint32_t c = 0; c < ports.keys.count; ++c)
      for (const uint32_t key : ports.keys[c].key) sum = sum * 31u + key;
  }
};
struct SpreadLayer {
  static constexpr std::string_view kName = "conformance_spread_layer";
  struct Ports {
    Shared<&Streams::layer_sum> layer;
    InOut<&Streams::keys> keys;
  };
  static void Run(const Ports& ports) {
    for (uint32_t& key : ports.keys->key) key = Mix(key, ports.layer->sum);
  }
};
struct SumScene {
  static constexpr std::string_view kName = "conformance_sum_scene";
  struct Ports {
    All<&Streams::layer_sum> layers;
    InOut<&Streams::scene_sum> scene;
  };
  static void Run(const Ports& ports) {
    for (uint32_t l = 0; l < ports.layers.count; ++l)
      ports.scene->sum = Mix(ports.scene->sum, ports.layers[l].sum);
  }
};
struct SpreadScene {
  static constexpr std::string_view kName = "conformance_spread_scene";
  struct Ports {
    Shared<&Streams::scene_sum> scene;
    InOut<&Streams::keys> keys;
  };
  static void Run(const Ports& ports) {
    for (uint32_t& key : ports.keys->key) key = Mix(key, ports.scene->sum);
  }
};

// Seven passes over 130 chunks, three layers or the scene, each of which needs all of the one
// before.
class SyntheticFrames {
 public:
  static constexpr uint32_t kFrames = 6;

  SyntheticFrames() {
    for (const uint32_t chunks : {97u, 1u, 32u}) shape_.AddLayer(0, 0, chunks);
    bytes_.reset(static_cast<std::byte*>(
        ::operator new(CountBytes(TableOf<Streams>(), shape_), std::align_val_t(kBlockAlignment))));
    memory_ = PlaceStreams(TableOf<Streams>(), shape_, bytes_.get());
    std::memset(bytes_.get(), 0, CountBytes(TableOf<Streams>(), shape_));
    for (uint32_t c = 0; c < shape_.chunk_count; ++c)
      for (uint32_t i = 0; i < Streams::kChunkLanes; ++i)
        memory_.Of<&Streams::keys>(c)->key[i] = c * Streams::kChunkLanes + i;
    plan_ = *CompilePlan({Of<StirChunk>(Domain::kChunk), Of<SumLayer>(Domain::kLayer),
                          Of<SpreadLayer>(Domain::kChunk), Of<SumLayer>(Domain::kLayer),
                          Of<SpreadLayer>(Domain::kChunk), Of<SumScene>(Domain::kScene),
                          Of<SpreadScene>(Domain::kChunk)},
                         shape_, {.must_fit = false});
  }
  SyntheticFrames(const SyntheticFrames&) = delete;

  Frame frame() const { return {&plan_, &memory_}; }

  uint64_t Digest() const { return DigestFrame(memory_); }

  static uint64_t Run(Executor& executor) {
    SyntheticFrames frames;
    for (uint32_t f = 0; f < kFrames; ++f) executor.Run(frames.frame());
    return frames.Digest();
  }

 private:
  template <class K>
  static Stage Of(Domain domain) {
    return {MakeKernelDesc<K>(), nullptr, domain};
  }

  struct Delete {
    void operator()(std::byte* p) const { ::operator delete(p, std::align_val_t(kBlockAlignment)); }
  };

  SceneShape shape_;
  std::unique_ptr<std::byte, Delete> bytes_;
  FrameMemory memory_;
  Plan plan_;
};

}  // namespace conformance
}  // namespace pelt
