#include "bench/report/timeline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "bench/report/budget.hpp"

namespace pelt {

namespace {

bool IsAnyPort(const Stage& stage, Stream stream, bool (*is)(Access)) {
  return std::any_of(stage.kernel.ports.begin(), stage.kernel.ports.end(),
                     [&](const PortDesc& p) { return p.stream == stream && is(p.access); });
}
std::span<const Stage> StagesOf(const Plan& plan, uint32_t pass) {
  return {plan.stages.data() + plan.passes[pass].first_stage, plan.passes[pass].stage_count};
}

// Whether a stage of the pass reads what no stage of the pass before it has written.
bool Reads(const Plan& plan, uint32_t pass, Stream stream) {
  for (const Stage& stage : StagesOf(plan, pass)) {
    if (IsAnyPort(stage, stream, IsRead)) return true;
    if (IsAnyPort(stage, stream, IsWritten)) return false;
  }
  return false;
}
bool Writes(const Plan& plan, uint32_t pass, Stream stream) {
  const auto stages = StagesOf(plan, pass);
  return std::any_of(stages.begin(), stages.end(),
                     [&](const Stage& s) { return IsAnyPort(s, stream, IsWritten); });
}

class TimelineBuilder {
 public:
  TimelineBuilder(const FurScene& scene, uint32_t workers, double ns_per_tick, uint64_t origin)
      : scene_(scene), plan_(scene.plan()), ns_per_tick_(ns_per_tick), origin_ticks_(origin) {
    for (uint32_t w = 0; w < workers; ++w) timeline_.tracks.push_back({WorkerName(w), {}});
    timeline_.counters = {{"strands", {"live", "drawn"}, {}},
                          {"MB moved by a frame", {"in", "out"}, {}},
                          {"MB moved by a pass", {"in", "out"}, {}}};
    prepare_name_ = Name("poses and parameters");
    for (uint32_t p = 0; p < plan_.passes.size(); ++p)
      pass_names_.push_back(Name(PassName(plan_, p)));
    for (const Stage& stage : plan_.stages)
      stage_names_.push_back(Name(std::string(stage.kernel.name)));
  }

  void AddFrame(const FrameRecord& record) {
    AddSlice(0, Name(fmt::format("frame {}", record.frame)), 0, Ns(record.ticks.begin),
             Ns(record.ticks.end));
    AddSlice(0, prepare_name_, 1, Ns(record.ticks.begin), Ns(record.ticks.prepared));
    pass_items_.assign(plan_.passes.size(), {});
    std::vector<PortTraffic> of_passes(plan_.passes.size());
    AddItems(record, of_passes);
    PortTraffic of_frame{};
    for (uint32_t p = 0; p < plan_.passes.size(); ++p) {
      AddTraffic(2, record.passes[p].begin_ticks, of_passes[p]);
      of_frame.in_bytes += of_passes[p].in_bytes;
      of_frame.out_bytes += of_passes[p].out_bytes;
    }
    std::ranges::stable_sort(timeline_.counters[2].samples, {}, &Timeline::Sample::at_ns);
    AddFlows();
    AddSample(0, record.ticks.begin, record.live_strands, record.drawn_strands);
    AddTraffic(1, record.ticks.begin, of_frame);
    AddTraffic(2, record.ticks.end, {});
  }

  Timeline Take() { return std::move(timeline_); }

 private:
  uint64_t Ns(uint64_t ticks) const {
    return ticks <= origin_ticks_ ? 0
                                  : uint64_t(double(ticks - origin_ticks_) * ns_per_tick_ + 0.5);
  }

  uint32_t Name(const std::string& name) {
    const auto [at, fresh] = name_of_.try_emplace(name, uint32_t(timeline_.names.size()));
    if (fresh) timeline_.names.push_back(name);
    return at->second;
  }

  Timeline::Place AddSlice(uint32_t track, uint32_t name, uint32_t depth, uint64_t begin_ns,
                           uint64_t end_ns) {
    std::vector<Timeline::Slice>& slices = timeline_.tracks[track].slices;
    slices.push_back({name, depth, begin_ns, end_ns});
    return {track, uint32_t(slices.size() - 1)};
  }
  const Timeline::Slice& At(Timeline::Place place) const {
    return timeline_.tracks[place.track].slices[place.slice];
  }

