#include "bench/verify/checks.hpp"

#include <algorithm>

#include "bench/verify/verified_scene.hpp"

namespace pelt {

Mismatch Locate(CaseRun expected, CaseRun found, uint32_t frame, bool bookkeeping) {
  for (uint32_t f = 0; f <= frame; ++f) {
    expected.RunFrame(f);
    found.RunFrame(f);
    if (auto mismatch = FindMismatch(expected, found, f, bookkeeping)) return *mismatch;
  }
  Mismatch unknown;
  unknown.frame = frame;
  unknown.reproduced = false;
  return unknown;
}

std::optional<Finding> FindUndeclared(Scenario& scenario, const VerifyCase& what,
                                      const VerifyOptions& options, uint32_t frame) {
  VerifyCase guarded = what;
  guarded.executor = "guarded";
  if (!guarded.executor->IsAvailable() || what.executor == guarded.executor) return {};
  guarded.odd_floats = false;
  CaseRun run(scenario, guarded, FrameSettingsOf(what.settings, scenario), {});
  // As the case has it: what is planted there is planted here.
  if (options.tamper) options.tamper(what, run.tampered_plan());
  for (uint32_t f = 0; f <= frame; ++f) run.RunFrame(f);
  const std::vector<Finding> findings = run.executor().Findings();
  return findings.empty() ? std::nullopt : std::optional<Finding>(findings.front());
}

namespace {

struct CheckSection {
  std::string_view name;
  void (*run)(Scenario&, const VerifyOptions&, VerifyReport&);
  bool with_everything = true;
};
constexpr CheckSection kSections[] = {
    {"course", CheckWholeCourse},   {"access", CheckAccessAtRest},
    {"waking", CheckWaking, false}, {"waking of all", CheckWakingOfAll},
    {"culling", CheckCulling},      {"rollback", CheckRollback},
    {"digest", CheckDigests}};

}  // namespace

void RunChecks(Scenario& scenario, const VerifyOptions& options, VerifyReport& report) {
  const auto& only = options.sections;
  Scenario whole = WithEverything(scenario);
  for (const CheckSection& section : kSections) {
    if (!only.empty() && std::find(only.begin(), only.end(), section.name) == only.end()) continue;
    if (!TakesNext(options, report)) continue;
    if (options.progress) options.progress(0, 0, std::string(section.name));
    const size_t first = report.checks.size();
    section.run(section.with_everything ? whole : scenario, options, report);
    for (size_t c = first; c < report.checks.size(); ++c)
      report.checks[c].place = report.places - 1;
  }
}

}  // namespace pelt
