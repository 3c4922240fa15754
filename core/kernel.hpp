// How a kernel declares what it touches. Everything else (barriers, fusion, DMA, residency) is
// derived.
//
//   template <class V>
//   struct FitCubic {
//     static constexpr std::string_view kName = "fit_cubic";
//     using Params = FitCubicParams;  // trivially copyable, filled once per frame by the caller; may
//                                     // be left out
//     struct Ports {
//       In<&Streams::roots> roots;  // the stream is the type
//       Out<&Streams::curves> curves;
//     };
//     static void Run(const Params&, const Ports&);  // one item: no loop over items, no thread, no
//   };                                               // allocation
//
// Invariant: a kernel reads and writes only through its ports, which are read off the struct: there
// is no second list of them. Writing through In, Shared, All or Gather does not compile; touching
// undeclared memory is caught by the local-store executor, which copies the declared blocks into a
// poisoned buffer and runs the kernel there.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>
#include <utility>

#include "core/kernel_desc.hpp"
#include "core/simd.hpp"
#include "core/stream_table.hpp"

namespace pelt {

namespace kernel_detail {

// What every port has: its stream, taken from the row, and how it is reached.
template <auto kRow, Access kHow>
struct PortOf {
  using Table = MemberClass<kRow>;
  using Block = BlockOf<kRow>;
  static_assert(std::is_trivially_copyable_v<Block>);
  static constexpr Stream kStream = StreamOf<kRow>;
  static constexpr Domain kDomain = RowOf<kRow>.domain;
  static constexpr Stream kRecordList = Stream::kNone;
  static constexpr uint32_t kRecords = 0;
  static constexpr Access kAccess = kHow;
};

template <auto kRow, Access kHow, class T>
struct OneBlock : PortOf<kRow, kHow> {
  static_assert(sizeof(T) % 16 == 0, "a block must be a legal DMA transfer");
  static constexpr uint32_t kBytes = sizeof(T);
  T* block = nullptr;
  PELT_INLINE void Bind(const Binding& binding) { block = static_cast<T*>(binding.block); }
  PELT_INLINE T* operator->() const { return block; }
  PELT_INLINE T& operator*() const { return *block; }
};

template <auto kRow, Access kHow, class T>
struct AllBlocks : PortOf<kRow, kHow> {
  static_assert(sizeof(T) % 16 == 0, "a block must be a legal DMA transfer");
  static constexpr uint32_t kBytes = sizeof(T);
  T* blocks = nullptr;
  uint32_t count = 0;
  PELT_INLINE void Bind(const Binding& binding) {
    blocks = static_cast<T*>(binding.block);
    count = binding.count;
  }
  PELT_INLINE T& operator[](uint32_t i) const { return blocks[i]; }
};

// A block that is one array of records is gathered and scattered by these.
template <class Block>
constexpr auto FirstRecord(Block& block) {
  auto& [records] = block;
  return records[0];
}
template <class Block>
using RecordOf = decltype(FirstRecord(std::declval<Block&>()));

template <auto kRow, auto kList, class T>
struct Listed : PortOf<kRow, Access::kGather> {
  using Record = T;
  static_assert(std::is_same_v<MemberClass<kRow>, MemberClass<kList>>);
  static constexpr Stream kRecordList = StreamOf<kList>;
  static constexpr uint32_t kBytes = sizeof(Record);
  static constexpr uint32_t kRecords = sizeof(BlockOf<kList>) / sizeof(uint32_t);
  const Record* records = nullptr;
  const uint32_t* index = nullptr;
  PELT_INLINE void Bind(const Binding& binding) {
    records = static_cast<const Record*>(binding.block);
    index = binding.index;
  }
  PELT_INLINE const Record& operator[](uint32_t i) const { return records[index ? index[i] : i]; }
};

}  // namespace kernel_detail

template <auto kRow>
struct In : kernel_detail::OneBlock<kRow, Access::kIn, const BlockOf<kRow>> {};
template <auto kRow>
struct Shared : kernel_detail::OneBlock<kRow, Access::kShared, const BlockOf<kRow>> {};
template <auto kRow>
struct Out : kernel_detail::OneBlock<kRow, Access::kOut, BlockOf<kRow>> {};
template <auto kRow>
struct InOut : kernel_detail::OneBlock<kRow, Access::kInOut, BlockOf<kRow>> {};
template <auto kRow>
struct All : kernel_detail::AllBlocks<kRow, Access::kAll, const BlockOf<kRow>> {};
template <auto kRow>
struct AllOut : kernel_detail::AllBlocks<kRow, Access::kAllOut, BlockOf<kRow>> {};
template <auto kRow>
struct AllInOut : kernel_detail::AllBlocks<kRow, Access::kAllInOut, BlockOf<kRow>> {};

// Record `i` of this item's record list, an uint32_t array at the head of the item's own block of
// the stream kList. In main memory the list is followed; in a local store the executor has fetched
// the listed records already and they lie in list order (index is null).
template <auto kRow, auto kList>
struct Gather : kernel_detail::Listed<kRow, kList, kernel_detail::RecordOf<BlockOf<kRow>>> {};
// The same of whole blocks.
template <auto kRow, auto kList>
struct GatherBlocks : kernel_detail::Listed<kRow, kList, BlockOf<kRow>> {};

// Put(i, to, value): the i-th record this item writes, to layer-wide place `to`. In main memory it
// is stored at once; in a local store value and place are kept in list order and put by the
// executor.
template <auto kRow>
struct Scatter : kernel_detail::PortOf<kRow, Access::kScatter> {
  using Record = kernel_detail::RecordOf<BlockOf<kRow>>;
  static constexpr uint32_t kBytes = sizeof(Record);
  static constexpr uint32_t kRecords = MemberClass<kRow>::kChunkLanes;
  Record* records = nullptr;
  uint32_t* index = nullptr;
  PELT_INLINE void Bind(const Binding& binding) {
    records = static_cast<Record*>(binding.block);
    index = binding.index;
  }
  PELT_INLINE void Put(uint32_t i, uint32_t to, const Record& value) const {
    if (index) {
      index[i] = to;
      records[i] = value;
    } else {
      records[to] = value;
    }
  }
};

template <class T>
inline constexpr bool kIsPort = requires {
  T::kStream;
};

// Calls visit(port, port, ...). What several kernels' ports begin with may be a struct of its own, their first member.
template <class Ports, class Visit>
constexpr decltype(auto) WithPorts(Ports&& ports, Visit&& visit) {
  return WithMembers(ports, [&]<class First>(First& first, auto&... more) -> decltype(auto) {
    if constexpr (kIsPort<First>)
      return visit(first, more...);
    else
      return WithPorts(first,
                       [&](auto&... port) -> decltype(auto) { return visit(port..., more...); });
  });
}

// Erases a kernel's types.
template <class K>
struct KernelTraits {
  using Ports = typename K::Ports;
  using Table = typename decltype(WithPorts(
      std::declval<Ports&>(), []<class P, class... More>(const P&, const More&...) {
        static_assert((std::is_same_v<typename P::Table, typename More::Table> && ...),
                      "ports are of one table");
        return std::type_identity<typename P::Table>{};
      }))::type;

