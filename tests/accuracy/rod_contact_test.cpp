// Strands that touch something, or are blown at, against a rod that does: how far they rest from it, and how far
// they go other ways when struck.
#include "bench/accuracy/rod_contact.hpp"

#include <gtest/gtest.h>

#include <map>

#include "bench/accuracy/quantile.hpp"
#include "bench/accuracy/solver_checks.hpp"

namespace pelt::accuracy {
namespace {

const RestCurve kLevel{kZero3, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 0.0};

double Median(const std::vector<double>& values) { return 100.0 * Quantile(values, 0.5); }
double Worst(const std::vector<double>& values) { return 100.0 * Quantile(values, 1.0); }

// ---- The rod ---------------------------------------------------------------------------------

TEST(RodReference, HangsAsTheElasticaAndConverges) {
  for (const double gamma : {3.0, 30.0, 100.0}) {
    const Sag sag = SolveElastica(gamma);
    const auto off = [&](int links) {
      const RodShape rod = FindRest({kLevel, {0.0, -gamma, 0.0}}, links);
      EXPECT_TRUE(rod.rests);
      return Length(rod.point.back() - Double3{sag.reach, -sag.drop, 0.0});
    };
    const double coarse = off(12), fine = off(24);
    EXPECT_LT(fine, 0.005) << gamma;
    EXPECT_LT(fine, 0.4 * coarse) << gamma;
  }
}

// Its tip lifted a little and let go, it swings at the first frequency.
TEST(RodReference, SwingsAsARod) {
  constexpr double kStep = 1e-3, kLoad = 1e-3, kLift = 0.02;
  constexpr int kLiftSteps = 4000;
  const double period = 2.0 * exact::kPi / kRodFrequency1;
  const auto below_tip = [](double height) {
    return std::vector<RodWall>{[=](double s, Double3 x) -> WallGap {
      return {s > 0.99 ? x.y - height : 1.0, {0.0, 1.0, 0.0}, 0.0};
    }};
  };
  const std::vector<RodWall> gone = below_tip(-1.0);
  RodMotion motion({kLevel, {0.0, -kLoad, 0.0}, gone}, {0.0, 0.0}, 12, kStep);
  for (int i = 1; i <= kLiftSteps; ++i) motion.Step(below_tip(kLift * i / kLiftSteps));
  EXPECT_NEAR(motion.Shape().point.back().y, kLift, 1e-4);
  std::vector<double> falls;
  double last = 0.0;
  for (int step = 0; step < int(3.5 * period / kStep); ++step) {
    motion.Step(gone);
    const double now = motion.Shape().point.back().y + kLoad / 8.0;
    if (last > 0.0 && now <= 0.0) falls.push_back(step * kStep);
    last = now;
  }
  ASSERT_GE(falls.size(), 3u);
  EXPECT_NEAR((falls.back() - falls.front()) / double(falls.size() - 1), period, 0.01 * period);
}

TEST(RodReference, StaysOutsideAndBearsItsWeight) {
  const double gamma = 12.0;
  const RodShape free = FindRest({kLevel, {0.0, -gamma, 0.0}}, 24);
  EXPECT_EQ(free.pushed, 0.0);
  const RodShape lies =
      FindRest({kLevel, {0.0, -gamma, 0.0}, {OutsideBall({0.55, -0.33, 0.0}, 0.3)}}, 24);
  EXPECT_TRUE(lies.rests);
  EXPECT_LT(lies.deepest, 1e-4);
  EXPECT_GT(lies.pushed, 0.5 * gamma);
  EXPECT_GT(lies.point.back().y, free.point.back().y + 0.2);
}

// ---- Rest ------------------------------------------------------------------------------------

// Those of rods are of 48 links in the comments, of fewer here: a median differs by up to 0.1.
RestErrorTable Measure(const std::vector<RestScene>& scenes, RestErrorOptions options) {
  options.links = 24;
  return MeasureRest(scenes, BestIsa(), options);
}

void Print(const RestErrorTable& table) {
  for (const RestErrorRow& row : table.rows)
    std::printf("%s, %s, quality %d: median %.2f, worst %.2f %% of the length; %.1e lengths/s\n",
                row.scene.c_str(), row.model.c_str(), int(row.quality), Median(row.errors),
                Worst(row.errors), row.speed);
}

// Per cent of the length, median over the cases, any quality; 3 nodes are wanted at 4, 2 and 1.
struct MostOff {
  double ball_15, ball_30, ball_60;
};

TEST(RodContact, StrandsLieOverABallAsARodDoes) {
  // Three nodes miss the 1 that is wanted of the ball of .60: 1.2 in `fast`, 1.1 else. Links, the rivals, are 1.8 to
  // 1.9, 1.2 to 1.3 and 2.4 to 2.5 off (3 links), 0.8, 0.8 to 0.9 and 1.4 to 1.7 (4 links).
  // Not held: that drawn points lie still. Where a point of 4 or 8 parts lies on the ball, stiff tips jump by up to
  // 1.6 % of the length from frame to frame, links' too.
  const std::map<std::string, MostOff> most = {{"3 nodes", {1.5, 2.0, 1.5}},
                                               {"4 nodes", {1.2, 1.0, 0.8}},
                                               {"4 nodes, 9 points", {0.9, 0.6, 0.8}}};
  const RestErrorTable table = Measure(BallScenes(), {.seconds = 3.0});
  Print(table);
  std::map<std::string, double> sum;
  for (const RestErrorRow& row : table.rows) {
    sum[row.model] += Median(row.errors);
    EXPECT_GE(row.errors.size(), 12u) << row.scene;
    const auto limits = most.find(row.model);
    if (limits == most.end()) continue;
    const double limit = row.scene == "0.15 ball"   ? limits->second.ball_15
                         : row.scene == "0.30 ball" ? limits->second.ball_30
                                                    : limits->second.ball_60;
    EXPECT_LT(Median(row.errors), limit) << row.scene << ", " << row.model;
  }
  EXPECT_LT(sum["3 nodes"], sum["3 links"]);
  EXPECT_LT(sum["4 nodes"], sum["4 links"]);
  for (const std::vector<double>& self : table.self_errors) {
    std::printf("a rod of half the links: median %.2f, worst %.2f %%\n", Median(self), Worst(self));
    EXPECT_LT(Median(self), 0.7);
  }
}

TEST(RodContact, FrictionLimitsAndWindHoldStrandsAsARod) {
  // Per cent, worst case, of 3 and of 4 nodes.
  const std::map<std::string, std::pair<double, double>> most = {
      {"ground, friction", {2.5, 1.0}}, {"limit", {0.4, 0.2}},        {"wind, dangly", {1.5, 1.0}},
      {"wind, soft", {0.9, 0.4}},       {"wind, medium", {0.4, 0.2}}, {"wind, stiff", {0.2, 0.1}}};
  RestErrorOptions options{.seconds = 5.0, .dropped = true};
  options.models.resize(2);
  const RestErrorTable table = Measure(OtherRestScenes(), options);
  Print(table);
  for (const RestErrorRow& row : table.rows) {
    const auto& limits = most.at(row.scene);
    EXPECT_GE(row.errors.size(), 2u) << row.scene;
    EXPECT_LT(Worst(row.errors), row.model == "3 nodes" ? limits.first : limits.second)
        << row.scene << ", " << row.model;
    EXPECT_LT(row.speed, 5e-3) << row.scene << ", " << row.model;
  }
}

// ---- Strikes ---------------------------------------------------------------------------------

TEST(RodStrike, StrandsFlyAsAStruckRod) {
  StrikeOptions options;
  options.links = 12;
  options.steps_per_second = 7680;
  options.rates = {60, 240};
  std::vector<StrikeCase> cases;
  // The well-posed ones: of what is struck at its middle or is dangly, half the steps change up to 28 %.
  for (const StrikeCase& c : StrikeCases())
    if (c.at > 0.7 && c.preset.name != "dangly") cases.push_back(c);
  const StrikeErrorTable table = MeasureStrikes(cases, BestIsa(), options);
  std::printf("half the steps: %.1f, three quarters of the links: %.1f %%\n",
              Worst(table.step_errors), Worst(table.link_errors));
  EXPECT_LT(Median(table.step_errors), 5.0);
  EXPECT_LT(Median(table.link_errors), 5.0);
  std::map<std::string, double> sum;
  for (size_t i = 0; i < table.rows.size(); ++i) {
    const StrikeErrorRow& row = table.rows[i];
    std::printf("%s, quality %d, %d Hz: median %.1f, worst %.1f %% of the way\n", row.model.c_str(),
                int(row.quality), row.rate, Median(row.errors), Worst(row.errors));
    sum[row.model] += Median(row.errors);
    // In every quality, of a ball of 0.5 m/s too, which substeps alone are 4 to 10 % off.
    if (row.model.find("nodes") != std::string::npos) {
      EXPECT_LT(Worst(row.errors), row.model == "3 nodes" ? 11.0 : 7.5) << row.model;
    }
    if (row.rate == options.rates[0]) continue;
    EXPECT_LT(Median(row.errors), Median(table.rows[i - 1].errors) + 0.5)
        << "more frames, " << row.model;
  }
  EXPECT_LT(sum["3 nodes"], sum["3 links"]);
  EXPECT_LT(sum["4 nodes"], sum["4 links"]);
}

}  // namespace
}  // namespace pelt::accuracy
