#include "bench/report/preempted_items.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

namespace pelt {
namespace {

// What is usual is not known of fewer.
constexpr size_t kLeastFrames = 5;
// Interrupts and caches make less; a scheduler gives others more.
constexpr double kLeastOverMs = 0.1;
// The counter's own steps, and what an item takes longer besides.
constexpr double kSlackShare = 0.25;

// Of an item on which the same number of stages ran: 0 if too few frames have one.
uint64_t UsualTicks(std::vector<uint64_t>& ticks) {
  if (ticks.size() < kLeastFrames) return 0;
  const auto middle = ticks.begin() + ptrdiff_t(ticks.size() / 2);
  std::nth_element(ticks.begin(), middle, ticks.end());
  return *middle;
}

double WaitedMs(const CoreWait& wait) {
  if (wait.waited_ms) return *wait.waited_ms;
  return wait.preemptions ? std::numeric_limits<double>::infinity() : 0.0;
}

}  // namespace

std::vector<PreemptedItem> FindPreempted(const FrameRecord& record,
                                         std::span<const FrameRecord> others, double ms_per_tick) {
  double left_ms = WaitedMs(record.wait) * (1.0 + kSlackShare);
  if (left_ms < kLeastOverMs) return {};
  using Key = std::pair<uint32_t, uint32_t>;
  std::map<Key, std::vector<uint64_t>> usual;
  std::map<Key, uint32_t> run_count;
  for (const FrameRecord::Item& item : record.items)
    run_count[{item.pass, item.item}] = item.run_count;
  for (const FrameRecord& other : others)
    for (const FrameRecord::Item& item : other.items) {
      const auto own = run_count.find({item.pass, item.item});
      if (own != run_count.end() && own->second == item.run_count)
        usual[own->first].push_back(item.Ticks());
    }
  std::vector<PreemptedItem> found;
  for (uint32_t i = 0; i < record.items.size(); ++i) {
    const FrameRecord::Item& item = record.items[i];
    const uint64_t ticks = UsualTicks(usual[{item.pass, item.item}]);
    if (ticks == 0 || item.Ticks() < 2 * ticks) continue;
    if (double(item.Ticks() - ticks) * ms_per_tick >= kLeastOverMs)
      found.push_back({i, item.Ticks() - ticks});
  }
  std::sort(found.begin(), found.end(), [](const PreemptedItem& a, const PreemptedItem& b) {
    return a.over_ticks > b.over_ticks;
  });
  std::erase_if(found, [&](const PreemptedItem& item) {
    const double over_ms = double(item.over_ticks) * ms_per_tick;
    if (over_ms > left_ms) return true;
    left_ms -= over_ms;
    return false;
  });
  return found;
}

}  // namespace pelt
