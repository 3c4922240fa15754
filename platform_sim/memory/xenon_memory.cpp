#include "platform_sim/memory/xenon_memory.hpp"

#include <algorithm>
#include <deque>

#include "core/format.hpp"

namespace pelt {

Cache::Entry* Cache::Find(uint64_t line) {
  Entry* set = &entries_[size_t(line % sets_) * ways_];
  const auto at = std::find_if(set, set + ways_, [&](const Entry& e) { return e.line == line; });
  return at == set + ways_ ? nullptr : at;
}

bool Cache::Touch(uint64_t line, bool dirty) {
  Entry* entry = Find(line);
  if (!entry) return false;
  entry->used = ++clock_;
  entry->dirty |= dirty;
  return true;
}

Cache::Evicted Cache::Fill(uint64_t line, bool dirty) {
  Entry* set = &entries_[size_t(line % sets_) * ways_];
  Entry* oldest = std::min_element(set, set + ways_,
                                   [](const Entry& a, const Entry& b) { return a.used < b.used; });
  const Evicted evicted = {oldest->used > 0, oldest->dirty, oldest->line};
  *oldest = {line, ++clock_, dirty};
  return evicted;
}

void Cache::Drop(uint64_t line) {
  if (Entry* entry = Find(line)) *entry = {};
}

namespace {

constexpr Cycles kMilli = 1000;

// A way for bytes at a rate: who comes later waits. Times inside are thousandths of a cycle.
class Channel {
 public:
  explicit Channel(uint64_t milli_bytes_per_cycle) : rate_(milli_bytes_per_cycle) {}

  // When the last byte of a transfer asked for at `time` is through.
  Cycles Take(Cycles time, uint64_t bytes) {
    free_ = std::max(free_, time * kMilli) + Cycles(bytes * kMilli * kMilli / rate_);
    return (free_ + kMilli - 1) / kMilli;
  }

 private:
  uint64_t rate_;
  Cycles free_ = 0;
};

struct Miss {
  uint64_t line;
  Cycles ready;
  bool from_memory;
};

struct Core {
  Cache l1;
  std::vector<Miss> misses;  // in flight
};

struct Store {
  uint64_t address;
  uint32_t bytes;
  Cycles time;
};

struct Thread {
  const std::vector<MemoryAccess>* trace;
  size_t next = 0;
  Cycles delay = 0;
  std::deque<Store> stores;  // young enough to be hit

  bool Done() const { return next == trace->size(); }
  Cycles Time() const { return (*trace)[next].cycle + delay; }
};

class Machine {
 public:
  Machine(const CacheMemoryParameters& p, std::span<const std::vector<MemoryAccess>> traces)
      : p_(p),
        cores_(p.cores, Core{Cache(p.l1_bytes, p.l1_ways, p.line_bytes), {}}),
        busy_threads_(p.cores),
        l2_(p.l2_bytes, p.l2_ways, p.line_bytes),
        l2_rate_(p.l2_milli_bytes_per_cycle),
        bus_read_(p.bus_milli_bytes_per_cycle),
        bus_write_(p.bus_milli_bytes_per_cycle),
        memory_(uint64_t(p.memory_milli_bytes_per_cycle) * (1000 - p.gpu_permille) / 1000) {
    for (const auto& trace : traces) {
      busy_threads_[threads_.size() / p.core.smt_threads] += !trace.empty();
      threads_.push_back({&trace, 0, 0, {}});
    }
    run_.threads.resize(threads_.size());
  }

  CacheMemoryRun Run() {
    for (;;) {
      const auto thread =
          std::min_element(threads_.begin(), threads_.end(), [](const Thread& a, const Thread& b) {
            return a.Done() ? false : b.Done() || a.Time() < b.Time();
          });
      if (thread == threads_.end() || thread->Done()) return run_;
      Step(uint32_t(thread - threads_.begin()));
    }
  }

 private:
  void Step(uint32_t t) {
    Thread& thread = threads_[t];
    ThreadMemoryTimes& times = run_.threads[t];
    const MemoryAccess& access = (*thread.trace)[thread.next];
    const uint64_t first = access.address / p_.line_bytes;
    const uint64_t last = (access.address + access.bytes - 1) / p_.line_bytes;
    // A thread that must stand for a place to miss from asks again then: what others ask for
    // meanwhile goes to memory first.
    for (uint64_t line = first; line <= last; ++line)
      if (Misses(t, access, line) && WaitForMissSlot(t)) return;
    for (uint64_t line = first; line <= last; ++line) Touch(t, access, line);
    if (access.kind == AccessKind::kStore)
      thread.stores.push_back({access.address, access.bytes, thread.Time()});
    times.finish = thread.Time();
    run_.finish = std::max(run_.finish, times.finish);
    ++thread.next;
  }

