#include "core/modal/modal_material.hpp"

#include "core/exact_math.hpp"
#include "core/float_environment.hpp"
#include "core/float_rules.hpp"
#include "core/modal/node_model.hpp"

namespace pelt {
namespace {

// a x = b for several b by elimination without pivots, a symmetric and positive definite; b becomes x.
template <size_t kSize, size_t kColumns>
void SolvePositive(uint32_t n, double (&a)[kSize][kSize], double (&b)[kSize][kColumns]) {
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t r = 0; r < n; ++r) {
      if (r == i) continue;
      const double factor = a[r][i] / a[i][i];
      for (uint32_t c = i; c < n; ++c) a[r][c] -= factor * a[i][c];
      for (uint32_t c = 0; c < kColumns; ++c) b[r][c] -= factor * b[i][c];
    }
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t c = 0; c < kColumns; ++c) b[i][c] /= a[i][i];
}

// The rest curve's tangent at s from the directions of its `parts` parts: of the polynomial, of third degree
// at most, whose means over the parts are nearest to them.
constexpr uint32_t kMostTerms = 4;
double MeanOfPower(uint32_t power, uint32_t part, uint32_t parts) {
  // Of (2 s - 1)^power over [part, part + 1] / parts.
  const double low = 2.0 * part / parts - 1.0, high = 2.0 * (part + 1) / parts - 1.0;
  double above = high, below = low;
  for (uint32_t k = 0; k < power; ++k) above *= high, below *= low;
  return (above - below) / ((power + 1) * (high - low));
}
void FillRest(uint32_t parts, double s, double (&row)[kMaxPlaces]) {
  const uint32_t terms = parts < kMostTerms ? parts : kMostTerms;
  double normal[kMostTerms][kMostTerms] = {}, right[kMostTerms][1] = {};
  double power = 1.0;
  for (uint32_t i = 0; i < terms; ++i, power *= 2.0 * s - 1.0) {
    right[i][0] = power;
    for (uint32_t j = 0; j < terms; ++j)
      for (uint32_t part = 0; part < parts; ++part)
        normal[i][j] += MeanOfPower(i, part, parts) * MeanOfPower(j, part, parts);
  }
  SolvePositive(terms, normal, right);
  for (uint32_t part = 0; part < parts; ++part) {
    row[part] = 0.0;
    for (uint32_t i = 0; i < terms; ++i) row[part] += right[i][0] * MeanOfPower(i, part, parts);
  }
}

// Lagrange's polynomials through the nodes: their integral over the strand, and their value at the clamp.
template <size_t N>
void FillLagrange(const NodePlaces<N>& places, ModalMaterial& m) {
  const auto& s = places.node;
  for (size_t i = 0; i < N; ++i) {
    double coefficient[N] = {1.0};
    size_t degree = 0;
    m.turn[i] = 1.0;
    for (size_t j = 0; j < N; ++j) {
      if (j == i) continue;
      m.turn[i] *= s[j] / (s[j] - s[i]);
      // Times (x - s_j) / (s_i - s_j).
      for (size_t k = ++degree; k > 0; --k)
        coefficient[k] = (coefficient[k - 1] - s[j] * coefficient[k]) / (s[i] - s[j]);
      coefficient[0] *= -s[j] / (s[i] - s[j]);
    }
    m.weight[i] = 0.0;
    for (size_t k = 0; k < N; ++k) m.weight[i] += coefficient[k] / double(k + 1);
  }
}

template <size_t N>
void FillNodes(const NodePlaces<N>& places, double omega, ModalMaterial& m) {
  const NodeModel<N> model = MakeNodeModel(places);
  const uint32_t parts = m.points - 1, touched = PlacesOf(m.points);
  const double long2 = double(parts) * parts;
  for (size_t i = 0; i < N; ++i) {
    m.pull[i] = model.pull[i] * parts;
    const auto bend = model.BendAt(places.node[i]);
    for (size_t j = 0; j < N; ++j) {
      m.mass[i][j] = model.mass[i][j] * long2;
      m.stiffness[i][j] = model.stiffness[i][j] * long2 * omega * omega;
      m.bend[i][j] = bend[j];
    }
    FillRest(parts, places.node[i], m.rest[i]);
  }
  for (uint32_t q = 0; q < touched; ++q) {
    const auto place = model.PlaceAt(double(q + 1) / touched);
    for (size_t i = 0; i < N; ++i) m.place[q][i] = place[i] * parts;
  }
  FillLagrange(places, m);
  const double rod = omega * omega / (kRodFrequency1 * kRodFrequency1) * long2;
  for (size_t i = 0; i < N; ++i) m.weight[i] *= rod;
}

}  // namespace

ModalMaterial StrandMaterial(uint32_t points, double frequency_hz, double damping_ratio,
                             double drag_per_s, bool stiff) {
  const FloatEnvironment guard;
  ModalMaterial m{};
  m.nodes = NodesOf(points);
  m.points = points;
  m.drag_per_s = drag_per_s;
  const double omega = 2.0 * exact::kPi * frequency_hz;
  m.bend_damping_s = omega > 0.0 ? 2.0 * damping_ratio / omega : 0.0;
  if (m.nodes == 4)
    FillNodes(kFourNodes, omega, m);
  else
    FillNodes(stiff ? kThreeStiffNodes : kThreeNodes, omega, m);
  return m;
}

namespace {

// What is computed from registers into a register, out of line: in line, some of it may come before
// or after the float environment is set (core/float_environment.hpp).
[[gnu::noinline]] double FrequencyOfRod(double bending_stiffness, double mass_per_length,
                                        double length) {
  const double square = length * length;
  return kRodFrequency1 / (2.0 * exact::kPi * square) *
         std::sqrt(bending_stiffness / mass_per_length);
}

[[gnu::noinline]] double Gamma(double frequency_hz, double length_m, double acceleration) {
  const double omega = 2.0 * exact::kPi * frequency_hz;
  return kRodFrequency1 * kRodFrequency1 * acceleration / (length_m * omega * omega);
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

double GammaOf(double frequency_hz, double length_m, double acceleration) {
  const FloatEnvironment guard;
  return Gamma(frequency_hz, length_m, acceleration);
}

double FrequencyOfHardness(uint32_t links, double inner, double last, uint32_t iterations) {
  const FloatEnvironment guard;
  return FrequencyOfIterations(links, inner, last, iterations);
}

double RodFrequency(double bending_stiffness, double mass_per_length, double length) {
  const FloatEnvironment guard;
  return FrequencyOfRod(bending_stiffness, mass_per_length, length);
}

}  // namespace pelt
