#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "bench/consoles/console_report.hpp"
#include "bench/report/timeline.hpp"

namespace pelt {
namespace {

class TrackWriter {
 public:
  TrackWriter(const FurScene& scene, const ConsoleMachine& machine, Timeline& timeline)
      : scene_(scene), machine_(machine), timeline_(timeline) {
    for (const std::string& name : timeline.names) name_of_.emplace(name, name_of_.size());
  }

  void AddFrame(const ModelledFrame& frame) {
    const size_t track = AddTrack("frame");
    Add(track, "frame", 0, 0, frame.cycles);
    Timeline::Counter& moved = timeline_.counters.emplace_back(
        Timeline::Counter{machine_.name + " transfers of a pass, MB", {"in", "out"}, {}});
    for (uint32_t p = 0; p < frame.passes.size(); ++p) {
      const ModelledPass& pass = frame.passes[p];
      if (pass.begin == pass.end) continue;
      moved.samples.push_back(
          {Ns(pass.begin), {double(pass.get_bytes) * 1e-6, double(pass.put_bytes) * 1e-6}});
    }
    std::ranges::sort(moved.samples, {}, &Timeline::Sample::at_ns);
    for (uint32_t u = 0; u < frame.units.size(); ++u)
      AddUnit(UnitName(machine_, u), frame.units[u]);
  }

 private:
  uint64_t Ns(Cycles cycle) const {
    return uint64_t(double(cycle) * 1e9 / double(machine_.clock_hz) + 0.5);
  }

  size_t AddTrack(const std::string& name) {
    timeline_.tracks.push_back({fmt::format("{} {}", machine_.name, name), {}});
    return timeline_.tracks.size() - 1;
  }

  void Add(size_t track, const std::string& text, uint32_t depth, Cycles begin, Cycles end) {
    const auto [at, is_new] = name_of_.try_emplace(text, name_of_.size());
    if (is_new) timeline_.names.push_back(text);
    timeline_.tracks[track].slices.push_back({uint32_t(at->second), depth, Ns(begin), Ns(end)});
  }

  std::string Item(uint32_t pass, uint32_t item) const {
    if (item == kNoBlock) return "code and parameters";
    return ItemName(scene_, scene_.plan().passes[pass].domain, item);
  }

  void AddUnit(const std::string& name, const UnitTimeline& unit) {
    const size_t work = AddTrack(name);
    for (size_t first = 0, s = 0; s < unit.slices.size(); ++s) {
      const UnitSlice& slice = unit.slices[s];
      // What it does for a pass without another between.
      if (s == first) {
        size_t last = s;
        while (last + 1 < unit.slices.size() && unit.slices[last + 1].pass == slice.pass) ++last;
        Add(work, PassName(scene_.plan(), slice.pass), 0, slice.begin, unit.slices[last].end);
        first = last + 1;
      }
      Add(work,
          slice.work == UnitWork::kCompute ? Item(slice.pass, slice.item)
                                           : std::string(UnitWorkName(slice.work)),
          1, slice.begin, slice.end);
    }
    for (const bool put : {false, true}) AddTransfers(name, unit, put);
  }

  // Two of one unit may be on their way together; a track shows them one after the other.
  void AddTransfers(const std::string& name, const UnitTimeline& unit, bool put) {
    const size_t track = AddTrack(fmt::format("{} {}", name, put ? "out" : "in"));
    Cycles shown = 0;
    std::vector<TransferSlice> transfers = unit.transfers;
    std::stable_sort(transfers.begin(), transfers.end(),
                     [](const auto& a, const auto& b) { return a.begin < b.begin; });
    for (const TransferSlice& transfer : transfers) {
      if (transfer.put != put || transfer.end <= shown) continue;
      Add(track, Item(transfer.pass, transfer.item), 0, std::max(shown, transfer.begin),
          transfer.end);
      shown = transfer.end;
    }
  }

  const FurScene& scene_;
  const ConsoleMachine& machine_;
  Timeline& timeline_;
  std::map<std::string, size_t> name_of_;
};

}  // namespace

std::string UnitName(const ConsoleMachine& machine, uint32_t unit) {
  if (machine.local_store_bytes) return fmt::format("SPU {}", unit);
  return fmt::format("core {} thread {}", unit / machine.threads_per_core,
                     unit % machine.threads_per_core);
}

void AddConsoleTracks(const FurScene& scene, const ConsoleMachine& machine,
                      const ModelledFrame& frame, Timeline& timeline) {
  TrackWriter(scene, machine, timeline).AddFrame(frame);
}

}  // namespace pelt
