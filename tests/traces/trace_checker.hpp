// What a viewer expects of a Chrome trace, as a list of what is wrong with one. Reads the file's
// text, and knows nothing of what wrote it.
#pragma once

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace pelt::testing {

struct TraceSlice {
  std::string name;
  double begin_us = 0.0, end_us = 0.0;
  int tid = 0;
  std::vector<std::string> parents;  // outermost first
};
struct TraceFlow {
  std::string name;
  double leave_us = -1.0, reach_us = -1.0;
  std::vector<std::string> from, to;  // the slices around its ends, outermost first
};
struct CheckedTrace {
  std::vector<std::string> faults;
  std::map<int, std::string> threads;  // by tid
  std::vector<TraceSlice> slices;      // in the order they end
  std::map<int, TraceFlow> flows;      // by id
  std::map<std::string, int> samples;  // of each counter
};

class TraceChecker {
 public:
  static CheckedTrace Check(const std::string& text) {
    TraceChecker checker;
    const auto trace = nlohmann::json::parse(text, nullptr, false);
    if (trace.is_discarded() || !trace.is_object() || !trace["traceEvents"].is_array()) {
      checker.out_.faults.push_back("no JSON object with traceEvents");
      return checker.out_;
    }
    for (const auto& event : trace["traceEvents"]) checker.CheckEvent(event);
    checker.CheckEnd();
    return checker.out_;
  }

 private:
  template <class... Args>
  void Fault(fmt::format_string<Args...> format, Args&&... args) {
    out_.faults.push_back(fmt::format(format, std::forward<Args>(args)...));
  }

  std::vector<std::string> OpenNames(int tid) {
    std::vector<std::string> names;
    for (const TraceSlice& slice : open_[tid]) names.push_back(slice.name);
    return names;
  }

  void CheckEvent(const nlohmann::json& event) {
    const std::string phase = event.value("ph", ""), name = event.value("name", "");
    if (name.empty() || event.value("pid", 0) <= 0) return Fault("an event without name or pid");
    const int tid = event.value("tid", 0);
    if (phase == "M") {
      if (name == "thread_name" && !out_.threads.emplace(tid, event["args"]["name"]).second)
        Fault("thread {} has two names", tid);
      return;
    }
    const double at_us = event.value("ts", -1.0);
    if (at_us < now_us_) Fault("'{}' at {} comes after {}", name, at_us, now_us_);
    now_us_ = at_us;
    if (phase == "C") return CheckSample(event, name);
    if (tid <= 0 || !out_.threads.contains(tid)) Fault("'{}' on a thread without a name", name);
    if (phase == "B") {
      open_[tid].push_back({name, at_us, 0.0, tid, OpenNames(tid)});
    } else if (phase == "E") {
      Close(tid, name, at_us);
    } else if (phase == "s" || phase == "f") {
      CheckFlow(event, phase == "s", tid, name, at_us);
    } else {
      Fault("phase '{}' is not known", phase);
    }
  }

  void Close(int tid, const std::string& name, double at_us) {
    if (open_[tid].empty()) return Fault("'{}' ends and has not begun", name);
    TraceSlice slice = open_[tid].back();
    if (slice.name != name)
      return Fault("'{}' ends inside '{}': one leaks out of the other", name, slice.name);
    open_[tid].pop_back();
    slice.end_us = at_us;
    out_.slices.push_back(std::move(slice));
  }

  void CheckFlow(const nlohmann::json& event, bool leaves, int tid, const std::string& name,
                 double at_us) {
    const int id = event.value("id", 0);
    if (event.value("cat", "") != "flow") Fault("flow {} has no category", id);
    if (!(leaves ? left_ : reached_).insert(id).second)
      return Fault("flow {} has two {}", id, leaves ? "starts" : "ends");
    if (open_[tid].empty()) Fault("flow {} {} no slice", id, leaves ? "leaves" : "reaches");
    TraceFlow& flow = out_.flows[id];
    if (!flow.name.empty() && flow.name != name) Fault("flow {} has two names", id);
    flow.name = name;
    (leaves ? flow.from : flow.to) = OpenNames(tid);
    (leaves ? flow.leave_us : flow.reach_us) = at_us;
    if (!leaves && event.value("bp", "") != "e") Fault("flow {} is not bound to its slice", id);
  }

  void CheckSample(const nlohmann::json& event, const std::string& name) {
    ++out_.samples[name];
    if (event["args"].empty()) Fault("counter '{}' has no value", name);
    for (const auto& value : event["args"])
      if (!value.is_number()) Fault("counter '{}' is not a number", name);
  }

  void CheckEnd() {
    for (const auto& [tid, slices] : open_)
      for (const TraceSlice& slice : slices) Fault("'{}' never ends", slice.name);
    for (const auto& [id, flow] : out_.flows) {
      if (!left_.contains(id)) Fault("flow {} has no start", id);
      if (!reached_.contains(id)) Fault("flow {} has no end", id);
      if (flow.leave_us > flow.reach_us) Fault("flow {} runs backwards", id);
    }
  }

  CheckedTrace out_;
  double now_us_ = 0.0;
  std::map<int, std::vector<TraceSlice>> open_;
  std::set<int> left_, reached_;
};

}  // namespace pelt::testing
