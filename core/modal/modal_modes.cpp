#include "core/modal/modal_modes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/float_rules.hpp"

namespace pelt {
namespace {

using Matrix = ModalMaterial::Matrix;

// M = L L^T; what comes back is L^-1, lower triangular.
void InvertCholesky(const Matrix& mass, uint32_t n, Matrix& inverse) {
  Matrix l = {};
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t j = 0; j <= i; ++j) {
      double sum = mass[i][j];
      for (uint32_t k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
      l[i][j] = i == j ? std::sqrt(sum) : sum / l[j][j];
    }
  for (uint32_t i = 0; i < n; ++i) {
    inverse[i][i] = 1.0 / l[i][i];
    for (uint32_t j = 0; j < i; ++j) {
      double sum = 0.0;
      for (uint32_t k = j; k < i; ++k) sum -= l[i][k] * inverse[k][j];
      inverse[i][j] = sum / l[i][i];
    }
  }
}

// One rotation in the plane (p, q) that makes a[p][q] 0.
void Rotate(Matrix& a, Matrix& vectors, uint32_t n, uint32_t p, uint32_t q) {
  if (a[p][q] == 0.0) return;
  const double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
  const double size = theta < 0.0 ? -theta : theta;
  // Above 1e150 the square would overflow; the tangent is 1 / (2 theta) to the last bit long
  // before.
  const double root = size < 1e100 ? std::sqrt(theta * theta + 1.0) : size;
  const double t = (theta < 0.0 ? -1.0 : 1.0) / (size + root);
  const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
  for (uint32_t k = 0; k < n; ++k) {
    const double x = a[k][p], y = a[k][q];
    a[k][p] = c * x - s * y;
    a[k][q] = s * x + c * y;
  }
  for (uint32_t k = 0; k < n; ++k) {
    const double x = a[p][k], y = a[q][k];
    a[p][k] = c * x - s * y;
    a[q][k] = s * x + c * y;
  }
  for (uint32_t k = 0; k < n; ++k) {
    const double x = vectors[k][p], y = vectors[k][q];
    vectors[k][p] = c * x - s * y;
    vectors[k][q] = s * x + c * y;
  }
  a[p][q] = a[q][p] = 0.0;
}

// Sweeps converge quadratically: 12 are four more than any chain needed.
constexpr int kSweeps = 12;

void Diagonalise(Matrix& a, uint32_t n, Matrix& vectors) {
  for (uint32_t i = 0; i < n; ++i) vectors[i][i] = 1.0;
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (uint32_t p = 0; p < n; ++p)
      for (uint32_t q = p + 1; q < n; ++q) Rotate(a, vectors, n, p, q);
}

}  // namespace

ModalModes FindModes(const ModalMaterial& material) {
  ModalModes m{};
  const uint32_t n = m.nodes = material.nodes;
  Matrix inverse = {}, a = {}, vectors = {};
  InvertCholesky(material.mass, n, inverse);
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t j = 0; j <= i; ++j) {
      double sum = 0.0;
      for (uint32_t p = 0; p <= i; ++p)
        for (uint32_t q = 0; q <= j; ++q)
          sum += inverse[i][p] * material.stiffness[p][q] * inverse[j][q];
      a[i][j] = a[j][i] = sum;
    }
  Diagonalise(a, n, vectors);

  uint32_t order[kMaxNodes];
  std::iota(order, order + n, 0u);
  std::sort(order, order + n,
            [&](uint32_t x, uint32_t y) { return a[x][x] != a[y][y] ? a[x][x] < a[y][y] : x < y; });
  for (uint32_t mode = 0; mode < n; ++mode) {
    const uint32_t v = order[mode];
    m.omega2[mode] = std::max(a[v][v], 0.0);
    double largest = 0.0;
    for (uint32_t i = 0; i < n; ++i) {
      double sum = 0.0;
      for (uint32_t p = i; p < n; ++p) sum += inverse[p][i] * vectors[p][v];
      m.shape[i][mode] = sum;
      if (std::fabs(sum) > std::fabs(largest)) largest = sum;
    }
    if (largest < 0.0)
      for (uint32_t i = 0; i < n; ++i) m.shape[i][mode] = -m.shape[i][mode];
    for (uint32_t j = 0; j < n; ++j) {
      double sum = 0.0;
      for (uint32_t i = 0; i < n; ++i) sum += m.shape[i][mode] * material.mass[i][j];
      m.image[mode][j] = sum;
      m.pull[mode] += m.shape[j][mode] * material.pull[j];
    }
  }
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t j = 0; j < n; ++j) {
      for (uint32_t k = 0; k < n; ++k) m.inverse_mass[i][j] += inverse[k][i] * inverse[k][j];
      m.root[i] += m.inverse_mass[i][j] * material.pull[j];
    }
  return m;
}

}  // namespace pelt
