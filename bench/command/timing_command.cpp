// `pelt timing`: an instruction listing through a core model, as a chart.
#include <fmt/format.h>

#include <array>
#include <cstdio>

#include "bench/command/commands.hpp"
#include "bench/command/usage_error.hpp"
#include "bench/report/report_tree.hpp"
#include "core/file_bytes.hpp"
#include "core/format.hpp"
#include "platform_sim/pipeline/issue_walk.hpp"
#include "platform_sim/pipeline/listing.hpp"
#include "platform_sim/pipeline/ppe_core.hpp"
#include "platform_sim/pipeline/spu_core.hpp"
#include "platform_sim/platforms/cell.hpp"

namespace pelt {
namespace {

constexpr uint64_t kListingBytesLimit = 64u << 20;

std::string DisplayName(const std::string& path) { return path == "-" ? "standard input" : path; }

// "-" is standard input.
std::string ReadText(const std::string& path) {
  const auto bytes =
      path == "-" ? ReadToEnd(stdin, kListingBytesLimit) : ReadWhole(path, kListingBytesLimit);
  if (!bytes)
    throw Error(
        fmt::format("{}: {}; expected an instruction listing", DisplayName(path), bytes.error()));
  return std::string(AsText(*bytes));
}

std::string LabelAt(const Listing& listing, uint32_t index) {
  for (const ListingLabel& label : listing.labels)
    if (label.index == index) return Printable(label.name);
  return fmt::format("line {}", listing.line[index]);
}

// "LABEL=N" to what the core takes.
TripCount ParseTrip(const Listing& listing, const std::string& text) {
  const size_t equals = text.rfind('=');
  const std::string name = text.substr(0, equals);
  uint64_t iterations = 0;
  const char* digits = text.c_str() + std::min(equals + 1, text.size());
  char extra = 0;
  if (equals == text.npos || *digits < '0' || *digits > '9' || text.size() - equals > 14 ||
      std::sscanf(digits, "%lu%c", &iterations, &extra) != 1 || iterations == 0 ||
      iterations > kMaxIterations)
    throw UsageError(
        fmt::format("--trip {}; expected LABEL=N with N from 1 to {}", text, kMaxIterations));
  const std::vector<uint32_t> heads = LoopHeads(listing.program);
  const ListingLabel* label = listing.FindLabel(name);
  for (const uint32_t head : heads)
    if (label && label->index == head) return {head, iterations};
  std::string loops;
  for (const uint32_t head : heads)
    loops += fmt::format("{}{}", loops.empty() ? "" : ", ", LabelAt(listing, head));
  throw UsageError(fmt::format("--trip {}: no branch of {} goes back to '{}'; its loops: {}", text,
                               listing.name, name, loops.empty() ? "none" : loops));
}

IssueChart Time(const Listing& listing, const TimingArgs& args) {
  std::vector<TripCount> trips;
  for (const std::string& trip : args.trips) trips.push_back(ParseTrip(listing, trip));
  auto chart = args.core == "spu"
                   ? TimeOnSpu(listing.program, trips, {args.pair_by_order, args.hinted}, {})
                   : TimeOnPpe(listing.program, trips, {args.smt}, {});
  if (chart) return *std::move(chart);
  std::string error = chart.error();
  // "instruction 4: ..." to the line it stands on.
  unsigned index = 0;
  if (std::sscanf(error.c_str(), "instruction %u:", &index) == 1 && index < listing.line.size())
    error = fmt::format("{}: {}{}", listing.line[index], listing.text[index],
                        error.substr(error.find(':')));
  throw Error(fmt::format("{}:{}", listing.name, error));
}

std::string DescribeStalls(const Listing& listing, const IssueSlot& slot) {
  std::string out;
  for (uint32_t s = 0; s < slot.stall_count; ++s) {
    const Stall& stall = slot.stalls[s];
    const std::string what = stall.reg == kNoRegister ? std::string(StallCauseName(stall.cause))
                                                      : RegisterName(*listing.set, stall.reg);
    out += fmt::format("{}{} {}", out.empty() ? "" : ", ", stall.cycles, what);
  }
  if (slot.unpaired != Unpaired::kPaired && slot.unpaired != Unpaired::kFirst)
    out += fmt::format("{}alone: {}", out.empty() ? "" : "; ", UnpairedName(slot.unpaired));
  return out;
}

void AddSlots(const Listing& listing, const IssueChart& chart, const std::vector<IssueSlot>& slots,
              ReportTree& tree) {
  // "+": together with the one above.
  ReportTable& issues = tree.AddTable("issues", {InText(" "),
                                                 {"cycle"},
                                                 {"pipe"},
                                                 InJson("paired"),
                                                 {"line"},
                                                 {"instruction"},
                                                 {"waited", "", -1, "cycles waited for"}});
  for (const IssueSlot& slot : slots) {
    const bool paired = slot.unpaired == Unpaired::kPaired;
    issues.Add({paired ? "+" : "", slot.cycle, chart.pipes[slot.pipe], paired,
                listing.line[slot.instruction], Printable(listing.text[slot.instruction]),
                DescribeStalls(listing, slot)});
  }
}

void AddTotals(const IssueChart& chart, const IssueTotals& totals, ReportTree& tree) {
  tree.Add({"instructions"}, totals.instructions).Add({"cycles"}, totals.cycles);
  tree.Add({"dual_issues", "", -1, "two at once in"}, totals.dual_issues);
  tree.Add(InText("of issuing cycles"), totals.IssueCycles());
  tree.Add(InText("which is", "%", 1), 100.0 * totals.DualIssueRate());
  ReportTree& busy = tree.AddSection("busy_cycles", "busy");
  for (size_t p = 0; p < chart.pipes.size(); ++p)
    busy.Add({std::string(chart.pipes[p])}, totals.pipe_cycles[p]);
  ReportTree& stalls = tree.AddSection("stall_cycles", "stalls");
  stalls.Add(InText("all"), totals.AllStallCycles());
  for (uint32_t c = 0; c < kStallCauseCount; ++c)
    stalls.Add({.key = std::string(StallCauseName(StallCause(c))),
                .show = totals.stall_cycles[c] ? Show::kBoth : Show::kJson},
               totals.stall_cycles[c]);
  ReportTree& unpaired = tree.AddSection("unpaired");
  for (uint32_t u = 0; u < kUnpairedCount; ++u)
    unpaired.Add(InJson(std::string(UnpairedName(Unpaired(u)))), totals.unpaired[u]);
  tree.Add({"binds"}, BindingResource(chart, totals));
}

void AddLoop(const Listing& listing, const IssueChart& chart, const LoopTiming& loop,
             uint64_t clock_hz, ReportTree& tree) {
  tree.BlankLine();
  tree.Add({"loop"}, LabelAt(listing, loop.head)).Add({"iterations"}, loop.iterations);
  tree.Add({"iterations_assumed", "", -1, "assumed"}, loop.iterations_assumed);
  tree.Add(InJson("steady"), loop.steady);
  if (!loop.steady) {
    tree.Say("over before its state came back");
    return;
  }
  const double ns = loop.CyclesPerIteration() * 1e9 / double(clock_hz);
  const double availability = CellSystem{}.Availability();
  tree.Add({"cycles_per_iteration"}, loop.CyclesPerIteration());
  tree.Add(InText(fmt::format("at {:.3f} GHz", double(clock_hz) * 1e-9), "ns", 2), ns);
  tree.Add(InText(fmt::format("with {} available", availability), "ns", 2), ns / availability);
  tree.Add(InJson("period_iterations"), loop.period_iterations);
  AddSlots(listing, chart, loop.slots, tree);
  AddTotals(chart, loop.period, tree.AddSection("period"));
}

ReportTree MakeTree(const Listing& listing, const IssueChart& chart, const TimingArgs& args,
                    uint64_t clock_hz) {
  ReportTree tree;
  tree.Say(fmt::format("{}: {} {} instructions{}", listing.name, listing.program.size(),
                       listing.set->name, args.pair_by_order ? ", paired by order" : ""));
  tree.Add(InJson("listing"), listing.name).Add(InJson("core"), args.core);
  tree.Add(InJson("clock_hz"), clock_hz).Add(InJson("pair_by_order"), args.pair_by_order);
  tree.Add(InJson("availability"), CellSystem{}.Availability());
  ReportTree& first = tree.AddSection("first_pass");
  first.BlankLine();
  first.Say("first pass");
  AddSlots(listing, chart, chart.first_pass, first);
  AddTotals(chart, chart.first_pass_totals, first.AddSection("totals"));
  tree.BeginList("loops");
  for (const LoopTiming& loop : chart.loops)
    AddLoop(listing, chart, loop, clock_hz, tree.AddEntry("loops"));
  tree.BlankLine();
  AddTotals(chart, chart.totals, tree.AddSection("totals", "in all"));
  ReportTable& registers = tree.AddTable("registers_live", {{"file", "", -1, "registers"},
                                                            {"most", "", -1, "live"},
                                                            {"limit", "", -1, "of"},
                                                            InText(" ")});
  for (const LiveRegisters& live : chart.live)
    registers.Add({live.file, live.most, live.limit, live.most > live.limit ? "does not fit" : ""});
  return tree;
}

// ---- Two threads

Listing ReadPpeListing(const std::string& path) {
  return ReadListing(ReadText(path), DisplayName(path), PpeInstructionSet()).OrThrow();
}

struct ThreadTime {
  const Listing* listing;
  std::string loop;
  double alone, beside;  // cycles per iteration
};

// The only loop of it, alone on the core.
ThreadTime TimeAlone(const Listing& listing) {
  const IssueChart chart = TimeOnPpe(listing.program, {}, {}, {}).OrThrow();
  if (chart.loops.size() != 1 || !chart.loops[0].steady)
    throw Error(fmt::format(
        "{}: {} loops that reach a steady state; a thread of two runs one for ever: give that loop",
        listing.name, chart.loops.size()));
  return {&listing, LabelAt(listing, chart.loops[0].head), chart.loops[0].CyclesPerIteration(),
          0.0};
}

ExitCode PrintThreadPair(const TimingArgs& args) {
  const Listing listings[] = {ReadPpeListing(args.path), ReadPpeListing(args.second_thread)};
  std::array<ThreadTime, 2> threads = {TimeAlone(listings[0]), TimeAlone(listings[1])};
  const PpePairTiming pair =
      TimePpePair({listings[0].program, listings[1].program}, PpeParameters{}).OrThrow();
  for (uint32_t t = 0; t < 2; ++t) threads[t].beside = pair.CyclesPerIteration(t);
  const uint64_t clock_hz = CellSystem{}.clock_hz;
  const double gained =
      threads[0].alone / threads[0].beside + threads[1].alone / threads[1].beside - 1.0;
  ReportTree tree;
  tree.Say(fmt::format("two threads of a PPE at {:.3f} GHz, each its loop for ever",
                       double(clock_hz) * 1e-9));
  tree.Add(InJson("core"), "ppe").Add(InJson("clock_hz"), clock_hz);
  tree.Add(InJson("period_cycles"), pair.period_cycles);
  ReportTable& table = tree.AddTable("threads", {{"listing"},
                                                 {"loop"},
                                                 {"cycles_per_iteration_alone", "", 2, "alone"},
                                                 {"cycles_per_iteration", "", 2},
                                                 InText("of its own rate", "%", 0)});
  for (const ThreadTime& thread : threads)
    table.Add({thread.listing->name, thread.loop, thread.alone, thread.beside,
               100.0 * thread.alone / thread.beside});
  tree.Add(InJson("gained"), gained);
  tree.Add(InText("both together", "times the work of one thread after the other", 2),
           1.0 + gained);
  tree.Print(args.json);
  return kDone;
}

}  // namespace

ExitCode PrintTiming(const TimingArgs& args) {
  if (!args.second_thread.empty()) return PrintThreadPair(args);
  const bool is_spu = args.core == "spu";
  const Listing listing = ReadListing(ReadText(args.path), DisplayName(args.path),
                                      is_spu ? SpuInstructionSet() : PpeInstructionSet())
                              .OrThrow();
  const IssueChart chart = Time(listing, args);
  MakeTree(listing, chart, args, CellSystem{}.clock_hz).Print(args.json);
  return kDone;
}

}  // namespace pelt
