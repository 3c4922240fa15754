// The digests of a digest log, taken from a scene after a frame.
//
// A stream of a scene may have several writers: one stage for layers of one kind, another for the
// next. Each (stage, stream) pair of the plan gets a digest of its own, over the blocks which that
// stage is the last to write, so that a log names the stage that went wrong and not all that share
// its stream. Every block of a value stream is in exactly one of them, and all are once more in
// the digest of the whole frame.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "jobs/scene.hpp"
#include "traces/digest_log.hpp"

namespace pelt {

class StageDigests {
 public:
  explicit StageDigests(const FurScene& scene);

  // A log with its head and columns, and no frames yet.
  DigestLog Begin(std::string_view scene_name, std::string_view settings,
                  VertexOrder vertex_order) const;
  // Adds the frame just run of the scene, which is the one this was made for or one of the same
  // grooms and options.
  void AddFrame(const FurScene& scene, DigestLog& log) const;

 private:
  struct Column {
    std::string_view stage;
    Stream stream;
    std::vector<uint32_t> items;
  };
  std::vector<Column> columns_;
};

std::string_view VertexOrderName(VertexOrder order);  // "sorted", "index-buffer"

}  // namespace pelt
