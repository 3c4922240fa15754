// The options of `pelt compare`.
#include <memory>

#include "bench/command/command_options.hpp"
#include "bench/command/usage_error.hpp"

namespace pelt {
namespace {

void CheckWays(const CLI::App& app, const CompareArgs& args) {
  if (!args.commands.empty()) return RefuseBeside(app, "--commands", {"left", "right"});
  if (args.right.empty())
    throw UsageError("two files of pelt run --json, or --commands with two commands, are required");
}

}  // namespace

Subcommand SetUpCompare(CLI::App& root) {
  const auto kept = std::make_shared<CompareArgs>();
  CompareArgs& args = *kept;
  auto* app = root.add_subcommand("compare",
                                  "Two runs: what each stage costs in the one against the other, "
                                  "and how sure that is. Exit code 2 "
                                  "when it is UNSURE: others used the machine meanwhile");
  AddInputFile(*app, "left", args.left, "A: what pelt run --json printed");
  AddInputFile(*app, "right", args.right, "B: the same of another commit, setup or option");
  auto* commands =
      app->add_option("--commands", args.commands,
                      "Instead: two commands that print such, for the shell, run alternately");
  commands->expected(2)->type_name("TEXT TEXT");
  app->add_option("--rounds", args.rounds, "With --commands: how often each runs")
      ->needs(commands)
      ->check(CLI::Range(6, 1000))
      ->capture_default_str();
  AddOutputFile(*app, "--page", args.page,
                "HTML page to write with both side by side: frames, costs, what differs");
  app->add_flag("--json", args.json, "Machine-readable output");
  app->footer(
      "Examples:\n"
      "  pelt compare a.json b.json\n"
      "  pelt compare a.json b.json --json\n"
      "  pelt compare a.json b.json --page two.html\n"
      "  pelt compare --rounds 12 --commands 'pelt run --scene tiny --frames 30 --json' "
      "'pelt run --scene tiny --frames 30 --no-cull --json'");
  return {app, [app, kept] { CheckWays(*app, *kept); }, [kept] { return Compare(*kept); }};
}

}  // namespace pelt
