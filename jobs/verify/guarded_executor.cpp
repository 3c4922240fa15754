#include "jobs/verify/guarded_executor.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <utility>

#include "core/float_environment.hpp"
#include "core/format.hpp"
#include "jobs/pass_loop.hpp"
#include "jobs/verify/guarded_pages.hpp"

namespace pelt {
namespace {

constexpr size_t kMostFindings = 64;
constexpr uint32_t kNotPut = ~0u;  // index of a scatter entry that the kernel did not use

// What lies in a port declared Out, and beside every block: one after the other, frame by frame.
// The second run of a stage has the last frame's own bytes there instead.
constexpr uint32_t kPatterns[] = {
    0xffffffffu,  // a quiet NaN; every flag set
    0x7fa5a5a5u,  // a signalling NaN
    0u,
    1u,           // the smallest denormal; a small count
    0x3f000000u,  // 0.5
    0x7e7e7e7eu,  // larger than anything
    0xfe7e7e7eu,  // and smaller
};
constexpr size_t kPatternCount = std::size(kPatterns);

void Fill(std::byte* from, size_t bytes, uint32_t pattern) {
  for (size_t at = 0; at + 4 <= bytes; at += 4) std::memcpy(from + at, &pattern, 4);
}
bool IsFilled(const std::byte* from, const std::byte* end, uint32_t pattern) {
  for (; from + 4 <= end; from += 4)
    if (std::memcmp(from, &pattern, 4) != 0) return false;
  return true;
}

// Of the port's stream, in the layer of a chunk.
uint32_t LayerRecords(const FrameMemory& memory, const PortDesc& port, uint32_t chunk) {
  const SceneShape& shape = *memory.shape;
  return shape.LayerItems(port.domain, shape.chunk_layer[chunk]) * (port.stride / port.block_bytes);
}

std::string_view NameOf(const Stage& stage, const PortDesc& port) {
  return stage.kernel.table()[port.stream].name;
}

// "item 3 of stream 'strands'" for an address of the scene's memory; empty outside it.
std::pair<std::string, std::string> NameAddress(const FrameMemory& memory, const std::byte* at) {
  for (uint32_t s = 0; s < memory.streams.size(); ++s) {
    const StreamDesc& desc = memory.table->streams[s];
    const std::byte* base = memory.streams[s].base;
    if (!base || at < base || at >= base + size_t(memory.streams[s].block_count) * desc.block_bytes)
      continue;
    for (uint32_t i = 0; i < memory.shape->ItemCount(desc.domain); ++i) {
      const std::byte* block = memory.Block(Stream(s), i);
      if (block && at >= block && at < block + desc.block_bytes)
        return {std::string(desc.name),
                Format("byte {} of item {} of stream '{}'", at - block, i, desc.name)};
    }
  }
  return {};
}

}  // namespace

// A port's block as the kernel has it.
struct GuardedExecutor::Place {
  GuardedPages::Block block;
  GuardedPages::Block index;        // of a scatter
  const std::byte* main = nullptr;  // the block in the scene's memory; null for a list of records
  uint32_t count = 1, record_bytes = 0;
};

struct GuardedExecutor::StageRun {
  std::vector<Place> places;
  std::vector<bool> true_bytes;  // of each port that is declared Out: as main memory has it
  uint32_t pattern = 0;
  bool at_end = false;
};

class GuardedExecutor::Arena {
 public:
  GuardedPages pages;
};

bool GuardedExecutor::IsAvailable() { return GuardedPages::IsAvailable(); }

GuardedExecutor::GuardedExecutor() : arena_(std::make_unique<Arena>()) {}
GuardedExecutor::~GuardedExecutor() = default;

void GuardedExecutor::RunPasses(const Frame& frame) {
  const SceneShape& shape = *frame.memory->shape;
  size_t largest = 0;
  for (const Stage& stage : frame.plan->stages)
    for (uint32_t i = 0; i < shape.ItemCount(stage.domain); ++i) {
      if (stage.domain >= Domain::kLayer &&
          !stage.kinds.Admits(
              shape.layer_kind[PlaceOf(shape, stage.domain, i).first[size_t(Domain::kLayer)]]))
        continue;
      for (const PortDesc& port : stage.kernel.ports)
        largest = std::max(largest, size_t(port.block_bytes) *
                                        BindPort(port, *frame.memory, stage.domain, i).count);
    }
  if (!arena_->pages.Reserve(largest, 2 * kMaxPorts)) {
    findings_.push_back({FindingKind::kExecutor, "", "",
                         "no address space for guarded blocks: is it limited (ulimit -v)?"});
    return RunUnguarded(frame);
  }
  const GuardedPages::Catcher catcher;
  ForEachPass(frame, [&](uint32_t pass_index, uint32_t count) {
    const Pass& pass = frame.plan->passes[pass_index];
    for (uint32_t item = 0; item < count; ++item)
      for (uint32_t s = pass.first_stage; s < pass.first_stage + pass.stage_count; ++s)
        if (IsWanted(frame.plan->stages[s], *frame.memory, item))
          RunStage(frame, frame.plan->stages[s], item);
  });
  ++frames_run_;
}

void GuardedExecutor::RunUnguarded(const Frame& frame) {
  ForEachPass(frame, [&](uint32_t pass, uint32_t count) {
    for (uint32_t item = 0; item < count; ++item) RunItem(frame, pass, item);
  });
}

void GuardedExecutor::RunStage(const Frame& frame, const Stage& stage, uint32_t item) {
  ++stages_run_;
  const size_t ports = stage.kernel.ports.size();
  const uint32_t pattern = kPatterns[frames_run_ % kPatternCount];
  StageRun first{{}, std::vector<bool>(ports, false), pattern, true};
  StageRun second{{}, std::vector<bool>(ports, true), pattern, false};
  const bool first_ran = RunOnce(frame, stage, item, first);
  const bool second_ran = RunOnce(frame, stage, item, second);
  if (first_ran && second_ran) Compare(frame, stage, item, first, second);
  if (first_ran) {
    Store(frame, stage, item, first);
  } else {
    // So that the stages behind it have something to work on: as any executor runs it. Caught
    // again, because a pointer that it kept is no better here.
    const FloatEnvironment float_environment;
    Binding bindings[kMaxPorts];
    for (size_t p = 0; p < ports; ++p)
      bindings[p] = BindPort(stage.kernel.ports[p], *frame.memory, stage.domain, item);
    GuardedPages::Call(stage.kernel.run, ParamsOf(stage, *frame.memory, item), bindings);
  }
  arena_->pages.CloseAll();
}

bool GuardedExecutor::RunOnce(const Frame& frame, const Stage& stage, uint32_t item,
                              StageRun& run) {
  Binding bindings[kMaxPorts];
  const auto& ports = stage.kernel.ports;
  for (size_t p = 0; p < ports.size(); ++p) {
    const PortDesc& port = ports[p];
    const Binding main = BindPort(port, *frame.memory, stage.domain, item);
    const size_t bytes = size_t(port.block_bytes) * main.count;
    Place place{arena_->pages.Open(bytes, run.at_end), {}, nullptr, main.count, port.block_bytes};
    Fill(place.block.region, place.block.region_bytes, run.pattern);
    std::byte* to = place.block.bytes;
    const auto* from = static_cast<const std::byte*>(main.block);
    if (port.access == Access::kGather) {
      // As a local store has them: fetched in list order. Entries that mean nothing stay poison.
      const uint32_t records = LayerRecords(*frame.memory, port, item);
      for (uint32_t i = 0; i < main.count; ++i)
        if (main.index[i] < records)
          std::memcpy(to + size_t(i) * port.block_bytes,
                      from + size_t(main.index[i]) * port.block_bytes, port.block_bytes);
    } else if (port.access == Access::kScatter) {
      place.index = arena_->pages.Open(4 * size_t(main.count), run.at_end);
      Fill(place.index.region, place.index.region_bytes, kNotPut);
    } else {
      place.main = from;
      if (IsRead(port.access) || run.true_bytes[p]) std::memcpy(to, from, bytes);
    }
    if (!IsWritten(port.access)) arena_->pages.MakeReadOnly(place.block);
    bindings[p] = {to, reinterpret_cast<uint32_t*>(place.index.bytes), main.count};
    run.places.push_back(place);
  }
  GuardedPages::Stop stop;
  {
    const FloatEnvironment float_environment;
    stop = GuardedPages::Call(stage.kernel.run, ParamsOf(stage, *frame.memory, item), bindings);
  }
  if (!stop.stopped) return CheckSlack(frame, stage, item, run);

  const auto kind = stop.write ? FindingKind::kUndeclaredWrite : FindingKind::kUndeclaredRead;
  const char* did = stop.write ? "writes" : "reads";
  for (size_t p = 0; p < ports.size(); ++p) {
    const Place& place = run.places[p];
    const ptrdiff_t offset = stop.address - place.block.bytes;
    const auto bytes = ptrdiff_t(place.count) * place.record_bytes;
    if (offset >= 0 && offset < bytes) {
      Find(kind, stage, std::string(NameOf(stage, ports[p])),
           Format("stage {}, item {}: writes through its read-only port '{}'", stage.kernel.name,
                  item, NameOf(stage, ports[p])));
      return false;
    }
    if (!arena_->pages.IsNear(place.block, stop.address)) continue;
    auto [stream, where] = place.main ? NameAddress(*frame.memory, place.main + offset)
                                      : std::pair<std::string, std::string>{};
    if (stream.empty()) {
      stream = NameOf(stage, ports[p]);
      where = "outside every stream of the scene";
    }
    Find(kind, stage, stream,
         Format("stage {}, item {}: {} {} bytes {} its block of port '{}': {}, for which it "
                "has no port",
                stage.kernel.name, item, did, offset < 0 ? -offset : offset - bytes,
                offset < 0 ? "in front of" : "behind", NameOf(stage, ports[p]), where));
    return false;
  }
  Find(kind, stage, "",
       Format("stage {}, item {}: {} through a pointer that is none of its ports: one kept "
              "from an earlier run, or a wild one",
              stage.kernel.name, item, did));
  return false;
}

bool GuardedExecutor::CheckSlack(const Frame&, const Stage& stage, uint32_t item,
                                 const StageRun& run) {
  for (size_t p = 0; p < run.places.size(); ++p) {
    const Place& place = run.places[p];
    const std::byte* end = place.block.bytes + size_t(place.count) * place.record_bytes;
    const bool front = IsFilled(place.block.region, place.block.bytes, run.pattern);
    const bool back = IsFilled(end, place.block.region + place.block.region_bytes, run.pattern);
    if (front && back) continue;
    const PortDesc& port = stage.kernel.ports[p];
    Find(FindingKind::kUndeclaredWrite, stage, std::string(NameOf(stage, port)),
         Format("stage {}, item {}: writes {} its block of port '{}'", stage.kernel.name, item,
                front ? "past the end of" : "in front of", NameOf(stage, port)));
    return false;
  }
  return true;
}

namespace {

// Whether a byte that two runs left differently was written by either.
bool IsWritten(const std::byte* at, size_t offset, uint32_t pattern) {
  std::byte poison[4];
  std::memcpy(poison, &pattern, 4);
  return *at != poison[offset % 4];
}

}  // namespace

void GuardedExecutor::Compare(const Frame& frame, const Stage& stage, uint32_t item,
                              StageRun& first, StageRun& second) {
  const auto& ports = stage.kernel.ports;
  for (size_t p = 0; p < ports.size(); ++p) {
    if (!pelt::IsWritten(ports[p].access)) continue;
    const Place &a = first.places[p], &b = second.places[p];
    const size_t bytes = size_t(a.count) * a.record_bytes;
    const bool same_index =
        !a.index.bytes || std::memcmp(a.index.bytes, b.index.bytes, 4 * size_t(a.count)) == 0;
    size_t at = 0;
    if (IsRead(ports[p].access)) {
      if (same_index && std::memcmp(a.block.bytes, b.block.bytes, bytes) == 0) continue;
      while (at < bytes && a.block.bytes[at] == b.block.bytes[at]) ++at;
    } else {
      // Left alone by both: each still has what it was given.
      const auto untouched = [&](size_t i) {
        const std::byte given = b.main ? b.main[i] : b.block.bytes[i];
        return !IsWritten(a.block.bytes + i, i, first.pattern) &&
               (b.main ? b.block.bytes[i] == given
                       : !IsWritten(b.block.bytes + i, i, second.pattern));
      };
      while (at < bytes && (a.block.bytes[at] == b.block.bytes[at] || untouched(at))) ++at;
      if (at == bytes && same_index) continue;
    }
    const std::string_view written = NameOf(stage, ports[p]);
    const std::string out = FindOutThatMatters(frame, stage, item, first);
    if (out.empty()) {
      Find(FindingKind::kHiddenState, stage, std::string(written),
           Format("stage {}, item {}: run twice on the same blocks it gives stream '{}' two "
                  "results (byte {}): it remembers something, or looks at where its blocks lie",
                  stage.kernel.name, item, written, at));
    } else {
      Find(FindingKind::kReadsOut, stage, out,
           Format("stage {}, item {}: reads stream '{}', which it declares Out: what it writes "
                  "to '{}' (byte {}) depends on what lay there",
                  stage.kernel.name, item, out, written, at));
    }
    return;
  }
}

std::string GuardedExecutor::FindOutThatMatters(const Frame& frame, const Stage& stage,
                                                uint32_t item, const StageRun& first) {
  const auto& ports = stage.kernel.ports;
  // Whether a run like the first gives every declared byte that both wrote as the first did.
  const auto same = [&](const StageRun& again, size_t but) {
    for (size_t p = 0; p < ports.size(); ++p) {
      if (!pelt::IsWritten(ports[p].access)) continue;
      const Place &a = first.places[p], &b = again.places[p];
      const size_t bytes = size_t(a.count) * a.record_bytes;
      for (size_t i = 0; i < bytes; ++i)
        if (a.block.bytes[i] != b.block.bytes[i] &&
            (p != but || IsWritten(a.block.bytes + i, i, first.pattern)))
          return false;
    }
    return true;
  };
  StageRun again{{}, std::vector<bool>(ports.size(), false), first.pattern, true};
  if (!RunOnce(frame, stage, item, again) || !same(again, ports.size())) return {};
  for (size_t p = 0; p < ports.size(); ++p) {
    if (!pelt::IsWritten(ports[p].access) || IsRead(ports[p].access)) continue;
    StageRun changed{{}, std::vector<bool>(ports.size(), false), first.pattern, true};
    changed.true_bytes[p] = true;
    if (!RunOnce(frame, stage, item, changed) || !same(changed, p))
      return std::string(NameOf(stage, ports[p]));
  }
  return {};
}

void GuardedExecutor::Store(const Frame& frame, const Stage& stage, uint32_t item,
                            const StageRun& run) {
  for (size_t p = 0; p < run.places.size(); ++p) {
    const PortDesc& port = stage.kernel.ports[p];
    if (!pelt::IsWritten(port.access)) continue;
    const Place& place = run.places[p];
    auto* to = static_cast<std::byte*>(BindPort(port, *frame.memory, stage.domain, item).block);
    if (port.access != Access::kScatter) {
      std::memcpy(to, place.block.bytes, size_t(place.count) * place.record_bytes);
      continue;
    }
    const uint32_t places = LayerRecords(*frame.memory, port, item);
    for (uint32_t i = 0; i < place.count; ++i) {
      uint32_t at;
      std::memcpy(&at, place.index.bytes + 4 * size_t(i), 4);
      if (at == kNotPut) continue;
      if (at >= places) {
        Find(FindingKind::kUndeclaredWrite, stage, std::string(NameOf(stage, port)),
             Format("stage {}, item {}: scatters to place {} of {} in its layer", stage.kernel.name,
                    item, at, places));
        continue;
      }
      std::memcpy(to + size_t(at) * place.record_bytes,
                  place.block.bytes + size_t(i) * place.record_bytes, place.record_bytes);
    }
  }
}

void GuardedExecutor::Find(FindingKind kind, const Stage& stage, std::string stream,
                           std::string text) {
  const auto same = [&](const Finding& f) {
    return f.kind == kind && f.stage == stage.kernel.name && f.stream == stream;
  };
  if (findings_.size() >= kMostFindings || std::any_of(findings_.begin(), findings_.end(), same))
    return;
  findings_.push_back({kind, std::string(stage.kernel.name), std::move(stream), std::move(text)});
}

}  // namespace pelt
