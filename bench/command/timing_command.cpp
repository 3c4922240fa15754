// `pelt timing`: an instruction listing through a core model, as a chart.
#include <fmt/format.h>

#include <array>
#include <cstdio>

#include "bench/command/commands.hpp"
#include "bench/command/usage_error.hpp"
#include "bench/report/json_text.hpp"
#include "core/file_bytes.hpp"
#include "core/printable.hpp"
#include "platform_sim/pipeline/issue_walk.hpp"
#include "platform_sim/pipeline/listing.hpp"
#include "platform_sim/pipeline/ppe_core.hpp"
#include "platform_sim/pipeline/ppe_pair.hpp"
#include "platform_sim/pipeline/spu_core.hpp"
#include "platform_sim/platforms/cell_system.hpp"

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

void PrintSlots(const Listing& listing, const IssueChart& chart,
                const std::vector<IssueSlot>& slots) {
  fmt::print("{:>8}  {:<11} {:>6}  {:<30}  {}\n", "cycle", "pipe", "line", "instruction",
             "cycles waited for");
  for (const IssueSlot& slot : slots) {
    const bool paired = slot.unpaired == Unpaired::kPaired;
    std::string line =
        fmt::format("{:>8}  {:<11} {:>6}  {:<30}  {}", paired ? "+" : fmt::format("{}", slot.cycle),
                    chart.pipes[slot.pipe], listing.line[slot.instruction],
                    Printable(listing.text[slot.instruction]), DescribeStalls(listing, slot));
    line.erase(line.find_last_not_of(' ') + 1);
    fmt::print("{}\n", line);
  }
}

void PrintTotals(const IssueChart& chart, const IssueTotals& totals) {
  fmt::print("  {} instructions in {} cycles; two at once in {} of {} issuing cycles ({:.1f} %)\n",
             totals.instructions, totals.cycles, totals.dual_issues, totals.IssueCycles(),
             100.0 * totals.DualIssueRate());
  fmt::print("  busy:");
  for (size_t p = 0; p < chart.pipes.size(); ++p)
    fmt::print("{} {} {}", p ? "," : "", chart.pipes[p], totals.pipe_cycles[p]);
  fmt::print("\n  stalls: {}", totals.AllStallCycles());
  for (uint32_t c = 0; c < kStallCauseCount; ++c)
    if (totals.stall_cycles[c])
      fmt::print(", {} {}", StallCauseName(StallCause(c)), totals.stall_cycles[c]);
  fmt::print("\n  binds: {}\n", BindingResource(chart, totals));
}

void PrintLoop(const Listing& listing, const IssueChart& chart, const LoopTiming& loop,
               uint64_t clock_hz) {
  const std::string name = LabelAt(listing, loop.head);
  if (!loop.steady) {
    fmt::print("\nloop {}: {} iterations, over before its state came back\n", name, loop.iterations);
    return;
  }
  const double ns = loop.CyclesPerIteration() * 1e9 / double(clock_hz);
  fmt::print("\nloop {}: {} cycles an iteration = {:.2f} ns at {:.3f} GHz", name, loop.CyclesPerIteration(),
             ns, double(clock_hz) * 1e-9);
  const double availability = CellSystem{}.Availability();
  fmt::print(", {:.2f} ns with {} available", ns / availability, availability);
  fmt::print("; {}{} iterations\n", loop.iterations, loop.iterations_assumed ? " (assumed)" : "");
  PrintSlots(listing, chart, loop.slots);
  PrintTotals(chart, loop.period);
}

void PrintChart(const Listing& listing, const IssueChart& chart, const TimingArgs& args,
                uint64_t clock_hz) {
  fmt::print("{}: {} {} instructions{}\n", listing.name, listing.program.size(), listing.set->name,
             args.pair_by_order ? ", paired by order" : "");
  fmt::print("\nfirst pass\n");
  PrintSlots(listing, chart, chart.first_pass);
  PrintTotals(chart, chart.first_pass_totals);
  for (const LoopTiming& loop : chart.loops) PrintLoop(listing, chart, loop, clock_hz);
  fmt::print("\nin all\n");
  PrintTotals(chart, chart.totals);
  for (const LiveRegisters& live : chart.live)
    fmt::print("  {} registers live: at most {} of {}{}\n", live.file, live.most, live.limit,
               live.most > live.limit ? ": does not fit" : "");
}

void AddTotals(JsonText& json, std::string_view key, const IssueChart& chart,
               const IssueTotals& totals) {
  json.BeginObject(key);
  json.Add("cycles", totals.cycles);
  json.Add("instructions", totals.instructions);
  json.Add("dual_issues", totals.dual_issues);
  json.BeginObject("busy_cycles");
  for (size_t p = 0; p < chart.pipes.size(); ++p) json.Add(chart.pipes[p], totals.pipe_cycles[p]);
  json.EndObject();
  json.BeginObject("stall_cycles");
  for (uint32_t c = 0; c < kStallCauseCount; ++c)
    json.Add(StallCauseName(StallCause(c)), totals.stall_cycles[c]);
  json.EndObject();
  json.BeginObject("unpaired");
  for (uint32_t u = 0; u < kUnpairedCount; ++u)
    json.Add(UnpairedName(Unpaired(u)), totals.unpaired[u]);
  json.EndObject();
  json.Add("binds", BindingResource(chart, totals));
  json.EndObject();
}

