#include "bench/consoles/console_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "bench/consoles/console_timeline.hpp"
#include "bench/consoles/kernel_rows_report.hpp"
#include "bench/report/timeline.hpp"
#include "platform_sim/frame/what_if.hpp"

namespace pelt {
namespace {

constexpr double kLinesMs[] = {5.0, 8.0};
constexpr size_t kNamedStreams = 8;  // of main memory, the largest first

double Mb(double bytes) { return bytes * 1e-6; }

std::string StageTable(const ConsoleBudget& b, const Plan& plan) {
  const FrameSummary& s = b.summary;
  double all_ms = 0.0;
  for (const FrameSummary::Stage& stage : s.stages) all_ms += stage.core_ms;
  std::string out = fmt::format("{:<24} {:>9} {:>9} {:>8} {:>9} {:>11}\n", "stage, of a frame",
                                "items", "core ms", "share", "wall ms", "code bytes");
  for (size_t i = 0; i < s.stages.size(); ++i)
    if (s.stages[i].items > 0.0)
      out += fmt::format("{:<24} {:>9.1f} {:>9.3f} {:>7.1f}% {:>9.3f} {:>11}\n",
                         plan.stages[i].kernel.name, s.stages[i].items, s.stages[i].core_ms,
                         all_ms > 0.0 ? 100.0 * s.stages[i].core_ms / all_ms : 0.0,
                         s.stages[i].wall_ms, b.costs.stages[i].code_bytes);
  return out;
}

// Where the unit that all others waited for spent each pass.
std::string PassTable(const ConsoleBudget& b, const Plan& plan) {
  std::string out =
      fmt::format("{:<40} {:>8} {:>8}", "pass, its critical unit in ms", "items", "ms");
  for (uint32_t w = 0; w < kUnitWorkCount; ++w)
    out += fmt::format(" {:>9}", UnitWorkName(UnitWork(w)));
  out += "  bound by\n";
  const auto row = [&](std::string_view name, double items, double ms, const WorkMs& work) {
    out += fmt::format("{:<40} {:>8.1f} {:>8.3f}", name, items, ms);
    for (const double part : work) out += fmt::format(" {:>9.3f}", part);
  };
  for (uint32_t p = 0; p < b.summary.passes.size(); ++p) {
    const FrameSummary::Pass& pass = b.summary.passes[p];
    row(PassName(plan, p), pass.items, pass.ms, pass.critical_ms);
    out += fmt::format("  {}, {:.3f} ms less without\n", PassLimitName(pass.binds),
                       pass.GainMs(pass.binds));
  }
  double all_ms = 0.0, all_items = 0.0;
  for (const FrameSummary::Pass& pass : b.summary.passes) {
    all_ms += pass.ms;
    all_items += pass.items;
  }
  row("all: the critical path", all_items, all_ms, b.summary.critical_ms);
  return out + '\n';
}

std::string MemoryText(const ConsoleBudget& b) {
  const FrameSummary& s = b.summary;
  const auto sum = [](const std::vector<double>& v) {
    return std::accumulate(v.begin(), v.end(), 0.0);
  };
  std::string out = fmt::format(
      "main memory: {:.2f} MB in, {:.2f} MB out, {:.2f} MB code, {:.2f} MB of lines nobody asked "
      "for; {:.0f} % of what the memory could move\n",
      Mb(sum(s.stream_get_bytes)), Mb(sum(s.stream_put_bytes)), Mb(s.code_bytes),
      Mb(s.wasted_bytes), 100.0 * s.bus_use);
  std::vector<uint32_t> order(kStreamCount);
  std::iota(order.begin(), order.end(), 0u);
  const auto bytes = [&](uint32_t i) { return s.stream_get_bytes[i] + s.stream_put_bytes[i]; };
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t a, uint32_t c) { return bytes(a) > bytes(c); });
  for (size_t i = 0; i < kNamedStreams && bytes(order[i]) > 0.0; ++i)
    out += fmt::format("  {:<20} {:>8.3f} MB in {:>8.3f} MB out\n",
                       DescribeStream(Stream(order[i])).name, Mb(s.stream_get_bytes[order[i]]),
                       Mb(s.stream_put_bytes[order[i]]));
  return out;
}

