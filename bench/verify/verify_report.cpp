// The words of a verification: names, tables, failures, the verdict.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "bench/report/report_tree.hpp"
#include "bench/verify/verify.hpp"

namespace pelt {
namespace {

std::string ExecutorColumn(const VerifyCase& what) {
  std::string name(what.executor->name);
  if (what.executor->HasWorkers()) name += fmt::format(" {}", what.workers);
  if (what.executor->HasSeed()) name += fmt::format(" {}", what.order_seed);
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

// Columns of what a case, a skip or a check came to; members that it has not are left out.
void AddOutcomeColumns(std::vector<Quantity>& columns) {
  for (const char* key :
       {"passed", "compared", "reason", "kind", "stage", "stream", "mismatch.reproduced",
        "mismatch.frame", "mismatch.stage", "mismatch.stream", "mismatch.layer", "mismatch.domain",
        "mismatch.item", "mismatch.place_in_layer", "mismatch.row", "mismatch.component",
        "mismatch.lane", "mismatch.expected", "mismatch.found"})
    columns.push_back(InJson(key));
}

void AddOutcome(const Outcome& outcome, std::vector<Value>& row) {
  row.push_back(outcome.passed);
  row.push_back(outcome.compared);
  row.push_back(outcome.reason.empty() ? Value{} : outcome.reason);
  const bool found = outcome.kind != FindingKind::kNone;
  row.push_back(found ? FindingName(outcome.kind) : Value{});
  row.push_back(found ? outcome.stage : Value{});
  row.push_back(found ? outcome.stream : Value{});
  if (!outcome.mismatch) return;
  const Mismatch& m = *outcome.mismatch;
  for (Value value :
       {Value(m.reproduced), Value(m.frame), Value(m.stage), Value(m.stream), Value(m.layer),
        Value(DomainName(m.domain)), Value(m.item), Value(m.place_in_layer), Value(m.row),
        Value(m.component), Value(m.lane), Value(fmt::format("{:08x}", m.expected)),
        Value(fmt::format("{:08x}", m.found))})
    row.push_back(std::move(value));
}

// Executors down, instruction sets across; a cell counts fusion x vertex order x sort.
void AddMatrix(const VerifyReport& report, ReportTree& tree) {
  std::vector<std::string> rows;
  std::vector<Isa> isas;
  std::map<std::pair<std::string, Isa>, Cell> cells;
  for (const CaseResult& c : report.cases) {
    const std::string row = ExecutorColumn(c.what);
    if (std::find(rows.begin(), rows.end(), row) == rows.end()) rows.push_back(row);
    if (std::find(isas.begin(), isas.end(), c.what.isa) == isas.end()) isas.push_back(c.what.isa);
    Cell& cell = cells[{row, c.what.isa}];
    ++cell.cases;
    cell.same += c.passed;
  }
  std::vector<Quantity> columns = {InText("same / cases")};
  for (const Isa isa : isas) columns.push_back(InText(std::string(IsaName(isa))));
  ReportTable& table = tree.AddTable({}, columns);
  for (const std::string& row : rows) {
    std::vector<Value> values = {row};
    for (const Isa isa : isas) {
      const Cell cell = cells[{row, isa}];
      values.push_back(cell.cases ? Value(fmt::format("{}/{}", cell.same, cell.cases)) : Value{});
    }
    table.Add(std::move(values));
  }
  std::string alone;
  for (const ExecutorEntry& entry : ExecutorEntries())
    if (entry.stages_alone) alone += fmt::format("; {}: {}", entry.name, entry.text);
  tree.Say(
      "each cell: fused and unfused plan x sorted vertices and index buffer x whole and piecewise "
      "sort x skips on, off and LOD; odd: threads that round upwards and flush denormals" +
      alone);
}

void AddCases(const VerifyReport& report, ReportTree& tree) {
  std::vector<Quantity> columns;
  for (const char* key :
       {"place", "name", "executor", "workers", "workers_observed", "order_seed", "isa", "fused",
        "vertex_order", "piecewise_sort", "settings", "odd_floats"})
    columns.push_back(InJson(key));
  AddOutcomeColumns(columns);
  ReportTable& cases = tree.AddTable("cases", columns);
  for (const CaseResult& c : report.cases) {
    std::vector<Value> row = {c.place,
                              NameCase(c.what),
                              c.what.executor->name,
                              c.what.workers,
                              c.what.executor->HasWorkers() ? Value(c.workers_observed) : Value{},
                              c.what.order_seed,
                              IsaName(c.what.isa),
                              c.what.fuse,
                              OrderName(c.what.vertex_order),
                              c.what.piecewise_sort,
                              SettingsName(c.what.settings),
                              c.what.odd_floats};
    AddOutcome(c, row);
    cases.Add(std::move(row));
  }
}

void AddSkips(const VerifyReport& report, ReportTree& tree) {
  std::vector<Quantity> columns = {
      InJson("place"), InJson("name"),   {"switch", "", -1, "skip off"},
      {"course"},      InText("result"), {"items_saved"}};
  AddOutcomeColumns(columns);
  columns.push_back(InText(" "));  // the reason, last and wrapped
  ReportTable& skips = tree.AddTable("skips", columns);
  for (const SkipResult& s : report.skips) {
    const char* result = !s.compared ? "skipped" : s.passed ? "same" : "DIFFERS";
    std::vector<Value> row = {s.place, fmt::format("skip {} off, {}", s.name, s.course),
                              s.name,  s.course,
                              result,  s.items_skipped};
    AddOutcome(s, row);
    row.resize(columns.size() - 1);
    row.push_back(s.reason.empty() ? Value{} : s.reason);
    skips.Add(std::move(row));
  }
}

// A section is one case of the list, with what it looked at inside.
void AddChecks(const VerifyReport& report, ReportTree& tree) {
  ReportTable& checks = tree.AddTable("checks", {InJson("place"),
                                                 {"name", "", -1, "check"},
                                                 InJson("passed"),
                                                 InJson("reason"),
                                                 InText("passed "),
                                                 InText("of"),
                                                 InText("looked at"),
                                                 InJson("results")});
  std::vector<std::string> not_compared;
  for (size_t first = 0, end = 0; first < report.checks.size(); first = end) {
    const std::string& section = report.checks[first].section;
    while (end < report.checks.size() && report.checks[end].section == section) ++end;
    std::vector<Quantity> columns = {{"name"}, {"looked_at"}, {"felt"}};
    AddOutcomeColumns(columns);
    ReportTable results{{}, columns};
    const CheckResult* failed = nullptr;
    uint64_t seen = 0;
    uint32_t passed = 0;
    for (size_t i = first; i < end; ++i) {
      const CheckResult& c = report.checks[i];
      if (!c.passed && !failed) failed = &c;
      if (!c.compared) not_compared.push_back(fmt::format("{}, {}: {}", section, c.name, c.reason));
      seen += c.seen;
      passed += c.compared && c.passed;
      std::vector<Value> row = {c.name, c.seen,
                                section.starts_with("waking") ? Value(c.felt) : Value{}};
      AddOutcome(c, row);
      results.Add(std::move(row));
    }
    checks.Add({report.checks[first].place, section, !failed,
                failed ? Value(fmt::format("{}: {}: {}", failed->name, FindingName(failed->kind),
                                           failed->reason))
                       : Value{},
                passed, end - first, seen, results});
  }
  tree.AddTexts({}, not_compared, "not compared");
}

// Failures of one part, the first ten in full.
template <class Result>
void AddFailures(const std::vector<Result>& results, auto name, std::string_view what,
                 ReportTree& tree) {
  uint32_t failed = 0;
  for (const Result& r : results) {
    if (r.passed || ++failed > 10) continue;
    tree.BlankLine();
    tree.Say("FAILED " + name(r));
    tree.Say(fmt::format("  {}: {}", FindingName(r.kind), r.reason));
  }
  if (failed > 10) tree.Say(fmt::format("... and {} more {} failed", failed - 10, what));
}

void AddVerdict(const VerifyReport& report, ReportTree& tree) {
  const auto failed = [](const auto& results) {
    return std::count_if(results.begin(), results.end(), [](const auto& r) { return !r.passed; });
  };
  const std::string of = report.shard.IsAll()
                             ? std::string()
                             : fmt::format(" of shard {}/{} (of {} in all)", report.shard.index,
                                           report.shard.count, report.places);
  tree.BlankLine();
  if (report.stopped) tree.Say("stopped there: what comes after it was not run");
  tree.Say(report.Passed()
               ? fmt::format("verdict: SAME BITS in all {} cases{}{}",
                             report.cases.empty() ? report.checks.size() : report.cases.size(), of,
                             report.Missing().empty() ? "" : ", BUT INCOMPLETE")
               : fmt::format("verdict: DIFFERENT BITS or a fault in {} cases{}",
                             failed(report.cases) + failed(report.skips) + failed(report.checks),
                             of));
}

}  // namespace

std::string_view SettingsName(Settings settings) { return kSettings[size_t(settings)]; }

std::string NameCase(const VerifyCase& what) {
  return fmt::format("{}, {}, {}, vertices {}, sort {}, {}", ExecutorColumn(what),
                     IsaName(what.isa), what.fuse ? "fused" : "unfused",
                     OrderName(what.vertex_order), what.piecewise_sort ? "in pieces" : "whole",
                     SettingsName(what.settings)) +
         (what.odd_floats ? ", odd floats" : "");
}

ReportTree MakeVerifyTree(const VerifyReport& report, const Fingerprint& fingerprint) {
  ReportTree tree;
  AddShardHeader(fingerprint, report.shard, report.places, tree);
  tree.Add({"scene"}, report.scene).Add({"characters"}, report.characters);
  tree.Add({"strands"}, report.strands).Add({"frames"}, report.frames);
  tree.Add({"digest", "", -1, "reference digest"}, DigestText(report.digest));
  tree.Add(InJson("passed"), report.Passed());
  if (!report.cases.empty()) AddMatrix(report, tree);
  AddCases(report, tree);
  tree.AddTexts("not_run", report.not_run, "not run, as this processor, system or build lacks it");
  tree.AddTexts("missing", report.Missing(), "could not be looked at");
  AddSkips(report, tree);
  AddChecks(report, tree);
  AddFailures(
      report.cases, [](const CaseResult& c) { return NameCase(c.what); }, "cases", tree);
  AddFailures(
      report.skips, [](const SkipResult& s) { return s.name + ", " + s.course; }, "skips", tree);
  AddFailures(
      report.checks, [](const CheckResult& c) { return c.section + ": " + c.name; }, "checks",
      tree);
  AddVerdict(report, tree);
  return tree;
}

std::string DescribeReport(const VerifyReport& report) { return MakeVerifyTree(report).Text(); }
std::string ReportAsJson(const VerifyReport& report, const Fingerprint& fingerprint) {
  return MakeVerifyTree(report, fingerprint).Json();
}

}  // namespace pelt
