#include "core/modal/node_model.hpp"

#include "core/exact_math.hpp"
#include "core/float_rules.hpp"

namespace pelt {
namespace {

// Gauss's 16 points on [-1, 1], the positive half, and their weights: exact to degree 31.
constexpr int kHalf = 8;
constexpr double kPoint[kHalf] = {
    0.0950125098376374402, 0.2816035507792589132, 0.4580167776572273863, 0.6178762444026437484,
    0.7554044083550030339, 0.8656312023878317439, 0.9445750230732325761, 0.9894009349916499326};
constexpr double kWeight[kHalf] = {
    0.1894506104550684963, 0.1826034150449235889, 0.1691565193950025382, 0.1495959888165767321,
    0.1246289712555338720, 0.0951585116824927848, 0.0622535239386478929, 0.0271524594117540949};

// visit(s, weight) at the points of [0, end].
template <class Visit>
void ForEachPoint(double end, const Visit& visit) {
  for (int side = 0; side < 2; ++side)
    for (int i = 0; i < kHalf; ++i) {
      const double x = side == 0 ? -kPoint[i] : kPoint[i];
      visit(0.5 * end * (1.0 + x), 0.5 * end * kWeight[i]);
    }
}

double Bowed(double bow, double s) { return bow > 0.0 ? 1.0 - exact::Exp(-bow * s) : s; }
double BowedRate(double bow, double s) { return bow > 0.0 ? bow * exact::Exp(-bow * s) : 1.0; }

}  // namespace

template <size_t N>
typename NodeModel<N>::Row NodeModel<N>::TangentAt(double s) const {
  Row at;
  const double u = Bowed(places.bow, s);
  for (size_t i = 0; i < N; ++i) {
    const double own = Bowed(places.bow, places.node[i]);
    at[i] = u / own;
    for (size_t j = 0; j < N; ++j) {
      const double other = Bowed(places.bow, places.node[j]);
      if (j != i) at[i] *= (u - other) / (own - other);
    }
  }
  return at;
}

template <size_t N>
typename NodeModel<N>::Row NodeModel<N>::BendAt(double s) const {
  Row at;
  const double u = Bowed(places.bow, s);
  // By the product rule: the factor that is differentiated is left out of its product.
  for (size_t i = 0; i < N; ++i) {
    const double own = Bowed(places.bow, places.node[i]);
    at[i] = 0.0;
    for (size_t k = 0; k < N; ++k) {
      double product = k == i ? 1.0 / own : u / own;
      for (size_t j = 0; j < N; ++j) {
        if (j == i) continue;
        const double other = Bowed(places.bow, places.node[j]);
        product *= (j == k ? 1.0 : u - other) / (own - other);
      }
      at[i] += product;
    }
    at[i] *= BowedRate(places.bow, s);
  }
  return at;
}

template <size_t N>
typename NodeModel<N>::Row NodeModel<N>::PlaceAt(double s) const {
  Row at{};
  ForEachPoint(s, [&](double x, double weight) {
    const Row tangent = TangentAt(x);
    for (size_t i = 0; i < N; ++i) at[i] += weight * tangent[i];
  });
  return at;
}

template <size_t N>
NodeModel<N> MakeNodeModel(const NodePlaces<N>& places) {
  NodeModel<N> m{places, {}, {}, {}, {}};
  ForEachPoint(1.0, [&](double s, double weight) {
    const auto place = m.PlaceAt(s), bend = m.BendAt(s);
    double clamp = s;
    for (size_t i = 0; i < N; ++i) clamp -= place[i];
    for (size_t i = 0; i < N; ++i) {
      m.pull[i] += weight * place[i];
      m.clamp[i] += weight * place[i] * clamp;
      for (size_t j = 0; j < N; ++j) {
        m.mass[i][j] += weight * place[i] * place[j];
        m.stiffness[i][j] += weight * bend[i] * bend[j] / (kRodFrequency1 * kRodFrequency1);
      }
    }
  });
  return m;
}

template struct NodeModel<3>;
template struct NodeModel<4>;
template struct NodeModel<8>;
template struct NodeModel<10>;
template NodeModel<3> MakeNodeModel(const NodePlaces<3>&);
template NodeModel<4> MakeNodeModel(const NodePlaces<4>&);
template NodeModel<8> MakeNodeModel(const NodePlaces<8>&);
template NodeModel<10> MakeNodeModel(const NodePlaces<10>&);

}  // namespace pelt
