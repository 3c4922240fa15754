#include "bench/accuracy/error_metric.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "bench/accuracy/quantile.hpp"
#include "bench/accuracy/solver_run.hpp"

namespace pelt::accuracy {
namespace {

constexpr double kNudge = 1e-7;
constexpr int kNudgeFrames = kKeptRate / 4;

std::array<Double3, kMaxLinks> Nudged(std::array<Double3, kMaxLinks> d, int links) {
  for (int i = 0; i < links; ++i) d[i] = Unit(d[i] + Double3{0.3 + 0.1 * i, -0.7, 0.5} * kNudge);
  return d;
}

// The same of what moves: rates stay across their links.
ChainState NudgedState(ChainState state, int links) {
  state.direction = Nudged(state.direction, links);
  for (size_t i = 0; i < size_t(links); ++i) {
    const Double3 d = state.direction[i];
    state.rate[i] = state.rate[i] - d * Dot(d, state.rate[i]);
  }
  return state;
}

// Points of an integrator's problem relative to the root.
void RelativePoints(const ReferenceIntegrator& integrator, size_t problem,
                    const ChainMaterial& material, std::vector<Double3>& out) {
  Double3 at = kZero3;
  for (int i = 0; i < material.links; ++i) {
    at = at + integrator.state(problem).direction[i] * material.length[i];
    out.push_back(at);
  }
}

size_t MotionCount(const SuiteOptions& options) {
  return options.drawn ? size_t(options.drawn->motions) : options.motions.size();
}

// One motion of a suite, with the strands that move so.
struct SuiteMotion {
  BodyMotion motion;
  std::vector<Strand> strands;
  double length_scale = 1.0;
};

SuiteMotion MakeMotion(const SuiteOptions& options, size_t index) {
  if (!options.drawn)
    return {MotionOf(options.motions[index]),
            SeededStrands(options.links, options.strands, options.seed, options.degrees)};
  const uint64_t seed = options.drawn->seed;
  return {DrawMotion(seed, int(index)),
          DrawStrands(options.links, options.strands, seed, int(index)),
          DrawLengthScale(seed, int(index))};
}

std::vector<SuiteCase> MakeCases(const SuiteOptions& options) {
  std::vector<SuiteCase> cases;
  std::vector<SuiteMotion> motions;
  for (size_t m = 0; m < MotionCount(options); ++m) motions.push_back(MakeMotion(options, m));
  for (size_t preset = 0; preset < options.presets.size(); ++preset)
    for (size_t m = 0; m < motions.size(); ++m) {
      Preset scaled = options.presets[preset];
      scaled.length *= motions[m].length_scale;
      ChainProblem problem;
      problem.material = MakeMaterial(scaled, options.links, options.coefficients);
      problem.material.curl = options.curl;
      problem.motion = motions[m].motion;
      for (const Strand& strand : motions[m].strands) {
        problem.strand = strand;
        problem.start = FindEquilibrium(problem.material, strand);
        cases.push_back({preset, m, problem, 0.0, true, {}, {}});
      }
    }
  return cases;
}

// Cases that share a motion and a step are solved together, each beside its nudged copy.
void SolveTogether(const std::vector<SuiteCase*>& group, int rate, const SuiteOptions& options) {
  std::vector<ChainProblem> problems;
  for (const SuiteCase* c : group) {
    problems.push_back(c->problem);
    problems.push_back(c->problem);
    problems.back().start = Nudged(c->problem.start, c->problem.material.links);
  }
  ReferenceIntegrator integrator(problems, rate);
  const int frames = int(std::lround(options.seconds * kKeptRate));
  // Drawn motions begin at any time, when a nudge of the start has long swung out.
  const int nudge_frames = options.drawn ? kNudgeFrames : frames + 1;
  std::vector<Double3> nudged;
  for (int frame = 0; frame <= frames; ++frame) {
    if (frame > 0 && frame % nudge_frames == 0)
      for (size_t g = 0; g < group.size(); ++g)
        integrator.SetState(2 * g + 1,
                            NudgedState(integrator.state(2 * g), group[g]->problem.material.links));
    const BodyPose pose = problems[0].motion(double(frame) / kKeptRate);
    for (size_t g = 0; g < group.size(); ++g) {
      SuiteCase& c = *group[g];
      const ChainMaterial& material = c.problem.material;
      const size_t first = c.exact.size();
      RelativePoints(integrator, 2 * g, material, c.exact);
      nudged.clear();
      RelativePoints(integrator, 2 * g + 1, material, nudged);
      Double3 rigid = kZero3;
      for (int i = 0; i < material.links; ++i) {
        rigid = rigid + pose.Turn(c.problem.start[i]) * material.length[i];
        c.rigid.push_back(rigid);
        const double off = Length(nudged[size_t(i)] - c.exact[first + size_t(i)]);
        // Model F has no direction to carry the curl to where a link turns right round.
        if (!std::isfinite(off)) c.growth = std::numeric_limits<double>::infinity();
        c.growth = std::max(c.growth, off / (kNudge * material.TotalLength()));
      }
    }
    if (frame < frames)
      for (int s = 0; s < rate / kKeptRate; ++s) integrator.Step();
  }
  for (SuiteCase* c : group) c->scored = c->growth < kMostGrowth;
}

// No frame ends after the exact motion: 2.5 s at 15 Hz are 37 of them.
int WholeFrames(double seconds, int rate) { return int(seconds * rate + 1e-9); }

// Sums over the frames of one case.
struct CaseSums {
  double error = 0.0, secondary = 0.0;
};

// The cases of one preset and motion that share a batch.
std::vector<const SuiteCase*> BatchOf(const Suite& suite, size_t preset, size_t motion) {
  std::vector<const SuiteCase*> batch;
  for (const SuiteCase& c : suite.cases)
    if (c.preset == preset && c.motion == motion) batch.push_back(&c);
  return batch;
}

// Adds what point i of a case at a frame is off to the case's sums and the score.
void Compare(const SuiteCase& c, int frame, int rate, const SolverRun& run, size_t strand,
             CaseSums& sums, Score& score) {
  const ChainMaterial& material = c.problem.material;
  Double3 upper = kZero3;
  for (int i = 0; i < material.links; ++i) {
    const Double3 point = run.Point(strand, i);
    score.finite = score.finite && IsFinite(point);
    const size_t at = size_t(frame) * (kKeptRate / rate) * material.links + size_t(i);
    const Double3 off = point - c.exact[at], moved = c.exact[at] - c.rigid[at];
    sums.error += Dot(off, off);
    sums.secondary += Dot(moved, moved);
    score.worst = std::max(score.worst, Length(off) / material.TotalLength());
    score.stretch =
        std::max(score.stretch, std::abs(Length(point - upper) / material.length[i] - 1.0));
    upper = point;
  }
}

// Runs the cases of a batch; returns the sum of their squared errors.
double RunBatch(const std::vector<const SuiteCase*>& batch, const SolverFactory& factory, int rate,
                double seconds, Score& score) {
  std::vector<LinkDirections> starts;
  std::vector<Strand> strands;
  for (const SuiteCase* c : batch) {
    strands.push_back(c->problem.strand);
    starts.push_back(c->problem.start);
  }
  const BodyMotion& motion = batch[0]->problem.motion;
  SolverRun run(factory, batch[0]->problem.material, 1.0 / rate, strands, starts, motion(0.0));
  if (!run.valid()) return 0.0;
  std::vector<CaseSums> sums(batch.size());
  const int frames = WholeFrames(seconds, rate);
  for (int f = 1; f <= frames && score.finite; ++f) {
    run.Step(motion(double(f) / rate));
    for (size_t s = 0; s < batch.size(); ++s)
      if (batch[s]->scored) Compare(*batch[s], f, rate, run, s, sums[s], score);
  }
  double squares = 0.0;
  for (size_t s = 0; s < batch.size(); ++s) {
    if (!batch[s]->scored) continue;
    const double square = sums[s].error / sums[s].secondary;
    squares += square;
    score.errors.push_back(std::sqrt(square));
    ++score.cases;
  }
  return squares;
}

// Of motions `first` up to `end`.
Score ScoreMotions(const Suite& suite, size_t preset, size_t first, size_t end,
                   const SolverFactory& factory, int frames_per_second) {
  Score score;
  double square_sum = 0.0;
  for (size_t motion = first; motion < end; ++motion) {
    const auto batch = BatchOf(suite, preset, motion);
    if (!batch.empty())
      square_sum += RunBatch(batch, factory, frames_per_second, suite.options.seconds, score);
  }
  score.error = score.cases > 0 ? std::sqrt(square_sum / score.cases) : 0.0;
  return score;
}

// One term of a pose between samples: a sample, or its velocity, times a function of time.
struct CourseTerm {
  Double3 position, axis[3];
  double value, slope, bend;  // of the function, by the frame's length

