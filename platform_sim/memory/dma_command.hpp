// A DMA command as a program gives it to the MFC, and what the hardware demands of it.
//
// 1, 2, 4, 8 bytes at their own alignment, or a multiple of 16 bytes up to 16 KiB at 16; both
// addresses agree in their low four bits. Whatever is refused here raises an alignment interrupt on
// the console and stops the game: an error here says which rule it was. Memory and the bus move
// whole 128-byte lines, so a command whose addresses are not at 128 costs the lines it touches.
//
// Not modelled: that a list lies in local store and its elements may not cross 4 GiB.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "platform_sim/platforms/cell_memory.hpp"

namespace pelt {

enum class DmaKind : uint8_t { kGet, kPut };
enum class DmaFar : uint8_t { kMemory, kL2, kLocalStore };
// A fence: after the earlier commands of its tag. A barrier: later ones of its tag after it, too.
enum class DmaOrder : uint8_t { kNone, kFence, kBarrier };

struct DmaElement {
  uint64_t address;  // main memory, or the far local store's
  uint32_t bytes;
};

struct DmaCommand {
  DmaKind kind = DmaKind::kGet;
  DmaFar far = DmaFar::kMemory;
  uint32_t far_spu = 0;  // of kLocalStore
  uint32_t tag = 0;
  DmaOrder order = DmaOrder::kNone;
  uint32_t local_address = 0;
  bool list = false;
  std::vector<DmaElement> elements;  // one, unless it is a list
};

DmaCommand MakeDma(DmaKind kind, uint32_t local_address, uint64_t address, uint32_t bytes,
                   uint32_t tag);

// False, and in `error` what the hardware demands and what to do.
bool CheckDma(const CellMemoryParameters& p, const DmaCommand& command, std::string& error);

// A block of any size and 128-byte, 16-byte or natural alignment as the fewest legal commands.
// Empty, and why in `error`, when no command sequence can move it. Zero bytes are no commands.
bool SplitDma(const CellMemoryParameters& p, const DmaCommand& block, std::vector<DmaCommand>& out,
              std::string& error);

// Lines that an element moves: those that either side touches, whichever are more.
uint32_t DmaLines(const CellMemoryParameters& p, uint32_t local_address, const DmaElement& element);

// Where the next list element goes in local store.
constexpr uint32_t NextListAddress(uint32_t local_address, uint32_t bytes) {
  return (local_address + bytes + 15) & ~15u;
}

}  // namespace pelt
