// Energy, frequency and decay, static shape.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "bench/accuracy/small_matrix.hpp"
#include "bench/accuracy/solver_checks.hpp"
#include "bench/accuracy/solver_run.hpp"
#include "core/exact_math.hpp"
#include "core/random.hpp"

namespace pelt::accuracy {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Strand StraightStrand(Double3 direction) {
  Strand strand;
  strand.root = kZero3;
  for (Double3& rest : strand.rest) rest = direction;
  return strand;
}

}  // namespace

double EnergyOf(const ChainMaterial& material, const Strand& strand, const Double3* points,
                const Double3* velocities) {
  double energy = 0.0;
  Double3 upper = kZero3, strain_above = kZero3;
  for (int i = 0; i < material.links; ++i) {
    energy += material.mass[i] *
              (0.5 * Dot(velocities[i], velocities[i]) - Dot(material.gravity, points[i]));
    const Double3 strain = (points[i] - upper) * (1.0 / material.length[i]) - strand.rest[i];
    const Double3 bend = strain - strain_above;
    energy += 0.5 * material.stiffness[i] * Dot(bend, bend);
    upper = points[i];
    strain_above = strain;
  }
  return energy;
}

double EnergyKept(const SolverFactory& factory, int links, double frequency, int frames_per_second,
                  double seconds) {
  ChainMaterial material = MakeMaterial(kPresets[1], links);
  material.drag = material.bending_damping = 0.0;
  if (frequency > 0.0) {
    ScaleToFrequency(frequency, material);
  } else {
    material.stiffness = {};
  }
  const Strand strand = StraightStrand({1.0, 0.0, 0.0});
  const BodyPose still = StillPose();
  const double degrees = (frequency > 0.0 ? -20.0 : 60.0) * std::numbers::pi / 180.0;
  LinkDirections start;
  start.fill({exact::Cos(degrees), -exact::Sin(degrees), 0.0});
  SolverRun run(factory, material, 1.0 / frames_per_second, {strand}, std::span(&start, 1), still);
  if (!run.valid()) return kNone;
  const auto energy_at = [&](const LinkDirections& d) {
    Double3 points[kMaxLinks], at = kZero3;
    const Double3 velocities[kMaxLinks] = {};
    for (int i = 0; i < links; ++i) points[i] = at = at + d[i] * material.length[i];
    return EnergyOf(material, strand, points, velocities);
  };
  const double first = energy_at(start);
  LinkDirections hanging;
  hanging.fill({0.0, -1.0, 0.0});
  const double low = energy_at(frequency > 0.0 ? FindEquilibrium(material, strand) : hanging);
  const int frames = int(std::lround(seconds * frames_per_second)), tail = frames_per_second / 2;
  double sum = 0.0;
  for (int f = 0; f < frames; ++f) {
    run.Step(still);
    if (f < frames - tail) continue;
    Double3 points[kMaxLinks], velocities[kMaxLinks];
    for (int i = 0; i < links; ++i) {
      points[i] = run.Point(0, i);
      velocities[i] = run.Velocity(0, i);
    }
    sum += EnergyOf(material, strand, points, velocities);
  }
  return (sum / tail - low) / (first - low);
}

namespace {

void FillExact(const ChainMaterial& material, double omega, double h, ModeResponse& r) {
  const double s = 0.5 * (material.drag + material.bending_damping * omega * omega);
  const double square = omega * omega - s * s, w = std::sqrt(std::abs(square)) * h;
  const double decay = exact::Exp(-s * h);
  const double even = square >= 0.0 ? exact::Cos(w) : 0.5 * (exact::Exp(w) + exact::Exp(-w));
  const double odd = square >= 0.0 ? exact::Sin(w) : 0.5 * (exact::Exp(w) - exact::Exp(-w));
  r.exact_first = decay * (even + (w > 0.0 ? s * h / w * odd : s * h));
  r.exact_sum = 2.0 * decay * even;
  r.exact_product = decay * decay;
}

// Least squares for y(k+2) = sum y(k+1) - product y(k).
void FitRecurrence(const std::vector<double>& y, ModeResponse& r) {
  double aa = 0.0, ab = 0.0, bb = 0.0, ac = 0.0, bc = 0.0;
  for (size_t k = 0; k + 2 < y.size(); ++k) {
    aa += y[k + 1] * y[k + 1];
    ab += y[k + 1] * y[k];
    bb += y[k] * y[k];
    ac += y[k + 1] * y[k + 2];
    bc += y[k] * y[k + 2];
  }
  const double determinant = aa * bb - ab * ab;
  r.sum = (ac * bb - bc * ab) / determinant;
  r.product = -(aa * bc - ab * ac) / determinant;
}

// Phi^T M d_y of one mode.
template <class F>
double ModeCoordinate(const ChainMatrices& x, int links, int mode, F direction) {
  double y = 0.0;
  for (int i = 0; i < links; ++i)
    for (int j = 0; j < links; ++j) y += x.mode[i][mode] * x.mass[i][j] * direction(j);
  return y;
}

}  // namespace

