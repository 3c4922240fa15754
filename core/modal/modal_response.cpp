#include "core/modal/modal_response.hpp"

#include <cmath>

#include "core/float_rules.hpp"

namespace pelt {
namespace {

constexpr int kTerms = 18;  // 0.25^18 / 18! is far below a rounding

// Sums the Taylor series of y'' = t^power (or 0 for power -1) - C y' - w2 y.
void SumSeries(double damping, double omega2, double h, double y0, double v0, int power, double* y,
               double* v) {
  // a: coefficient times h^n, so that nothing overflows.
  double a[kTerms + 2] = {y0, v0 * h};
  double force = power == 0 ? 1.0 : 0.0;
  double h_power = 1.0;
  for (int n = 0; n < kTerms; ++n) {
    if (n == power) force = h_power;
    a[n + 2] = ((n == power ? force : 0.0) * h * h - damping * h * double(n + 1) * a[n + 1] -
                omega2 * h * h * a[n]) /
               (double(n + 1) * double(n + 2));
    h_power *= h;
  }
  double sum_y = 0.0, sum_v = 0.0;
  for (int n = kTerms + 1; n >= 0; --n) {
    sum_y += a[n];
    sum_v += double(n) * a[n];
  }
  *y = sum_y;
  *v = sum_v / h;
}

OscillatorStep ShortStep(double damping, double omega2, double h) {
  OscillatorStep s;
  SumSeries(damping, omega2, h, 1.0, 0.0, -1, &s.y_of_y, &s.v_of_y);
  SumSeries(damping, omega2, h, 0.0, 1.0, -1, &s.y_of_v, &s.v_of_v);
  for (int k = 0; k < kResponsePowers; ++k)
    SumSeries(damping, omega2, h, 0.0, 0.0, k, &s.y_of_force[k], &s.v_of_force[k]);
  return s;
}

// From a step of h to one of 2 h.
OscillatorStep Double(const OscillatorStep& s, double h) {
  static constexpr double kBinomial[kResponsePowers][kResponsePowers] = {
      {1}, {1, 1}, {1, 2, 1}, {1, 3, 3, 1}};
  OscillatorStep d;
  d.y_of_y = s.y_of_y * s.y_of_y + s.y_of_v * s.v_of_y;
  d.y_of_v = s.y_of_y * s.y_of_v + s.y_of_v * s.v_of_v;
  d.v_of_y = s.v_of_y * s.y_of_y + s.v_of_v * s.v_of_y;
  d.v_of_v = s.v_of_y * s.y_of_v + s.v_of_v * s.v_of_v;
  for (int k = 0; k < kResponsePowers; ++k) {
    double y = s.y_of_y * s.y_of_force[k] + s.y_of_v * s.v_of_force[k];
    double v = s.v_of_y * s.y_of_force[k] + s.v_of_v * s.v_of_force[k];
    double h_power = 1.0;
    for (int j = k; j >= 0; --j) {
      y += kBinomial[k][j] * h_power * s.y_of_force[j];
      v += kBinomial[k][j] * h_power * s.v_of_force[j];
      h_power *= h;
    }
    d.y_of_force[k] = y;
    d.v_of_force[k] = v;
  }
  return d;
}

}  // namespace

OscillatorStep StepOscillator(double damping, double omega2, double h) {
  int halvings = 0;
  double part = h;
  while (halvings < 60 && (damping * part > 0.25 || omega2 * part * part > 0.0625)) {
    part *= 0.5;
    ++halvings;
  }
  OscillatorStep s = ShortStep(damping, omega2, part);
  for (; halvings > 0; --halvings) {
    s = Double(s, part);
    part *= 2.0;
  }
  return s;
}

}  // namespace pelt
