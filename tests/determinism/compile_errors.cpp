// What must not compile, one mistake at a time: compile_errors_test.sh builds this file with FAULT
// set to each number and looks for the compiler's refusal. With FAULT 0 it must compile.
#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/streams.hpp"

namespace pelt {

struct NoParams {};

struct Copy {
  static constexpr std::string_view kName = "copy";
  using Params = NoParams;
  struct Ports {
    In<SortKeyBlock> keys;
    Out<OrderBlock> order;
  };
#if FAULT == 1  // a port left out
  static constexpr auto kPorts = PortList(Port<&Ports::keys>(Stream::kSortKeys, "keys"));
#elif FAULT == 2  // ports in another order
  static constexpr auto kPorts = PortList(Port<&Ports::order>(Stream::kOrder, "order"),
                                          Port<&Ports::keys>(Stream::kSortKeys, "keys"));
#else
  static constexpr auto kPorts = PortList(Port<&Ports::keys>(Stream::kSortKeys, "keys"),
                                          Port<&Ports::order>(Stream::kOrder, "order"));
#endif
  static void Run(const Params&, const Ports& ports) {
#if FAULT == 3  // a write through In
    ports.keys->key[0] = 1;
#endif
    for (uint32_t i = 0; i < kStrandsPerChunk; ++i) ports.order->strand[i] = ports.keys->key[i];
  }
};

#if FAULT == 4  // parameters that cannot be copied as bytes
struct WithPointer : Copy {
  struct Params {
    Params(const Params&) {}
  };
  static void Run(const Params&, const Ports&) {}
};
using Kernel = WithPointer;
#else
using Kernel = Copy;
#endif

#if FAULT == 5  // a block that is no legal DMA transfer
struct OddBlock {
  uint32_t word[3];
};
struct OddPorts {
  In<OddBlock> odd;
};
constexpr auto kOdd = PortList(Port<&OddPorts::odd>(Stream::kSortKeys, "odd"));
#endif

constexpr KernelDesc kDesc = MakeKernelDesc<Kernel>();
const KernelDesc& UseIt() { return kDesc; }

}  // namespace pelt
