#include "bench/accuracy/named_solver.hpp"

#include <fmt/format.h>

#include <charconv>
#include <span>

#include "bench/accuracy/modal_solver.hpp"

namespace pelt::accuracy {
namespace {

struct NamedQuality {
  ModalQuality quality;
  std::string_view name, label;
};
constexpr NamedQuality kQualities[] = {{ModalQuality::kFast, "modal", "modal"},
                                       {ModalQuality::kFine, "modal-fine", "modal, fine"},
                                       {ModalQuality::kBest, "modal-best", "modal, best"}};

constexpr int kNewtonSteps = 6;  // of implicit Euler: fully converged
constexpr int kTrapezoidNewtonSteps = 2;
constexpr int kLayerIterations = 4;  // of "pbd" and "verlet", as of a layer that says no more

// The names of one family's members: "xpbd-8".
std::string_view NameStem(Family family) {
  switch (family) {
    case Family::kFollowTheLeader:
      return "dftl";
    case Family::kPbd:
      return "textbook-pbd";
    case Family::kPeltPbd:
      return "pbd";
    case Family::kVerlet:
      return "verlet";
    case Family::kXpbd:
      return "xpbd";
    case Family::kXpbdIterated:
      return "xpbd4";
    case Family::kXpbdSwept:
      return "xpbd16";
    case Family::kXpbdCubic:
      return "xpbd-cubic";
    case Family::kImplicitEuler:
      return "euler";
    case Family::kTrapezoid:
      return "trapezoid";
    case Family::kModal:
      break;
  }
  return "modal";
}

MethodSettings MethodOf(Family family, int spent) {
  switch (family) {
    case Family::kFollowTheLeader:
      return {Method::kFollowTheLeader, spent, 1};
    case Family::kPbd:
      return {Method::kPbd, 1, spent};
    case Family::kXpbd:
      return {Method::kXpbd, spent, 1};
    case Family::kXpbdIterated:
      return {Method::kXpbd, spent, 4};
    case Family::kXpbdSwept:
      return {Method::kXpbd, spent, 16};
    case Family::kXpbdCubic:
      return {Method::kXpbdCubic, spent, 1};
    case Family::kImplicitEuler:
      return {Method::kImplicitEuler, spent, kNewtonSteps};
    default:
      return {Method::kTrapezoid, spent, kTrapezoidNewtonSteps};
  }
}

bool IsCore(Family family) { return family == Family::kPeltPbd || family == Family::kVerlet; }

NamedSolver MakeNamed(Family family, int spent) {
  NamedSolver solver{family, fmt::format("{}-{}", NameStem(family), spent), {}, spent, {}, {}};
  if (IsCore(family)) {
    solver.core = {family == Family::kPeltPbd ? CoreMethod::kPbd : CoreMethod::kVerlet,
                   uint32_t(spent)};
    solver.label =
        fmt::format("{}, {} iteration{}", FamilyName(family), spent, spent == 1 ? "" : "s");
  } else {
    solver.method = MethodOf(family, spent);
    solver.label = MethodLabel(solver.method);
  }
  return solver;
}

NamedSolver MakeModal(const NamedQuality& quality) {
  return {Family::kModal,
          std::string(quality.name),
          std::string(quality.label),
          int(quality.quality) + 1,
          {},
          {},
          quality.quality};
}

struct Members {
  Family family;
  std::vector<int> all, quick;
};
const std::vector<Members>& AllMembers() {
  static const std::vector<Members> members = {
      {Family::kFollowTheLeader, {1, 2, 4, 8}, {1}},
      {Family::kPbd, {1, 2, 4, 8, 16}, {4}},
      {Family::kPeltPbd, {1, 2, 4, 8, 16}, {1, 4}},
      {Family::kVerlet, {1, 4, 16}, {4}},
      {Family::kXpbd, {1, 2, 4, 8, 16, 32, 64}, {8, 32}},
      {Family::kXpbdIterated, {1, 2, 4, 8, 16}, {4}},
      {Family::kXpbdSwept, {1, 2, 4}, {}},
      {Family::kXpbdCubic, {1, 2, 4, 8, 16, 32, 64}, {8, 32}},
      {Family::kImplicitEuler, {1, 2, 4, 8}, {1}},
      {Family::kTrapezoid, {1, 2, 4, 8}, {1, 2}}};
  return members;
}

constexpr double kStiffnessScales[] = {0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7,
                                       1.0,  1.4,  2.0, 3.0, 5.0,  8.0};
}  // namespace

std::string_view FamilyName(Family family) {
  static constexpr std::string_view kNames[kFamilies] = {"follow-the-leader",
                                                         "PBD, textbook",
                                                         "PBD, Pelt's",
                                                         "Verlet, Pelt's",
                                                         "XPBD",
                                                         "XPBD, 4 iterations",
                                                         "XPBD, 16 iterations",
                                                         "XPBD, cubic root",
                                                         "implicit Euler",
                                                         "trapezoid",
                                                         "modal, Pelt's"};
  return kNames[size_t(family)];
}

bool NamedSolver::Tuned() const {
  return IsCore(family) || family == Family::kPbd || family == Family::kFollowTheLeader;
}

double NamedSolver::stiffness_scale() const {
  return IsCore(family) ? core.stiffness_scale : method.stiffness_scale;
}

std::vector<NamedSolver> AllSolvers(bool quick) {
  std::vector<NamedSolver> solvers;
  for (const Members& members : AllMembers())
    for (const int spent : quick ? members.quick : members.all)
      solvers.push_back(MakeNamed(members.family, spent));
  for (const NamedQuality& quality : kQualities) solvers.push_back(MakeModal(quality));
  return solvers;
}

std::optional<NamedSolver> FindSolver(std::string_view name) {
  for (const NamedQuality& quality : kQualities)
    if (quality.name == name) return MakeModal(quality);
  for (const Members& members : AllMembers()) {
    const std::string_view stem = NameStem(members.family);
    if (!name.starts_with(stem)) continue;
    const std::string_view rest = name.substr(stem.size());
    if (rest.empty() && IsCore(members.family)) return MakeNamed(members.family, kLayerIterations);
    int spent = 0;
    const auto [end, error] = std::from_chars(rest.data() + !rest.empty(), rest.end(), spent);
    if (rest.starts_with('-') && error == std::errc() && end == rest.end() && spent >= 1 &&
        spent <= kMaxSubsteps)
      return MakeNamed(members.family, spent);
  }
  return std::nullopt;
}

std::vector<std::string> SolverStems() {
  std::vector<std::string> stems;
  for (const NamedQuality& quality : kQualities) stems.emplace_back(quality.name);
  for (const Members& members : AllMembers()) stems.emplace_back(NameStem(members.family));
  return stems;
}

std::string SolverNames() {
  std::vector<std::string> names;
  for (const NamedQuality& quality : kQualities) names.emplace_back(quality.name);
  for (const Members& members : AllMembers()) {
    const std::string_view stem = NameStem(members.family);
    names.push_back(IsCore(members.family) ? fmt::format("{0}, {0}-N", stem)
                                           : fmt::format("{}-N", stem));
  }
  return fmt::format("{} (N from 1 to {})", fmt::join(names, ", "), kMaxSubsteps);
}

bool RunsParts(const NamedSolver& solver, int parts) {
  return parts <= kMostLinks || solver.family == Family::kModal;
}

std::string WhyNotLinks(const NamedSolver& solver, int links) {
  return fmt::format("{} runs strands of 3 or 4 links, not of {}", solver.name, links);
}

SolverFactory FactoryOf(const NamedSolver& solver, Isa isa) {
  if (IsCore(solver.family)) return CoreFactory(isa, solver.core);
  if (solver.family != Family::kModal) return ComparisonFactory(isa, solver.method);
  if (!FindKernels(isa)) return [](const SolverSetup&) { return std::unique_ptr<StrandSolver>(); };
  return ModalFactory(ModalKernelsOf(isa), solver.quality, {.velocities = solver.velocities});
}

SolverFactory LayerFactoryOf(const NamedSolver& solver, Isa isa) {
  if (solver.family != Family::kModal || !FindKernels(isa)) return FactoryOf(solver, isa);
  return LayerFactory(ModalKernelsOf(isa), solver.quality, {.velocities = solver.velocities});
}

std::vector<NamedSolver> TuningCandidates(const NamedSolver& solver) {
  if (!solver.Tuned()) return {solver};
  std::vector<NamedSolver> candidates;
  for (const bool one_sided : {false, true}) {
    if (one_sided && solver.family != Family::kPbd) continue;
    for (const double scale : kStiffnessScales) {
      NamedSolver& candidate = candidates.emplace_back(solver);
      candidate.method.one_sided = one_sided;
      candidate.method.stiffness_scale = candidate.core.stiffness_scale = scale;
    }
  }
  return candidates;
}

TunedSolver ScoreNamed(const NamedSolver& solver, Isa isa, const Suite& suite, size_t preset,
                       int frames_per_second) {
  const auto score_of = [&](const NamedSolver& candidate) {
    return ScoreSolver(suite, preset, FactoryOf(candidate, isa), frames_per_second);
  };
  if (!solver.Tuned()) return {solver, score_of(solver), 1.0};
  TunedSolver best{solver, {}, 0.0};
  for (const NamedSolver& candidate : TuningCandidates(solver)) {
    const Score score = score_of(candidate);
    if (!score.finite || score.cases == 0) continue;
    if (best.scale == 0.0 || score.error < best.score.error)
      best = {candidate, score, candidate.stiffness_scale()};
  }
  return best;
}

}  // namespace pelt::accuracy
