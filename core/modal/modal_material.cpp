#include "core/modal/modal_material.hpp"

#include "core/exact_math.hpp"
#include "core/float_environment.hpp"
#include "core/float_rules.hpp"
#include "core/modal/modal_modes.hpp"

namespace pelt {
namespace {

constexpr RodCoefficients kThree = {{3.28087, 0.71400, 5.98435}, {0.72339, 1.45956, 0.31705}};
constexpr RodCoefficients kFour = {{3.07533, 0.76668, 1.38316, 4.35960},
                                   {0.69224, 1.27676, 1.15442, 0.37657}};
constexpr RodCoefficients kEight = {
    {2.6627, 0.96725, 0.97545, 0.96298, 0.96857, 1.20479, 1.34444, 1.10586},
    {0.90695, 0.84608, 0.94688, 1.1458, 1.0743, 1.0301, 1.1792, 0.36912}};
constexpr RodCoefficients kUniform = {{1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0},
                                      {1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0}};

ModalMaterial Scale(const RodCoefficients& c, uint32_t links, double frequency_hz,
                    double damping_ratio, double drag_per_s) {
  ModalMaterial m{};
  m.links = links;
  m.drag_per_s = drag_per_s;
  double total = 0.0;
  for (uint32_t i = 0; i < links; ++i) total += c.mass[i];
  for (uint32_t i = 0; i < links; ++i) {
    m.mass[i] = c.mass[i] / total;
    m.stiffness[i] = c.stiffness[i];
  }
  const double omega = 2.0 * exact::kPi * frequency_hz;
  const double scale = omega * omega / FindModes(m).omega2[0];
  for (uint32_t i = 0; i < links; ++i) m.stiffness[i] *= scale;
  m.bend_damping_s = omega > 0.0 ? 2.0 * damping_ratio / omega : 0.0;
  return m;
}

}  // namespace

const RodCoefficients& CalibratedCoefficients(uint32_t links) {
  return links == 3 ? kThree : links == 4 ? kFour : kEight;
}

ModalMaterial CalibratedMaterial(uint32_t links, double frequency_hz, double damping_ratio,
                                 double drag_per_s) {
  const FloatEnvironment guard;
  return Scale(CalibratedCoefficients(links), links, frequency_hz, damping_ratio, drag_per_s);
}

ModalMaterial UniformMaterial(uint32_t links, double frequency_hz, double damping_ratio,
                              double drag_per_s) {
  const FloatEnvironment guard;
  return Scale(kUniform, links, frequency_hz, damping_ratio, drag_per_s);
}

namespace {

// What is computed from registers into a register, out of line: in line, some of it may come before
// or after the float environment is set (core/float_environment.hpp).
[[gnu::noinline]] double FrequencyOfRod(double bending_stiffness, double mass_per_length,
                                        double length) {
  const double square = length * length;
  // First root of cos(x) cosh(x) = -1, squared.
  const double ratio = 3.5160152685001;
  return ratio / (2.0 * exact::kPi * square) * std::sqrt(bending_stiffness / mass_per_length);
}

[[gnu::noinline]] double FrequencyOfIterations(uint32_t links, double inner, double last,
                                               uint32_t iterations) {
  constexpr double kFramesPerSecond = 60.0, kLeastLeft = 1.0e-4;
  const double hardness = (inner * (links - 1) + last) / links;
  double left = 1.0;
  for (uint32_t i = 0; i < iterations; ++i) left *= 1.0 - hardness;
  left = left > kLeastLeft ? left : kLeastLeft;
  // A joint's stiffness over a link's mass; with links of length 1 that is B over rho.
  const double omega = kFramesPerSecond * std::sqrt(1.0 / left - 1.0);
  return FrequencyOfRod(omega * omega, 1.0, double(links));
}

}  // namespace

double FrequencyOfHardness(uint32_t links, double inner, double last, uint32_t iterations) {
  const FloatEnvironment guard;
  return FrequencyOfIterations(links, inner, last, iterations);
}

double RodFrequency(double bending_stiffness, double mass_per_length, double length) {
  const FloatEnvironment guard;
  return FrequencyOfRod(bending_stiffness, mass_per_length, length);
}

}  // namespace pelt
