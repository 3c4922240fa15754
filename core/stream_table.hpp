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
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "core/block_members.hpp"

namespace pelt {

// What an item of a stage, or a block of a stream, stands for. Each is a refinement of the one
// before: a scene has characters, a character layers, a layer chunks.
enum class Domain : uint8_t { kScene, kCharacter, kLayer, kChunk };
inline constexpr size_t kDomainCount = 4;

// What a stream is to the frame, and so to a digest.
enum class Role : uint8_t {
  kInput,        // constant, or filled by the caller before the frame
  kValue,        // what the frame computes: the same bits whatever runs it and whatever is skipped
  kBookkeeping,  // what ran and why: the same on every executor, but not with other skip switches
  kScratch,      // meaningless after the pass that wrote it
};
std::string_view RoleName(Role role);  // "bookkeeping"

// Which lanes of a block hold values after a frame. Lanes beyond are whatever was there before.
enum class Lanes : uint8_t {
  kAll,           // the whole block
  kLiveStrands,   // lanes below live_strands
  kLiveVertices,  // lanes below live_vertices
  kLiveChains,    // vertices in vertex-chain layers, strands otherwise
  kDrawn,         // places of the layer's order below visible_count
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
  kState,   // of the simulation: the next frame begins with it
};

template <class B>
struct StreamRow {
  using Block = B;
  std::string_view name;  // the member's
  Domain domain;
  Role role;
  Lanes lanes = Lanes::kAll;
  KindMask kinds = {};  // chunk streams exist for layers of these kinds; and so stages run on them
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

}  // namespace pelt
