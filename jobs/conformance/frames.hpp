// Frames without a scene, for checks of executors: small kernels on real streams, in passes that
// each need all of the one before, so that an item too early or too late changes the digest.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/chunk.hpp"
#include "jobs/frame.hpp"
#include "jobs/plan.hpp"
#include "traces/digest.hpp"

namespace pelt::conformance {

inline uint32_t Mix(uint32_t a, uint32_t b) {
  uint32_t x = (a ^ b) * 2654435761u;
  for (int round = 0; round < 16; ++round) x = (x ^ (x >> 15)) * 2246822519u + b;
  return x ^ (x >> 13);
}
// Turns every key of a chunk over. Twice is not the same as once.
struct StirChunk {
  static constexpr std::string_view kName = "conformance_stir";
  struct Ports {
    InOut<&Streams::sort_keys> keys;
  };
  static void Run(const Ports& ports) {
    for (uint32_t& key : ports.keys->key) key = Mix(key, 77);
  }
};
// A layer's number is of all keys of all its chunks: none may be early, none late.
struct SumLayer {
  static constexpr std::string_view kName = "conformance_sum_layer";
  struct Ports {
    All<&Streams::sort_keys> keys;
    InOut<&Streams::layer_sort> layer;
  };
  static void Run(const Ports& ports) {
    uint32_t& sum = ports.layer->visible_count;
    for (uint32_t c = 0; c < ports.keys.count; ++c)
      for (const uint32_t key : ports.keys[c].key) sum = sum * 31u + key;
  }
};
struct SpreadLayer {
  static constexpr std::string_view kName = "conformance_spread_layer";
  struct Ports {
    Shared<&Streams::layer_sort> layer;
    InOut<&Streams::sort_keys> keys;
  };
  static void Run(const Ports& ports) {
    for (uint32_t& key : ports.keys->key) key = Mix(key, ports.layer->visible_count);
  }
};
struct SumScene {
  static constexpr std::string_view kName = "conformance_sum_scene";
  struct Ports {
    All<&Streams::layer_sort> layers;
    InOut<&Streams::draw_list> scene;
  };
  static void Run(const Ports& ports) {
    for (uint32_t l = 0; l < ports.layers.count; ++l)
      ports.scene->count = Mix(ports.scene->count, ports.layers[l].visible_count);
  }
};
struct SpreadScene {
  static constexpr std::string_view kName = "conformance_spread_scene";
  struct Ports {
    Shared<&Streams::draw_list> scene;
    InOut<&Streams::sort_keys> keys;
  };
  static void Run(const Ports& ports) {
    for (uint32_t& key : ports.keys->key) key = Mix(key, ports.scene->count);
  }
};

// Seven passes over 130 chunks, three layers or the scene, each of which needs all of the one
// before.
class SyntheticFrames {
 public:
  static constexpr uint32_t kFrames = 6;

  SyntheticFrames() {
    shape_.character_count = 1;
    for (const uint32_t chunks : {97u, 1u, 32u}) {
      shape_.layer_character.push_back(0);
      shape_.layer_kind.push_back(0);
      shape_.layer_first_chunk.push_back(shape_.chunk_count);
      shape_.chunk_layer.insert(shape_.chunk_layer.end(), chunks, shape_.layer_count++);
      shape_.chunk_count += chunks;
    }
    shape_.layer_first_chunk.push_back(shape_.chunk_count);
    keys_.resize(shape_.chunk_count);
    layers_.resize(shape_.layer_count);
    for (uint32_t c = 0; c < shape_.chunk_count; ++c)
      for (uint32_t i = 0; i < kStrandsPerChunk; ++i) keys_[c].key[i] = c * kStrandsPerChunk + i;
    memory_.shape = &shape_;
    memory_.base[size_t(StreamOf<&Streams::sort_keys>)] =
        reinterpret_cast<std::byte*>(keys_.data());
    memory_.base[size_t(StreamOf<&Streams::layer_sort>)] =
        reinterpret_cast<std::byte*>(layers_.data());
    memory_.base[size_t(StreamOf<&Streams::draw_list>)] = reinterpret_cast<std::byte*>(&scene_);
    std::string error;
    plan_ = *TryCompilePlan({Of<StirChunk>(Domain::kChunk), Of<SumLayer>(Domain::kLayer),
                             Of<SpreadLayer>(Domain::kChunk), Of<SumLayer>(Domain::kLayer),
                             Of<SpreadLayer>(Domain::kChunk), Of<SumScene>(Domain::kScene),
                             Of<SpreadScene>(Domain::kChunk)},
                            shape_, {.must_fit = false}, error);
  }
  SyntheticFrames(const SyntheticFrames&) = delete;

  Frame frame() const { return {&plan_, &memory_}; }

  uint64_t Digest() const {
    pelt::Digest digest;
    for (const SortKeyBlock& block : keys_)
      for (const uint32_t key : block.key) digest.Add(key);
    for (const LayerSortBlock& layer : layers_) digest.Add(layer.visible_count);
    digest.Add(scene_.count);
    return digest.Value();
  }

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

  SceneShape shape_;
  std::vector<SortKeyBlock> keys_;
  std::vector<LayerSortBlock> layers_;
  DrawListBlock scene_{};
  FrameMemory memory_{};
  Plan plan_;
};

}  // namespace pelt::conformance
