#include "bench/accuracy/feature_errors.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "bench/accuracy/solver_run.hpp"
#include "core/exact_math.hpp"
#include "core/random.hpp"

namespace pelt::accuracy {
namespace {

constexpr int kRate = 60;
constexpr double kRootDistance = 0.1;  // m from the body's centre
constexpr uint32_t kStrands = 2 * kLaneGroup;

// Strands around `axis`, leaning up to `spread` from it; link i rests turned by i * `curl` from the
// first, about an axis across it.
std::vector<Strand> Tuft(int links, Double3 axis, double spread, double curl) {
  std::vector<Strand> strands;
  Random random(7);
  for (uint32_t s = 0; s < kStrands; ++s) {
    const auto part = [&] { return random.Uniform(-spread, spread); };
    const double x = part(), y = part(), z = part();
    Strand strand;
    const Double3 up = Unit(axis + Double3{x, y, z});
    const Double3 across = Unit(Cross(up, Double3{0.3, 0.2, 1.0}));
    strand.root = up * kRootDistance;
    for (int i = 0; i < links; ++i)
      strand.rest[size_t(i)] = up * exact::Cos(i * curl) + across * exact::Sin(i * curl);
    strands.push_back(strand);
  }
  return strands;
}

// ---- Runs ------------------------------------------------------------------------------------

// Points of all strands at every 60 Hz frame, relative to their roots.
using Track = std::vector<Double3>;

Track RunAt(const FeatureProblem& p, const SolverFactory& factory, int scale, double seconds) {
  std::vector<LinkDirections> start;
  for (const Strand& strand : p.strands) start.push_back(FindEquilibrium(p.material, strand));
  const BodyMotion motion = MotionOf(p.motion);
  SolverRun run(factory, p.material, 1.0 / (kRate * scale), p.strands, start, motion(0.0));
  Track track;
  const int frames = int(std::lround(seconds * kRate)) * scale;
  for (int f = 1; f <= frames; ++f) {
    run.Step(motion(double(f) / (kRate * scale)));
    if (f % scale != 0) continue;
    for (size_t s = 0; s < p.strands.size(); ++s)
      for (int i = 0; i < p.material.links; ++i) track.push_back(run.Point(s, i));
  }
  return track;
}

// Calls f(index in the track, time, pose, strand, link) for every point.
template <class F>
void ForEachPoint(const FeatureProblem& p, size_t points, F f) {
  const BodyMotion motion = MotionOf(p.motion);
  const size_t links = size_t(p.material.links), row = p.strands.size() * links;
  for (size_t frame = 0; frame < points / row; ++frame) {
    const double time = double(frame + 1) / kRate;
    const BodyPose pose = motion(time);
    for (size_t s = 0; s < p.strands.size(); ++s)
      for (size_t i = 0; i < links; ++i)
        f(frame * row + s * links + i, time, pose, p.strands[s], i);
  }
}

// RMS distance of two tracks over the reference's secondary motion.
double ErrorOf(const FeatureProblem& p, const Track& track, const Track& reference) {
  std::vector<LinkDirections> start;
  for (const Strand& strand : p.strands) start.push_back(FindEquilibrium(p.material, strand));
  double off = 0.0, moved = 0.0;
  Double3 rigid = kZero3;
  ForEachPoint(p, track.size(),
               [&](size_t at, double, const BodyPose& pose, const Strand& strand, size_t link) {
                 const LinkDirections& d = start[size_t(&strand - p.strands.data())];
                 rigid =
                     (link == 0 ? kZero3 : rigid) + pose.Turn(d[link]) * p.material.length[link];
                 const Double3 a = track[at] - reference[at], b = reference[at] - rigid;
                 off += Dot(a, a);
                 moved += Dot(b, b);
               });
  return std::sqrt(off / moved);
}

double DistanceToLink(Double3 point, Double3 from, Double3 to) {
  const Double3 link = to - from;
  const double share = std::clamp(Dot(point - from, link) / Dot(link, link), 0.0, 1.0);
  return Length(from + link * share - point);
}

// Deepest point, of links for the sphere, over the length. The first frames are left out: strands may start inside.
double PenetrationOf(const FeatureProblem& p, const Track& track) {
  constexpr size_t kSettleFrames = 6;
  const ModalFeatures& f = p.features;
  const size_t first = kSettleFrames * p.strands.size() * size_t(p.material.links);
  double deepest = 0.0;
  Double3 groom = kZero3;
  double along = 0.0;
  ForEachPoint(
      p, track.size(),
      [&](size_t at, double time, const BodyPose& pose, const Strand& strand, size_t link) {
        groom =
            (link == 0 ? kZero3 : groom) + pose.Turn(strand.rest[link]) * p.material.length[link];
        along = (link == 0 ? 0.0 : along) + p.material.length[link];
        if (at < first) return;
        const Double3 world = pose.Place(strand.root) + track[at];
        if (f.max_distance > 0.0f)
          deepest = std::max(deepest, Length(track[at] - groom) - double(f.max_distance) * along);
        if (f.surface_hardness > 0.0f)
          deepest = std::max(deepest, -Dot(track[at], pose.Turn(strand.rest[0])));
        if (f.use_ground)
          deepest = std::max(deepest, -Dot(world, f.ground_normal) - f.ground_offset);
        if (f.sphere_radius > 0.0)
          deepest = std::max(
              deepest,
              f.sphere_radius - DistanceToLink(SphereAt(f, time),
                                               link == 0 ? pose.Place(strand.root)
                                                         : pose.Place(strand.root) + track[at - 1],
                                               world));
      });
  return deepest / p.material.TotalLength();
}

double Nanoseconds(const FeatureProblem& p, const ModalKernels& kernels, ModalQuality quality,
                   const TimingOptions& timing) {
  if (timing.frames == 0) return 0.0;
  TimedProblem timed{p.material, p.strands, {}, MotionOf(p.motion), 1.0};
  for (const Strand& strand : p.strands) timed.start.push_back(FindEquilibrium(p.material, strand));
  ModalFeatures bare;
  bare.wind = false;
  const SolverFactory pair[] = {ModalFactory(kernels, quality, p.features),
                                ModalFactory(kernels, quality, bare)};
  const auto time = TimeInTurn(pair, timed, timing);
  return time[0].ns - time[1].ns;
}

}  // namespace

std::vector<FeatureProblem> FeatureProblems(int links) {
  const ChainMaterial medium = MakeMaterial(kPresets[2], links);
  const Double3 side = {1.0, 0.0, 0.0}, down = {1.0, -0.6, 0.0};
  ModalFeatures bare;
  bare.wind = false;
  const auto with = [&](auto change) {
    ModalFeatures features = bare;
    change(features);
    return features;
  };
  // Curled so far that tips brush the surface. Pressed harder (1.6) the folded strands have more
  // than one place to go, and the reference itself does not converge.
  const auto curled = Tuft(links, side, 0.3, links == 3 ? 1.56 : 1.04);
  const auto straight = Tuft(links, side, 0.3, 0.1), leaning = Tuft(links, down, 0.2, 0.1);
  const double ground = 0.085;  // below the lowest root of the walk, m
  const auto surface = [](ModalFeatures& f) { f.surface_hardness = 1.0f; };
  const auto on_ground = [=](ModalFeatures& f) { f.use_ground = true, f.ground_offset = ground; };
  std::vector<FeatureProblem> problems;
  problems.push_back({"bare", medium, straight, Motion::kHeadshake, bare});
  problems.push_back({"surface", medium, curled, Motion::kHeadshake, with(surface)});
  // In the way of the tips, from the side. (Head on, a strand may pass a sphere on either side, and
  // no solver can tell which.)
  problems.push_back({"sphere", medium, straight, Motion::kHeadshake, with([](ModalFeatures& f) {
                        f.sphere_radius = 0.1;
                        f.sphere_centre = {0.16, 0.0, 0.16};
                      })});
  // To and fro through their tips at up to 0.25 m/s.
  problems.push_back(
      {"moving sphere", medium, straight, Motion::kHeadshake, with([](ModalFeatures& f) {
         f.sphere_radius = 0.05;
         f.sphere_centre = {0.16, 0.0, 0.09};
         f.sphere_swing = {0.0, 0.0, 0.02};
         f.sphere_period = 0.5;
       })});
  problems.push_back({"ground", medium, leaning, Motion::kWalk, with(on_ground)});
  problems.push_back({"bounce", medium, leaning, Motion::kWalk, with([=](ModalFeatures& f) {
                        on_ground(f);
                        f.bounce = 0.5f;
                      })});
  problems.push_back({"limit", medium, straight, Motion::kHeadshake,
                      with([](ModalFeatures& f) { f.max_distance = 0.2f; })});
  problems.push_back({"clump", medium, straight, Motion::kHeadshake,
                      with([](ModalFeatures& f) { f.clump = 0.3f; })});
  problems.push_back({"strength 0.5", medium, straight, Motion::kHeadshake,
                      with([](ModalFeatures& f) { f.strength = 0.5f; })});
  problems.push_back(
      {"wind", medium, straight, Motion::kWind, with([](ModalFeatures& f) { f.wind = true; })});
  return problems;
}

std::vector<FeatureError> MeasureFeatures(const ModalKernels& kernels,
                                          const FeatureOptions& options) {
  std::vector<FeatureError> rows;
  for (const FeatureProblem& p : FeatureProblems(options.links)) {
    const SolverFactory best = ModalFactory(kernels, ModalQuality::kBest, p.features);
    const Track reference = RunAt(p, best, options.reference_scale, options.seconds);
    const Track coarser = RunAt(p, best, options.reference_scale / 2, options.seconds);
    const double self = ErrorOf(p, coarser, reference);
    for (const ModalQuality quality :
         {ModalQuality::kFast, ModalQuality::kDefault, ModalQuality::kBest}) {
      const Track track = RunAt(p, ModalFactory(kernels, quality, p.features), 1, options.seconds);
      rows.push_back({p.name, quality, ErrorOf(p, track, reference), PenetrationOf(p, track),
                      Nanoseconds(p, kernels, quality, options.timing), self});
    }
  }
  return rows;
}

uint64_t RunDigest(const ModalKernels& kernels, ModalQuality quality, const FeatureProblem& problem,
                   double seconds) {
  uint64_t digest = 0;
  for (const Double3 point :
       RunAt(problem, ModalFactory(kernels, quality, problem.features), 1, seconds))
    for (const double v : {point.x, point.y, point.z})
      digest = MixSeed(digest, std::bit_cast<uint64_t>(v));
  return digest;
}

}  // namespace pelt::accuracy
