#include "bench/consoles/console_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "bench/consoles/gpu_bound.hpp"
#include "bench/report/timeline.hpp"

namespace pelt {
namespace {

constexpr double kLinesMs[] = {5.0, 8.0};
constexpr size_t kNamedStreams = 8;  // of main memory, the largest first

double Mb(double bytes) { return bytes * 1e-6; }

// Of the page too.
ReportTable StageTable(const ConsoleBudget& b, const Plan& plan) {
  ReportTable table{"stages",
                    {{"name", "", -1, "stage, of a frame"},
                     {"items", "", 1},
                     {"core_ms", "ms", 3, "core"},
                     {"share", "%", 1, "", 100},
                     {"wall_ms", "ms", 3, "wall"},
                     {"code_bytes", "B", -1, "code"}}};
  double all_ms = 0.0;
  for (const FrameSummary::Stage& stage : b.summary.stages) all_ms += stage.core_ms;
  for (size_t i = 0; i < b.summary.stages.size(); ++i) {
    const FrameSummary::Stage& stage = b.summary.stages[i];
    if (stage.items > 0.0)
      table.Add({plan.stages[i].kernel.name, stage.items, stage.core_ms,
                 all_ms > 0.0 ? stage.core_ms / all_ms : 0.0, stage.wall_ms,
                 b.costs.stages[i].code_bytes});
  }
  return table;
}

void AddWork(const WorkMs& work, std::vector<Value>& row) {
  for (const double ms : work) row.push_back(ms);
}

std::vector<Quantity> WorkColumns(const std::string& key) {
  std::vector<Quantity> columns;
  for (uint32_t w = 0; w < kUnitWorkCount; ++w)
    columns.push_back({fmt::format("{}.{}", key, UnitWorkName(UnitWork(w))), "ms", 3});
  return columns;
}

ReportTable BufferTable(const Pass& pass) {
  ReportTable buffers{{}, {{"stream"}, {"bytes"}}, true};
  for (const PassStream& stream : pass.streams)
    buffers.Add({DescribeStream(stream.stream).name, stream.bytes});
  return buffers;
}

// What units did in each pass, in the mean; the critical path; and what lies in the local stores.
void AddPasses(const ConsoleBudget& b, const Plan& plan, ReportTree& tree) {
  const FrameSummary& s = b.summary;
  std::vector<Quantity> columns = {InText("pass"), InJson("name"), {"items", "", 1}, {"ms", "", 3}};
  for (Quantity& column : WorkColumns("unit_ms")) columns.push_back(std::move(column));
  for (const Quantity& column : WorkColumns("critical_ms")) columns.push_back(InJson(column.key));
  columns.push_back(InJson("bound_by"));
  for (uint32_t l = 0; l < kPassLimitCount; ++l)
    columns.push_back(InJson(fmt::format("gain_ms.{}", PassLimitName(PassLimit(l)))));
  for (const char* key : {"code", "stack", "parameters", "buffers", "buffer_sets", "free"})
    columns.push_back(InJson(fmt::format("local_store_bytes.{}", key)));
  columns.push_back(InJson("buffer_bytes"));
  tree.BlankLine();
  tree.Say(
      "passes, which run side by side, by what units did, in the mean; path: what the frame's end "
      "waited for");
  ReportTable& passes = tree.AddTable("passes", columns);
  ReportTable& bounds = tree.AddTable(
      {}, {InText("pass"), InText("bound by"), InText("without, less", "ms", 3), InText("stages")});
  double all_ms = 0.0, all_items = 0.0;
  for (uint32_t p = 0; p < s.passes.size(); ++p) {
    const FrameSummary::Pass& pass = s.passes[p];
    all_ms += pass.ms;
    all_items += pass.items;
    std::vector<Value> row = {p, PassName(plan, p), pass.items, pass.ms};
    AddWork(pass.unit_ms, row);
    AddWork(pass.critical_ms, row);
    row.push_back(PassLimitName(pass.binds));
    for (uint32_t l = 0; l < kPassLimitCount; ++l) row.push_back(pass.GainMs(PassLimit(l)));
    if (!b.stores.empty()) {
      const PassStore& store = b.stores[p];
      for (const uint64_t bytes : std::initializer_list<uint64_t>{
               store.code_bytes, store.stack_bytes, store.parameter_bytes, store.buffer_bytes,
               store.buffer_sets, store.free_bytes})
        row.push_back(bytes);
      row.push_back(BufferTable(plan.passes[p]));
    }
    passes.Add(std::move(row));
    bounds.Add({p, PassLimitName(pass.binds), pass.GainMs(pass.binds), PassName(plan, p)});
  }
  std::vector<Value> all = {"all", {}, all_items, all_ms};
  AddWork(s.unit_ms, all);
  passes.Add(std::move(all), Show::kText);
  std::vector<Value> path = {"path", {}, {}, all_ms};
  AddWork(s.critical_ms, path);
  passes.Add(std::move(path), Show::kText);
}

void AddWorkSection(const std::string& key, const WorkMs& work, ReportTree& tree) {
  ReportTree& of = tree.AddSection(key);
  for (uint32_t w = 0; w < kUnitWorkCount; ++w)
    of.Add(InJson(std::string(UnitWorkName(UnitWork(w)))), work[w]);
}

void AddMemory(const ConsoleBudget& b, ReportTree& tree) {
  const FrameSummary& s = b.summary;
  const auto sum = [](const std::vector<double>& v) {
    return std::accumulate(v.begin(), v.end(), 0.0);
  };
  tree.BlankLine();
  tree.Add(InText("main memory: in", "MB", 2), Mb(sum(s.stream_get_bytes)));
  tree.Add(InText("out", "MB", 2), Mb(sum(s.stream_put_bytes)));
  tree.Add({"code_bytes", "MB", 2, "code", 1e-6}, s.code_bytes);
  tree.Add({"wasted_bytes", "MB", 2, "lines that were not requested", 1e-6}, s.wasted_bytes);
  tree.Add({"bus_use", "% of what the memory could move", 0, "together", 100}, s.bus_use);
  std::vector<uint32_t> order(kStreamCount);
  std::iota(order.begin(), order.end(), 0u);
  const auto bytes = [&](uint32_t i) { return s.stream_get_bytes[i] + s.stream_put_bytes[i]; };
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t x, uint32_t y) { return bytes(x) > bytes(y); });
  ReportTable named{{}, {{"stream"}, {"in", "MB", 3, "", 1e-6}, {"out", "MB", 3, "", 1e-6}}};
  ReportTree& of = tree.AddSection("main_memory_bytes");
  for (const uint32_t i : order) {
    if (bytes(i) == 0.0) break;
    const std::string name(DescribeStream(Stream(i)).name);
    if (named.rows.size() < kNamedStreams)
      named.Add({name, s.stream_get_bytes[i], s.stream_put_bytes[i]});
    of.Add(InJson(name + ".in"), s.stream_get_bytes[i]);
    of.Add(InJson(name + ".out"), s.stream_put_bytes[i]);
  }
  tree.AddTable({}, {}) = named;
}

