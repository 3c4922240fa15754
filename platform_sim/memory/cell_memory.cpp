#include "platform_sim/memory/cell_memory.hpp"

#include <algorithm>

#include "core/format.hpp"

namespace pelt {

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
