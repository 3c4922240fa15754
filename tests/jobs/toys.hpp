// A small table of streams of the tests' own: what plan, executors, digests and local store are
// tested with, so that none of them leans on fur's.
#pragma once

#include <array>
#include <cstdint>

#include "core/frame_memory.hpp"
#include "core/stage.hpp"

namespace pelt {
namespace testing {

inline constexpr uint32_t kToyLanes = 128;
// Kinds of layer.
inline constexpr uint32_t kLong = 1, kRound = 2, kHard = 4;

PELT_BLOCK KeyBlock { uint32_t key[kToyLanes]; };
PELT_BLOCK PlaceBlock { uint32_t place[kToyLanes]; };
struct KeyPlace {
  uint32_t key, place;
};
PELT_BLOCK PairBlock { KeyPlace pair[kToyLanes]; };
PELT_BLOCK CountBlock { uint32_t bin[256]; };
struct alignas(16) Record {
  uint32_t word[16];
};
PELT_BLOCK RecordBlock { Record record[kToyLanes]; };
PELT_BLOCK RowBlock { float a[3][kToyLanes], b[3][kToyLanes], c[3][kToyLanes]; };
PELT_BLOCK MadeBlock { float value[3][kToyLanes]; };
PELT_BLOCK StateBlock { uint32_t flags, first_place, live; };
PELT_BLOCK WordBlock { uint32_t word; };
inline constexpr uint32_t kToyListed = 32;
PELT_BLOCK ListBlock { uint32_t patch[kToyListed]; };

uint32_t CountLive(const FrameMemory& memory, uint32_t chunk);

struct Toys {
  static constexpr uint32_t kChunkLanes = kToyLanes;
  static constexpr Lanes kLive{&CountLive};

  // Of characters and layers.
  StreamRow<WordBlock> body{"body", Domain::kCharacter, Role::kInput};
  StreamRow<WordBlock> box{"box", Domain::kLayer, Role::kValue};
  StreamRow<WordBlock> sum{"sum", Domain::kLayer, Role::kBookkeeping, {}, {}, Kept::kOutput};
  // Of chunks.
  StreamRow<StateBlock> state{"state", Domain::kChunk, Role::kBookkeeping};
  StreamRow<RowBlock> baked{"baked", Domain::kChunk, Role::kInput};
  StreamRow<KeyBlock> keys{"keys", Domain::kChunk, Role::kValue};
  StreamRow<PlaceBlock> order{"order", Domain::kChunk, Role::kValue, kLive, {}, Kept::kOutput};
  StreamRow<PairBlock> pairs_a{"pairs_a", Domain::kChunk, Role::kScratch};
  StreamRow<PairBlock> pairs_b{"pairs_b", Domain::kChunk, Role::kScratch};
  StreamRow<CountBlock> counts{"counts", Domain::kChunk, Role::kScratch};
  StreamRow<RecordBlock> records{"records", Domain::kChunk, Role::kValue};
  StreamRow<RecordBlock> copies{"copies", Domain::kChunk, Role::kValue, kLive, {}, Kept::kOutput};
  StreamRow<MadeBlock> made{"made", Domain::kChunk, Role::kScratch};
  StreamRow<RowBlock> of_long{"of_long", Domain::kChunk, Role::kValue, {}, {kLong, 0}};
  // Of patches, and which of the layer's patches a chunk names; behind those ~0.
  StreamRow<RecordBlock> parts{"parts", Domain::kPatch, Role::kValue};
  StreamRow<WordBlock> marks{"marks", Domain::kPatch, Role::kBookkeeping};
  StreamRow<RowBlock> long_parts{"long_parts", Domain::kPatch, Role::kValue, {}, {kLong, 0}};
  StreamRow<ListBlock> list{"list", Domain::kChunk, Role::kInput};
};

inline uint32_t CountLive(const FrameMemory& memory, uint32_t chunk) {
  return memory.Of<&Toys::state>(chunk)->live;
}

// All of these flags of a chunk's state.
template <uint32_t kFlags>
bool HasToyFlags(const FrameMemory& memory, const ItemPlace& place) {
  return (memory.Of<&Toys::state>(place.first[size_t(Domain::kChunk)])->flags & kFlags) == kFlags;
}
template <uint32_t kFlags>
inline constexpr Condition kWithToyFlags{
    &HasToyFlags<kFlags>, Domain::kChunk, {StreamOf<&Toys::state>, Stream::kNone}};

}  // namespace testing

template <>
inline constexpr auto kBlockMembers<testing::KeyBlock> =
    std::tuple{PELT_MEMBER(testing::KeyBlock, key)};
template <>
inline constexpr auto kBlockMembers<testing::PlaceBlock> =
    std::tuple{PELT_MEMBER(testing::PlaceBlock, place)};
template <>
inline constexpr auto kBlockMembers<testing::PairBlock> =
    std::tuple{PELT_MEMBER(testing::PairBlock, pair)};
template <>
inline constexpr auto kBlockMembers<testing::CountBlock> =
    std::tuple{PELT_MEMBER(testing::CountBlock, bin)};
template <>
inline constexpr auto kBlockMembers<testing::RecordBlock> =
    std::tuple{PELT_MEMBER(testing::RecordBlock, record)};
template <>
inline constexpr auto kBlockMembers<testing::RowBlock> =
    std::tuple{PELT_MEMBER(testing::RowBlock, a), PELT_MEMBER(testing::RowBlock, b),
               PELT_MEMBER(testing::RowBlock, c)};
template <>
inline constexpr auto kBlockMembers<testing::MadeBlock> =
    std::tuple{PELT_MEMBER(testing::MadeBlock, value)};
template <>
inline constexpr auto kBlockMembers<testing::StateBlock> = std::tuple{
    PELT_MEMBER(testing::StateBlock, flags), PELT_MEMBER(testing::StateBlock, first_place),
    PELT_MEMBER(testing::StateBlock, live)};
template <>
inline constexpr auto kBlockMembers<testing::WordBlock> =
    std::tuple{PELT_MEMBER(testing::WordBlock, word)};
template <>
inline constexpr auto kBlockMembers<testing::ListBlock> =
    std::tuple{PELT_MEMBER(testing::ListBlock, patch)};

}  // namespace pelt
