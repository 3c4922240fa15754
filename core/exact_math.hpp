// Elementary functions that give the same bits on every machine: sine, exponential, logarithm and
// their relatives, made from IEEE-754 double addition, multiplication, division and square root.
//
// libm is allowed to differ between versions in the last bits, and does; what reaches the groom
// file or a frame goes through here instead. Every function reduces its argument to a short
// interval and sums the Taylor series there to below one unit in the last place.
//
// Accuracy: relative error below 1e-14 (Pow: 1e-14 * (1 + |y ln x|)); sine, cosine and tangent:
// absolute error below 1e-14 for |x| <= 1e6. Not for kernels: those take no transcendentals at all.
// What breaks if ignored: build with -ffp-contract=off, or a fused multiply-add changes the bits.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace pelt::exact {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kRadiansPerDegree = kPi / 180.0;

// Largest whole number not above x. Exact for every double; NaN and infinities pass through.
inline double Floor(double x) {
  // Beyond 2^52 every double is whole already.
  if (!(x > -4503599627370496.0 && x < 4503599627370496.0)) return x;
  const double t = double(int64_t(x));
  return t > x ? t - 1.0 : t;
}

namespace exact_detail {

// a^0 c0 + a^1 c1 + ...
template <int N>
inline double Horner(const double (&c)[N], double a) {
  double sum = c[N - 1];
  for (int i = N - 2; i >= 0; --i) sum = sum * a + c[i];
  return sum;
}

// 2^n for n in [-1022, 1023].
inline double PowerOfTwo(int64_t n) {
  const uint64_t bits = uint64_t(n + 1023) << 52;
  double r;
  std::memcpy(&r, &bits, sizeof r);
  return r;
}

// x = quadrant * pi/2 + r, |r| <= pi/4 and a little. pi/2 in three parts of 33 bits and less, so
// that quadrant * part is exact.
inline double ReduceToQuadrant(double x, int* quadrant) {
  const double n = Floor(x * (2.0 / kPi) + 0.5);
  const double high = 1.57079632673412561417e+00;
  const double middle = 6.07710050630396597660e-11;
  const double low = 2.02226624879595063154e-21;
  *quadrant = int(int64_t(n) & 3);
  return ((x - n * high) - n * middle) - n * low;
}

inline double SinNearZero(double r) {
  static constexpr double kC[] = {1.0,
                                  -1.0 / 6,
                                  1.0 / 120,
                                  -1.0 / 5040,
                                  1.0 / 362880,
                                  -1.0 / 39916800,
                                  1.0 / 6227020800,
                                  -1.0 / 1307674368000,
                                  1.0 / 355687428096000};
  return r * Horner(kC, r * r);
}

inline double CosNearZero(double r) {
  static constexpr double kC[] = {1.0,
                                  -1.0 / 2,
                                  1.0 / 24,
                                  -1.0 / 720,
                                  1.0 / 40320,
                                  -1.0 / 3628800,
                                  1.0 / 479001600,
                                  -1.0 / 87178291200,
                                  1.0 / 20922789888000,
                                  -1.0 / 6402373705728000};
  return Horner(kC, r * r);
}

inline double SinOfQuadrant(double r, int quadrant) {
  const double s = (quadrant & 1) ? CosNearZero(r) : SinNearZero(r);
  return (quadrant & 2) ? -s : s;
}

// For |x| <= 1e15; beyond that (and for NaN) there is no meaningful phase left.
inline bool HasPhase(double x) { return x >= -1e15 && x <= 1e15; }

}  // namespace exact_detail

// Radians. NaN where |x| > 1e15 or x is not finite.
inline double Sin(double x) {
  if (!exact_detail::HasPhase(x)) return std::numeric_limits<double>::quiet_NaN();
  int quadrant;
  const double r = exact_detail::ReduceToQuadrant(x, &quadrant);
  return exact_detail::SinOfQuadrant(r, quadrant);
}

inline double Cos(double x) {
  if (!exact_detail::HasPhase(x)) return std::numeric_limits<double>::quiet_NaN();
  int quadrant;
  const double r = exact_detail::ReduceToQuadrant(x, &quadrant);
  return exact_detail::SinOfQuadrant(r, quadrant + 1);
}

inline double Tan(double x) { return Sin(x) / Cos(x); }