  // Of each worker what it ran one after the other of one pass, and the items in it.
  void AddItems(const FrameRecord& record, std::vector<PortTraffic>& of_passes) {
    std::vector<const FrameRecord::Item*> items;
    for (const FrameRecord::Item& item : record.items) items.push_back(&item);
    std::ranges::stable_sort(items, {}, [](const FrameRecord::Item* item) {
      return std::pair(item->worker, item->begin_ticks);
    });
    for (size_t first = 0, end = 0; first < items.size(); first = end) {
      const FrameRecord::Item& head = *items[first];
      while (end < items.size() && items[end]->worker == head.worker &&
             items[end]->pass == head.pass)
        ++end;
      AddSlice(head.worker, pass_names_[head.pass], head.worker == 0 ? 1 : 0, Ns(head.begin_ticks),
               Ns(items[end - 1]->end_ticks));
      for (size_t i = first; i < end; ++i) AddItem(record, *items[i], of_passes[head.pass]);
    }
  }

  void AddItem(const FrameRecord& record, const FrameRecord::Item& item, PortTraffic& of_pass) {
    const Domain domain = plan_.passes[item.pass].domain;
    const uint32_t depth = item.worker == 0 ? 2 : 1;
    pass_items_[item.pass].push_back(AddSlice(item.worker,
                                              Name(ItemName(scene_, domain, item.item)), depth,
                                              Ns(item.begin_ticks), Ns(item.end_ticks)));
    for (const FrameRecord::StageRun& run :
         std::span(record.runs).subspan(item.first_run, item.run_count)) {
      if (run.Ticks() != 0)
        AddSlice(item.worker, stage_names_[run.stage], depth + 1, Ns(run.begin_ticks),
                 Ns(run.end_ticks));
      const PortTraffic of_stage = StageTraffic(plan_.stages[run.stage], scene_.shape(), item.item);
      of_pass.in_bytes += of_stage.in_bytes;
      of_pass.out_bytes += of_stage.out_bytes;
    }
  }

  // One arrow a pair of passes, named by all streams between them: to the consumer's first item, from
  // the producer's that was done last before it began.
  void AddFlows() {
    std::vector<bool> ran;
    for (const auto& items : pass_items_) ran.push_back(!items.empty());
    const std::vector<PassDependency> dependencies = FindDependencies(plan_, ran);
    for (size_t i = 0; i < dependencies.size();) {
      const auto [producer, consumer, first] = dependencies[i];
      std::string streams;
      for (; i < dependencies.size() && dependencies[i].producer == producer &&
             dependencies[i].consumer == consumer;
           ++i) {
        if (!streams.empty()) streams += ", ";
        streams += DescribeStream(dependencies[i].stream).name;
      }
      const auto begin = [&](Timeline::Place place) { return At(place).begin_ns; };
      const Timeline::Place to = *std::ranges::min_element(pass_items_[consumer], {}, begin);
      const Timeline::Place* from = nullptr;
      for (const Timeline::Place& place : pass_items_[producer])
        if (At(place).end_ns <= At(to).begin_ns && (!from || At(place).end_ns > At(*from).end_ns))
          from = &place;
      if (from) timeline_.flows.push_back({Name(streams), *from, to});
    }
  }

  void AddSample(size_t counter, uint64_t ticks, double a, double b) {
    timeline_.counters[counter].samples.push_back({Ns(ticks), {a, b}});
  }
  void AddTraffic(size_t counter, uint64_t ticks, const PortTraffic& traffic) {
    AddSample(counter, ticks, double(traffic.in_bytes) * 1e-6, double(traffic.out_bytes) * 1e-6);
  }

