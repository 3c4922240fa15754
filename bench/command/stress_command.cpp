// `pelt stress`: problems no solver should come out of with a NaN, a stretched hair or a strand
// that never settles, for several solvers, frame rates and instruction sets.
//
// Our modal solver promises three things on every row: every value finite, links within
// kMostPromisedStretch of their length, every strand at rest in the end. Exit code 1 says that a
// promise was broken, or that an instruction set gave other results than the first. The other
// solvers' figures are shown, not judged.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "bench/accuracy/named_solver.hpp"
#include "bench/accuracy/stress.hpp"
#include "bench/command/commands.hpp"
#include "bench/command/progress.hpp"
#include "bench/report/machine.hpp"
#include "core/error.hpp"
#include "core/groom/nearest_word.hpp"

namespace pelt {

using namespace accuracy;

namespace {

constexpr std::string_view kUsualSolvers[] = {"modal",   "modal-fine",  "modal-best",
                                              "pbd",     "verlet",      "xpbd-8",
                                              "euler-1", "trapezoid-2", "trapezoid-4"};

struct StressRow {
  int links;
  std::string problem;
  int frames_per_second;
  size_t strands;
  NamedSolver solver;
  StressResult result;          // on the first instruction set
  std::vector<Isa> other_bits;  // sets that gave another result

  bool Promised() const { return solver.family == Family::kModal; }
  // What it broke, for people; empty: nothing.
  std::string Broken() const {
    std::vector<std::string> broken;
    if (Promised()) broken = BrokenPromises(result);
    for (const Isa isa : other_bits) broken.push_back(fmt::format("other on {}", IsaName(isa)));
    return fmt::format("{}", fmt::join(broken, ", "));
  }
};

bool SameResult(const StressResult& a, const StressResult& b) {
  return a.ran == b.ran && a.non_finite == b.non_finite && a.worst_stretch == b.worst_stretch &&
         a.unsettled == b.unsettled && a.stuck == b.stuck &&
         a.worst_off_balance == b.worst_off_balance && a.recovery_seconds == b.recovery_seconds;
}

std::vector<NamedSolver> SolversOf(const StressArgs& args) {
  std::vector<NamedSolver> solvers;
  const auto add = [&](std::string_view name) {
    std::optional<NamedSolver> solver = FindSolver(name);
    if (!solver)
      throw Error(fmt::format("--solvers {}: no such solver; there are {}{}", name, SolverNames(),
                              DidYouMean(name, SolverStems())));
    solvers.push_back(*std::move(solver));
  };
  if (args.solvers.empty())
    for (const std::string_view name : kUsualSolvers) add(name);
  for (const std::string& name : args.solvers) add(name);
  // Who was named runs on every row; of the usual ones those that can.
  if (!args.solvers.empty())
    for (const NamedSolver& solver : solvers)
      for (const int links : args.links)
        if (!RunsParts(solver, links))
          throw Error(fmt::format("--solvers {} --links {}: {}", solver.name, links,
                                  WhyNotLinks(solver, links)));
  return solvers;
}

// The widest first: its figures are the ones that are shown.
std::vector<Isa> IsasOf(const StressArgs& args) {
  std::vector<Isa> isas = args.isas;
  if (isas.empty())
    for (const Isa isa : kAllIsas)
      if (FindKernels(isa)) isas.insert(isas.begin(), isa);
  for (const Isa isa : isas)
    if (!FindKernels(isa))
      throw Error(fmt::format("no {} kernels in this program or processor", IsaName(isa)));
  return isas;
}

std::vector<StressProblem> ProblemsOf(const StressArgs& args) {
  std::vector<StressProblem> problems;
  std::vector<int> links = args.links;
  if (links.empty()) links = {3, 4};
  for (const int n : links) {
    StressOptions options{.links = n, .calibrated = true};
    if (args.quick) {
      options.random_starts = 80;
      options.frame_rates = {15, 60, 240};
    }
    if (!args.rates.empty()) options.frame_rates = args.rates;
    for (StressProblem& problem : StressProblems(options)) problems.push_back(std::move(problem));
  }
  return problems;
}

std::vector<StressRow> RunAll(const StressArgs& args, const std::vector<Isa>& isas) {
  const std::vector<NamedSolver> solvers = SolversOf(args);
  const std::vector<StressProblem> problems = ProblemsOf(args);
  std::vector<StressRow> rows;
  size_t count = 0;
  for (const StressProblem& problem : problems)
    for (const NamedSolver& solver : solvers) count += RunsParts(solver, problem.material.links);
  Progress progress("stress", count);
  for (const StressProblem& problem : problems)
    for (const NamedSolver& solver : solvers) {
      if (!RunsParts(solver, problem.material.links)) continue;
      progress.Show(rows.size(), problem.name);
      StressRow row{
          problem.material.links,
          problem.name,
          problem.frames_per_second,
          problem.strands.size(),
          solver,
          RunStress(problem, LayerFactoryOf(solver, isas[0]), solver.family != Family::kModal),
          {}};
      for (size_t i = 1; i < isas.size(); ++i)
        if (!SameResult(RunStress(problem, LayerFactoryOf(solver, isas[i]),
                                  solver.family != Family::kModal),
                        row.result))
          row.other_bits.push_back(isas[i]);
      rows.push_back(std::move(row));
    }
  return rows;
}

void AddRows(const std::vector<StressRow>& rows, ReportTree& tree) {
  ReportTable& table = tree.AddTable("rows", {{"problem"},
                                              {"links"},
                                              {"rate", "Hz"},
                                              {"strands"},
                                              {"solver"},
                                              {"stretch", "", -2},
                                              {"not_finite", "finite", -1, "not"},
                                              {"unsettled", "settled", -1, "not"},
                                              {"stuck"},
                                              InJson("off_balance"),
                                              {"recovery_s", "very, s", 2, "reco-"},
                                              InJson("promised"),
                                              InJson("broken")});
  std::vector<std::string> broken;
  for (const StressRow& row : rows) {
    table.Add({row.problem, row.links, row.frames_per_second, row.strands, row.solver.name,
               row.result.worst_stretch, row.result.non_finite, row.result.unsettled,
               row.result.stuck, row.result.worst_off_balance, row.result.recovery_seconds,
               row.Promised(), row.Broken()});
    if (!row.Broken().empty())
      broken.push_back(fmt::format("{}, {} links, {} Hz, {}: {}", row.problem, row.links,
                                   row.frames_per_second, row.solver.name, row.Broken()));
  }
  tree.BlankLine();
  tree.AddTexts({}, broken, "BROKEN");
}

struct SceneRow {
  SceneStressResult result;     // on the first instruction set
  std::vector<Isa> other_bits;  // sets that gave another result

