#include "traces/chrome_trace.hpp"

#include <algorithm>
#include <iterator>

#include "core/format.hpp"

namespace pelt {

void AppendJsonString(std::string& out, std::string_view text) {
  out += '"';
  while (!text.empty()) {
    const auto [code, count] = FirstCharacter(text);
    const char c = text.front();
    if (count == 0) {
      out += "\\ufffd";
    } else if (count == 1 && (c == '"' || c == '\\')) {
      out += {'\\', c};
    } else if (code < 0x10000 && !IsPrintable(text.substr(0, count))) {
      FormatTo(out, "\\u{:04x}", code);
    } else {
      out += text.substr(0, count);
    }
    text.remove_prefix(count ? count : 1);
  }
  out += '"';
}

namespace {

constexpr uint32_t kProcess = 1;

uint32_t ThreadOf(uint32_t track) { return track + 1; }

struct Event {
  uint64_t at_ns;
  char phase;      // as in the file: B E s f C
  uint32_t track;  // C: unused
  uint32_t index;  // B E: the slice; s f: the flow; C: the counter
  uint32_t sample = 0;
};

// Flows in the order of the slices they leave or reach on each track.
using FlowEnds = std::vector<std::vector<std::pair<uint32_t, uint32_t>>>;  // (slice, flow)
FlowEnds SortFlows(const Timeline& timeline, Timeline::Place Timeline::Flow::*end) {
  FlowEnds ends(timeline.tracks.size());
  for (uint32_t f = 0; f < timeline.flows.size(); ++f) {
    const Timeline::Place place = timeline.flows[f].*end;
    ends[place.track].push_back({place.slice, f});
  }
  for (auto& track : ends) std::sort(track.begin(), track.end());
  return ends;
}

// An arrow leaves in the last nanosecond of its slice: at the very end some viewers take the slice
// for closed.
uint64_t LeaveAt(const Timeline::Slice& slice) {
  return slice.end_ns > slice.begin_ns ? slice.end_ns - 1 : slice.end_ns;
}

void AddTrack(const Timeline& timeline, uint32_t track, const FlowEnds& leaving,
              const FlowEnds& reaching, std::vector<Event>& events) {
  const std::vector<Timeline::Slice>& slices = timeline.tracks[track].slices;
  std::vector<uint32_t> open;
  auto leave = leaving[track].begin();
  auto reach = reaching[track].begin();
  const auto close_to = [&](uint32_t depth) {
    for (; open.size() > depth; open.pop_back())
      events.push_back({slices[open.back()].end_ns, 'E', track, open.back()});
  };
  for (uint32_t s = 0; s < slices.size(); ++s) {
    close_to(slices[s].depth);
    events.push_back({slices[s].begin_ns, 'B', track, s});
    open.push_back(s);
    for (; reach != reaching[track].end() && reach->first == s; ++reach)
      events.push_back({slices[s].begin_ns, 'f', track, reach->second});
    for (; leave != leaving[track].end() && leave->first == s; ++leave)
      events.push_back({LeaveAt(slices[s]), 's', track, leave->second});
  }
  close_to(0);
}

std::vector<Event> ListEvents(const Timeline& timeline) {
  std::vector<Event> events;
  const FlowEnds leaving = SortFlows(timeline, &Timeline::Flow::from);
  const FlowEnds reaching = SortFlows(timeline, &Timeline::Flow::to);
  for (uint32_t t = 0; t < timeline.tracks.size(); ++t)
    AddTrack(timeline, t, leaving, reaching, events);
  for (uint32_t c = 0; c < timeline.counters.size(); ++c)
    for (uint32_t s = 0; s < timeline.counters[c].samples.size(); ++s)
      events.push_back({timeline.counters[c].samples[s].at_ns, 'C', 0, c, s});
  // Stable: events of one time stay in the order of nesting.
  std::stable_sort(events.begin(), events.end(),
                   [](const Event& a, const Event& b) { return a.at_ns < b.at_ns; });
  return events;
}

class Writer {
 public:
  explicit Writer(const Timeline& timeline) : timeline_(timeline) {}

  std::string Write() {
    out_ = "{\"displayTimeUnit\": \"ms\",\n\"otherData\": {";
    std::string labels;
    for (const auto& [key, value] : timeline_.metadata) {
      if (!labels.empty()) {
        out_ += ", ";
        labels += ", ";
      }
      AppendJsonString(out_, key);
      out_ += ": ";
      AppendJsonString(out_, value);
      labels += Format("{}: {}", key, value);
    }
    out_ += "},\n\"traceEvents\": [\n";
    AddName("process_name", 0, timeline_.process);
    AddLine("process_labels", 0, "labels", labels);
    for (uint32_t t = 0; t < timeline_.tracks.size(); ++t) {
      AddName("thread_name", t, timeline_.tracks[t].name);
      Add("{{\"ph\": \"M\", \"name\": \"thread_sort_index\", \"pid\": {}, \"tid\": {}, \"args\": "
          "{{\"sort_index\": {}}}}},\n",
          kProcess, ThreadOf(t), t);
    }
    for (const Event& event : ListEvents(timeline_)) AddEvent(event);
    // No comma after the last.
    out_.erase(out_.size() - 2);
    out_ += "\n]}\n";
    return std::move(out_);
  }

 private:
  template <class... Args>
  void Add(fmt::format_string<Args...> format, Args&&... args) {
    FormatTo(out_, format, std::forward<Args>(args)...);
  }

  void AddName(const char* what, uint32_t track, const std::string& name) {
    AddLine(what, track, "name", name);
  }
  void AddLine(const char* what, uint32_t track, const char* key, const std::string& value) {
    Add("{{\"ph\": \"M\", \"name\": \"{}\", \"pid\": {}, \"tid\": {}, \"args\": {{\"{}\": ", what,
        kProcess, ThreadOf(track), key);
    AppendJsonString(out_, value);
    out_ += "}},\n";
  }

  void AddEvent(const Event& event) {
    // Digits written, not a double: as exact as the clock.
    Add("{{\"ph\": \"{}\", \"ts\": {}.{:03}, \"pid\": {}, ", event.phase, event.at_ns / 1000,
        event.at_ns % 1000, kProcess);
    if (event.phase == 'C') {
      AddSample(timeline_.counters[event.index], event.sample);
    } else {
      Add("\"tid\": {}, \"name\": ", ThreadOf(event.track));
      if (event.phase == 'B' || event.phase == 'E') {
        AppendJsonString(out_,
                         timeline_.names[timeline_.tracks[event.track].slices[event.index].name]);
      } else {
        AppendJsonString(out_, timeline_.names[timeline_.flows[event.index].name]);
        Add(", \"cat\": \"flow\", \"id\": {}{}", event.index + 1,
            event.phase == 'f' ? ", \"bp\": \"e\"" : "");
      }
    }
    out_ += "},\n";
  }

  void AddSample(const Timeline::Counter& counter, uint32_t sample) {
    out_ += "\"name\": ";
    AppendJsonString(out_, counter.name);
    out_ += ", \"args\": {";
    for (size_t i = 0; i < counter.series.size(); ++i) {
      if (i) out_ += ", ";
      AppendJsonString(out_, counter.series[i]);
      Add(": {:.9g}", counter.samples[sample].values[i]);
    }
    out_ += '}';
  }

  const Timeline& timeline_;
  std::string out_;
};

}  // namespace

std::string ChromeTrace(const Timeline& timeline) { return Writer(timeline).Write(); }

}  // namespace pelt
