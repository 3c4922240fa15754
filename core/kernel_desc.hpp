// A kernel as the plan and the executors know it: without its types, and without vectors. Made from
// a kernel's struct by MakeKernelDesc (core/kernel.hpp).
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "core/stream_table.hpp"

namespace pelt {

enum class Access : uint8_t {
  kIn,      // own block, read
  kOut,     // own block, every byte the readers use is written: costs no DMA get
  kInOut,   // own block, read and written
  kShared,  // the one block of a coarser domain that the item belongs to, read
  kAll,  // every block of a finer domain inside the item, read: the item waits for all that write one
  kAllOut,    // the same, written
  kAllInOut,  // the same, read and written
  kGather,  // records anywhere in the layer, read by index: the item waits for those blocks, or the layer
  kScatter,  // records anywhere in the layer, written by index, each index by one chunk only
};

constexpr bool IsWritten(Access access) {
  return access == Access::kOut || access == Access::kInOut || access == Access::kAllOut ||
         access == Access::kAllInOut || access == Access::kScatter;
}
// Needs what was there before.
constexpr bool IsRead(Access access) {
  return access != Access::kOut && access != Access::kAllOut && access != Access::kScatter;
}

// What the executor hands a port. `block` is the first byte; `count` the number of blocks behind it
// (All, AllOut) or of records (Gather, Scatter); `index` is the record list of Gather and Scatter,
// null when records are addressed directly.
struct Binding {
  void* block;
  uint32_t* index;
  uint32_t count;
};

// The kernel's view of one port, for the plan. `record_list` names the stream that holds the
// indices of a Gather port, in the item's own block.
struct PortDesc {
  Stream stream;
  Access access;
  Domain domain;         // the stream's
  uint32_t block_bytes;  // Gather, Scatter: bytes of one record
  uint32_t stride;       // from one block of the stream to the next
  Stream record_list;
  uint32_t records;  // Gather, Scatter: most of one item
};

inline constexpr uint32_t kMaxPorts = 12;

// A kernel with its types erased: what the frame's table holds.
struct KernelDesc {
  std::string_view name;
  const StreamTable& (*table)();  // that its ports are of
  std::span<const PortDesc> ports;
  uint32_t params_bytes;
  void (*run)(const void* params, const Binding* bindings);
};

}  // namespace pelt