// Overflows to infinity above 709.78, to 0 below -745.
inline double Exp(double x) {
  if (x != x) return x;
  if (x > 709.782712893384) return std::numeric_limits<double>::infinity();
  if (x < -745.2) return 0.0;
  const double n = Floor(x * 1.44269504088896340736 + 0.5);
  const double r = (x - n * 6.93147180369123816490e-01) - n * 1.90821492927058770002e-10;
  static constexpr double kC[] = {1.0,
                                  1.0,
                                  1.0 / 2,
                                  1.0 / 6,
                                  1.0 / 24,
                                  1.0 / 120,
                                  1.0 / 720,
                                  1.0 / 5040,
                                  1.0 / 40320,
                                  1.0 / 362880,
                                  1.0 / 3628800,
                                  1.0 / 39916800,
                                  1.0 / 479001600,
                                  1.0 / 6227020800};
  // In two steps, so that neither factor leaves the range of normal numbers.
  const int64_t half = int64_t(n) / 2;
  return exact_detail::Horner(kC, r) * exact_detail::PowerOfTwo(half) *
         exact_detail::PowerOfTwo(int64_t(n) - half);
}

// Natural logarithm. -infinity for 0, NaN below.
inline double Log(double x) {
  if (x != x || x == std::numeric_limits<double>::infinity()) return x;
  if (x == 0.0) return -std::numeric_limits<double>::infinity();
  if (x < 0.0) return std::numeric_limits<double>::quiet_NaN();
  int64_t exponent = 0;
  if (x < 2.2250738585072014e-308) {  // denormal
    x *= 18014398509481984.0;         // 2^54
    exponent = -54;
  }
  uint64_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  exponent += int64_t(bits >> 52) - 1023;
  bits = (bits & 0x000fffffffffffffull) | 0x3ff0000000000000ull;
  double m;
  std::memcpy(&m, &bits, sizeof m);  // [1, 2)
  if (m > 1.41421356237309504880) {
    m *= 0.5;
    ++exponent;
  }
  // ln m = 2 atanh s.
  const double s = (m - 1.0) / (m + 1.0);
  static constexpr double kC[] = {2.0,      2.0 / 3,  2.0 / 5,  2.0 / 7,  2.0 / 9, 2.0 / 11,
                                  2.0 / 13, 2.0 / 15, 2.0 / 17, 2.0 / 19, 2.0 / 21};
  const double n = double(exponent);
  return n * 6.93147180369123816490e-01 +
         (s * exact_detail::Horner(kC, s * s) + n * 1.90821492927058770002e-10);
}

// x^y for x > 0; 0^y is 0 for y > 0 and 1 for y = 0; NaN for negative x.
inline double Pow(double x, double y) {
  if (y == 0.0) return 1.0;
  return Exp(y * Log(x));
}

// [-pi/2, pi/2].
inline double Atan(double x) {
  if (x != x) return x;
  const double a = x < 0.0 ? -x : x;
  double t = a > 1.0 ? 1.0 / a : a;
  double base = 0.0;
  if (t > 0.26794919243112270647) {  // tan(pi/12): turn back by pi/6
    const double root3 = 1.73205080756887729353;
    t = (t * root3 - 1.0) / (root3 + t);
    base = kPi / 6;
  }
  static constexpr double kC[] = {1.0,       -1.0 / 3,  1.0 / 5,   -1.0 / 7, 1.0 / 9,
                                  -1.0 / 11, 1.0 / 13,  -1.0 / 15, 1.0 / 17, -1.0 / 19,
                                  1.0 / 21,  -1.0 / 23, 1.0 / 25,  -1.0 / 27};
  double r = base + t * exact_detail::Horner(kC, t * t);
  if (a > 1.0) r = kPi / 2 - r;
  return x < 0.0 ? -r : r;
}

// Angle of (x, y) in (-pi, pi]; 0 for both 0.
inline double Atan2(double y, double x) {
  const double ax = x < 0.0 ? -x : x;
  const double ay = y < 0.0 ? -y : y;
  if (ax == 0.0 && ay == 0.0) return 0.0;
  double r = ax >= ay ? Atan(ay / ax) : kPi / 2 - Atan(ax / ay);
  if (x < 0.0) r = kPi - r;
  return y < 0.0 ? -r : r;
}

// x is clamped to [-1, 1]. Accurate at both ends.
inline double Acos(double x) {
  if (x >= 1.0) return 0.0;
  if (x <= -1.0) return kPi;
  return 2.0 * Atan2(std::sqrt(1.0 - x), std::sqrt(1.0 + x));
}

inline double Asin(double x) {
  if (x >= 1.0) return kPi / 2;
  if (x <= -1.0) return -kPi / 2;
  return Atan2(x, std::sqrt((1.0 - x) * (1.0 + x)));
}

}  // namespace pelt::exact
