// What a block is made of: each of its members once, by name. Digests, mismatch reports and files
// go through these lists, in their order, which is that of the block.
//
// Invariant: all members but `pad` are listed, in order (a table with another block does not
// compile, core/stream_table.hpp). Padding never reaches a digest or a file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "core/reflect.hpp"

namespace pelt {

enum class ElementType : uint8_t { kFloat, kU32, kU16, kU8 };

// One named array of a block. Rows are [component][lane]; records (lane_major) are
// [lane][component].
struct RowDesc {
  std::string_view name;
  uint32_t offset_bytes;
  uint32_t element_count;
  uint32_t lane_count;
  ElementType type;
  bool lane_major;
};

template <class B, class M>
struct BlockMember {
  std::string_view name;
  M B::*member;
  uint32_t offset_bytes;
  bool by_lane = false;     // [lane][component], else [component][lane]
  float low = 0, high = 0;  // inclusive, of what a groom may hold; equal: any

  constexpr BlockMember ByLane() const { return {name, member, offset_bytes, true, low, high}; }
  constexpr BlockMember Within(float least, float most) const {
    return {name, member, offset_bytes, by_lane, least, most};
  }
  constexpr bool HasBounds() const { return low < high; }
};

// A block that is one record of 32-bit words.
template <class B>
struct BlockRecord {
  std::string_view name;
};

namespace block_rows_detail {

// A block's members are arrays, which only initialisers in braces of their own count right.
template <class B, class... A>
consteval size_t CountMembers() {
  using reflect_detail::AnyMember;
  if constexpr (requires { B{{A{}}..., {AnyMember{}}}; })
    return CountMembers<B, A..., AnyMember>();
  else
    return sizeof...(A);
}

template <class B, class M>
constexpr BlockMember<B, M> Member(std::string_view name, M B::*member, size_t offset) {
  return {name, member, uint32_t(offset)};
}

}  // namespace block_rows_detail

#define PELT_MEMBER(Block, member) \
  ::pelt::block_rows_detail::Member(#member, &Block::member, offsetof(Block, member))

// Specialised for every block of a table:
//   template <>
//   inline constexpr auto kBlockMembers<MeshBlock> = std::tuple{PELT_MEMBER(MeshBlock, position),
//   ...};
template <class Block>
inline constexpr std::tuple<> kBlockMembers{};

template <class B>
inline constexpr size_t kListedMembers = std::tuple_size_v<decltype(kBlockMembers<B>)>;

// Calls visit(member) for each member of the block.
template <class B>
constexpr void ForEachMember(auto&& visit) {
  std::apply([&](const auto&... member) { (visit(member), ...); }, kBlockMembers<B>);
}

// Every member but the padding, each behind the one before it.
template <class B>
consteval bool ListsAllMembers() {
  size_t listed = 0, end = 0;
  bool record = false, in_order = true;
  ForEachMember<B>([&]<class Row>(const Row& row) {
    if constexpr (std::is_same_v<Row, BlockRecord<B>>) {
      record = true;
    } else {
      ++listed;
      in_order = in_order && row.offset_bytes >= end;
      end = row.offset_bytes + 1;
    }
  });
  constexpr bool kPadded = requires { &B::pad; };
  return record || (in_order && listed + kPadded == block_rows_detail::CountMembers<B>());
}

template <class T>
constexpr ElementType ElementTypeOf() {
  using E = std::remove_all_extents_t<T>;
  if constexpr (std::is_same_v<E, float>) return ElementType::kFloat;
  if constexpr (sizeof(E) == 1) return ElementType::kU8;
  if constexpr (sizeof(E) == 2) return ElementType::kU16;
  return ElementType::kU32;
}

// A member that is an array whose last extent is the lanes (or, by lane, whose first is). Records
// are made of 32-bit words: hashed and reported word by word.
template <class B, class M>
constexpr RowDesc DescribeMember(const BlockMember<B, M>& member) {
  using E = std::remove_all_extents_t<M>;
  constexpr size_t kRank = std::rank_v<M>, kElement = std::is_class_v<E> ? 4 : sizeof(E);
  constexpr uint32_t kFirst = kRank == 0 ? 1 : uint32_t(std::extent_v<M, 0>);
  constexpr uint32_t kLast =
      kRank == 0 ? 1 : uint32_t(std::extent_v < M, kRank == 0 ? 0 : kRank - 1 >);
  const bool by_lane = member.by_lane || std::is_class_v<E>;
  return {member.name,
          member.offset_bytes,
          uint32_t(sizeof(M) / kElement),
          by_lane ? kFirst : kLast,
          ElementTypeOf<M>(),
          by_lane};
}
template <class B>
constexpr RowDesc DescribeMember(const BlockRecord<B>& record) {
  return {record.name, 0, uint32_t(sizeof(B) / 4), 1, ElementType::kU32, true};
}

template <class B>
inline constexpr auto kRowsOf =
    std::apply([](const auto&... m) { return std::array{DescribeMember(m)...}; }, kBlockMembers<B>);

}  // namespace pelt
