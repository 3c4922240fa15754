#include "bench/accuracy/chain_problem.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/accuracy/small_matrix.hpp"
#include "core/modal/modal_material.hpp"
#include "core/random.hpp"

namespace pelt::accuracy {
namespace {

constexpr double kPi = std::numbers::pi;

void FillBending(const ChainMaterial& material, ChainMatrix& bending) {
  const auto& k = material.stiffness;
  bending = {};
  for (int j = 0; j < material.links; ++j) {
    bending[j][j] += k[j];
    if (j == 0) continue;
    bending[j - 1][j - 1] += k[j];
    bending[j][j - 1] -= k[j];
    bending[j - 1][j] -= k[j];
  }
}

// M^-1 from the masses themselves: exact where M is nearly singular (mass ratios of 1e4).
void FillMassInverse(const ChainMaterial& material, ChainMatrix& inverse) {
  inverse = {};
  for (int i = 0; i < material.links; ++i) {
    const double above = i > 0 ? 1.0 / material.mass[i - 1] : 0.0;
    inverse[i][i] = (1.0 / material.mass[i] + above) / (material.length[i] * material.length[i]);
    if (i > 0)
      inverse[i][i - 1] = inverse[i - 1][i] =
          -above / (material.length[i] * material.length[i - 1]);
  }
}

ChainMaterial EqualLinks(int links, double length) {
  ChainMaterial material;
  material.links = links;
  for (int i = 0; i < links; ++i) {
    material.length[i] = length / links;
    material.mass[i] = 1.0 / links;
    material.stiffness[i] = 1.0;
  }
  return material;
}

}  // namespace

double ChainMaterial::TotalLength() const {
  double sum = 0.0;
  for (int i = 0; i < links; ++i) sum += length[i];
  return sum;
}

ChainMatrices MatricesOf(const ChainMaterial& material) {
  ChainMatrices m{};
  const int n = material.links;
  std::array<double, kMaxLinks> below{};  // mass from link i on
  for (int i = n - 1; i >= 0; --i) below[i] = material.mass[i] + (i + 1 < n ? below[i + 1] : 0.0);
  for (int i = 0; i < n; ++i) {
    m.pull[i] = material.length[i] * below[i];
    for (int j = 0; j < n; ++j)
      m.mass[i][j] = material.length[i] * material.length[j] * below[std::max(i, j)];
  }
  FillMassInverse(material, m.mass_inverse);
  FillBending(material, m.bending);
  std::array<double, kMaxLinks> square{};
  SolveModes(n, m.mass, m.bending, m.mode, square);
  for (int i = 0; i < n; ++i) m.omega[i] = std::sqrt(std::max(square[i], 0.0));
  return m;
}

void ScaleToFrequency(double frequency, ChainMaterial& material) {
  const double wanted = 2.0 * kPi * frequency / MatricesOf(material).omega[0];
  for (int i = 0; i < material.links; ++i) material.stiffness[i] *= wanted * wanted;
}

ChainMaterial MakeMaterial(const Preset& preset, int links, Coefficients coefficients) {
  ChainMaterial material = coefficients == Coefficients::kCalibrated
                               ? CalibratedRod(links, preset.length, 1.0, 1.0 / preset.length)
                               : EqualLinks(links, preset.length);
  ScaleToFrequency(preset.frequency, material);
  material.drag = preset.drag;
  material.bending_damping = 2.0 * preset.damping_ratio / (2.0 * kPi * preset.frequency);
  return material;
}

namespace {

constexpr RodCoefficients kThree = {{3.28087, 0.71400, 5.98435}, {0.72339, 1.45956, 0.31705}};
constexpr RodCoefficients kFour = {{3.07533, 0.76668, 1.38316, 4.35960},
                                   {0.69224, 1.27676, 1.15442, 0.37657}};
constexpr RodCoefficients kEight = {
    {2.6627, 0.96725, 0.97545, 0.96298, 0.96857, 1.20479, 1.34444, 1.10586},
    {0.90695, 0.84608, 0.94688, 1.1458, 1.0743, 1.0301, 1.1792, 0.36912}};

}  // namespace

const RodCoefficients& CalibratedCoefficients(int links) {
  return links == 3 ? kThree : links == 4 ? kFour : kEight;
}

ChainMaterial CalibratedRod(int links, double length, double bending_stiffness, double density) {
  const RodCoefficients& coefficients = CalibratedCoefficients(links);
  ChainMaterial material = NaiveRod(links, length, bending_stiffness, density);
  for (int i = 0; i < links; ++i) {
    material.stiffness[i] *= coefficients.stiffness[i];
    material.mass[i] *= coefficients.mass[i];
  }
  return material;
}

ChainMaterial NaiveRod(int links, double length, double bending_stiffness, double density) {
  ChainMaterial material = EqualLinks(links, length);
  for (int i = 0; i < links; ++i) {
    material.stiffness[i] = links * bending_stiffness / length;
    material.mass[i] = density * length / links;
  }
  return material;
}

std::vector<Strand> SeededStrands(int links, int count, uint64_t seed, CurlRange range) {
  std::vector<Strand> strands;
  for (int s = 0; s < count; ++s) {
    Random random(MixSeed(seed, uint64_t(s)));
    // Fibonacci's lattice on the sphere.
    const double height = 1.0 - 2.0 * (s + 0.5) / count, around = 2.39996322972865332 * s;
    const double across = std::sqrt(1.0 - height * height);
    const Double3 up = {across * exact::Cos(around), height, across * exact::Sin(around)};
    const Double3 side =
        Unit(Cross(up, std::abs(up.y) < 0.9 ? Double3{0.0, 1.0, 0.0} : Double3{1.0, 0.0, 0.0}));
    Double3 axis = TurnAbout(side, up, random.Uniform(0.0, 2.0 * kPi));
    const double curl = random.Uniform(range.least, range.most) * kPi / 180.0;
    Strand strand;
    strand.root = up * 0.1;
    Double3 direction = up;
    for (int i = 0; i < links; ++i) {
      strand.rest[i] = direction;
      direction = Unit(TurnAbout(direction, axis, curl));
      axis = Unit(TurnAbout(axis, direction, 0.5 * curl));
    }
    strands.push_back(strand);
  }
  return strands;
}

}  // namespace pelt::accuracy
