#include "bench/report/timeline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "bench/report/budget.hpp"

namespace pelt {
namespace {

// A processor may read its clock a little before the instructions around it are done, so an item on
// another core can seem to begin before its pass. What is further off is a fault, and stays to be
// seen.
constexpr uint64_t kClockSlackNs = 1000;

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
    pass_ends_.assign(plan_.passes.size(), {});
    PortTraffic of_frame{};
    size_t item = 0;
    for (uint32_t p = 0; p < plan_.passes.size(); ++p) {
      const size_t first = item;
      while (item < record.items.size() && record.items[item].pass == p) ++item;
      const PortTraffic traffic =
          AddPass(record, p, std::span(record.items).subspan(first, item - first));
      of_frame.in_bytes += traffic.in_bytes;
      of_frame.out_bytes += traffic.out_bytes;
    }
    AddFlows();
    AddSample(0, record.ticks.begin, record.live_strands, record.drawn_strands);
    AddTraffic(1, record.ticks.begin, of_frame);
    AddTraffic(2, record.ticks.end, {});
  }

  Timeline Take() { return std::move(timeline_); }

 private:
  // The item of a pass that started first, and the one that finished last.
  struct PassEnds {
    bool ran = false;
    Timeline::Place first, last;
  };

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

  // On the caller's track every pass, on the others those they had a part in.
  PortTraffic AddPass(const FrameRecord& record, uint32_t pass,
                      std::span<const FrameRecord::Item> items) {
    const uint64_t begin_ns = Ns(record.passes[pass].begin_ticks);
    const uint64_t end_ns = Ns(record.passes[pass].end_ticks);
    AddSlice(0, pass_names_[pass], 1, begin_ns, end_ns);
    PortTraffic traffic{};
    uint32_t worker = 0;
    for (const FrameRecord::Item& item : items) {
      if (item.worker != worker) {
        worker = item.worker;
        AddSlice(worker, pass_names_[pass], 0, begin_ns, end_ns);
      }
      const PortTraffic of_item = AddItem(record, item, begin_ns, end_ns);
      traffic.in_bytes += of_item.in_bytes;
      traffic.out_bytes += of_item.out_bytes;
    }
    AddTraffic(2, record.passes[pass].begin_ticks, traffic);
    return traffic;
  }

  PortTraffic AddItem(const FrameRecord& record, const FrameRecord::Item& item, uint64_t low_ns,
                      uint64_t high_ns) {
    const auto inside = [&](uint64_t ticks) {
      const uint64_t ns = Ns(ticks);
      if (ns < low_ns && ns + kClockSlackNs >= low_ns) return low_ns;
      if (ns > high_ns && ns <= high_ns + kClockSlackNs) return high_ns;
      return ns;
    };
    const Domain domain = plan_.passes[item.pass].domain;
    const uint32_t depth = item.worker == 0 ? 2 : 1;
    const Timeline::Place place = AddSlice(item.worker, Name(ItemName(scene_, domain, item.item)),
                                           depth, inside(item.begin_ticks), inside(item.end_ticks));
    PortTraffic traffic{};
    for (const FrameRecord::StageRun& run :
         std::span(record.runs).subspan(item.first_run, item.run_count)) {
      if (run.Ticks() != 0)
        AddSlice(item.worker, stage_names_[run.stage], depth + 1, inside(run.begin_ticks),
                 inside(run.end_ticks));
      const PortTraffic of_stage = StageTraffic(plan_.stages[run.stage], scene_.shape(), item.item);
      traffic.in_bytes += of_stage.in_bytes;
      traffic.out_bytes += of_stage.out_bytes;
    }
    PassEnds& ends = pass_ends_[item.pass];
    if (!ends.ran || At(place).begin_ns < At(ends.first).begin_ns) ends.first = place;
    if (!ends.ran || At(place).end_ns > At(ends.last).end_ns) ends.last = place;
    ends.ran = true;
    return traffic;
  }

  // One arrow a pair of passes, named by all streams between them.
  void AddFlows() {
    std::vector<bool> ran;
    for (const PassEnds& ends : pass_ends_) ran.push_back(ends.ran);
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
      timeline_.flows.push_back(
          {Name(streams), pass_ends_[producer].last, pass_ends_[consumer].first});
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
  std::vector<PassEnds> pass_ends_;
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

}  // namespace pelt
