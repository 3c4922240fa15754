// What a stream is: a named array of blocks, one row of a table.
//
//   struct Streams {                                          // a table: an aggregate of rows
//     StreamRow<MeshBlock> mesh{"mesh", Domain::kChunk, Role::kInput};
//     StreamRow<SkinnedBlock> skinned{"skinned", Domain::kChunk, Role::kValue};
//   };
//
// A port names its stream by the row (In<&Streams::mesh>, core/kernel.hpp), and with it the block's
// type: a stream bound to a port of another is another type, which does not compile. A row's number
// is its place; nothing is listed beside the table.
//
// Plan, executors, digests, local store and prices take a table as data (StreamTable): fur's
// (core/streams.hpp) is one of them, tests and other programs bring their own (jobs/README.md).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/block_members.hpp"

namespace pelt {

// What an item of a stage, or a block of a stream, stands for. A scene has characters, a character
// layers, a layer patches (of what is shared) and chunks: neither of these two is part of the other.
enum class Domain : uint8_t { kScene, kCharacter, kLayer, kPatch, kChunk };
inline constexpr size_t kDomainCount = 5;
// Patches and chunks.
constexpr bool IsInLayer(Domain domain) { return domain > Domain::kLayer; }
// Whether an item of `fine` belongs to one of `coarse`.
constexpr bool IsPartOf(Domain fine, Domain coarse) { return coarse < fine && !IsInLayer(coarse); }

// What a stream is to the frame, and so to a digest.
enum class Role : uint8_t {
  kInput,        // constant, or filled by the caller before the frame
  kValue,        // what the frame computes: the same bits on every executor, with any skip switches
  kBookkeeping,  // what ran and why: the same on every executor, but not with other skip switches
  kScratch,      // meaningless after the pass that wrote it
};
constexpr std::string_view RoleName(Role role) {
  constexpr std::string_view kNames[] = {"input", "value", "bookkeeping", "scratch"};
  return kNames[size_t(role)];
}

// Every block is aligned to this, and its size a multiple of it.
inline constexpr uint32_t kBlockAlignment = 128;
#define PELT_BLOCK struct alignas(::pelt::kBlockAlignment)

struct FrameMemory;  // core/frame_memory.hpp

// Which lanes of a patch's or chunk's block live: kernels work on these, and they hold values after a frame.
// Lanes beyond are what was there before.
struct Lanes {
  uint32_t (*count)(const FrameMemory&, uint32_t item) = nullptr;  // those below; null: all
  uint32_t group = 1;   // kernels go over them in whole groups of so many
  bool filled = false;  // those beyond hold values too, though no work
  constexpr bool AllHoldValues() const { return !count || filled; }
};

// The kinds of layer that have all bits of `required` and none of `forbidden`.
struct KindMask {
  uint32_t required = 0, forbidden = 0;
  constexpr bool Admits(uint32_t kind) const {
    return (kind & required) == required && (kind & forbidden) == 0;
  }
};

// What readers outside the frame, and the next frame, take from a stream.
enum class Kept : uint8_t {
  kNot,     // what is not read within the frame need not be there after it
  kOutput,  // read after the frame, by whoever draws or measures it
  // The next frame begins with it. A snapshot has these, and all else that a stage reads before one
  // has written it (jobs/carried_state.hpp); of inputs these alone, the others being baked.
  kState,
};

template <class B>
struct StreamRow {
  using Block = B;
  std::string_view name;  // the member's
  Domain domain;
  Role role;
  Lanes lanes = {};
  // Streams of patches and chunks exist for layers of these kinds, and so stages run on them; those of layers and
  // characters, where the scene has a layer of these kinds.
  KindMask kinds = {};
  Kept kept = Kept::kNot;
};

// The rows of a table, as constants.
template <class Table>
inline constexpr Table kTable{};

// A stream's place in its table.
enum class Stream : uint8_t { kNone = 0xff };

namespace stream_detail {
template <auto kRow>
consteval Stream PlaceOf() {
  using Table = MemberClass<kRow>;
  static_assert((kTable<Table>.*kRow).name == MemberName<kRow>(), "a row is named as its member");
  return WithMembers(kTable<Table>, [](const auto&... row) {
    const void* wanted = &(kTable<Table>.*kRow);
    uint8_t place = 0, next = 0;
    ((static_cast<const void*>(&row) == wanted ? void(place = next) : void(), ++next), ...);
    return Stream{place};
  });
}
}  // namespace stream_detail

template <auto kRow>
inline constexpr Stream StreamOf = stream_detail::PlaceOf<kRow>();
template <auto kRow>
using BlockOf = typename MemberType<kRow>::Block;
template <auto kRow>
inline constexpr const auto& RowOf = kTable<MemberClass<kRow>>.*kRow;

// A row with its types erased.
struct StreamDesc {
  std::string_view name;
  Domain domain;
  uint32_t block_bytes;
  Role role;
  Lanes lanes;
  KindMask kinds;
  Kept kept;
  std::span<const RowDesc> rows;
};

// A table with its types erased.
struct StreamTable {
  std::span<const StreamDesc> streams;
  uint32_t
      chunk_lanes;  // of a patch's or chunk's blocks, and records of those that are gathered from
  const StreamDesc& operator[](Stream stream) const { return streams[size_t(stream)]; }
};

template <class B>
constexpr StreamDesc Describe(const StreamRow<B>& row) {
  static_assert(kListedMembers<B> > 0 && ListsAllMembers<B>(),
                "a member that is not listed (kBlockMembers) is neither hashed nor located");
  static_assert(sizeof(B) % kBlockAlignment == 0 && alignof(B) == kBlockAlignment);
  return {row.name,  row.domain, uint32_t(sizeof(B)), row.role, row.lanes,
          row.kinds, row.kept,   kRowsOf<B>};
}

template <class Table>
const StreamTable& MakeTable() {
  static constexpr auto kStreams =
      WithMembers(kTable<Table>, [](const auto&... row) { return std::array{Describe(row)...}; });
  static constexpr StreamTable kErased{kStreams, Table::kChunkLanes};
  return kErased;
}
// The one of a table type, which says how many lanes its chunks have: Table::kChunkLanes. Made in
// each file that asks, unless its own header keeps that to one (core/streams.hpp).
template <class Table>
const StreamTable& TableOf() {
  return MakeTable<Table>();
}

}  // namespace pelt
