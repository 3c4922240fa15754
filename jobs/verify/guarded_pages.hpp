// Memory whose neighbours are closed: blocks with pages on both sides that stop whoever touches
// them, and a call that survives being stopped.
//
// Invariant: a block is opened at an address that none of the last openings had; closed again, it
// cannot be touched. Needs POSIX; elsewhere nothing is available.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/kernel_desc.hpp"

namespace pelt {

class GuardedPages {
 public:
  struct Block {
    std::byte* bytes = nullptr;   // aligned to kBlockAlignment
    std::byte* region = nullptr;  // whole pages that hold it
    size_t region_bytes = 0;
  };
  // Where a kernel was stopped.
  struct Stop {
    bool stopped = false, write = false;
    const std::byte* address = nullptr;
  };
  // While one lives, faults of this process are caught: one at a time, and one thread.
  class Catcher {
   public:
    Catcher();
    ~Catcher();
    Catcher(const Catcher&) = delete;
    Catcher& operator=(const Catcher&) = delete;
  };

  static bool IsAvailable();
  GuardedPages() = default;
  ~GuardedPages();
  GuardedPages(const GuardedPages&) = delete;
  GuardedPages& operator=(const GuardedPages&) = delete;

  // Address space for blocks of `bytes`, and at least `blocks` of them open at a time. False: there is
  // none, as where it is limited (ulimit -v).
  bool Reserve(size_t bytes, uint32_t blocks);
  // Against the closed page behind it, or against the one in front.
  Block Open(size_t bytes, bool at_end);
  void MakeReadOnly(const Block& block);
  void CloseAll();
  // Whether `address` lies in the part of the address space that is kept for this block.
  bool IsNear(const Block& block, const std::byte* address) const;

  // Calls the kernel; it ends early at the first access that no open page allows.
  static Stop Call(void (*run)(const void*, const Binding*), const void* params,
                   const Binding* bindings);

 private:
  std::byte* base_ = nullptr;
  size_t total_bytes_ = 0, stride_ = 0;  // of one block's part
  size_t slots_ = 0, next_ = 0;
  static constexpr size_t kMostOpen = 512;
  Block open_[kMostOpen];
  size_t open_count_ = 0;
};

}  // namespace pelt