// What lies in the buffers of the pass that has least room left.
std::string FullestBuffers(const ConsoleBudget& b, const Plan& plan) {
  const auto fullest = std::min_element(
      b.stores.begin(), b.stores.end(),
      [](const PassStore& x, const PassStore& y) { return x.free_bytes < y.free_bytes; });
  const auto pass = uint32_t(fullest - b.stores.begin());
  std::string out = fmt::format("  buffers of pass {}:", pass);
  for (const PassStream& stream : plan.passes[pass].streams)
    out += fmt::format(" {} {}", DescribeStream(stream.stream).name, stream.bytes);
  return out + '\n';
}

std::string StoreTable(const ConsoleBudget& b, const Plan& plan) {
  if (b.stores.empty()) return {};
  std::string out =
      fmt::format("{:<40} {:>8} {:>8} {:>10} {:>14} {:>8}\n", "local store of a pass, bytes",
                  "code", "stack", "parameters", "buffers", "free");
  for (uint32_t p = 0; p < b.stores.size(); ++p) {
    const PassStore& store = b.stores[p];
    out += fmt::format("{:<40} {:>8} {:>8} {:>10} {:>3} x {:>8} {:>8}\n", PassName(plan, p),
                       store.code_bytes, store.stack_bytes, store.parameter_bytes,
                       store.buffer_sets, store.buffer_bytes, store.free_bytes);
  }
  return out + FullestBuffers(b, plan);
}

std::string DigestText(const ConsoleBudget& b) {
  if (b.differs_at) return fmt::format("DIGEST: frame {} is not the host's\n", *b.differs_at);
  return fmt::format(
      "executed while it was timed: digests equal the host's in {} of {} frames "
      "compared, the last {:016x}\n",
      b.digests_compared, b.digests_compared, b.digest);
}

void AddWork(JsonText& json, std::string_view key, const WorkMs& work) {
  json.BeginObject(key);
  for (uint32_t w = 0; w < kUnitWorkCount; ++w) json.Add(UnitWorkName(UnitWork(w)), work[w]);
  json.EndObject();
}

void AddSpread(JsonText& json, std::string_view key, const Spread& ms) {
  json.BeginObject(key);
  json.Add("median", ms.median);
  json.Add("p95", ms.p95);
  json.Add("worst", ms.worst);
  json.EndObject();
}

void AddStages(JsonText& json, const ConsoleBudget& b, const Plan& plan) {
  double all_ms = 0.0;
  for (const FrameSummary::Stage& stage : b.summary.stages) all_ms += stage.core_ms;
  json.BeginArray("stages");
  for (size_t i = 0; i < b.summary.stages.size(); ++i) {
    const FrameSummary::Stage& stage = b.summary.stages[i];
    if (stage.items == 0.0) continue;
    json.BeginObject();
    json.Add("name", plan.stages[i].kernel.name);
    json.Add("items", stage.items);
    json.Add("core_ms", stage.core_ms);
    json.Add("wall_ms", stage.wall_ms);
    json.Add("share", all_ms > 0.0 ? stage.core_ms / all_ms : 0.0);
    json.Add("code_bytes", b.costs.stages[i].code_bytes);
    json.EndObject();
  }
  json.EndArray();
}

void AddPasses(JsonText& json, const ConsoleBudget& b, const Plan& plan) {
  json.BeginArray("passes");
  for (uint32_t p = 0; p < b.summary.passes.size(); ++p) {
    const FrameSummary::Pass& pass = b.summary.passes[p];
    json.BeginObject();
    json.Add("name", PassName(plan, p));
    json.Add("items", pass.items);
    json.Add("ms", pass.ms);
    AddWork(json, "critical_ms", pass.critical_ms);
    json.Add("bound_by", PassLimitName(pass.binds));
    json.BeginObject("gain_ms");
    for (uint32_t l = 0; l < kPassLimitCount; ++l)
      json.Add(PassLimitName(PassLimit(l)), pass.GainMs(PassLimit(l)));
    json.EndObject();
    if (!b.stores.empty()) {
      json.BeginObject("local_store_bytes");
      json.Add("code", b.stores[p].code_bytes);
      json.Add("stack", b.stores[p].stack_bytes);
      json.Add("parameters", b.stores[p].parameter_bytes);
      json.Add("buffers", b.stores[p].buffer_bytes);
      json.Add("buffer_sets", b.stores[p].buffer_sets);
      json.Add("free", b.stores[p].free_bytes);
      json.EndObject();
      json.BeginObject("buffer_bytes");
      for (const PassStream& stream : plan.passes[p].streams)
        json.Add(DescribeStream(stream.stream).name, stream.bytes);
      json.EndObject();
    }
    json.EndObject();
  }
  json.EndArray();
}