  void Touch(uint32_t t, const MemoryAccess& access, uint64_t line) {
    ThreadMemoryTimes& times = run_.threads[t];
    switch (access.kind) {
      case AccessKind::kLoad:
        ++times.loads;
        HitStore(t, access);
        return Load(t, access, line);
      case AccessKind::kPrefetch:
        ++times.prefetches;
        return Prefetch(t, line);
      case AccessKind::kStore:
      case AccessKind::kLineZero:
        ++times.stores;
        return StoreThrough(t, access, line);
    }
  }

  // The thread stands for `cycles`, rounded up to its next turn to dispatch.
  void Stall(uint32_t t, Cycles cycles, Cycles ThreadMemoryTimes::*reason) {
    if (cycles <= 0) return;
    threads_[t].delay += cycles;
    run_.threads[t].*reason += cycles;
  }

  Cycles ToSlot(uint32_t t, Cycles cycles) const {
    const Cycles slot = busy_threads_[t / p_.core.smt_threads];
    return (cycles + slot - 1) / slot * slot;
  }

  void HitStore(uint32_t t, const MemoryAccess& load) {
    Thread& thread = threads_[t];
    const Cycles window = p_.core.load_hit_store_cycles;
    while (!thread.stores.empty() && thread.stores.front().time + window <= thread.Time())
      thread.stores.pop_front();
    for (auto store = thread.stores.rbegin(); store != thread.stores.rend(); ++store) {
      if (store->address >= load.address + load.bytes ||
          load.address >= store->address + store->bytes)
        continue;
      ++run_.threads[t].load_hit_stores;
      return Stall(t, store->time + window - thread.Time(),
                   &ThreadMemoryTimes::load_hit_store_stall);
    }
  }

  Core& CoreOf(uint32_t t) { return cores_[t / p_.core.smt_threads]; }

  void Load(uint32_t t, const MemoryAccess& access, uint64_t line) {
    ThreadMemoryTimes& times = run_.threads[t];
    Core& core = CoreOf(t);
    const bool hit = core.l1.Touch(line, false);
    const Miss* miss = InFlight(core, line, threads_[t].Time());
    if (hit && !miss) return;
    if (!hit) ++times.l1_misses;
    bool from_memory;
    Cycles ready;
    if (miss) {
      if (!hit) core.l1.Fill(line, false);  // a store asked for it, or it was driven out
      ready = miss->ready;
      from_memory = miss->from_memory;
    } else {
      WaitForMissSlot(t);
      const Miss fetched = Fetch(t, line);
      if (fetched.from_memory) ++times.l2_misses;
      ready = fetched.ready;
      from_memory = fetched.from_memory;
    }
    const Cycles l1 = ToSlot(t, p_.core.load_to_address_cycles);
    const Cycles later = ToSlot(t, ready - threads_[t].Time()) - l1 - access.use_cycles;
    Stall(t, later, from_memory ? &ThreadMemoryTimes::memory_stall : &ThreadMemoryTimes::l2_stall);
  }

  void Prefetch(uint32_t t, uint64_t line) {
    Core& core = CoreOf(t);
    if (core.l1.Touch(line, false) || InFlight(core, line, threads_[t].Time())) return;
    WaitForMissSlot(t);
    Fetch(t, line);
    Stall(t, p_.l1_fill_cycles, &ThreadMemoryTimes::l2_stall);
  }

  // Stores go to L2, which owns the line first; the line in other cores' L1 is stale.
  void StoreThrough(uint32_t t, const MemoryAccess& access, uint64_t line) {
    const Cycles now = threads_[t].Time();
    for (Core& core : cores_)
      if (&core != &CoreOf(t)) core.l1.Drop(line);
    const uint64_t bytes = std::min<uint32_t>(access.bytes, p_.line_bytes);
    run_.l2_bytes += bytes;
    l2_rate_.Take(now, bytes);
    if (l2_.Touch(line, true)) return;
    if (access.kind == AccessKind::kLineZero) return FillL2(line, true, now);
    ++run_.threads[t].store_l2_misses;
    WaitForMissSlot(t);
    ReadMemory(line, threads_[t].Time(), true, CoreOf(t));
  }

  const Miss* InFlight(Core& core, uint64_t line, Cycles now) {
    std::erase_if(core.misses, [&](const Miss& m) { return m.ready <= now; });
    const auto at = std::find_if(core.misses.begin(), core.misses.end(),
                                 [&](const Miss& m) { return m.line == line; });
    return at == core.misses.end() ? nullptr : &*at;
  }

