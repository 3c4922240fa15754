// Dense algebra for matrices of a strand's size, in double: set-up only.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace pelt::accuracy {

template <size_t K>
using SquareMatrix = std::array<std::array<double, K>, K>;

// a := a^-1 b for the leading n columns of `b`, by elimination with row pivots; a is destroyed.
template <size_t kSize, size_t kColumns>
bool SolveDense(int n, std::array<std::array<double, kSize>, kSize>& a,
                std::array<std::array<double, kColumns>, kSize>& b, int columns) {
  for (int i = 0; i < n; ++i) {
    int pivot = i;
    for (int r = i + 1; r < n; ++r)
      if (std::abs(a[r][i]) > std::abs(a[pivot][i])) pivot = r;
    if (!(std::abs(a[pivot][i]) > 0.0)) return false;
    std::swap(a[i], a[pivot]);
    std::swap(b[i], b[pivot]);
    for (int r = 0; r < n; ++r) {
      if (r == i) continue;
      const double f = a[r][i] / a[i][i];
      for (int j = i; j < n; ++j) a[r][j] -= f * a[i][j];
      for (int j = 0; j < columns; ++j) b[r][j] -= f * b[i][j];
    }
  }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < columns; ++j) b[i][j] /= a[i][i];
  return true;
}

// The inverse of the leading n x n part.
template <size_t K>
SquareMatrix<K> Inverse(int n, SquareMatrix<K> a) {
  SquareMatrix<K> b{};
  for (int i = 0; i < n; ++i) b[i][i] = 1.0;
  SolveDense(n, a, b, n);
  return b;
}

template <size_t K>
SquareMatrix<K> Product(int n, const SquareMatrix<K>& a, const SquareMatrix<K>& b) {
  SquareMatrix<K> c{};
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) c[i][j] += a[i][k] * b[k][j];
  return c;
}

// The yardstick has an eigensolver of its own beside core/modal's: a fault of that one must not be
// in what it is measured by.

// Eigenvalues (ascending) and orthonormal eigenvectors (columns) of a symmetric matrix, by Jacobi's
// rotations.
template <size_t K>
void SolveSymmetric(int n, SquareMatrix<K> a, SquareMatrix<K>& vectors,
                    std::array<double, K>& values) {
  SquareMatrix<K> v{};
  for (int i = 0; i < n; ++i) v[i][i] = 1.0;
  for (int sweep = 0; sweep < 60; ++sweep) {
    for (int p = 0; p < n; ++p)
      for (int q = p + 1; q < n; ++q) {
        if (a[p][q] == 0.0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
        const double t =
            std::copysign(1.0, theta) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
        const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
        for (int k = 0; k < n; ++k) {
          const double x = a[k][p], y = a[k][q];
          a[k][p] = c * x - s * y;
          a[k][q] = s * x + c * y;
        }
        for (int k = 0; k < n; ++k) {
          const double x = a[p][k], y = a[q][k];
          a[p][k] = c * x - s * y;
          a[q][k] = s * x + c * y;
          const double vx = v[k][p], vy = v[k][q];
          v[k][p] = c * vx - s * vy;
          v[k][q] = s * vx + c * vy;
        }
      }
  }
  // Into ascending order, by selection.
  bool taken[K] = {};
  for (int m = 0; m < n; ++m) {
    int least = -1;
    for (int i = 0; i < n; ++i)
      if (!taken[i] && (least < 0 || a[i][i] < a[least][least])) least = i;
    taken[least] = true;
    values[m] = a[least][least];
    for (int i = 0; i < n; ++i) vectors[i][m] = v[i][least];
  }
}

// K phi = omega^2 M phi with Phi^T M Phi = 1, M positive definite (through its Cholesky factor).
template <size_t K>
void SolveModes(int n, const SquareMatrix<K>& mass, const SquareMatrix<K>& stiffness,
                SquareMatrix<K>& modes, std::array<double, K>& squares) {
  SquareMatrix<K> lower{};
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j) {
      double s = mass[i][j];
      for (int k = 0; k < j; ++k) s -= lower[i][k] * lower[j][k];
      lower[i][j] = i == j ? std::sqrt(s) : s / lower[j][j];
    }
  const SquareMatrix<K> inverse = Inverse(n, lower);
  SquareMatrix<K> transposed{};
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) transposed[i][j] = inverse[j][i];
  SquareMatrix<K> a = Product(n, Product(n, inverse, stiffness), transposed);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < i; ++j) a[i][j] = a[j][i] = 0.5 * (a[i][j] + a[j][i]);
  SquareMatrix<K> vectors{};
  SolveSymmetric(n, a, vectors, squares);
  modes = Product(n, transposed, vectors);
}

}  // namespace pelt::accuracy
