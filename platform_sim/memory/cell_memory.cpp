#include "platform_sim/memory/cell_memory.hpp"

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

Result<std::unique_ptr<CellMemory>> CellMemory::Make(const CellMemoryParameters& p,
                                                     EventQueue& queue) {
  std::string error;
  if (!CheckCellMemory(p, error)) return Failure{error};
  return std::unique_ptr<CellMemory>(new CellMemory(p, queue));
}

CellMemory::CellMemory(const CellMemoryParameters& p, EventQueue& queue)
    : p_(p), queue_(queue), bus_(p_, queue), memory_(p_, queue), mfcs_(p.spu_count) {}

bool CellMemory::Submit(uint32_t spu, const DmaCommand& command, Action accepted, Action done,
                        std::string& error) {
  if (spu >= mfcs_.size()) {
    error = Format("DMA of SPU {}; there are {}", spu, mfcs_.size());
    return false;
  }
  if (!CheckDma(p_, command, error)) return false;
  if (command.far == DmaFar::kLocalStore && command.far_spu == spu) {
    error = Format("SPU {} moves data to its own local store by DMA; copy it there", spu);
    return false;
  }
  if (command.far == DmaFar::kL2 && command.kind == DmaKind::kPut) {
    error = "a put goes to memory; only a get finds its lines in the PPE's L2";
    return false;
  }
  Mfc& mfc = mfcs_[spu];
  if (mfc.queue.size() >= p_.queue_commands) {
    mfc.stalled.push_back({command, std::move(accepted), std::move(done)});
    return true;
  }
  Accept(spu, command, std::move(done));
  queue_.After(0, std::move(accepted));
  return true;
}

void CellMemory::Accept(uint32_t spu, DmaCommand command, Action done) {
  Mfc& mfc = mfcs_[spu];
  DmaCounts& counts = mfc.counts;
  ++counts.commands;
  if (command.list) counts.list_elements += command.elements.size();
  for (const DmaElement& e : command.elements)
    (command.kind == DmaKind::kGet ? counts.get_bytes : counts.put_bytes) += e.bytes;
  auto entry = std::make_unique<Entry>();
  entry->local_address = command.local_address;
  entry->command = std::move(command);
  entry->done = std::move(done);
  mfc.queue.push_back(std::move(entry));
  counts.most_queued = std::max(counts.most_queued, uint32_t(mfc.queue.size()));
  Pump(spu);
}

void CellMemory::WaitTags(uint32_t spu, uint32_t tag_mask, Action done) {
  for (const auto& entry : mfcs_[spu].queue)
    if (tag_mask >> entry->command.tag & 1) {
      mfcs_[spu].waits.push_back({tag_mask, std::move(done)});
      return;
    }
  queue_.After(0, std::move(done));
}

// The first in the queue that no earlier command of its tag holds back.
CellMemory::Entry* CellMemory::NextToStart(Mfc& mfc) const {
  uint32_t earlier_tags = 0, barred_tags = 0;
  for (const auto& entry : mfc.queue) {
    const uint32_t tag = 1u << entry->command.tag;
    const bool held =
        (entry->command.order != DmaOrder::kNone && (earlier_tags & tag)) || (barred_tags & tag);
    if (!entry->started && !held) return entry.get();
    earlier_tags |= tag;
    if (entry->command.order == DmaOrder::kBarrier) barred_tags |= tag;
  }
  return nullptr;
}

void CellMemory::PumpAfter(uint32_t spu, Cycles cycles) {
  mfcs_[spu].busy = true;
  queue_.After(cycles, [this, spu] {
    mfcs_[spu].busy = false;
    Pump(spu);
  });
}

// One step of the MFC: take up a command, fetch a list element, or send off a line.
void CellMemory::Pump(uint32_t spu) {
  Mfc& mfc = mfcs_[spu];
  if (mfc.busy) return;
  if (!mfc.current) {
    mfc.current = NextToStart(mfc);
    if (!mfc.current) return;
    mfc.current->started = true;
    return PumpAfter(spu, p_.command_cycles);
  }
  Entry& entry = *mfc.current;
  if (entry.lines_left == 0) {
    const DmaElement& element = entry.command.elements[entry.element++];
    entry.lines_left = DmaLines(p_, entry.local_address, element);
    entry.local_address = NextListAddress(entry.local_address, element.bytes);
    mfc.counts.lines += entry.lines_left;
    if (entry.command.list) return PumpAfter(spu, p_.list_element_cycles);
  }
  if (mfc.lines_in_flight == p_.lines_in_flight) return;  // LineDone goes on
  StartLine(spu, entry);
  if (entry.AllCut()) mfc.current = nullptr;
  PumpAfter(spu, p_.bus_cycle_cycles);
}

void CellMemory::StartLine(uint32_t spu, Entry& entry) {
  ++mfcs_[spu].lines_in_flight;
  ++entry.in_flight;
  --entry.lines_left;
  const Cycles start = std::max(queue_.now(), next_snoop_);
  next_snoop_ = start + p_.bus_cycle_cycles;
  queue_.At(start + p_.snoop_cycles, [this, spu, &entry] { MoveLine(spu, entry); });
}

void CellMemory::MoveLine(uint32_t spu, Entry& entry) {
  const DmaCommand& command = entry.command;
  const uint32_t own = BusStop(p_, spu);
  const auto done = [this, spu, &entry] { LineDone(spu, entry); };
  const auto send_here = [this, own, done](uint32_t from) {
    return [this, own, done, from] { bus_.Send(from, own, done); };
  };
  switch (command.far) {
    case DmaFar::kMemory:
      if (command.kind == DmaKind::kGet)
        memory_.Access(false, send_here(kMemoryStop));
      else
        bus_.Send(own, kMemoryStop, [this, done] { memory_.Access(true, done); });
      break;
    case DmaFar::kL2:
      l2_free_ = std::max(l2_free_, queue_.now()) + p_.l2_line_cycles;
      queue_.At(l2_free_, send_here(kPpeStop));
      break;
    case DmaFar::kLocalStore: {
      const uint32_t far = BusStop(p_, command.far_spu);
      if (command.kind == DmaKind::kGet)
        queue_.After(p_.local_store_cycles, send_here(far));
      else
        bus_.Send(own, far, [this, done] { queue_.After(p_.local_store_cycles, done); });
      break;
    }
  }
}

void CellMemory::LineDone(uint32_t spu, Entry& entry) {
  --mfcs_[spu].lines_in_flight;
  --entry.in_flight;
  if (entry.in_flight == 0 && entry.AllCut()) Complete(spu, entry);
  Pump(spu);
}

void CellMemory::Complete(uint32_t spu, Entry& entry) {
  Mfc& mfc = mfcs_[spu];
  Action done = std::move(entry.done);
  const auto at = std::find_if(mfc.queue.begin(), mfc.queue.end(),
                               [&](const auto& e) { return e.get() == &entry; });
  mfc.queue.erase(at);
  queue_.After(0, std::move(done));

  if (!mfc.stalled.empty()) {
    Waiting next = std::move(mfc.stalled.front());
    mfc.stalled.pop_front();
    Accept(spu, std::move(next.command), std::move(next.done));
    queue_.After(0, std::move(next.accepted));
  }
  uint32_t tags = 0;
  for (const auto& e : mfc.queue) tags |= 1u << e->command.tag;
  std::erase_if(mfc.waits, [&](TagWait& wait) {
    if (wait.mask & tags) return false;
    queue_.After(0, std::move(wait.done));
    return true;
  });
}

}  // namespace pelt
