#include "bench/accuracy/fixed_problems.hpp"

#include <cmath>
#include <limits>

#include "bench/accuracy/solver_run.hpp"
#include "core/exact_math.hpp"

namespace pelt::accuracy {
namespace {

constexpr const Preset& kMedium = kPresets[2];

FixedProblem Release(int links, std::vector<FixedValue> tip) {
  FixedProblem fixed{links == 3 ? "release, 3 links" : "release, 4 links", {}, 1e-10, tip};
  fixed.problem.material = MakeMaterial(kMedium, links);
  fixed.problem.strand.root = kZero3;
  for (Double3& rest : fixed.problem.strand.rest) rest = {1.0, 0.0, 0.0};
  fixed.problem.start = fixed.problem.strand.rest;
  return fixed;
}

FixedProblem HangingChain() {
  FixedProblem fixed{"hanging chain, moving root",
                     {},
                     1e-10,
                     {{0.5, {0.0995866346, -0.0576332707, 0.0120291245}},
                      {1.0, {0.0794080094, 0.0116080578, -0.0193215638}},
                      {1.5, {0.1115231396, 0.0096630783, -0.0362345470}}}};
  ChainMaterial& material = fixed.problem.material;
  material.links = 3;
  for (int i = 0; i < 3; ++i) {
    material.length[i] = 0.02;
    material.mass[i] = 1.0 / 3.0;
  }
  material.drag = 2.0;
  fixed.problem.motion = MotionOf(Motion::kHeadshake);
  fixed.problem.strand.root = {0.1, 0.0, 0.0};
  for (Double3& rest : fixed.problem.strand.rest) rest = {0.0, -1.0, 0.0};
  fixed.problem.start = fixed.problem.strand.rest;
  return fixed;
}

FixedProblem CurledHeadshake(CurlModel curl, std::string_view name, std::vector<FixedValue> tip) {
  FixedProblem fixed{name, {}, 1e-10, tip};
  fixed.problem.material = MakeMaterial(kMedium, 3);
  fixed.problem.material.curl = curl;
  fixed.problem.motion = MotionOf(Motion::kHeadshake);
  fixed.problem.strand.root = {0.06, 0.08, 0.0};
  for (int i = 0; i < 3; ++i) {
    const double turn = 0.35 * i;
    fixed.problem.strand.rest[i] = {0.6 * exact::Cos(turn), 0.8 * exact::Cos(turn),
                                    exact::Sin(turn)};
  }
  fixed.problem.start = fixed.problem.strand.rest;
  return fixed;
}

}  // namespace

FixedProblem PendulumChallenge() {
  FixedProblem fixed{"pendulum challenge",
                     {},
                     1e-9,
                     {{0.25, {0.299996964, 0.295930466, 0.0}},
                      {0.5, {0.164739173, -0.763572898, 0.0}},
                      {0.75, {-0.171119732, -0.013671231, 0.0}},
                      {1.0, {-0.617362810, -0.086025600, 0.0}}}};
  ChainMaterial& material = fixed.problem.material;
  material.links = 3;
  material.gravity = {0.0, -10.0, 0.0};
  for (int i = 0; i < 3; ++i) {
    material.length[i] = 0.3;
    material.mass[i] = 1.0;
  }
  fixed.problem.strand.root = kZero3;
  for (Double3& rest : fixed.problem.strand.rest) rest = {0.0, -1.0, 0.0};
  fixed.problem.start = {Double3{1.0, 0.0, 0.0}, Double3{0.0, 1.0, 0.0}, Double3{0.0, 1.0, 0.0}};
  return fixed;
}

std::vector<FixedProblem> FixedProblems() {
  return {PendulumChallenge(),
          Release(3, {{0.05, {0.0384172067, -0.0109294530, 0.0}},
                      {0.1, {0.0348790825, -0.0191269922, 0.0}},
                      {0.2, {0.0393052139, -0.0073033411, 0.0}},
                      {0.5, {0.0376600073, -0.0132016435, 0.0}},
                      {1.0, {0.0380801792, -0.0119979949, 0.0}},
                      {4.0, {0.0380514679, -0.0120845556, 0.0}}}),
          Release(4, {{0.05, {0.0382675956, -0.0113379254, 0.0}},
                      {0.1, {0.0344707858, -0.0196480577, 0.0}},
                      {0.2, {0.0392428490, -0.0075681544, 0.0}},
                      {1.0, {0.0379126747, -0.0124005781, 0.0}},
                      {4.0, {0.0378892854, -0.0124674222, 0.0}}}),
          HangingChain(),
          CurledHeadshake(CurlModel::kRoot, "headshake with curl, model L",
                          {{0.5, {0.0829467752, 0.1004301265, 0.0170030881}},
                           {1.0, {0.0877730275, 0.0911681354, 0.0343395718}},
                           {2.0, {0.0919583606, 0.0929390339, 0.0086427242}},
                           {4.0, {0.0879352326, 0.1014664776, 0.0145745875}}}),
          CurledHeadshake(CurlModel::kParent, "headshake with curl, model F",
                          {{0.5, {0.0809266135, 0.0980362825, 0.0200725937}},
                           {1.0, {0.0859713107, 0.0873688441, 0.0371550432}},
                           {2.0, {0.0905486194, 0.0927096552, 0.0110041051}}})};
}

Double3 SolveFixed(const FixedProblem& fixed, const SolverFactory& factory, int frames_per_second,
                   double seconds) {
  const ChainProblem& problem = fixed.problem;
  const int last = problem.material.links - 1;
  SolverRun run(factory, problem.material, 1.0 / frames_per_second, {problem.strand},
                std::span(&problem.start, 1), problem.motion(0.0));
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (!run.valid()) return {kNone, kNone, kNone};
  const int frames = int(std::lround(seconds * frames_per_second));
  for (int f = 1; f <= frames; ++f) run.Step(problem.motion(double(f) / frames_per_second));
  return problem.motion(seconds).Place(problem.strand.root) + run.Point(0, last);
}

}  // namespace pelt::accuracy
