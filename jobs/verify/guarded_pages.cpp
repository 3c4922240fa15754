#include "jobs/verify/guarded_pages.hpp"

#include <cstdlib>

#include "core/stream_table.hpp"

#if defined(__unix__) || defined(__APPLE__)
#include <setjmp.h>
#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>
#endif

namespace pelt {

#if defined(__unix__) || defined(__APPLE__)
namespace {

// More than are open at once, so that an address comes again only after many runs; a prime, so that
// it does not come again at the same place of the next frame.
constexpr size_t kSlotsPerBlock = 11;

size_t PageBytes() {
  static const size_t kBytes = size_t(sysconf(_SC_PAGESIZE));
  return kBytes;
}
size_t RoundUpToPages(size_t bytes) {
  return (bytes + PageBytes() - 1) / PageBytes() * PageBytes();
}

sigjmp_buf stopped_at;
volatile sig_atomic_t armed = 0;
void* volatile stopped_address = nullptr;
volatile bool stopped_writing = false;
struct sigaction previous_segv, previous_bus;

bool IsWriteFault([[maybe_unused]] void* context) {
#if defined(__linux__) && defined(__x86_64__)
  return (static_cast<ucontext_t*>(context)->uc_mcontext.gregs[REG_ERR] & 2) != 0;
#else
  return false;  // not known here: reported as a read
#endif
}

void OnFault(int signal, siginfo_t* info, void* context) {
  if (!armed) {
    // Not a kernel's: dies as it would have without us.
    sigaction(signal, signal == SIGSEGV ? &previous_segv : &previous_bus, nullptr);
    return;
  }
  armed = 0;
  stopped_address = info->si_addr;
  stopped_writing = IsWriteFault(context);
  siglongjmp(stopped_at, 1);
}

void Protect(std::byte* from, size_t bytes, int protection) {
  if (mprotect(from, bytes, protection) != 0) std::abort();  // a system out of mappings
}

}  // namespace

bool GuardedPages::IsAvailable() { return true; }

GuardedPages::Catcher::Catcher() {
  struct sigaction action {};
  action.sa_sigaction = OnFault;
  // A handler that jumps away never returns: the signal must not stay blocked.
  action.sa_flags = SA_SIGINFO | SA_NODEFER;
  sigemptyset(&action.sa_mask);
  sigaction(SIGSEGV, &action, &previous_segv);
  sigaction(SIGBUS, &action, &previous_bus);
}

GuardedPages::Catcher::~Catcher() {
  sigaction(SIGSEGV, &previous_segv, nullptr);
  sigaction(SIGBUS, &previous_bus, nullptr);
}

GuardedPages::~GuardedPages() {
  if (base_) munmap(base_, total_bytes_);
}

bool GuardedPages::Reserve(size_t bytes, uint32_t blocks) {
  const size_t stride = 2 * RoundUpToPages(bytes) + 2 * PageBytes();
  if (stride <= stride_ && blocks * kSlotsPerBlock <= slots_) return true;
  if (base_) munmap(base_, total_bytes_);
  stride_ = stride;
  slots_ = blocks * kSlotsPerBlock;
  total_bytes_ = stride_ * slots_;
  void* at =
      mmap(nullptr, total_bytes_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (at == MAP_FAILED) {
    base_ = nullptr;
    stride_ = slots_ = 0;
    return false;
  }
  base_ = static_cast<std::byte*>(at);
  next_ = 0;
  return true;
}

GuardedPages::Block GuardedPages::Open(size_t bytes, bool at_end) {
  Block block;
  block.region_bytes = RoundUpToPages(bytes);
  // In the middle of its part: whoever goes astray by less than a block's size stays in it.
  block.region = base_ + next_ * stride_ + RoundUpToPages(stride_ / 4);
  next_ = (next_ + 1) % slots_;
  Protect(block.region, block.region_bytes, PROT_READ | PROT_WRITE);
  const size_t slack =
      at_end ? (block.region_bytes - bytes) / kBlockAlignment * kBlockAlignment : 0;
  block.bytes = block.region + slack;
  if (open_count_ == kMostOpen) std::abort();
  open_[open_count_++] = block;
  return block;
}

void GuardedPages::MakeReadOnly(const Block& block) {
  Protect(block.region, block.region_bytes, PROT_READ);
}

void GuardedPages::CloseAll() {
  for (size_t i = 0; i < open_count_; ++i)
    Protect(open_[i].region, open_[i].region_bytes, PROT_NONE);
  open_count_ = 0;
}

bool GuardedPages::IsNear(const Block& block, const std::byte* address) const {
  const auto slot = [&](const std::byte* at) { return size_t(at - base_) / stride_; };
  return address >= base_ && address < base_ + total_bytes_ && slot(address) == slot(block.region);
}

__attribute__((noinline)) GuardedPages::Stop GuardedPages::Call(
    void (*run)(const void*, const Binding*), const void* params, const Binding* bindings) {
  if (sigsetjmp(stopped_at, 0) == 0) {
    armed = 1;
    run(params, bindings);
    armed = 0;
    return {};
  }
  return {true, stopped_writing, static_cast<const std::byte*>(stopped_address)};
}

#else

bool GuardedPages::IsAvailable() { return false; }
GuardedPages::Catcher::Catcher() {}
GuardedPages::Catcher::~Catcher() {}
GuardedPages::~GuardedPages() {}
bool GuardedPages::Reserve(size_t, uint32_t) { return false; }
GuardedPages::Block GuardedPages::Open(size_t, bool) { std::abort(); }
void GuardedPages::MakeReadOnly(const Block&) {}
void GuardedPages::CloseAll() {}
bool GuardedPages::IsNear(const Block&, const std::byte*) const { return false; }
GuardedPages::Stop GuardedPages::Call(void (*)(const void*, const Binding*), const void*,
                                      const Binding*) {
  return {};
}

#endif

}  // namespace pelt
