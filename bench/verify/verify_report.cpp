// The words of a verification: names, the table, the verdict, JSON.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <map>

#include "bench/report/json_text.hpp"
#include "bench/verify/verify.hpp"

namespace pelt {
namespace {

constexpr std::string_view kExecutors[] = {"serial",   "tbb",         "door",   "pull",
                                           "permuted", "local-store", "guarded"};

std::string ExecutorColumn(const VerifyCase& what) {
  std::string name(ExecutorName(what.executor));
  if (HasWorkers(what.executor)) name += fmt::format(" {}", what.workers);
  if (what.executor == ExecutorKind::kPermuted) name += fmt::format(" {}", what.order_seed);
  return what.odd_floats ? name + " odd" : name;
}

constexpr std::string_view kSettings[] = {"skips", "no-skips", "lod"};

std::string_view OrderName(VertexOrder order) {
  return order == VertexOrder::kSorted ? "sorted" : "index-buffer";
}

// One cell of the table: all cases of one executor and one instruction set.
struct Cell {
  uint32_t same = 0, cases = 0;
};

// One part of the report's third section.
struct Section {
  std::string name;
  uint32_t checks = 0, compared = 0, passed = 0;
  uint64_t seen = 0;
};

std::vector<Section> SectionsOf(const VerifyReport& report) {
  std::vector<Section> sections;
  for (const CheckResult& c : report.checks) {
    if (sections.empty() || sections.back().name != c.section) sections.push_back({c.section});
    Section& section = sections.back();
    ++section.checks;
    section.compared += c.compared;
    section.passed += c.compared && c.passed;
    section.seen += c.seen;
  }
  return sections;
}

std::string DescribeChecks(const VerifyReport& report) {
  if (report.checks.empty()) return {};
  std::string out =
      fmt::format("\n{:<10} {:>8} {:>8} {:>10}\n", "check", "passed", "of", "looked at");
  for (const Section& s : SectionsOf(report))
    out += fmt::format("{:<10} {:>8} {:>8} {:>10}\n", s.name, s.passed, s.checks, s.seen);
  for (const CheckResult& c : report.checks)
    if (!c.compared) out += fmt::format("not compared: {}, {}: {}\n", c.section, c.name, c.reason);
  return out;
}

// Failures of one part, the first ten in full.
template <class Result>
void AddFailures(const std::vector<Result>& results, auto name, std::string_view what,
                 std::string& out) {
  uint32_t failed = 0;
  for (const Result& r : results)
    if (!r.passed && ++failed <= 10)
      out += fmt::format("\nFAILED {}\n  {}: {}\n", name(r), FindingName(r.kind), r.reason);
  if (failed > 10) out += fmt::format("\n... and {} more {} failed\n", failed - 10, what);
}

void AddMismatch(JsonText& json, const Mismatch& m) {
  json.BeginObject("mismatch");
  json.Add("reproduced", m.reproduced);
  json.Add("frame", m.frame);
  json.Add("stage", m.stage);
  json.Add("stream", m.stream);
  json.Add("layer", m.layer);
  json.Add("item", m.item);
  json.Add("chunk_in_layer", m.chunk_in_layer);
  json.Add("row", m.row);
  json.Add("component", m.component);
  json.Add("lane", m.lane);
  json.Add("expected", fmt::format("{:08x}", m.expected));
  json.Add("found", fmt::format("{:08x}", m.found));
  json.EndObject();
}

void AddOutcome(JsonText& json, const Outcome& outcome) {
  json.Add("passed", outcome.passed);
  json.Add("compared", outcome.compared);
  if (!outcome.reason.empty()) json.Add("reason", outcome.reason);
  if (outcome.kind != FindingKind::kNone) {
    json.Add("kind", FindingName(outcome.kind));
    json.Add("stage", outcome.stage);
    json.Add("stream", outcome.stream);
  }
  if (outcome.mismatch) AddMismatch(json, *outcome.mismatch);
}

// A section is one case of the list, with what it looked at inside.
void AddChecks(const VerifyReport& report, JsonText& json) {
  json.BeginArray("checks");
  for (size_t first = 0, end = 0; first < report.checks.size(); first = end) {
    const std::string& section = report.checks[first].section;
    while (end < report.checks.size() && report.checks[end].section == section) ++end;
    const auto from = report.checks.begin() + ptrdiff_t(first);
    const auto to = report.checks.begin() + ptrdiff_t(end);
    const auto failed = std::find_if(from, to, [](const CheckResult& c) { return !c.passed; });
    json.BeginObject();
    json.Add("place", from->place);
    json.Add("name", section);
    json.Add("passed", failed == to);
    if (failed != to)
      json.Add("reason",
               fmt::format("{}: {}: {}", failed->name, FindingName(failed->kind), failed->reason));
    json.BeginArray("results");
    for (auto c = from; c != to; ++c) {
      json.BeginObject();
      json.Add("name", c->name);
      json.Add("looked_at", c->seen);
      if (section == "waking") json.Add("felt", c->felt);
      AddOutcome(json, *c);
      json.EndObject();
    }
    json.EndArray();
    json.EndObject();
  }
  json.EndArray();
}

}  // namespace

std::string_view ExecutorName(ExecutorKind kind) { return kExecutors[size_t(kind)]; }

std::string_view SettingsName(Settings settings) { return kSettings[size_t(settings)]; }

std::optional<ExecutorKind> ParseExecutor(std::string_view name) {
  for (size_t i = 0; i < std::size(kExecutors); ++i)
    if (kExecutors[i] == name) return ExecutorKind(i);
  return std::nullopt;
}

std::string NameCase(const VerifyCase& what) {
  return fmt::format("{}, {}, {}, vertices {}, sort {}, {}", ExecutorColumn(what),
                     IsaName(what.isa), what.fuse ? "fused" : "unfused",
                     OrderName(what.vertex_order), what.piecewise_sort ? "in pieces" : "whole",
                     SettingsName(what.settings)) +
         (what.odd_floats ? ", odd floats" : "");
}

std::string DescribeMismatch(const Mismatch& m) {
  if (!m.reproduced)
    return fmt::format("frame {} differed once and not again in lock-step", m.frame);
  std::string place = m.layer.empty() ? fmt::format("item {}", m.item)
                                      : fmt::format("layer '{}', chunk {} (item {})", m.layer,
                                                    m.chunk_in_layer, m.item);
  std::string values = fmt::format("expected 0x{:08x}, found 0x{:08x}", m.expected, m.found);
  // Records are hashed as words; most are floats, so both readings are given.
  values += fmt::format(" (as float {:.9g} and {:.9g})", std::bit_cast<float>(m.expected),
                        std::bit_cast<float>(m.found));
  return fmt::format("frame {}, stage {}, stream {}, {}, row {}[{}], lane {}: {}", m.frame, m.stage,
                     m.stream, place, m.row, m.component, m.lane, values);
}

std::string DescribeReport(const VerifyReport& report) {
  // Executors down, instruction sets across; a cell counts fusion x vertex order x sort.
  std::vector<std::string> rows;
  std::vector<Isa> columns;
  std::map<std::pair<std::string, Isa>, Cell> cells;
  for (const CaseResult& c : report.cases) {
    const std::string row = ExecutorColumn(c.what);
    if (std::find(rows.begin(), rows.end(), row) == rows.end()) rows.push_back(row);
    if (std::find(columns.begin(), columns.end(), c.what.isa) == columns.end())
      columns.push_back(c.what.isa);
    Cell& cell = cells[{row, c.what.isa}];
    ++cell.cases;
    cell.same += c.passed;
  }
  std::string out =
      fmt::format("scene {}: {} characters, {} strands, {} frames, reference digest {:016x}\n",
                  report.scene, report.characters, report.strands, report.frames, report.digest);
  out += fmt::format("{:<16}", "same / cases");
  for (const Isa isa : columns) out += fmt::format("{:>11}", IsaName(isa));
  out += '\n';
  for (const std::string& row : rows) {
    out += fmt::format("{:<16}", row);
    for (const Isa isa : columns) {
      const Cell cell = cells[{row, isa}];
      out += fmt::format("{:>11}", cell.cases ? fmt::format("{}/{}", cell.same, cell.cases) : "");
    }
    out += '\n';
  }
  out +=
      "each cell: fused and unfused plan x sorted vertices and index buffer x whole and "
      "piecewise sort x skips on, off and LOD; odd: threads that round upwards and flush "
      "denormals; "
      "guarded: each stage between closed pages\n";
  for (const std::string& what : report.not_run)
    out += fmt::format("skipped: {} (this processor, system or build lacks it)\n", what);
  if (!report.skips.empty())
    out += fmt::format("\n{:<14} {:<15} {:<9} {:>16}\n", "skip off", "course", "result",
                       "items it saved");
  for (const SkipResult& s : report.skips)
    out += fmt::format("{:<14} {:<15} {:<9} {:>16}{}{}\n", s.name, s.course,
                       !s.compared ? "skipped"
                       : s.passed  ? "same"
                                   : "DIFFERS",
                       s.items_skipped, s.reason.empty() ? "" : "  ", s.reason);
  out += DescribeChecks(report);
  AddFailures(
      report.cases, [](const CaseResult& c) { return NameCase(c.what); }, "cases", out);
  AddFailures(
      report.skips, [](const SkipResult& s) { return s.name + ", " + s.course; }, "skips", out);
  AddFailures(
      report.checks, [](const CheckResult& c) { return c.section + ": " + c.name; }, "checks", out);
  const auto failed = [](const auto& results) {
    return std::count_if(results.begin(), results.end(), [](const auto& r) { return !r.passed; });
  };
  const std::string of = report.shard.IsAll()
                             ? std::string()
                             : fmt::format(" of shard {}/{} (of {} in all)", report.shard.index,
                                           report.shard.count, report.places);
  if (report.stopped) out += "\nstopped there: what comes after it was not run\n";
  out += report.Passed()
             ? fmt::format("\nverdict: SAME BITS in all {} cases{}\n", report.cases.size(), of)
             : fmt::format("\nverdict: DIFFERENT BITS or a fault in {} cases{}\n",
                           failed(report.cases) + failed(report.skips) + failed(report.checks), of);
  return out;
}

std::string ReportAsJson(const VerifyReport& report, const Fingerprint& fingerprint) {
  JsonText json;
  json.BeginObject();
  AddShardHeader(fingerprint, report.shard, report.places, json);
  json.Add("scene", report.scene);
  json.Add("characters", report.characters);
  json.Add("strands", report.strands);
  json.Add("frames", report.frames);
  json.AddDigest("digest", report.digest);
  json.Add("passed", report.Passed());
  json.BeginArray("cases");
  for (const CaseResult& c : report.cases) {
    json.BeginObject();
    json.Add("place", c.place);
    json.Add("name", NameCase(c.what));
    json.Add("executor", ExecutorName(c.what.executor));
    json.Add("workers", c.what.workers);
    if (HasWorkers(c.what.executor)) json.Add("workers_observed", c.workers_observed);
    json.Add("order_seed", c.what.order_seed);
    json.Add("isa", IsaName(c.what.isa));
    json.Add("fused", c.what.fuse);
    json.Add("vertex_order", OrderName(c.what.vertex_order));
    json.Add("piecewise_sort", c.what.piecewise_sort);
    json.Add("settings", SettingsName(c.what.settings));
    json.Add("odd_floats", c.what.odd_floats);
    AddOutcome(json, c);
    json.EndObject();
  }
  json.EndArray();
  json.BeginArray("not_run");
  for (const std::string& what : report.not_run) json.Add("", what);
  json.EndArray();
  json.BeginArray("skips");
  for (const SkipResult& s : report.skips) {
    json.BeginObject();
    json.Add("place", s.place);
    json.Add("name", fmt::format("skip {} off, {}", s.name, s.course));
    json.Add("switch", s.name);
    json.Add("course", s.course);
    json.Add("items_saved", s.items_skipped);
    AddOutcome(json, s);
    json.EndObject();
  }
  json.EndArray();
  AddChecks(report, json);
  json.EndObject();
  return json.text();
}

}  // namespace pelt