  bool Misses(uint32_t t, const MemoryAccess& access, uint64_t line) {
    Core& core = CoreOf(t);
    switch (access.kind) {
      case AccessKind::kLoad:
      case AccessKind::kPrefetch:
        return !core.l1.Touch(line, false) && !InFlight(core, line, threads_[t].Time());
      case AccessKind::kStore:
        return !l2_.Touch(line, true);
      case AccessKind::kLineZero:
        return false;
    }
    return false;
  }

  // Whether the thread had to stand.
  bool WaitForMissSlot(uint32_t t) {
    Core& core = CoreOf(t);
    InFlight(core, ~uint64_t{0}, threads_[t].Time());
    if (core.misses.size() < p_.outstanding_misses) return false;
    const auto first =
        std::min_element(core.misses.begin(), core.misses.end(),
                         [](const Miss& a, const Miss& b) { return a.ready < b.ready; });
    Stall(t, first->ready - threads_[t].Time(), &ThreadMemoryTimes::miss_queue_stall);
    return true;
  }

  // Brings a line to the thread's L1, from L2 or from memory.
  Miss Fetch(uint32_t t, uint64_t line) {
    Core& core = CoreOf(t);
    const Cycles now = threads_[t].Time();
    run_.l2_bytes += p_.line_bytes;
    const Cycles transfer = p_.line_bytes * kMilli / p_.l2_milli_bytes_per_cycle;
    const Cycles queued = l2_rate_.Take(now, p_.line_bytes) - now - transfer;
    core.l1.Fill(line, false);
    if (l2_.Touch(line, false)) {
      core.misses.push_back({line, now + p_.l2_hit_cycles + std::max<Cycles>(queued, 0), false});
    } else {
      ReadMemory(line, now, false, core);
    }
    return core.misses.back();
  }

  // The latency is that of an idle memory; rates add what is queued before.
  void ReadMemory(uint64_t line, Cycles now, bool dirty, Core& core) {
    run_.bus_read_bytes += p_.line_bytes;
    const Cycles memory = memory_.Take(now, p_.line_bytes);
    const Cycles bus = bus_read_.Take(now, p_.line_bytes);
    const Cycles own =
        (p_.line_bytes * kMilli + p_.bus_milli_bytes_per_cycle - 1) / p_.bus_milli_bytes_per_cycle;
    const Cycles queued = std::max<Cycles>(0, std::max(memory, bus) - now - own);
    core.misses.push_back({line, now + p_.memory_cycles + queued, true});
    FillL2(line, dirty, now);
  }

  void FillL2(uint64_t line, bool dirty, Cycles now) {
    const Cache::Evicted evicted = l2_.Fill(line, dirty);
    if (!evicted.any) return;
    for (Core& core : cores_) core.l1.Drop(evicted.line);
    if (!evicted.dirty) return;
    run_.bus_write_bytes += p_.line_bytes;
    bus_write_.Take(now, p_.line_bytes);
    memory_.Take(now, p_.line_bytes);
  }

  const CacheMemoryParameters& p_;
  std::vector<Core> cores_;
  std::vector<uint32_t> busy_threads_;  // of each core: those that issue in rotation
  Cache l2_;
  Channel l2_rate_, bus_read_, bus_write_, memory_;
  std::vector<Thread> threads_;
  CacheMemoryRun run_;
};

}  // namespace

bool RunCacheMemory(const CacheMemoryParameters& p,
                    std::span<const std::vector<MemoryAccess>> traces, CacheMemoryRun& run,
                    std::string& error) {
  if (!CheckCacheMemory(p, error)) return false;
  if (traces.size() > size_t(p.Threads())) {
    error = Format("{} traces; the {} has {} hardware threads", traces.size(), p.name, p.Threads());
    return false;
  }
  for (size_t t = 0; t < traces.size(); ++t) {
    Cycles before = 0;
    for (size_t i = 0; i < traces[t].size(); before = traces[t][i++].cycle) {
      const MemoryAccess& a = traces[t][i];
      if (a.cycle < before || a.bytes == 0 || a.bytes > p.line_bytes ||
          a.address + a.bytes < a.address) {
        error = Format(
            "thread {}, access {}: {} bytes at {:#x} in cycle {}, after cycle {}; a trace goes "
            "forward in "
            "time, and an access has 1 to {} bytes inside memory",
            t, i, a.bytes, a.address, a.cycle, before, p.line_bytes);
        return false;
      }
    }
  }
  run = Machine(p, traces).Run();
  return true;
}

}  // namespace pelt