  static constexpr auto kDescs = WithPorts(Ports{}, [](const auto&... port) {
    return std::array{
        PortDesc{port.kStream, port.kAccess, port.kDomain, port.kBytes,
                 uint32_t(sizeof(typename std::remove_cvref_t<decltype(port)>::Block)),
                 port.kRecordList, port.kRecords}...};
  });
  static_assert(kDescs.size() <= kMaxPorts);
  static PELT_INLINE Ports Bind(const Binding* bindings) {
    Ports ports;
    WithPorts(ports, [&](auto&... port) { (port.Bind(*bindings++), ...); });
    return ports;
  }
  static void Run(const void* params, const Binding* bindings) {
    if constexpr (requires { typename K::Params; })
      K::Run(*static_cast<const typename K::Params*>(params), Bind(bindings));
    else
      K::Run(Bind(bindings));
  }
  static constexpr uint32_t ParamsBytes() {
    if constexpr (requires { typename K::Params; }) {
      static_assert(std::is_trivially_copyable_v<typename K::Params>);
      return sizeof(typename K::Params);
    } else {
      return 0;
    }
  }
};

template <class K>
constexpr KernelDesc MakeKernelDesc(decltype(KernelDesc::run) run = &KernelTraits<K>::Run) {
  return {K::kName, &TableOf<typename KernelTraits<K>::Table>, KernelTraits<K>::kDescs,
          KernelTraits<K>::ParamsBytes(), run};
}

}  // namespace pelt
