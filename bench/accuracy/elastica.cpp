#include "bench/accuracy/elastica.hpp"

#include <cmath>
#include <numbers>

#include "bench/accuracy/dop853.hpp"
#include "core/exact_math.hpp"

namespace pelt::accuracy {
namespace {

// From the free end: with tau = 1 - s and phi = pi/2 - theta, phi'' = Gamma tau sin phi from
// phi'(0) = 0. Shooting from the clamp would magnify rounding by exp(2/3 sqrt Gamma); from the tip
// only the small angle phi(0) shrinks that way, and its logarithm is found without loss.
struct Rod {
  double gamma, target;  // phi at the clamp
  int steps;

  // phi, phi', integral of cos phi, of sin phi at the clamp; phi stays above `target` once there.
  std::array<double, 4> Shoot(double tip_angle) const {
    std::array<double, 4> y = {tip_angle, 0.0, 0.0, 0.0};
    const double h = 1.0 / steps;
    for (int i = 0; i < steps && y[0] <= target; ++i)
      dop853::Step<4>(
          [this](double tau, const std::array<double, 4>& at, std::array<double, 4>& slope) {
            slope = {at[1], gamma * tau * exact::Sin(at[0]), exact::Cos(at[0]), exact::Sin(at[0])};
          },
          i * h, h, y);
    return y;
  }
};

}  // namespace

Sag SolveElastica(double gamma, double clamp_angle) {
  Rod rod{gamma, 0.5 * std::numbers::pi - clamp_angle, 0};
  rod.steps = 200 + int(30.0 * std::sqrt(gamma));
  double high = exact::Log(rod.target), low = high - std::sqrt(gamma) - 5.0;
  for (int i = 0; i < 100 && high - low > 4e-16 * std::abs(high + low); ++i) {
    const double middle = 0.5 * (low + high);
    (rod.Shoot(exact::Exp(middle))[0] > rod.target ? high : low) = middle;
  }
  const std::array<double, 4> end = rod.Shoot(exact::Exp(low));
  return {end[2], end[3]};
}

Sag SolveChainSag(ChainMaterial material, double gamma, double bending_stiffness, double density,
                  double clamp_angle) {
  const double length = material.TotalLength();
  const double weight = gamma * bending_stiffness / (density * length * length * length);
  material.gravity = {0.0, -weight, 0.0};
  Strand strand;
  for (Double3& rest : strand.rest) rest = {exact::Cos(clamp_angle), -exact::Sin(clamp_angle), 0.0};
  const auto direction = FindEquilibrium(material, strand);
  Double3 tip = kZero3;
  for (int i = 0; i < material.links; ++i) tip = tip + direction[i] * material.length[i];
  return {-tip.y / length, tip.x / length};
}

}  // namespace pelt::accuracy
