#include "bench/accuracy/feature_errors.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "bench/accuracy/reference_integrator.hpp"
#include "bench/accuracy/solver_run.hpp"
#include "core/random.hpp"

namespace pelt::accuracy {
namespace {

constexpr int kRate = 60;

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

// Distance of the nearest points of two segments, by thirds: one of them may be a point.
double DistanceOf(Double3 from, Double3 to, Double3 other_from, Double3 other_to) {
  const auto nearest = [](Double3 point, Double3 a, Double3 b) {
    const Double3 way = b - a;
    const double square = Dot(way, way);
    return square > 0.0 ? a + way * std::clamp(Dot(point - a, way) / square, 0.0, 1.0) : a;
  };
  const auto at = [&](double share) {
    const Double3 point = from + (to - from) * share;
    return Length(nearest(point, other_from, other_to) - point);
  };
  // Convex in the share.
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
    (at(a) < at(b) ? high : low) = at(a) < at(b) ? b : a;
  }
  return at(low);
}

// Deepest point, of links for round shapes, over the length. The first frames are left out: strands may start inside.
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
        const Double3 root = pose.Place(strand.root),
                      from = link == 0 ? root : root + track[at - 1];
        const Double3 way = ColliderWay(f, time), centre = f.sphere_centre + way;
        const auto meet = [&](double radius, Double3 first, Double3 last) {
          if (radius > 0.0)
            deepest = std::max(deepest, radius - DistanceOf(from, world, first, last));
        };
        meet(f.sphere_radius, centre, centre);
        meet(f.capsule_radius, f.capsule_from + way, f.capsule_to + way);
      });
  return deepest / p.material.TotalLength();
}

// ---- The reference of contact ----------------------------------------------------------------

std::vector<ContactShape> ShapesOf(const ModalFeatures& f) {
  std::vector<ContactShape> shapes;
  if (f.use_ground) {
    ContactShape ground;
    ground.normal = f.ground_normal;
    ground.offset = f.ground_offset;
    shapes.push_back(ground);
  }
  const auto add = [&](double radius, Double3 from, Double3 to) {
    if (radius <= 0.0) return;
    ContactShape shape;
    shape.from = from, shape.to = to, shape.radius = radius;
    shape.way = [f](double t) { return ColliderWay(f, t); };
    shape.speed = [f](double t) { return ColliderSpeed(f, t); };
    shapes.push_back(shape);
  };
  add(f.sphere_radius, f.sphere_centre, f.sphere_centre);
  add(f.capsule_radius, f.capsule_from, f.capsule_to);
  return shapes;
}

Track ContactTrack(const FeatureProblem& p, int steps_per_second, double seconds) {
  std::vector<LinkDirections> start;
  for (const Strand& strand : p.strands) start.push_back(FindEquilibrium(p.material, strand));
  ContactReference run(p.material, p.strands, start, MotionOf(p.motion), ShapesOf(p.features),
                       double(p.features.friction), steps_per_second * p.contact_scale);
  Track track;
  for (int f = 0; f < int(std::lround(seconds * kRate)); ++f) {
    for (int step = 0; step < steps_per_second * p.contact_scale / kRate; ++step) run.Step();
    for (size_t s = 0; s < p.strands.size(); ++s)
      for (int i = 0; i < p.material.links; ++i) track.push_back(run.Point(s, i));
  }
  return track;
}

// Fastest point of the frames from `first` on, m/s.
double FastestOf(const FeatureProblem& p, const Track& track, size_t first) {
  const size_t row = p.strands.size() * size_t(p.material.links);
  double fastest = 0.0;
  for (size_t at = std::max<size_t>(first, 1) * row; at < track.size(); ++at)
    fastest = std::max(fastest, Length(track[at] - track[at - row]) * kRate);
  return fastest;
}

double SecondsOf(const FeatureProblem& p, double seconds) {
  return p.seconds > 0.0 ? std::min(p.seconds, seconds) : seconds;
}

