#include "bench/accuracy/comparison/tables.hpp"

#include <algorithm>

#include "bench/accuracy/chain_problem.hpp"
#include "bench/accuracy/small_matrix.hpp"
#include "core/exact_math.hpp"

namespace pelt::accuracy {
namespace {

static_assert(kMaxTableLinks <= kMaxLinks);

StepTable MakeStep(const ChainMaterial& m, const MethodSettings& settings, double frame_seconds) {
  const double h = frame_seconds / settings.substeps;
  StepTable t{};
  t.links = m.links;
  t.substeps = settings.substeps;
  t.iterations = settings.iterations;
  t.step = float(h);
  t.step_inverse = float(1.0 / h);
  const double keep = exact::Exp(-m.drag * h);
  t.keep = float(keep);
  t.take = float(1.0 - keep);
  t.gravity[0] = float(m.gravity.x);
  t.gravity[1] = float(m.gravity.y);
  t.gravity[2] = float(m.gravity.z);
  for (int i = 0; i < m.links; ++i) {
    t.length[i] = float(m.length[i]);
    t.length_inverse[i] = float(1.0 / m.length[i]);
  }
  return t;
}

// The share of a sweep: what one sweep of implicit Euler on the lower point alone would take,
// spread over the sweeps.
void FillPoint(const ChainMaterial& m, const MethodSettings& settings, double frame_seconds,
               PointTable& t) {
  t.step = MakeStep(m, settings, frame_seconds);
  t.correction = float(settings.correction);
  t.one_sided = settings.one_sided;
  const double h = frame_seconds / settings.substeps;
  const int sweeps = settings.method == Method::kPbd ? settings.iterations : 1;
  for (int i = 0; i < m.links; ++i) {
    const double a =
        settings.stiffness_scale * m.stiffness[i] * h * h / (m.length[i] * m.length[i] * m.mass[i]);
    t.share[i] = float(1.0 - exact::Pow(1.0 + a, -1.0 / sweeps));
  }
}

void FillCubicRoot(int substeps, CubicRootTable& t) {
  for (int s = 0; s < substeps; ++s) {
    double begin[4], value[4], rate[4], bend[4];
    CubicWeights(double(s) / substeps, begin, rate, bend);
    CubicWeights(double(s + 1) / substeps, value, rate, bend);
    for (int j = 0; j < 4; ++j) {
      t.end[s][j] = float(value[j]);
      t.change[s][j] = float(value[j] - begin[j]);
    }
  }
}

void FillXpbd(const ChainMaterial& m, const MethodSettings& settings, double frame_seconds,
              XpbdTable& t) {
  t.step = MakeStep(m, settings, frame_seconds);
  const double h = frame_seconds / settings.substeps;
  t.damping = float(m.bending_damping / h);
  t.damped = m.bending_damping > 0.0;
  t.bends = false;
  t.inverse_mass[0] = 0.0f;
  for (int i = 0; i < m.links; ++i) {
    const double w = 1.0 / m.mass[i], w_up = i > 0 ? 1.0 / m.mass[i - 1] : 0.0;
    const double w_top = i > 1 ? 1.0 / m.mass[i - 2] : 0.0;
    const double below = 1.0 / m.length[i], above = i > 0 ? 1.0 / m.length[i - 1] : 0.0;
    const double response =
        w * below * below + w_up * (below + above) * (below + above) + w_top * above * above;
    const double k = m.stiffness[i];
    t.bends = t.bends || k > 0.0;
    t.inverse_mass[i + 1] = float(w);
    t.compliance[i] = float(k > 0.0 ? 1.0 / (k * h * h) : 0.0);
    t.denominator[i] =
        float(k > 0.0 ? 1.0 / ((1.0 + m.bending_damping / h) * response + 1.0 / (k * h * h)) : 0.0);
    t.below[i] = float(below);
    t.at[i] = float(-(below + above));
    t.above[i] = float(above);
    t.lower_share[i] = float(w / (w + w_up));
  }
  FillCubicRoot(settings.substeps, t.root);
}

void Store(int n, const ChainMatrix& a, float (&out)[kMaxTableLinks][kMaxTableLinks]) {
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) out[i][j] = float(a[i][j]);
}

// a M + b K.
ChainMatrix Mix(int n, const ChainMatrices& x, double a, double b) {
  ChainMatrix sum{};
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) sum[i][j] = a * x.mass[i][j] + b * x.bending[i][j];
  return sum;
}

