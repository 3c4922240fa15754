// How a kernel declares what it touches. Everything else (barriers, fusion, DMA, residency) is
// derived.
//
//   template <class V> struct FitCubic {
//     static constexpr std::string_view kName = "fit_cubic";
//     struct Params { ... };                        // trivially copyable; filled once a frame by
//     the caller struct Ports { In<RootBlock> roots; Out<CurveBlock> curves; }; static constexpr
//     auto kPorts = PortList(Port<&Ports::roots>(Stream::kRoots, "roots"),
//                                             Port<&Ports::curves>(Stream::kCurves, "curves"));
//     static void Run(const Params&, const Ports&); // one item: no loop over items, no thread, no
//     allocation
//   };
//
// Invariant: a kernel reads and writes only through its ports. A port left out of kPorts does not
// compile; writing through In, Shared, All or Gather does not compile; touching undeclared memory
// is caught by the local-store executor, which copies the declared blocks into a poisoned buffer
// and runs the kernel there.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "core/simd.hpp"

namespace pelt {

enum class Stream : uint8_t;  // core/streams.hpp

// What an item of a stage, or a block of a stream, stands for. Each is a refinement of the one
// before: a scene has characters, a character layers, a layer chunks.
enum class Domain : uint8_t { kScene, kCharacter, kLayer, kChunk };

enum class Access : uint8_t {
  kIn,        // own block, read
  kOut,       // own block, every byte the readers use is written: costs no DMA get
  kInOut,     // own block, read and written
  kShared,    // the one block of a coarser domain that the item belongs to, read
  kAll,       // every block of a finer domain inside the item, read: implies a barrier
  kAllOut,    // the same, written
  kAllInOut,  // the same, read and written
  kGather,    // records anywhere in the layer, read by index: implies a barrier
  kScatter,   // records anywhere in the layer, written by index, each index by one chunk only
};

constexpr bool IsWritten(Access a) {
  return a == Access::kOut || a == Access::kInOut || a == Access::kAllOut ||
         a == Access::kAllInOut || a == Access::kScatter;
}
// Needs what was there before.
constexpr bool IsRead(Access a) {
  return a != Access::kOut && a != Access::kAllOut && a != Access::kScatter;
}

// What the executor hands a port. `block` is the first byte; `count` the number of blocks behind it
// (All, AllOut) or of records (Gather, Scatter); `index` is the record list of Gather and Scatter,
// null when records are addressed directly.
struct Binding {
  void* block;
  uint32_t* index;
  uint32_t count;
};

template <class T>
struct In {
  using Block = T;
  static constexpr Access kAccess = Access::kIn;
  const T* block;
  PELT_INLINE explicit In(const Binding& b) : block(static_cast<const T*>(b.block)) {}
  PELT_INLINE const T* operator->() const { return block; }
  PELT_INLINE const T& operator*() const { return *block; }
};
template <class T>
struct Shared {
  using Block = T;
  static constexpr Access kAccess = Access::kShared;
  const T* block;
  PELT_INLINE explicit Shared(const Binding& b) : block(static_cast<const T*>(b.block)) {}
  PELT_INLINE const T* operator->() const { return block; }
  PELT_INLINE const T& operator*() const { return *block; }
};
template <class T>
struct Out {
  using Block = T;
  static constexpr Access kAccess = Access::kOut;
  T* block;
  PELT_INLINE explicit Out(const Binding& b) : block(static_cast<T*>(b.block)) {}
  PELT_INLINE T* operator->() const { return block; }
  PELT_INLINE T& operator*() const { return *block; }
};
template <class T>
struct InOut {
  using Block = T;
  static constexpr Access kAccess = Access::kInOut;
  T* block;
  PELT_INLINE explicit InOut(const Binding& b) : block(static_cast<T*>(b.block)) {}
  PELT_INLINE T* operator->() const { return block; }
  PELT_INLINE T& operator*() const { return *block; }
};
template <class T>
struct All {
  using Block = T;
  static constexpr Access kAccess = Access::kAll;
  const T* blocks;
  uint32_t count;
  PELT_INLINE explicit All(const Binding& b)
      : blocks(static_cast<const T*>(b.block)), count(b.count) {}
  PELT_INLINE const T& operator[](uint32_t i) const { return blocks[i]; }
};
template <class T>
struct AllOut {
  using Block = T;
  static constexpr Access kAccess = Access::kAllOut;
  T* blocks;
  uint32_t count;
  PELT_INLINE explicit AllOut(const Binding& b)
      : blocks(static_cast<T*>(b.block)), count(b.count) {}
  PELT_INLINE T& operator[](uint32_t i) const { return blocks[i]; }
};
template <class T>
struct AllInOut {
  using Block = T;
  static constexpr Access kAccess = Access::kAllInOut;
  T* blocks;
  uint32_t count;
  PELT_INLINE explicit AllInOut(const Binding& b)
      : blocks(static_cast<T*>(b.block)), count(b.count) {}
  PELT_INLINE T& operator[](uint32_t i) const { return blocks[i]; }
};
// Record `i` of this item's record list. In main memory the list is followed; in a local store the
// executor has fetched the listed records already and they lie in list order (index is null).
template <class T>
struct Gather {
  using Block = T;
  static constexpr Access kAccess = Access::kGather;
  const T* records;
  const uint32_t* index;
  PELT_INLINE explicit Gather(const Binding& b)
      : records(static_cast<const T*>(b.block)), index(b.index) {}
  PELT_INLINE const T& operator[](uint32_t i) const { return records[index ? index[i] : i]; }
};
// Put(i, to, value): the i-th record this item writes, to layer-wide place `to`. In main memory it
// is stored at once; in a local store value and place are kept in list order and put by the
// executor.
template <class T>
struct Scatter {
  using Block = T;
  static constexpr Access kAccess = Access::kScatter;
  T* records;
  uint32_t* index;
  PELT_INLINE explicit Scatter(const Binding& b)
      : records(static_cast<T*>(b.block)), index(b.index) {}
  PELT_INLINE void Put(uint32_t i, uint32_t to, const T& value) const {
    if (index) {
      index[i] = to;
      records[i] = value;
    } else {
      records[to] = value;
    }
  }
};

// The kernel's view of one port, for the plan. `record_list` names the stream that holds the
// indices of a Gather port (an uint32_t array at the head of the item's own block); unused
// otherwise.
struct PortDesc {
  std::string_view name;
  Stream stream;
  Access access;
  uint32_t block_bytes;  // Gather, Scatter: bytes of one record
  Stream record_list;
};

inline constexpr uint32_t kMaxPorts = 12;

// A kernel with its types erased: what the frame's table holds.
struct KernelDesc {
  std::string_view name;
  std::span<const PortDesc> ports;
  uint32_t params_bytes;
  void (*run)(const void* params, const Binding* bindings);
};

namespace kernel_detail {
template <class M>
struct MemberOf;
template <class C, class T>
struct MemberOf<T C::*> {
  using Class = C;
  using Type = T;
};
template <auto kMember>
struct PortEntry {
  using Type = typename MemberOf<decltype(kMember)>::Type;
  PortDesc desc;
};
}  // namespace kernel_detail

template <auto kMember>
constexpr auto Port(Stream stream, std::string_view name, Stream record_list = Stream{}) {
  using Entry = kernel_detail::PortEntry<kMember>;
  using Type = typename Entry::Type;
  using Block = typename Type::Block;
  static_assert(std::is_trivially_copyable_v<Block>);
  static_assert(Type::kAccess == Access::kGather || Type::kAccess == Access::kScatter ||
                    sizeof(Block) % 16 == 0,
                "a block must be a legal DMA transfer");
  return Entry{{name, stream, Type::kAccess, uint32_t(sizeof(Block)), record_list}};
}

template <class... Entry>
constexpr auto PortList(Entry... entry) {
  return std::tuple<Entry...>{entry...};
}

// Erases a kernel's types. The members of Ports must be listed in kPorts, all of them and in order.
template <class K>
struct KernelTraits {
  using Ports = typename K::Ports;
  using Params = typename K::Params;
  using List = std::remove_cvref_t<decltype(K::kPorts)>;
  static constexpr size_t kCount = std::tuple_size_v<List>;
  static_assert(std::is_trivially_copyable_v<Params>);
  static_assert(kCount <= kMaxPorts);

  template <size_t... I>
  static constexpr auto MakeDescs(std::index_sequence<I...>) {
    return std::array<PortDesc, kCount>{std::get<I>(K::kPorts).desc...};
  }
  static constexpr auto kDescs = MakeDescs(std::make_index_sequence<kCount>{});

  template <size_t... I>
  static PELT_INLINE Ports Bind(const Binding* b, std::index_sequence<I...>) {
    return Ports{typename std::tuple_element_t<I, List>::Type(b[I])...};
  }
  static void Run(const void* params, const Binding* bindings) {
    K::Run(*static_cast<const Params*>(params), Bind(bindings, std::make_index_sequence<kCount>{}));
  }
  // Aggregate initialisation from exactly the listed ports fails to compile if one is missing or
  // misplaced.
  static_assert(sizeof(Bind(nullptr, std::make_index_sequence<kCount>{})) == sizeof(Ports));
};

template <class K>
constexpr KernelDesc MakeKernelDesc() {
  return {K::kName, KernelTraits<K>::kDescs, uint32_t(sizeof(typename K::Params)),
          &KernelTraits<K>::Run};
}

}  // namespace pelt
