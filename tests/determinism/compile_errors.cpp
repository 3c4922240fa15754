// What must not compile, one mistake at a time: compile_errors_test.sh builds this file with FAULT
// set to each number and looks for the compiler's refusal. With FAULT 0 it must compile.
#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/streams.hpp"

namespace pelt {

struct Copy {
  static constexpr std::string_view kName = "copy";
  struct Ports {
#if FAULT == 1  // a stream that is not in the table
    In<&Streams::no_such_stream> keys;
#elif FAULT == 2  // a stream of as many bytes, and of another type
    In<&Streams::order> keys;
#else
    In<&Streams::sort_keys> keys;
#endif
    Out<&Streams::order> order;
  };
  static void Run(const Ports& ports) {
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
struct OddTable {
  StreamRow<OddBlock> odd{"odd", Domain::kChunk, Role::kInput};
};
struct OddPorts {
  In<&OddTable::odd> odd;
};
constexpr OddPorts kOdd{};
#elif FAULT == 6  // a row that is not named as its member
struct MisnamedTable {
  StreamRow<SortKeyBlock> keys{"key", Domain::kChunk, Role::kInput};
};
constexpr Stream kMisnamed = StreamOf<&MisnamedTable::keys>;
#endif

constexpr KernelDesc kDesc = MakeKernelDesc<Kernel>();
const KernelDesc& UseIt() { return kDesc; }

}  // namespace pelt