std::vector<ModeResponse> MeasureModes(const SolverFactory& factory, const ChainMaterial& material,
                                       double frame_seconds, double amplitude) {
  ChainMaterial weightless = material;
  weightless.gravity = kZero3;
  const ChainMatrices x = MatricesOf(weightless);
  const int n = material.links;
  const Strand strand = StraightStrand({1.0, 0.0, 0.0});
  const BodyPose still = StillPose();
  std::vector<ModeResponse> responses;
  for (int m = 0; m < n; ++m) {
    double largest = 0.0;
    for (int i = 0; i < n; ++i) largest = std::max(largest, std::abs(x.mode[i][m]));
    LinkDirections start{};
    for (int i = 0; i < n; ++i) start[i] = Unit({1.0, amplitude * x.mode[i][m] / largest, 0.0});
    SolverRun run(factory, weightless, frame_seconds, {strand}, std::span(&start, 1), still);
    if (!run.valid()) return {};
    const double first = ModeCoordinate(x, n, m, [&](int j) { return start[j].y; });
    std::vector<double> y = {1.0};
    // While more is left than the float's noise.
    for (int f = 1; f <= 600; ++f) {
      run.Step(still);
      y.push_back(ModeCoordinate(x, n, m,
                                 [&](int j) {
                                   const double upper = j > 0 ? run.Point(0, j - 1).y : 0.0;
                                   return (run.Point(0, j).y - upper) / weightless.length[j];
                                 }) /
                  first);
      if (f >= 3 && std::abs(y[y.size() - 1]) + std::abs(y[y.size() - 2]) < 0.05) break;
    }
    ModeResponse response{};
    response.omega = x.omega[m];
    response.first = y[1];
    response.gone = std::abs(y[1]) + std::abs(y[2]) < 0.01;
    FillExact(material, x.omega[m], frame_seconds, response);
    FitRecurrence(y, response);
    responses.push_back(response);
  }
  return responses;
}

ModeRate RateOf(double sum, double product, double frame_seconds) {
  const double decay = -0.5 * exact::Log(product) / frame_seconds;
  return {std::acos(sum / (2.0 * std::sqrt(product))) / frame_seconds, decay};
}

double StaticShapeError(const SolverFactory& factory, const ChainMaterial& material,
                        const Strand& strand, double frames_per_second, double seconds,
                        double jitter) {
  const LinkDirections exact = FindEquilibrium(material, strand);
  Double3 rest = kZero3, tip = kZero3;
  for (int i = 0; i < material.links; ++i) {
    rest = rest + strand.rest[i] * material.length[i];
    tip = tip + exact[i] * material.length[i];
  }
  const BodyPose still = StillPose();
  SolverRun run(factory, material, 1.0 / frames_per_second, {strand}, std::span(&strand.rest, 1),
                still);
  if (!run.valid()) return kNone;
  Random random(1);
  for (double t = 0.0; t < seconds;) {
    double frame = 1.0 / frames_per_second;
    if (jitter > 0.0) {
      frame *= exact::Exp(exact::Log(1.0 + jitter) * random.Uniform(-1.0, 1.0));
      run.SetFrameTime(frame);
    }
    run.Step(still);
    t += frame;
  }
  return Length(run.Point(0, material.links - 1) - rest) / Length(tip - rest) - 1.0;
}

// ---- What solvers make of it -----------------------------------------------------------------

namespace {

double WorstMode(const SolverFactory& factory, const ChainMaterial& material) {
  double worst = 0.0;
  for (const int rate : {15, 60, 240})
    for (const ModeResponse& mode : MeasureModes(factory, material, 1.0 / rate)) {
      worst = std::max(worst, std::abs(mode.first - mode.exact_first));
      if (mode.gone) continue;
      worst = std::max(worst, std::abs(mode.sum - mode.exact_sum));
      worst = std::max(worst, std::abs(mode.product - mode.exact_product));
    }
  return worst;
}

StabilityRow MeasureSolver(const NamedSolver& solver, Isa isa) {
  const SolverFactory factory = FactoryOf(solver, isa);
  const ChainMaterial medium = MakeMaterial(kPresets[2], 3);
  const Strand strand = SeededStrands(3, 6, 1)[3];
  StabilityRow row{};
  row.solver = solver;
  for (size_t f = 0; f < 3; ++f) row.energy[f] = EnergyKept(factory, 3, kEnergyFrequencies[f], 60);
  for (size_t r = 0; r < kStaticRates.size(); ++r)
    row.shape[r] = StaticShapeError(factory, medium, strand, kStaticRates[r]);
  row.mixed_shape = StaticShapeError(factory, medium, strand, 60, 8.0, 3.0);
  const ModeResponse first = MeasureModes(factory, medium, 1.0 / 60)[0];
  const ModeRate exact = RateOf(first.exact_sum, first.exact_product, 1.0 / 60);
  const ModeRate rate = RateOf(first.sum, first.product, 1.0 / 60);
  row.frequency_error = rate.frequency / exact.frequency - 1.0;
  row.decay_error = rate.decay / exact.decay - 1.0;
  row.worst_mode = WorstMode(factory, medium);
  return row;
}

}  // namespace

std::vector<StabilityRow> MeasureStability(Isa isa, bool quick) {
  static constexpr std::string_view kQuick[] = {"pbd-4", "xpbd-8", "modal", "modal-fine",
                                                "modal-best"};
  static constexpr std::string_view kAll[] = {
      "dftl-1",  "textbook-pbd-4", "pbd-4", "verlet-4",   "xpbd-8",    "xpbd-64",
      "euler-1", "trapezoid-2",    "modal", "modal-fine", "modal-best"};
  std::vector<StabilityRow> rows;
  const std::span<const std::string_view> names =
      quick ? std::span<const std::string_view>(kQuick) : std::span<const std::string_view>(kAll);
  for (const std::string_view name : names) rows.push_back(MeasureSolver(*FindSolver(name), isa));
  return rows;
}

}  // namespace pelt::accuracy