  const FurScene& scene_;
  const Plan& plan_;
  double ns_per_tick_;
  uint64_t origin_ticks_;
  Timeline timeline_;
  std::map<std::string, uint32_t> name_of_;
  uint32_t prepare_name_ = 0;
  std::vector<uint32_t> pass_names_, stage_names_;
  std::vector<std::vector<Timeline::Place>> pass_items_;  // of the present frame
};

}  // namespace

FrameRecord RecordFrame(const FurScene& scene, const FrameProfile& profile, uint32_t frame,
                        const FrameTicks& ticks) {
  const Plan& plan = scene.plan();
  FrameRecord record;
  record.frame = frame;
  record.ticks = ticks;
  record.live_strands = scene.LiveStrands();
  record.drawn_strands = scene.DrawnStrands();
  for (uint32_t p = 0; p < plan.passes.size(); ++p) {
    const Pass& pass = plan.passes[p];
    const uint32_t items = scene.shape().ItemCount(pass.domain);
    record.passes.push_back(profile.Pass(p, items));
    for (uint32_t i = 0; i < items; ++i) {
      FrameRecord::Item item{profile.items[profile.item_first[p] + i], p, i,
                             uint32_t(record.runs.size()), 0};
      for (uint32_t s = 0; s < pass.stage_count; ++s) {
        const Slice run = profile.Stage(plan, p, i, s);
        if (run.Ran()) record.runs.push_back({run, pass.first_stage + s});
      }
      item.run_count = uint32_t(record.runs.size()) - item.first_run;
      if (item.run_count) record.items.push_back(item);
    }
  }
  std::sort(record.items.begin(), record.items.end(),
            [](const FrameRecord::Item& a, const FrameRecord::Item& b) {
              return std::tie(a.pass, a.worker, a.begin_ticks) <
                     std::tie(b.pass, b.worker, b.begin_ticks);
            });
  return record;
}

std::vector<PassDependency> FindDependencies(const Plan& plan, const std::vector<bool>& ran) {
  std::vector<PassDependency> found;
  for (uint32_t consumer = 0; consumer < plan.passes.size(); ++consumer) {
    if (!ran[consumer]) continue;
    for (uint32_t s = 0; s < kStreamCount; ++s) {
      if (!Reads(plan, consumer, Stream(s))) continue;
      for (uint32_t producer = consumer; producer-- > 0;) {
        if (!ran[producer] || !Writes(plan, producer, Stream(s))) continue;
        found.push_back({producer, consumer, Stream(s)});
        break;
      }
    }
  }
  std::sort(found.begin(), found.end(), [](const PassDependency& a, const PassDependency& b) {
    return std::tie(a.consumer, a.producer, a.stream) < std::tie(b.consumer, b.producer, b.stream);
  });
  return found;
}

std::string PassName(const Plan& plan, uint32_t pass) {
  const auto stages = StagesOf(plan, pass);
  std::string name = fmt::format("pass {}: {}", pass, stages.front().kernel.name);
  if (stages.size() > 1) name += fmt::format(" and {} more", stages.size() - 1);
  return name;
}

std::string ItemName(const FurScene& scene, Domain domain, uint32_t item) {
  const SceneShape& shape = scene.shape();
  const auto layer = [&](uint32_t l) { return fmt::format("layer {} {}", l, scene.LayerName(l)); };
  switch (domain) {
    case Domain::kScene:
      return "scene";
    case Domain::kCharacter:
      return fmt::format("character {}", item);
    case Domain::kLayer:
      return layer(item);
    case Domain::kPatch:
    case Domain::kChunk:
      break;
  }
  const uint32_t of = shape.LayerOf(domain, item);
  return fmt::format("{} {} of {}", DomainName(domain), item - shape.LayerFirst(domain, of),
                     layer(of));
}

std::string WorkerName(uint32_t worker) {
  return fmt::format("worker {}{}", worker, worker == 0 ? " (caller)" : "");
}

Timeline BuildTimeline(const FurScene& scene, std::span<const FrameRecord> frames, uint32_t workers,
                       double ns_per_tick) {
  TimelineBuilder builder(scene, workers, ns_per_tick,
                          frames.empty() ? 0 : frames.front().ticks.begin);
  for (const FrameRecord& frame : frames) builder.AddFrame(frame);
  return builder.Take();
}

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