  CourseTerm(const BodyPose& p) : position(p.position) { std::copy_n(p.axis, 3, axis); }
  static CourseTerm RateOf(const BodyPose& p) {
    CourseTerm term(p);
    term.position = p.velocity;
    std::copy_n(p.axis_rate, 3, term.axis);
    return term;
  }
};

// Lagrange's polynomial of the lower degrees is the cubic's formula on fewer nodes. `s`: frames
// since the frame's start.
void AddLagrange(const std::array<BodyPose, 4>& sample, int degree, double s,
                 std::vector<CourseTerm>& terms) {
  for (int j = 0; j <= degree; ++j) {
    CourseTerm& term = terms.emplace_back(sample[size_t(j)]);
    term.value = 1.0, term.slope = term.bend = 0.0;
    for (int i = 0; i <= degree; ++i) {
      if (i == j) continue;
      const double per = 1.0 / (i - j), f = (s - 1.0 + i) * per;
      term.bend = term.bend * f + 2.0 * term.slope * per;
      term.slope = term.slope * f + term.value * per;
      term.value *= f;
    }
  }
}

void AddHermite(const BodyPose& end, const BodyPose& start, double frame_seconds, double s,
                std::vector<CourseTerm>& terms) {
  // Coefficients of 1, s, s^2, s^3.
  static constexpr double kBasis[4][4] = {
      {1, 0, -3, 2}, {0, 1, -2, 1}, {0, 0, 3, -2}, {0, 0, -1, 1}};
  terms = {CourseTerm(start), CourseTerm::RateOf(start), CourseTerm(end), CourseTerm::RateOf(end)};
  for (size_t j = 0; j < 4; ++j) {
    const auto& c = kBasis[j];
    const double scale = j % 2 == 0 ? 1.0 : frame_seconds;
    terms[j].value = scale * (c[0] + s * (c[1] + s * (c[2] + s * c[3])));
    terms[j].slope = scale * (c[1] + s * (2.0 * c[2] + s * 3.0 * c[3]));
    terms[j].bend = scale * (2.0 * c[2] + s * 6.0 * c[3]);
  }
}

// The pose in frame `frame`, between the samples at its ends.
BodyMotion SampledMotion(const BodyMotion& exact, int rate, int frame, RootCourse course) {
  std::array<BodyPose, 4> sample;
  for (int j = 0; j < 4; ++j) sample[size_t(j)] = exact(std::max(frame - j, 0) / double(rate));
  return [=](double t) {
    const double s = t * rate - (frame - 1);
    std::vector<CourseTerm> terms;
    if (course == RootCourse::kHermite)
      AddHermite(sample[0], sample[1], 1.0 / rate, s, terms);
    else
      AddLagrange(sample, int(course), s, terms);
    BodyPose pose{};
    for (const CourseTerm& p : terms) {
      const double v = p.value, d = p.slope * rate, b = p.bend * rate * rate;
      pose.position = pose.position + p.position * v;
      pose.velocity = pose.velocity + p.position * d;
      pose.acceleration = pose.acceleration + p.position * b;
      for (int k = 0; k < 3; ++k) {
        pose.axis[k] = pose.axis[k] + p.axis[k] * v;
        pose.axis_rate[k] = pose.axis_rate[k] + p.axis[k] * d;
        pose.axis_bend[k] = pose.axis_bend[k] + p.axis[k] * b;
      }
    }
    const double share = std::clamp(s, 0.0, 1.0);
    pose.wind = sample[1].wind + (sample[0].wind - sample[1].wind) * share;
    return pose;
  };
}

double InputSquares(const std::vector<const SuiteCase*>& batch, const Suite& suite, int rate,
                    RootCourse course, int& cases) {
  std::vector<ChainProblem> problems;
  for (const SuiteCase* c : batch) problems.push_back(c->problem);
  // An error in per cent needs no thirteen digits.
  const int steps = ReferenceRate(problems[0].material) / 4;
  const BodyMotion exact = problems[0].motion;
  ReferenceIntegrator integrator(problems, steps);
  std::vector<CaseSums> sums(batch.size());
  std::vector<Double3> points;
  std::vector<Double3> root_rate(batch.size(), kZero3);
  const int frames = WholeFrames(suite.options.seconds, rate);
  for (int frame = 1; frame <= frames; ++frame) {
    const BodyMotion motion = SampledMotion(exact, rate, frame, course);
    integrator.SetMotion(motion);
    const BodyPose begin = motion(double(frame - 1) / rate), end = motion(double(frame) / rate);
    for (size_t s = 0; s < batch.size(); ++s) {
      const Double3 root = problems[s].strand.root;
      integrator.Kick(s, begin.PlaceRate(root) - root_rate[s]);
      root_rate[s] = end.PlaceRate(root);
    }
    for (int k = 0; k < steps / rate; ++k) integrator.Step();
    for (size_t s = 0; s < batch.size(); ++s) {
      points.clear();
      RelativePoints(integrator, s, problems[s].material, points);
      const size_t at = size_t(frame) * (kKeptRate / rate) * points.size();
      for (size_t i = 0; i < points.size(); ++i) {
        const Double3 off = points[i] - batch[s]->exact[at + i];
        const Double3 moved = batch[s]->exact[at + i] - batch[s]->rigid[at + i];
        sums[s].error += Dot(off, off);
        sums[s].secondary += Dot(moved, moved);
      }
    }
  }
  double squares = 0.0;
  for (size_t s = 0; s < batch.size(); ++s) {
    if (!batch[s]->scored) continue;
    squares += sums[s].error / sums[s].secondary;
    ++cases;
  }
  return squares;
}

}  // namespace

double Score::Median() const { return Quantile(errors, 0.5); }

double Score::WorstCase() const {
  return errors.empty() ? 0.0 : *std::max_element(errors.begin(), errors.end());
}

Suite SolveSuite(const SuiteOptions& options) {
  Suite suite{options, MakeCases(options)};
  std::map<std::pair<size_t, int>, std::vector<SuiteCase*>> groups;
  for (SuiteCase& c : suite.cases)
    groups[{c.motion, ReferenceRate(c.problem.material) * options.rate_scale}].push_back(&c);
  for (const auto& [key, group] : groups) SolveTogether(group, key.second, options);
  return suite;
}

double SuiteDistance(const Suite& suite, const Suite& other, size_t preset) {
  double squares = 0.0;
  int cases = 0;
  for (size_t c = 0; c < suite.cases.size(); ++c) {
    const SuiteCase &a = suite.cases[c], &b = other.cases[c];
    if (a.preset != preset || !a.scored || !b.scored) continue;
    CaseSums sums;
    for (size_t i = 0; i < a.exact.size(); ++i) {
      const Double3 off = b.exact[i] - a.exact[i], moved = a.exact[i] - a.rigid[i];
      sums.error += Dot(off, off);
      sums.secondary += Dot(moved, moved);
    }
    squares += sums.error / sums.secondary;
    ++cases;
  }
  return cases > 0 ? std::sqrt(squares / cases) : 0.0;
}

Score ScoreSolver(const Suite& suite, size_t preset, const SolverFactory& factory,
                  int frames_per_second) {
  return ScoreMotions(suite, preset, 0, MotionCount(suite.options), factory, frames_per_second);
}

Score ScoreSolver(const Suite& suite, size_t preset, Motion motion, const SolverFactory& factory,
                  int frames_per_second) {
  const auto& motions = suite.options.motions;
  const size_t at = size_t(std::find(motions.begin(), motions.end(), motion) - motions.begin());
  return ScoreMotions(suite, preset, at, std::min(at + 1, motions.size()), factory,
                      frames_per_second);
}

double InputError(const Suite& suite, size_t preset, int frames_per_second, RootCourse course) {
  double squares = 0.0;
  int cases = 0;
  for (size_t motion = 0; motion < MotionCount(suite.options); ++motion) {
    const auto batch = BatchOf(suite, preset, motion);
    if (!batch.empty()) squares += InputSquares(batch, suite, frames_per_second, course, cases);
  }
  return cases > 0 ? std::sqrt(squares / cases) : 0.0;
}

}  // namespace pelt::accuracy
