// The digest log: what a run computed, as one digest for each frame, stage and stream, in text.
//
//   pelt digest log 1
//   scene tiny
//   settings lod, strand budget 400
//   chunk_strands 128
//   vertex_order sorted
//   frames 20
//   columns frame stage stream digest
//   0 sample_pose local_pose 8c0f54d1b3a7e266
//   ...
//   19 whole_frame all 01fd7c8e9bb02a35
//   end 540
//
// A line's digest is of the blocks of that stream which that stage is the last to write in a frame,
// so the first line of a frame that differs names the first stage whose result differs. The last
// line of every frame is the digest of the whole frame, as FurScene::DigestFrame gives it. Nothing
// in a log depends on kernels, executor, fusion or byte order; everything in it depends on the
// capacity of a chunk, the vertex order, the scene and the settings, which the head names.
//
// Invariant: every frame has the same lines in the same order. A log that was cut, or has a line
// too many, is refused with the number of the line.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.hpp"

namespace pelt {

inline constexpr uint32_t kDigestLogVersion = 1;

// What a line of each frame is about.
struct DigestColumn {
  std::string stage, stream;
  bool operator==(const DigestColumn&) const = default;
};
inline constexpr std::string_view kWholeFrameStage = "whole_frame";

struct DigestLog {
  std::string scene;
  std::string settings;  // what makes the run another than the scene's own; empty: nothing
  uint32_t chunk_strands = 0;
  std::string vertex_order;  // "sorted" or "index-buffer"
  std::vector<DigestColumn> columns;
  std::vector<uint64_t> digests;  // [frame][column]

  uint32_t FrameCount() const {
    return columns.empty() ? 0 : uint32_t(digests.size() / columns.size());
  }
  std::span<const uint64_t> Frame(uint32_t frame) const {
    return std::span(digests).subspan(size_t(frame) * columns.size(), columns.size());
  }
};

// Scene and settings are written on one line each: control characters in them become blanks.
std::string WriteDigestLog(const DigestLog& log);

// The text of a failure is "digest log 'name', line 12: reason". Holds at most twice the size of
// `text` in memory, and 256 KiB.
Result<DigestLog> ReadDigestLog(std::string_view text, const std::string& name);
Result<DigestLog> ReadDigestLogFile(const std::string& path);
Result<> WriteDigestLogFile(const DigestLog& log, const std::string& path);

// Whether a file begins like a digest log.
bool LooksLikeDigestLog(std::span<const std::byte> bytes);

}  // namespace pelt
