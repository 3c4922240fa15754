#include "bench/accuracy/solver_timing.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <map>

#include "bench/accuracy/quantile.hpp"
#include "core/random.hpp"

namespace pelt::accuracy {
namespace {

double SteadySeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

uint64_t PointsDigest(const StrandSolver& solver, int links, size_t lanes) {
  std::vector<float> values(3 * lanes);
  float* const rows[3] = {&values[0], &values[lanes], &values[2 * lanes]};
  uint64_t digest = 0;
  for (int i = 0; i < links; ++i) {
    solver.Points(i, rows);
    for (const float v : values) {
      uint32_t bits;
      std::memcpy(&bits, &v, sizeof bits);
      digest = MixSeed(digest, bits);
    }
  }
  return digest;
}

// The batch's input for every frame, found once: it is the same for all solvers and rounds.
class TimedBatch {
 public:
  TimedBatch(const TimedProblem& problem, const TimingOptions& options)
      : problem_(problem),
        dt_(1.0 / options.frames_per_second),
        now_(options.now ? options.now : &SteadySeconds) {
    std::vector<Strand> strands(options.strands);
    std::vector<LinkDirections> start(options.strands);
    for (size_t s = 0; s < strands.size(); ++s) {
      strands[s] = problem.strands[s % problem.strands.size()];
      start[s] = problem.start[s % problem.start.size()];
    }
    const int links = problem.material.links;
    directions_ = std::make_unique<FrameBuffer>(links, strands.size());
    directions_->SetDirections(start);
    for (int f = 0; f <= options.frames; ++f) {
      const auto pose = [&](int frame) { return problem.motion(problem.begin + frame * dt_); };
      frames_.push_back(std::make_unique<FrameBuffer>(links, strands.size()));
      // A frame's motion is from the sample before it.
      if (f > 0) frames_.back()->Sample(pose(f - 1), strands);
      frames_.back()->Sample(pose(f), strands);
    }
  }

  size_t lanes() const { return directions_->lanes(); }
  // Runs a fresh solver over all frames; adds the slice that each took.
  void RunTurn(const SolverFactory& factory, SolverTime& time) const {
    const auto solver = factory({problem_.material, dt_, uint32_t(lanes())});
    if (!solver) return;
    solver->Start(frames_[0]->rows(), directions_->rows().rest);
    for (size_t f = 1; f < frames_.size(); ++f) {
      const FrameRows& rows = frames_[f]->rows();
      solver->Prepare(rows);
      const double begin = now_();
      solver->Step(rows);
      time.slices.push_back(1e9 * (now_() - begin) / double(lanes()));
    }
    time.digest = PointsDigest(*solver, problem_.material.links, lanes());
  }

 private:
  const TimedProblem& problem_;
  double dt_;
  double (*now_)();
  std::unique_ptr<FrameBuffer> directions_;
  std::vector<std::unique_ptr<FrameBuffer>> frames_;
};

}  // namespace

TimedProblem HeadshakeProblem(const ChainMaterial& material) {
  TimedProblem problem{material,
                       SeededStrands(material.links, int(kBatchLanes), 1),
                       {},
                       MotionOf(Motion::kHeadshake),
                       1.0};
  for (const Strand& strand : problem.strands)
    problem.start.push_back(FindEquilibrium(material, strand));
  return problem;
}

TimingOptions TableTiming(bool quick) {
  return {.strands = quick ? 1024u : 4096u, .frames = quick ? 8 : 12, .repeats = quick ? 5 : 15};
}

std::vector<SolverTime> TimeInTurn(std::span<const TimedSolver> solvers,
                                   const TimingOptions& options) {
  std::map<const TimedProblem*, TimedBatch> batches;
  for (const TimedSolver& solver : solvers)
    batches.try_emplace(solver.problem, *solver.problem, options);
  std::vector<SolverTime> times(solvers.size());
  for (int round = 0; round < options.repeats; ++round)
    for (size_t s = 0; s < solvers.size(); ++s)
      batches.at(solvers[s].problem).RunTurn(solvers[s].factory, times[s]);
  for (SolverTime& time : times) {
    time.ns = Quantile(time.slices, 0.5);
    time.low_ns = Quantile(time.slices, 0.25);
    time.high_ns = Quantile(time.slices, 0.75);
  }
  return times;
}

std::vector<SolverTime> TimeInTurn(std::span<const SolverFactory> factories,
                                   const TimedProblem& problem, const TimingOptions& options) {
  std::vector<TimedSolver> solvers;
  for (const SolverFactory& factory : factories) solvers.push_back({factory, &problem});
  return TimeInTurn(solvers, options);
}

double TimeRatio(const SolverTime& a, const SolverTime& b) {
  std::vector<double> ratios;
  for (size_t slice = 0; slice < std::min(a.slices.size(), b.slices.size()); ++slice)
    if (b.slices[slice] > 0.0) ratios.push_back(a.slices[slice] / b.slices[slice]);
  return Quantile(ratios, 0.5);
}

double NanosecondsPerStrand(const SolverFactory& factory, const ChainMaterial& material,
                            const TimingOptions& options, uint64_t* digest) {
  const SolverTime time =
      TimeInTurn(std::span(&factory, 1), HeadshakeProblem(material), options)[0];
  if (digest && time.ns > 0.0) *digest = time.digest;
  return time.ns;
}

}  // namespace pelt::accuracy