void AddStores(const ConsoleBudget& b, const Plan& plan, ReportTree& tree) {
  if (b.stores.empty()) return;
  ReportTable& table = tree.AddTable(
      {}, {InText("local store of a pass", "B"), InText("code"), InText("stack"),
           InText("parameters"), InText("sets of"), InText("buffers"), InText("free")});
  for (uint32_t p = 0; p < b.stores.size(); ++p) {
    const PassStore& store = b.stores[p];
    table.Add({PassName(plan, p), store.code_bytes, store.stack_bytes, store.parameter_bytes,
               store.buffer_sets, store.buffer_bytes, store.free_bytes});
  }
  // Of the pass that has least room left.
  const auto fullest = std::ranges::min_element(b.stores, {}, &PassStore::free_bytes);
  const auto pass = uint32_t(fullest - b.stores.begin());
  std::string buffers = fmt::format("buffers of pass {}:", pass);
  for (const PassStream& stream : plan.passes[pass].streams)
    buffers += fmt::format(" {} {}", DescribeStream(stream.stream).name, stream.bytes);
  tree.Say(buffers);
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

void AddHead(const ConsoleBudget& b, ReportTree& tree) {
  const ConsoleMachine& m = b.machine;
  const FrameSummary& s = b.summary;
  tree.Say(fmt::format(
      "{}, modelled: {} {} at {:.3f} GHz; frame median {:.2f}, p95 {:.2f}, worst {:.2f} ms (frame "
      "{} of {}, behind {} to warm up) as the models have it, like all figures below",
      m.name, m.units, m.local_store_bytes ? "SPUs" : "hardware threads", double(m.clock_hz) * 1e-9,
      s.median_ms, s.p95_ms, s.worst_ms, s.worst_frame, s.frames, b.warm_up));
  tree.Say(DescribeVerdictTime(b));
  tree.Say("its range, availability in it:").Say(DescribeRange(b));
  tree.Say("all else here is " + DescribePlace(m.code_order));
  tree.Add(InJson("machine"), m.name).Add(InJson("units"), m.units);
  tree.Add(InJson("clock_hz"), m.clock_hz).Add(InJson("availability"), m.availability);
  tree.Add(InJson("availability_from"), m.availability_from);
  const auto spread = [](const std::string& key, const Spread& ms, ReportTree& to) {
    to.Add(InJson(key + ".median"), ms.median).Add(InJson(key + ".p95"), ms.p95);
    to.Add(InJson(key + ".worst"), ms.worst);
  };
  spread("frame_ms", {s.median_ms, s.p95_ms, s.worst_ms}, tree);
  spread("frame_ms_with_availability",
         {m.Available(s.median_ms), b.VerdictMs(), m.Available(s.worst_ms)}, tree);
  tree.Add(InJson("verdict_takes"), "frame_ms_with_availability.p95");
  ReportTree& range = tree.AddSection("range");
  spread("scheduled_ms", b.scheduled_ms, range);
  spread("as_written_ms", b.as_written_ms, range);
  range.Add(InJson("code_order"), m.code_order);
  range.Add(InJson("code_order_least"), MeasuredCodePlace().least);
  range.Add(InJson("code_order_most"), MeasuredCodePlace().most);
  tree.Add(InJson("warm_up_frames"), b.warm_up);
  tree.Add(InJson("worst_frame"), s.worst_frame);
}

void AddDigests(const ConsoleBudget& b, ReportTree& tree) {
  tree.BlankLine();
  tree.Say(b.differs_at ? fmt::format("DIGEST: frame {} is not the host's", *b.differs_at)
                        : fmt::format("executed while it was timed: digests equal the host's in "
                                      "{} of {} frames compared, the last {:016x}",
                                      b.digests_compared, b.digests_compared, b.digest));
  tree.Add(InJson("digests_compared"), b.digests_compared);
  tree.Add(InJson("digests_equal"), !b.differs_at);
  tree.Add(InJson("digest"), DigestText(b.digest));
  tree.AddTexts("faults", b.faults, "FAULT");
}

}  // namespace