void FillRootWeights(int substeps, double frame_seconds, DirectTable& t) {
  double value[4], rate[4], bend[4], begin[4], unused[4], unused2[4];
  for (int s = 0; s < substeps; ++s) {
    CubicWeights((s + 0.5) / substeps, value, rate, bend);
    for (int j = 0; j < 4; ++j) {
      t.middle[s][j] = float(value[j]);
      t.bend[s][j] = float(bend[j] / (frame_seconds * frame_seconds));
    }
    CubicWeights(double(s) / substeps, begin, unused, unused2);
    CubicWeights(double(s + 1) / substeps, value, unused, unused2);
    for (int j = 0; j < 4; ++j) t.change[s][j] = float(value[j] - begin[j]);
  }
  CubicWeights(0.0, value, rate, bend);
  for (int j = 0; j < 4; ++j) t.start_rate[j] = float(rate[j] / frame_seconds);
  CubicWeights(1.0, value, rate, bend);
  for (int j = 0; j < 4; ++j) t.end_rate[j] = float(rate[j] / frame_seconds);
}

void FillDirect(const ChainMaterial& m, const MethodSettings& settings, double frame_seconds,
                DirectTable& t) {
  t.step = MakeStep(m, settings, frame_seconds);
  const double h = frame_seconds / settings.substeps, c = m.drag, beta = m.bending_damping;
  t.drag = float(c);
  t.damping = float(beta);
  t.damping_rate = float(beta / h);
  const ChainMatrices x = MatricesOf(m);
  const int n = m.links;
  const bool trapezoid = settings.method == Method::kTrapezoid;
  const double first = trapezoid ? 2.0 / (h * h) + c / h : 1.0 / (h * h) + c / h;
  const ChainMatrix system = Mix(n, x, first, beta / h + (trapezoid ? 0.5 : 1.0));
  const ChainMatrix response = Inverse(n, system);
  Store(n, system, t.system);
  Store(n, response, t.response);
  Store(n, Product(n, response, Mix(n, x, first, beta / h - (trapezoid ? 0.5 : 0.0))),
        t.to_direction);
  Store(n, Product(n, response, Mix(n, x, (trapezoid ? 2.0 : 1.0) / h, 0.0)), t.to_rate);
  Store(n, Product(n, response, Mix(n, x, 0.0, 1.0)), t.to_rest);
  Store(n, x.mass_inverse, t.mass_inverse);
  for (int i = 0; i < n; ++i) {
    double sum = 0.0;
    for (int j = 0; j < n; ++j) sum += response[i][j] * x.pull[j];
    t.pull[i] = float(sum);
  }
  FillRootWeights(settings.substeps, frame_seconds, t);
}

}  // namespace

void CubicWeights(double s, double (&value)[4], double (&rate)[4], double (&bend)[4]) {
  constexpr double kNode[4] = {1.0, 0.0, -1.0, -2.0};
  for (int j = 0; j < 4; ++j) {
    value[j] = 1.0;
    rate[j] = bend[j] = 0.0;
    for (int i = 0; i < 4; ++i) {
      if (i == j) continue;
      const double slope = 1.0 / (kNode[j] - kNode[i]), f = (s - kNode[i]) * slope;
      bend[j] = bend[j] * f + 2.0 * rate[j] * slope;
      rate[j] = rate[j] * f + value[j] * slope;
      value[j] *= f;
    }
  }
}

void MakeTables(const ChainMaterial& material, const MethodSettings& settings, double frame_seconds,
                ComparisonTables& tables) {
  tables.settings = settings;
  switch (settings.method) {
    case Method::kFollowTheLeader:
    case Method::kPbd:
      return FillPoint(material, settings, frame_seconds, tables.point);
    case Method::kXpbd:
    case Method::kXpbdCubic:
      return FillXpbd(material, settings, frame_seconds, tables.xpbd);
    case Method::kImplicitEuler:
    case Method::kTrapezoid:
      return FillDirect(material, settings, frame_seconds, tables.direct);
  }
}

}  // namespace pelt::accuracy