void AddMemory(JsonText& json, const FrameSummary& s) {
  json.BeginObject("main_memory_bytes");
  for (uint32_t i = 0; i < kStreamCount; ++i) {
    if (s.stream_get_bytes[i] + s.stream_put_bytes[i] == 0.0) continue;
    json.BeginObject(DescribeStream(Stream(i)).name);
    json.Add("in", s.stream_get_bytes[i]);
    json.Add("out", s.stream_put_bytes[i]);
    json.EndObject();
  }
  json.EndObject();
  json.Add("code_bytes", s.code_bytes);
  json.Add("wasted_bytes", s.wasted_bytes);
  json.Add("bus_use", s.bus_use);
}

}  // namespace

std::string DescribeFit(double ms) {
  if (ms <= kLinesMs[0]) return fmt::format("fits {} ms", kLinesMs[0]);
  if (ms <= kLinesMs[1]) return fmt::format("fits {} ms, not {} ms", kLinesMs[1], kLinesMs[0]);
  return fmt::format("does not fit {} ms", kLinesMs[1]);
}

std::string DescribeVerdictTime(const ConsoleBudget& b) {
  const ConsoleMachine& m = b.machine;
  const FrameSummary& s = b.summary;
  return fmt::format(
      "with an availability of {} ({}), which the verdict takes: median {:.2f}, p95 {:.2f}, worst "
      "{:.2f} ms",
      m.availability, m.availability_from, m.Available(s.median_ms), b.VerdictMs(),
      m.Available(s.worst_ms));
}

std::string DescribeRange(const ConsoleBudget& b) {
  return fmt::format("p95 {:.2f} ms with the best schedules, {:.2f} ms as written",
                     b.machine.Available(b.scheduled_ms.p95),
                     b.machine.Available(b.as_written_ms.p95));
}

std::string DescribeConsole(const ConsoleBudget& b, const FurScene& scene) {
  const Plan& plan = scene.plan();
  const FrameSummary& s = b.summary;
  std::string out = fmt::format(
      "{}, modelled: {} {} at {:.3f} GHz; frame median {:.2f}, p95 {:.2f}, worst {:.2f} ms (frame "
      "{} of {}, behind {} to warm up) as the models have it, like all figures below\n{}\n",
      b.machine.name, b.machine.units, b.machine.local_store_bytes ? "SPUs" : "hardware threads",
      double(b.machine.clock_hz) * 1e-9, s.median_ms, s.p95_ms, s.worst_ms, s.worst_frame, s.frames,
      b.warm_up, DescribeVerdictTime(b));
  if (b.machine.what_if != WhatIf::kNothing)
    out += fmt::format("what if: {}{}\n", DescribeWhatIf(b.machine.what_if),
                       b.why_no_change.empty() ? "" : ": CHANGES NOTHING: " + b.why_no_change);
  out += fmt::format("its range, availability in it: {}; all else here is {}\n\n", DescribeRange(b),
                     DescribePlace(b.machine.code_order));
  out += StageTable(b, plan) + '\n' + PassTable(b, plan) + '\n' + MemoryText(b);
  if (!b.stores.empty()) out += '\n' + StoreTable(b, plan);
  out += '\n' + DigestText(b);
  for (const std::string& fault : b.faults) out += "FAULT " + fault + '\n';
  return out;
}