std::string DescribeFit(double ms) {
  if (ms <= kLinesMs[0]) return fmt::format("fits {} ms", kLinesMs[0]);
  if (ms <= kLinesMs[1]) return fmt::format("fits {} ms, not {} ms", kLinesMs[1], kLinesMs[0]);
  return fmt::format("does not fit {} ms", kLinesMs[1]);
}

std::string DescribeRange(const ConsoleBudget& b) {
  return fmt::format("p95 {:.2f} ms with the best schedules, {:.2f} ms as written",
                     b.machine.Available(b.scheduled_ms.p95),
                     b.machine.Available(b.as_written_ms.p95));
}

void AddConsole(const ConsoleBudget& b, const FurScene& scene, ReportTree& tree) {
  const Plan& plan = scene.plan();
  AddHead(b, tree);
  tree.AddTable({}, {}) = StageTable(b, plan);
  AddPasses(b, plan, tree);
  AddWorkSection("unit_ms", b.summary.unit_ms, tree);
  AddWorkSection("critical_path_ms", b.summary.critical_ms, tree);
  AddMemory(b, tree);
  AddStores(b, plan, tree);
  AddGpuBound(b.gpu, b.draws, tree);
  AddDigests(b, tree);
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
  json.Add("stages", StageTable(b, plan));
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