void AddSlots(JsonText& json, const Listing& listing, const IssueChart& chart,
              const std::vector<IssueSlot>& slots) {
  json.BeginArray("issues");
  for (const IssueSlot& slot : slots) {
    json.BeginObject();
    json.Add("cycle", slot.cycle);
    json.Add("pipe", chart.pipes[slot.pipe]);
    json.Add("paired", slot.unpaired == Unpaired::kPaired);
    json.Add("line", listing.line[slot.instruction]);
    json.Add("instruction", listing.text[slot.instruction]);
    json.Add("waited", DescribeStalls(listing, slot));
    json.EndObject();
  }
  json.EndArray();
}

std::string ChartAsJson(const Listing& listing, const IssueChart& chart, const TimingArgs& args,
                        uint64_t clock_hz) {
  JsonText json;
  json.BeginObject();
  json.Add("listing", listing.name);
  json.Add("core", args.core);
  json.Add("clock_hz", clock_hz);
  json.Add("pair_by_order", args.pair_by_order);
  json.Add("availability", CellSystem{}.Availability());
  json.BeginObject("first_pass");
  AddSlots(json, listing, chart, chart.first_pass);
  AddTotals(json, "totals", chart, chart.first_pass_totals);
  json.EndObject();
  json.BeginArray("loops");
  for (const LoopTiming& loop : chart.loops) {
    json.BeginObject();
    json.Add("loop", LabelAt(listing, loop.head));
    json.Add("iterations", loop.iterations);
    json.Add("iterations_assumed", loop.iterations_assumed);
    json.Add("steady", loop.steady);
    if (loop.steady) {
      json.Add("cycles_per_iteration", loop.CyclesPerIteration());
      json.Add("period_iterations", loop.period_iterations);
      AddSlots(json, listing, chart, loop.slots);
      AddTotals(json, "period", chart, loop.period);
    }
    json.EndObject();
  }
  json.EndArray();
  AddTotals(json, "totals", chart, chart.totals);
  json.BeginArray("registers_live");
  for (const LiveRegisters& live : chart.live) {
    json.BeginObject();
    json.Add("file", live.file);
    json.Add("most", live.most);
    json.Add("limit", live.limit);
    json.EndObject();
  }
  json.EndArray();
  json.EndObject();
  return json.text();
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

int PrintThreadPair(const TimingArgs& args) {
  const Listing listings[] = {ReadPpeListing(args.path), ReadPpeListing(args.second_thread)};
  std::array<ThreadTime, 2> threads = {TimeAlone(listings[0]), TimeAlone(listings[1])};
  const PpePairTiming pair =
      TimePpePair({listings[0].program, listings[1].program}, PpeParameters{}).OrThrow();
  for (uint32_t t = 0; t < 2; ++t) threads[t].beside = pair.CyclesPerIteration(t);
  const uint64_t clock_hz = CellSystem{}.clock_hz;
  const double gained =
      threads[0].alone / threads[0].beside + threads[1].alone / threads[1].beside - 1.0;
  if (args.json) {
    JsonText json;
    json.BeginObject();
    json.Add("core", "ppe");
    json.Add("clock_hz", clock_hz);
    json.Add("period_cycles", pair.period_cycles);
    json.BeginArray("threads");
    for (const ThreadTime& thread : threads) {
      json.BeginObject();
      json.Add("listing", thread.listing->name);
      json.Add("loop", thread.loop);
      json.Add("cycles_per_iteration_alone", thread.alone);
      json.Add("cycles_per_iteration", thread.beside);
      json.EndObject();
    }
    json.EndArray();
    json.Add("gained", gained);
    json.EndObject();
    fmt::print("{}\n", json.text());
    return 0;
  }
  fmt::print("two threads of a PPE at {:.3f} GHz, each its loop for ever\n",
             double(clock_hz) * 1e-9);
  for (const ThreadTime& thread : threads)
    fmt::print("{} {}: {:.2f} cycles an iteration, {:.2f} alone: {:.0f} % of its own rate\n",
               thread.listing->name, thread.loop, thread.beside, thread.alone,
               100.0 * thread.alone / thread.beside);
  fmt::print("both together: {:.2f} times the work of one thread after the other\n", 1.0 + gained);
  return 0;
}

}  // namespace

int PrintTiming(const TimingArgs& args) {
  if (!args.second_thread.empty()) return PrintThreadPair(args);
  const bool is_spu = args.core == "spu";
  const Listing listing = ReadListing(ReadText(args.path), DisplayName(args.path),
                                      is_spu ? SpuInstructionSet() : PpeInstructionSet())
                              .OrThrow();
  const IssueChart chart = Time(listing, args);
  const uint64_t clock_hz = CellSystem{}.clock_hz;
  if (args.json)
    fmt::print("{}\n", ChartAsJson(listing, chart, args, clock_hz));
  else
    PrintChart(listing, chart, args, clock_hz);
  return 0;
}

}  // namespace pelt