void AddConsole(JsonText& json, const ConsoleBudget& b, const FurScene& scene) {
  const FrameSummary& s = b.summary;
  json.Add("machine", b.machine.name);
  json.Add("units", b.machine.units);
  json.Add("clock_hz", b.machine.clock_hz);
  json.Add("availability", b.machine.availability);
  json.Add("availability_from", b.machine.availability_from);
  AddSpread(json, "frame_ms", {s.median_ms, s.p95_ms, s.worst_ms});
  AddSpread(json, "frame_ms_with_availability",
            {b.machine.Available(s.median_ms), b.VerdictMs(), b.machine.Available(s.worst_ms)});
  json.Add("verdict_takes", "frame_ms_with_availability.p95");
  json.BeginObject("range");
  AddSpread(json, "scheduled_ms", b.scheduled_ms);
  AddSpread(json, "as_written_ms", b.as_written_ms);
  json.Add("code_order", b.machine.code_order);
  json.Add("code_order_least", MeasuredCodePlace().least);
  json.Add("code_order_most", MeasuredCodePlace().most);
  json.EndObject();
  json.Add("warm_up_frames", b.warm_up);
  json.Add("what_if", WhatIfName(b.machine.what_if));
  if (!b.why_no_change.empty()) json.Add("what_if_changes_nothing", b.why_no_change);
  json.Add("worst_frame", s.worst_frame);
  AddStages(json, b, scene.plan());
  AddPasses(json, b, scene.plan());
  AddWork(json, "unit_ms", s.unit_ms);
  AddWork(json, "critical_path_ms", s.critical_ms);
  AddMemory(json, s);
  json.Add("digests_compared", b.digests_compared);
  json.Add("digests_equal", !b.differs_at);
  json.AddDigest("digest", b.digest);
  json.BeginArray("faults");
  for (const std::string& fault : b.faults) json.Add("", fault);
  json.EndArray();
}

void AddConsoleFrame(JsonText& json, const ConsoleBudget& b, const FurScene& scene) {
  const Plan& plan = scene.plan();
  const auto ns = [&](Cycles cycles) {
    return int64_t(double(cycles) * 1e9 / double(b.machine.clock_hz) + 0.5);
  };
  const auto run = [&](uint32_t kind, uint32_t pass, uint32_t item, Cycles begin, Cycles end) {
    json.Add("", kind);
    json.Add("", pass == kNoBlock ? -1 : int64_t(pass));
    json.Add("", item == kNoBlock ? -1 : int64_t(item));
    json.Add("", ns(begin));
    json.Add("", ns(end));
  };
  json.BeginObject();
  json.Add("name", b.machine.name);
  json.Add("verdict",
           fmt::format("{}: median {:.2f}, p95 {:.2f}, worst {:.2f} ms over {} frames; {}: {}. "
                       "Range: {}; the picture is {}. {} % "
                       "of the memory's rate is used.",
                       b.machine.name, b.summary.median_ms, b.summary.p95_ms, b.summary.worst_ms,
                       b.summary.frames, DescribeVerdictTime(b), DescribeFit(b.VerdictMs()),
                       DescribeRange(b), DescribePlace(b.machine.code_order),
                       int(100.0 * b.summary.bus_use + 0.5)));
  json.Add("frame", b.summary.worst_frame);
  json.Add("ns", ns(b.slowest.cycles));
  json.BeginArray("works");
  for (uint32_t w = 0; w < kUnitWorkCount; ++w) json.Add("", UnitWorkName(UnitWork(w)));
  json.EndArray();
  json.BeginArray("plan");
  for (uint32_t p = 0; p < plan.passes.size(); ++p) {
    json.BeginObject();
    json.Add("name", PassName(plan, p));
    json.Add("domain", DomainName(plan.passes[p].domain));
    json.EndObject();
  }
  json.EndArray();
  json.BeginArray("passes");
  for (const ModelledPass& pass : b.slowest.passes) {
    json.Add("", ns(pass.begin));
    json.Add("", ns(pass.end));
  }
  json.EndArray();
  json.BeginArray("units");
  for (uint32_t u = 0; u < b.slowest.units.size(); ++u) {
    json.BeginObject();
    json.Add("name", UnitName(b.machine, u));
    json.BeginArray("slices");
    for (const UnitSlice& slice : b.slowest.units[u].slices)
      run(uint32_t(slice.work), slice.pass, slice.item, slice.begin, slice.end);
    json.EndArray();
    json.BeginArray("transfers");
    for (const TransferSlice& transfer : b.slowest.units[u].transfers)
      run(transfer.put, transfer.pass, transfer.item, transfer.begin, transfer.end);
    json.EndArray();
    json.EndObject();
  }
  json.EndArray();
  AddStages(json, b, plan);
  json.EndObject();
}

void AddRefusedConsole(JsonText& json, std::string_view name, std::string_view why) {
  json.BeginObject();
  json.Add("name", name);
  json.Add("verdict", fmt::format("{}: cannot run this scene: {}", name, why));
  json.BeginArray("units");
  json.EndArray();
  json.EndObject();
}

}  // namespace pelt