double Nanoseconds(const FeatureProblem& p, const ModalKernels& kernels, ModalQuality quality,
                   const TimingOptions& timing) {
  if (timing.frames == 0) return 0.0;
  TimedProblem timed{p.material, p.strands, {}, MotionOf(p.motion), 1.0};
  for (const Strand& strand : p.strands) timed.start.push_back(FindEquilibrium(p.material, strand));
  ModalFeatures bare;
  bare.wind = false;
  const SolverFactory pair[] = {LayerFactory(kernels, quality, p.features),
                                LayerFactory(kernels, quality, bare)};
  const auto time = TimeInTurn(pair, timed, timing);
  return time[0].ns - time[1].ns;
}

}  // namespace

bool HasContactReference(const FeatureProblem& p) {
  const ModalFeatures& f = p.features;
  const bool touches = f.use_ground || f.sphere_radius > 0.0 || f.capsule_radius > 0.0;
  return touches && f.bounce == 0.0f && p.promise == Promise::kNone;
}

double ContactError(const ModalKernels& kernels, const FeatureProblem& p, int scale,
                    int steps_per_second, double seconds) {
  const double lasts = SecondsOf(p, seconds);
  const SolverFactory best = ModalFactory(kernels, ModalQuality::kBest, p.features);
  return ErrorOf(p, RunAt(p, best, scale, lasts), ContactTrack(p, steps_per_second, lasts));
}

double ContactSelfError(const FeatureProblem& p, int steps_per_second, double seconds) {
  const double lasts = SecondsOf(p, seconds);
  return ErrorOf(p, ContactTrack(p, steps_per_second, lasts),
                 ContactTrack(p, 2 * steps_per_second, lasts));
}

std::vector<FeatureError> MeasureFeatures(const ModalKernels& kernels,
                                          const FeatureOptions& options) {
  std::vector<FeatureError> rows;
  for (const FeatureProblem& p : FeatureProblems(options.links)) {
    const double seconds = SecondsOf(p, options.seconds);
    const SolverFactory best = LayerFactory(kernels, ModalQuality::kBest, p.features);
    const Track reference = RunAt(p, best, options.reference_scale, seconds);
    const double self = ErrorOf(p, RunAt(p, best, options.reference_scale / 2, seconds), reference);
    Track exact;
    FeatureError row{};
    row.name = p.name, row.self_error = self;
    if (HasContactReference(p)) {
      exact = ContactTrack(p, options.contact_rate, seconds);
      row.contact_self_error =
          ErrorOf(p, ContactTrack(p, options.contact_rate / 2, seconds), exact);
    }
    for (const ModalQuality quality :
         {ModalQuality::kFast, ModalQuality::kFine, ModalQuality::kBest}) {
      const Track track = RunAt(p, LayerFactory(kernels, quality, p.features), 1, seconds);
      row.quality = quality;
      row.error = ErrorOf(p, track, reference);
      if (!exact.empty())
        row.contact_error =
            ErrorOf(p, RunAt(p, ModalFactory(kernels, quality, p.features), 1, seconds), exact);
      row.penetration = PenetrationOf(p, track);
      row.nanoseconds = Nanoseconds(p, kernels, quality, options.timing);
      const size_t last = size_t(std::lround((seconds - 0.5) * kRate));
      if (p.promise == Promise::kLeavesSlowly) row.fastest = FastestOf(p, track, 0);
      if (p.promise == Promise::kComesToRest) row.fastest = FastestOf(p, track, last);
      rows.push_back(row);
    }
  }
  return rows;
}

uint64_t RunDigest(const ModalKernels& kernels, ModalQuality quality, const FeatureProblem& problem,
                   double seconds) {
  uint64_t digest = 0;
  for (const Double3 point :
       RunAt(problem, LayerFactory(kernels, quality, problem.features), 1, seconds))
    for (const double v : {point.x, point.y, point.z})
      digest = MixSeed(digest, std::bit_cast<uint64_t>(v));
  return digest;
}

}  // namespace pelt::accuracy
