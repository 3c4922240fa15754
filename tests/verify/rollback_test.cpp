// What is kept over a rollback is found, and the stage named.
#include <gtest/gtest.h>

#include <mutex>
#include <set>

#include "tests/jobs/tiny_scene.hpp"
#include "tests/verify/planting.hpp"

namespace pelt::testing {
namespace {

VerifyReport RunRollback(const Scenario& scenario, Tamper tamper = {}) {
  VerifyOptions options = NoCases(8);
  options.checks = true;
  options.sections = {"rollback"};
  options.tamper = std::move(tamper);
  return Verify(scenario, options);
}

TEST(VerifyRollback, AHealthySceneGoesBackUnderEveryExecutor) {
  Scenario scenario = EveryOutputScenario();
  scenario.velocities = scenario.origins = true;
  const VerifyReport report = RunRollback(scenario);
  EXPECT_TRUE(report.Passed()) << DescribeReport(report);
  uint32_t executors = 0;
  for (const ExecutorEntry& entry : ExecutorEntries()) executors += entry.IsAvailable();
  const auto checks = ChecksOf(report, "rollback");
  EXPECT_EQ(checks.size(), 2 * executors);
  for (const CheckResult& c : checks) EXPECT_GT(c.seen, 20u) << c.name;
}

// A kernel that knows a place again moves it: right as long as time goes on.
std::mutex mutex;
std::set<std::pair<const void*, float>> places;

TEST(VerifyRollback, AKernelThatRemembersIsNamed) {
  places.clear();
  const VerifyReport report =
      RunRollback(Tiny(), Planting("roots", [](const void* params, const Binding* bindings) {
                    healthy.run(params, bindings);
                    const auto* vertex =
                        healthy.FirstListed<SkinnedVertex>(bindings, StreamOf<&Streams::skinned>);
                    auto* roots = healthy.As<RootBlock>(bindings, StreamOf<&Streams::roots>);
                    const std::lock_guard lock(mutex);
                    if (!places.emplace(roots, vertex->position[0]).second)
                      roots->position[0][0] += 1.0e-3f;
                  }));
  const auto checks = ChecksOf(report, "rollback");
  EXPECT_TRUE(std::any_of(checks.begin(), checks.end(), [](const CheckResult& c) {
    return !c.passed && c.kind == FindingKind::kRollback && c.stage == "roots";
  })) << DescribeReport(report);
}

}  // namespace
}  // namespace pelt::testing