  std::string Broken() const {
    std::vector<std::string> broken = BrokenPromises(result);
    for (const Isa isa : other_bits) broken.push_back(fmt::format("other on {}", IsaName(isa)));
    return fmt::format("{}", fmt::join(broken, ", "));
  }
};

// Not of solvers that were asked for by name: the scene's is our modal one.
std::vector<SceneRow> RunScenes(const StressArgs& args, const std::vector<Isa>& isas) {
  std::vector<SceneRow> rows;
  if (!args.solvers.empty()) return rows;
  for (SceneStressResult& result : RunSceneStress(isas[0])) rows.push_back({std::move(result), {}});
  for (size_t i = 1; i < isas.size(); ++i) {
    const std::vector<SceneStressResult> other = RunSceneStress(isas[i]);
    for (size_t r = 0; r < rows.size(); ++r)
      if (!(other[r] == rows[r].result)) rows[r].other_bits.push_back(isas[i]);
  }
  return rows;
}

// Shares of the strands' lengths; not a number where there is nothing to compare with.
double ShareOf(const std::optional<double>& value) {
  return value.value_or(std::numeric_limits<double>::quiet_NaN());
}

void AddScenes(const std::vector<SceneRow>& rows, ReportTree& tree) {
  if (rows.empty()) return;
  tree.BlankLine();
  tree.Say(
      "Scene tiny, modal. Apart: from the same scene as it should have been (the hitch stepped "
      "through, at home, of its size from the start), over the half second from the disturbance "
      "on, RMS, in lengths; rigid: of strands that are not simulated; rests: what 99 % of the "
      "points "
      "are within when all is at rest.");
  ReportTable& table = tree.AddTable("scenes", {{"problem"},
                                                {"strands"},
                                                {"stretch", "", -2},
                                                {"not_finite", "finite", -1, "not"},
                                                {"unsettled", "settled", -1, "not"},
                                                {"apart", "", -2},
                                                {"rigid_apart", "rigid", -2},
                                                {"rests_apart", "rests", -2},
                                                InJson("promised"),
                                                InJson("broken")});
  std::vector<std::string> broken;
  for (const SceneRow& row : rows) {
    const SceneStressResult& r = row.result;
    table.Add({r.name, r.strands, r.worst_stretch, r.non_finite, r.unsettled, ShareOf(r.apart),
               ShareOf(r.rigid_apart), ShareOf(r.apart_at_end), r.promised, row.Broken()});
    if (!row.Broken().empty()) broken.push_back(fmt::format("{}: {}", r.name, row.Broken()));
  }
  tree.BlankLine();
  tree.AddTexts({}, broken, "BROKEN");
}

ReportTree MakeTree(const std::vector<StressRow>& rows, const std::vector<SceneRow>& scenes,
                    const std::vector<Isa>& isas, size_t broken) {
  ReportTree tree;
  tree.Say(
      "Stretch: the worst of any link, over its length. Unsettled: strands that still move "
      "at the end. Stuck: at rest, but with a link off balance by more than 0.1 rad "
      "(position-based solvers by design). Recovery: until all strands stay within 1 % of "
      "their length of where they end.");
  AddRows(rows, tree);
  AddScenes(scenes, tree);
  std::vector<std::string_view> names;
  for (const Isa isa : isas) names.push_back(IsaName(isa));
  tree.Add({"isas", "", -1, "instruction sets"}, names);
  tree.Say("figures are the first's, the others' were compared with them");
  AddMachine(DescribeMachine(), tree);
  tree.Add(InJson("broken"), broken);
  tree.Say(broken == 0
               ? std::string("KEPT: finite, within 1e-5 of its length, settled, the same "
                             "on every instruction set")
               : fmt::format("BROKEN in {} of {} rows", broken, rows.size() + scenes.size()));
  return tree;
}

}  // namespace

ExitCode StressSolvers(const StressArgs& args) {
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<Isa> isas = IsasOf(args);
  const std::vector<StressRow> rows = RunAll(args, isas);
  const std::vector<SceneRow> scenes = RunScenes(args, isas);
  const auto is_broken = [](const auto& row) { return !row.Broken().empty(); };
  const auto broken = size_t(std::count_if(rows.begin(), rows.end(), is_broken) +
                             std::count_if(scenes.begin(), scenes.end(), is_broken));
  const ReportTree tree = MakeTree(rows, scenes, isas, broken);
  fmt::print("{}", tree.Text());
  if (!args.json.empty()) {
    WriteOutput("stress", args.json, tree.Json());
    fmt::print("json {}\n", args.json.path());
  }
  fmt::print("took {:.1f} s\n",
             std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  return AnswerOf(broken == 0);
}

}  // namespace pelt
