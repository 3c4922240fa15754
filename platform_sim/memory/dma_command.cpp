#include "platform_sim/memory/dma_command.hpp"

#include <algorithm>

#include "core/format.hpp"

namespace pelt {
namespace {

constexpr bool IsSmall(uint32_t bytes) {
  return bytes == 1 || bytes == 2 || bytes == 4 || bytes == 8;
}

std::string CheckElement(const CellMemoryParameters& p, uint32_t local, const DmaElement& e) {
  if (!IsSmall(e.bytes) && (e.bytes == 0 || e.bytes % 16 != 0))
    return Format(
        "{} bytes; a DMA command moves 1, 2, 4, 8 or a multiple of 16 bytes: pad the block",
        e.bytes);
  if (e.bytes > p.largest_command_bytes)
    return Format("{} bytes; a DMA command moves at most {}: split it, or make it a list", e.bytes,
                  p.largest_command_bytes);
  if (((local ^ e.address) & 15) != 0)
    return Format(
        "local store {:#x} and effective address {:#x} differ in their low 4 bits; "
        "they must agree",
        local, e.address);
  const uint32_t alignment = std::min(e.bytes, 16u);
  if (local % alignment != 0)
    return Format(
        "{} bytes at local store {:#x} and effective address {:#x}; they must lie at "
        "multiples of {} (128 is fastest)",
        e.bytes, local, e.address, alignment);
  if (e.address + e.bytes < e.address)
    return Format("{} bytes at effective address {:#x} end behind the last address", e.bytes,
                  e.address);
  if (uint64_t(local) + e.bytes > p.local_store_bytes)
    return Format("local store {:#x} + {} bytes ends {} bytes behind the local store of {}", local,
                  e.bytes, uint64_t(local) + e.bytes - p.local_store_bytes, p.local_store_bytes);
  return {};
}

uint32_t Touched(uint64_t address, uint32_t bytes, uint32_t line) {
  return uint32_t((address + bytes - 1) / line - address / line + 1);
}

// The largest legal command at the start of what is left.
uint32_t NextPiece(const CellMemoryParameters& p, uint64_t address, uint64_t left) {
  if (address % 16 == 0 && left >= 16)
    return uint32_t(std::min<uint64_t>(left & ~uint64_t(15), p.largest_command_bytes));
  uint32_t piece = 8;
  while (address % piece != 0 || piece > left) piece /= 2;
  return piece;
}

}  // namespace

DmaCommand MakeDma(DmaKind kind, uint32_t local_address, uint64_t address, uint32_t bytes,
                   uint32_t tag) {
  DmaCommand command;
  command.kind = kind;
  command.tag = tag;
  command.local_address = local_address;
  command.elements = {{address, bytes}};
  return command;
}

bool CheckDma(const CellMemoryParameters& p, const DmaCommand& command, std::string& error) {
  std::string why;
  if (command.tag >= p.tags)
    why = Format("tag {}; tags are 0 to {}", command.tag, p.tags - 1);
  else if (command.far == DmaFar::kLocalStore && command.far_spu >= p.spu_count)
    why = Format("local store of SPU {}; there are {}", command.far_spu, p.spu_count);
  else if (command.elements.empty())
    why = "it has no element; give it something to move";
  else if (!command.list && command.elements.size() != 1)
    why = Format("{} elements; only a list has more than one", command.elements.size());
  else if (command.elements.size() > p.list_elements)
    why = Format("a list of {} elements; {} at most: use a second list", command.elements.size(),
                 p.list_elements);
  uint32_t local = command.local_address;
  for (size_t i = 0; why.empty() && i < command.elements.size(); ++i) {
    why = CheckElement(p, local, command.elements[i]);
    if (!why.empty() && command.list) why = Format("list element {}: {}", i, why);
    local = NextListAddress(local, command.elements[i].bytes);
    const uint64_t far_end = command.elements[i].address + command.elements[i].bytes;
    if (why.empty() && command.far == DmaFar::kLocalStore && far_end > p.local_store_bytes)
      why = Format("it ends {} bytes behind the local store of SPU {}",
                   far_end - p.local_store_bytes, command.far_spu);
  }
  if (why.empty()) return true;
  error = Format("illegal DMA {}: {}", command.kind == DmaKind::kGet ? "get" : "put", why);
  return false;
}

bool SplitDma(const CellMemoryParameters& p, const DmaCommand& block, std::vector<DmaCommand>& out,
              std::string& error) {
  out.clear();
  if (block.list || block.elements.size() != 1) {
    error = "SplitDma takes one block, not a list";
    return false;
  }
  uint32_t local = block.local_address;
  auto [address, left] = block.elements[0];
  if (((local ^ address) & 15) != 0)  // every piece would be refused; say it once
    return CheckDma(p, MakeDma(block.kind, local, address, 1, block.tag), error);
  while (left > 0) {
    const uint32_t piece = NextPiece(p, address, left);
    DmaCommand command = block;
    command.local_address = local;
    command.elements = {{address, piece}};
    if (!CheckDma(p, command, error)) {
      out.clear();
      return false;
    }
    out.push_back(std::move(command));
    local += piece;
    address += piece;
    left -= piece;
  }
  return true;
}

uint32_t DmaLines(const CellMemoryParameters& p, uint32_t local_address,
                  const DmaElement& element) {
  return std::max(Touched(element.address, element.bytes, p.line_bytes),
                  Touched(local_address, element.bytes, p.line_bytes));
}

}  // namespace pelt
