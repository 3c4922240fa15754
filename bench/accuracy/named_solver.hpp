// Every solver under its name: one list for the work-precision table, the stress table and
// `--solver`.
//
// A family is one method; its members differ in what they spend per frame (substeps, iterations,
// quality), so a family is one curve of the diagram and a member one point on it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/accuracy/comparison/comparison.hpp"
#include "bench/accuracy/error_metric.hpp"
#include "core/modal/modal_quality.hpp"

namespace pelt::accuracy {

enum class Family : uint8_t {
  kFollowTheLeader,
  kPbd,           // the textbook's, bench/accuracy/comparison
  kPeltPbd,       // ours, as it runs in a frame
  kVerlet,        // ours
  kXpbd,          // one iteration a substep
  kXpbdIterated,  // four
  kXpbdSwept,     // sixteen
  kXpbdCubic,     // one, the root on a cubic
  kImplicitEuler,
  kTrapezoid,
  kModal,  // ours
};
inline constexpr size_t kFamilies = 11;
std::string_view FamilyName(Family family);  // "implicit Euler"

struct NamedSolver {
  Family family;
  std::string name;   // for the command line: "xpbd-8", "modal-fine"
  std::string label;  // for people: "XPBD, 8 substeps"
  int spent;          // substeps or iterations
  // What the family is made from; one of them counts.
  MethodSettings method;
  CoreSettings core;
  ModalQuality quality = ModalQuality::kFine;
  bool velocities = false;  // modal: takes the root's, where a motion has them

  // Its stiffness is not the material's but found by trying (TuningCandidates).
  bool Tuned() const;
  double stiffness_scale() const;
};

// Family after family, from cheapest to most exact. `quick`: one or two members of each.
std::vector<NamedSolver> AllSolvers(bool quick = false);
// By name, with any count: "xpbd-50". The layers' own names ("modal", "pbd", "verlet") are what
// layers run.
std::optional<NamedSolver> FindSolver(std::string_view name);
// The names there are, for messages.
std::string SolverNames();
// Their words without numbers.
std::vector<std::string> SolverStems();

inline constexpr int kMostLinks = 4;  // of the chains that every solver runs
// Whether it runs strands that are drawn as so many parts, as a layer has them (LayerFactoryOf).
bool RunsParts(const NamedSolver& solver, int parts);
// Why it does not run so many links, for messages.
std::string WhyNotLinks(const NamedSolver& solver, int links);

SolverFactory FactoryOf(const NamedSolver& solver, Isa isa);
// As a layer has it: the modal solvers' strands have nodes, and `links` parts to be drawn as.
SolverFactory LayerFactoryOf(const NamedSolver& solver, Isa isa);

// What a tuned solver is chosen from, on the very cases that it is scored on, as its users tune it by eye: a ladder
// of stiffness scales and, for the textbook's PBD, both ways of bending. Of the others the solver alone.
std::vector<NamedSolver> TuningCandidates(const NamedSolver& solver);

// The candidate with the least error on the suite's preset; scale 0: none came out finite.
struct TunedSolver {
  NamedSolver solver;
  Score score;
  double scale = 1.0;
};
TunedSolver ScoreNamed(const NamedSolver& solver, Isa isa, const Suite& suite, size_t preset,
                       int frames_per_second);

}  // namespace pelt::accuracy
