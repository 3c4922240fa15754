#include "core/modal/modal_table.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/exact_math.hpp"
#include "core/float_rules.hpp"
#include "core/modal/modal_response.hpp"

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

namespace {

constexpr uint32_t kSamples = kModalSamples;

// Coefficients of t^0 .. t^3, t in seconds from the frame's end, that each backward difference
// of the samples contributes to their polynomial.
struct DifferenceBasis {
  double coefficient[kSamples][kSamples];
};

DifferenceBasis MakeBasis(const FrameTimes& times) {
  double at[kSamples] = {};
  for (uint32_t j = 1; j < kSamples; ++j) at[j] = at[j - 1] - times.dt_s[j - 1];
  // Lagrange's polynomial of each sample.
  double sample[kSamples][kSamples] = {};
  for (uint32_t j = 0; j < kSamples; ++j) {
    sample[j][0] = 1.0;
    uint32_t degree = 0;
    for (uint32_t i = 0; i < kSamples; ++i) {
      if (i == j) continue;
      const double scale = 1.0 / (at[j] - at[i]);
      ++degree;
      for (uint32_t k = degree + 1; k-- > 0;)
        sample[j][k] =
            ((k > 0 ? sample[j][k - 1] : 0.0) - at[i] * (k < degree ? sample[j][k] : 0.0)) * scale;
    }
  }
  // Sample j is the sum over k <= j of (-1)^k binomial(j, k) times difference k.
  static constexpr double kSigned[kSamples][kSamples] = {
      {1, 0, 0, 0}, {1, -1, 0, 0}, {1, -2, 1, 0}, {1, -3, 3, -1}};
  DifferenceBasis basis = {};
  for (uint32_t j = 0; j < kSamples; ++j)
    for (uint32_t k = 0; k <= j; ++k)
      for (uint32_t power = 0; power < kSamples; ++power)
        basis.coefficient[k][power] += kSigned[j][k] * sample[j][power];
  return basis;
}

// The same where velocities are known: u = t / frame.
DifferenceBasis MakeHermiteBasis(double frame) {
  const double per = 1.0 / frame;
  DifferenceBasis basis = {};
  basis.coefficient[0][0] = 1.0;
  basis.coefficient[1][1] = per;
  basis.coefficient[2][1] = 0.5 * per;
  basis.coefficient[2][2] = 0.5 * per * per;
  basis.coefficient[3][2] = per * per;
  basis.coefficient[3][3] = per * per * per;
  return basis;
}

// The polynomial's Taylor coefficients about time t.
void ShiftTo(const double (&c)[kSamples], double t, double (&out)[kSamples]) {
  out[0] = c[0] + t * (c[1] + t * (c[2] + t * c[3]));
  out[1] = c[1] + t * (2.0 * c[2] + t * 3.0 * c[3]);
  out[2] = c[2] + 3.0 * t * c[3];
  out[3] = c[3];
}

struct ModeSteps {
  OscillatorStep mode[kMaxNodes];
};

void FillSubstep(const ModalLayer& layer, const ModeSteps& steps, const DifferenceBasis& basis,
                 double start, double h, double frame, bool last, ModalSubstep* s) {
  const double bend = layer.material.bend_damping_s;
  // Difference 0 is the newest sample itself: constant, and so part of the frame's constant force.
  for (uint32_t k = 1; k < kSamples; ++k) {
    double from[kSamples], middle[kSamples], to[kSamples];
    ShiftTo(basis.coefficient[k], start, from);
    ShiftTo(basis.coefficient[k], start + 0.5 * h, middle);
    ShiftTo(basis.coefficient[k], start + h, to);
    for (uint32_t m = 0; m < layer.modes.nodes; ++m) {
      // Force: T + beta dT/dt.
      double q = 0.0, z = 0.0;
      for (uint32_t power = 0; power < kSamples; ++power) {
        const double next = power + 1 < kSamples ? double(power + 1) * from[power + 1] : 0.0;
        const double force = from[power] + bend * next;
        q += steps.mode[m].y_of_force[power] * force;
        z += steps.mode[m].v_of_force[power] * force;
      }
      s->bend_q[k - 1][m] = float(q);
      s->bend_z[k - 1][m] = float(z);
    }
    s->root_place[k - 1] = last ? 0.0f : float(to[0]);
    s->root_speed[k - 1] = float(to[1]);
    s->middle_place[k - 1] = float(middle[0]);
  }
  for (uint32_t m = 0; m < layer.modes.nodes; ++m) {
    const OscillatorStep& step = steps.mode[m];
    const double weight = layer.modes.pull[m];
    s->wind_q[m] = float(weight * (step.y_of_force[0] * start + step.y_of_force[1]) / frame);
    s->wind_z[m] = float(weight * (step.v_of_force[0] * start + step.v_of_force[1]) / frame);
  }
}

// The longest substeps, s: one and three at 60 frames per second. The length, not their number, is
// what an error and a steady state depend on: at 15 frames per second substeps of a fixed number
// leave a static shape 3e-4 off and single strands that do not converge to rest.
constexpr double kLongestFast = 1.0 / 48.0;
// The force that keeps the lengths has one direction over a substep of the default tier, while
// tension swings what is light in the strand: three substeps at 60 frames per second leave two fifths of the error that
// two do (README.md).
constexpr double kLongest = 1.0 / 150.0;

// Where velocities are known the root is exact to 0.04 %, and what is left is the substeps'.
constexpr double kLongestRated = 1.0 / 200.0;

// Whether substeps of h follow a mode: they are at most 0.45 of its period.
bool Follows(double omega2, double h) { return omega2 * h * h <= 8.0; }

void FillConstraint(const ModalLayer& layer, const ModeSteps& steps, double h, ModalTableBlock* t) {
  const uint32_t n = layer.modes.nodes;
  // A change of force over the substep, 0 in its middle. Where every step turns the force, not of modes that it does
  // not follow: they hardly answer to the force itself, and soft strands that drag alone damps then never rest. What is
  // stepped again because it failed needs it (modal_step.hpp).
  const auto slope_of = [&](uint32_t m, double constant, double linear) {
    const bool turns = t->use_slope == 0 || Follows(layer.modes.omega2[m], h);
    return turns ? linear / h - 0.5 * constant : 0.0;
  };
  for (uint32_t m = 0; m < n; ++m) {
    const OscillatorStep& step = steps.mode[m];
    t->impulse[m] = float(0.5 * step.v_of_force[0]);
    t->impulse_slope[m] = float(slope_of(m, step.v_of_force[0], step.v_of_force[1]));
    t->y_of_force[m] = float(step.y_of_force[0]);
    t->v_of_force[m] = float(step.v_of_force[0]);
    t->y_of_y[m] = float(step.y_of_y);
    t->y_of_v[m] = float(step.y_of_v);
    t->v_of_y[m] = float(step.v_of_y);
    t->v_of_v[m] = float(step.v_of_v);
  }
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t j = 0; j < n; ++j) {
      double constant = 0.0, slope = 0.0;
      for (uint32_t m = 0; m < n; ++m) {
        const OscillatorStep& step = steps.mode[m];
        const double pair = layer.modes.shape[i][m] * layer.modes.shape[j][m];
        constant += pair * step.y_of_force[0];
        slope += pair * slope_of(m, step.y_of_force[0], step.y_of_force[1]);
      }
      t->response[i][j] = float(0.5 * constant);
      t->slope[i][j] = float(slope);
    }
}

// Gauss-Jordan with row pivots. a is lost.
void Invert(double (&a)[kMaxNodes][kMaxNodes], uint32_t n,
            double (&inverse)[kMaxNodes][kMaxNodes]) {
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t j = 0; j < n; ++j) inverse[i][j] = i == j ? 1.0 : 0.0;
  for (uint32_t i = 0; i < n; ++i) {
    uint32_t pivot = i;
    for (uint32_t r = i + 1; r < n; ++r)
      if (std::fabs(a[r][i]) > std::fabs(a[pivot][i])) pivot = r;
    std::swap(a[i], a[pivot]);
    std::swap(inverse[i], inverse[pivot]);
    const double scale = 1.0 / a[i][i];
    for (uint32_t j = 0; j < n; ++j) a[i][j] *= scale, inverse[i][j] *= scale;
    for (uint32_t r = 0; r < n; ++r) {
      if (r == i) continue;
      const double factor = a[r][i];
      for (uint32_t j = 0; j < n; ++j) {
        a[r][j] -= factor * a[i][j];
        inverse[r][j] -= factor * inverse[i][j];
      }
    }
  }
}

void FillEuler(const ModalLayer& layer, double frame, ModalTableBlock* t) {
  const double place = 1.0 / (frame * frame) + layer.material.drag_per_s / frame;
  const double bend = layer.material.bend_damping_s / frame;
  double euler[kMaxNodes][kMaxNodes] = {}, inverse[kMaxNodes][kMaxNodes];
  for (uint32_t i = 0; i < layer.modes.nodes; ++i)
    for (uint32_t j = 0; j < layer.modes.nodes; ++j) {
      const double m = layer.material.mass[i][j], k = layer.material.stiffness[i][j];
      t->mass[i][j] = float(m);
      t->stiffness[i][j] = float(k);
      euler[i][j] = m * place + k * (1.0 + bend);
      t->euler[i][j] = float(euler[i][j]);
    }
  Invert(euler, layer.modes.nodes, inverse);
  for (uint32_t i = 0; i < layer.modes.nodes; ++i)
    for (uint32_t j = 0; j < layer.modes.nodes; ++j) t->euler_inverse[i][j] = float(inverse[i][j]);
  t->euler_place = float(place);
  t->euler_speed = float(1.0 / frame);
  t->euler_bend = float(bend);
  t->frame_s = float(frame);
}

// r = K^-1 M Phi T. Without stiffness rest directions are not in the pull.
void FillRestOfBend(const ModalLayer& layer, ModalTableBlock* t) {
  const uint32_t n = layer.modes.nodes;
  if (!(layer.modes.omega2[0] > 0.0)) return;
  double stiffness[kMaxNodes][kMaxNodes] = {}, inverse[kMaxNodes][kMaxNodes];
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t j = 0; j < n; ++j) stiffness[i][j] = layer.material.stiffness[i][j];
  Invert(stiffness, n, inverse);
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t m = 0; m < n; ++m) {
      double sum = 0.0;
      for (uint32_t j = 0; j < n; ++j) sum += inverse[i][j] * layer.modes.image[m][j];
      t->rest_of_bend[i][m] = float(sum);
    }
}

// Of a curl that turns with the strand: what is stiffer rests where the curl's explicit force puts it within a substep,
// and that does not settle above 1 rad of curl; it hardly leaves its rest shape either, and turns with the root.
void FillCurl(const ModalLayer& layer, double h, ModalTableBlock* t) {
  const uint32_t n = layer.modes.nodes;
  const ModalMaterial& material = layer.material;
  const double square = layer.modes.omega2[0];
  if (!material.parent_curl || !(square > 0.0) || !Follows(square, h)) return;
  t->parent_curl = 1;
  double bend[kMaxNodes][kMaxNodes] = {}, inverse[kMaxNodes][kMaxNodes];
  for (uint32_t i = 0; i < n; ++i) {
    double sum = 0.0;
    for (uint32_t j = 0; j < n; ++j) sum += bend[i][j] = material.bend[i][j];
    for (uint32_t j = 0; j < n; ++j) {
      t->curl_bend[i][j] = float(bend[i][j]);
      t->curl_turn[i][j] = float(bend[i][j] - sum * material.turn[j]);
    }
    t->curl_weight[i] = float(material.weight[i]);
  }
  Invert(bend, n, inverse);
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t j = 0; j < n; ++j) {
      double sum = 0.0;
      for (uint32_t k = 0; k < n; ++k) sum += material.stiffness[i][k] * inverse[k][j];
      t->curl_pull[i][j] = float(sum);
    }
}

// A quarter of the slowest swing, or of a second without stiffness.
double QuietTime(const ModalLayer& layer) {
  const double omega = std::sqrt(layer.modes.omega2[0]);
  const double quarter = omega > 0.0 ? 0.5 * exact::kPi / omega : 0.25;
  return quarter < 0.25 ? quarter : 0.25;
}

// Substeps that keep a frame's as short as the quality asks for; none in one too long for any.
uint32_t SubstepsOf(ModalQuality quality, const FrameTimes& times) {
  const double frame = times.dt_s[0];
  if (frame > kLongestModalFrame_s) return 0;
  double longest = quality == ModalQuality::kFast ? kLongestFast : kLongest;
  if (quality == ModalQuality::kFine && times.velocities) longest = kLongestRated;
  uint32_t count = 1;
  while (count < kModalSubsteps && frame > count * longest) ++count;
  return count;
}

}  // namespace

FrameTimes NextTimes(const FrameTimes& last, double dt_s) {
  FrameTimes next = last;
  for (size_t k = std::size(next.dt_s); k-- > 1;) next.dt_s[k] = FrameInHistory(last.dt_s[k - 1]);
  next.dt_s[0] = dt_s;
  return next;
}

ModalLayer MakeModalLayer(const ModalMaterial& material) { return {material, FindModes(material)}; }

double PushRatio(const ModalLayer& layer, ModalQuality quality, const FrameTimes& times) {
  const uint32_t substeps = SubstepsOf(quality, times);
  if (substeps == 0) return 0.0;
  double moved = 0.0, usually = 0.0;
  for (uint32_t m = 0; m < layer.modes.nodes; ++m) {
    const double omega2 = layer.modes.omega2[m];
    const double damping = layer.material.drag_per_s + layer.material.bend_damping_s * omega2;
    double tip = 0.0;
    const auto& place = layer.material.place[PlacesOf(layer.material.points) - 1];
    for (uint32_t i = 0; i < layer.modes.nodes; ++i) tip += place[i] * layer.modes.shape[i][m];
    const auto response = [&](double h) {
      return tip * tip * StepOscillator(damping, omega2, h).y_of_force[0];
    };
    moved += response(times.dt_s[0] / substeps);
    usually += response(1.0 / 120.0);
  }
  return moved / usually;
}

void FillModalTable(const ModalLayer& layer, ModalQuality quality, const FrameTimes& times,
                    ModalTableBlock* table) {
  ModalTableBlock& t = *table;
  t = {};
  const ModalModes& modes = layer.modes;
  t.nodes = modes.nodes;
  t.substeps = SubstepsOf(quality, times);
  t.use_slope = quality == ModalQuality::kBest ? 1 : 0;
  t.looks = quality == ModalQuality::kBest ? 1 : 2;
  t.look_share = 1.0f;
  const double frame = times.dt_s[0], h = frame / std::max(t.substeps, 1u);
  ModeSteps steps;
  for (uint32_t m = 0; m < modes.nodes; ++m) {
    const double damping =
        layer.material.drag_per_s + layer.material.bend_damping_s * modes.omega2[m];
    steps.mode[m] = StepOscillator(damping, modes.omega2[m], h);
  }
  const DifferenceBasis basis = times.velocities ? MakeHermiteBasis(frame) : MakeBasis(times);
  for (uint32_t s = 0; s < t.substeps; ++s)
    FillSubstep(layer, steps, basis, double(s) * h - frame, h, frame, s + 1 == t.substeps,
                &t.substep[s]);
  FillConstraint(layer, steps, h, &t);
  FillEuler(layer, frame, &t);
  t.half_step_s = float(0.5 * h);
  FillCurl(layer, h, &t);
  FillRestOfBend(layer, &t);
  if (t.substeps > 0)
    std::copy_n(t.substep[t.substeps - 1].root_speed, std::size(t.root_end_speed),
                t.root_end_speed);
  else
    t.root_end_speed[0] = float(1.0 / kCarriedFrame_s);
  for (uint32_t i = 0; i < modes.nodes; ++i) {
    t.pull[i] = float(layer.material.pull[i]);
    t.pull_mode[i] = float(modes.pull[i]);
    t.bend_root[i] = float(modes.omega2[i] * modes.pull[i]);
    t.root[i] = float(modes.root[i]);
    for (uint32_t q = 0; q < PlacesOf(layer.material.points); ++q)
      t.place[q][i] = float(layer.material.place[q][i]);
    for (uint32_t part = 0; part + 1 < layer.material.points; ++part)
      t.rest[i][part] = float(layer.material.rest[i][part]);
    for (uint32_t j = 0; j < modes.nodes; ++j) {
      t.inverse_mass[i][j] = float(modes.inverse_mass[i][j]);
      t.shape[i][j] = float(modes.shape[i][j]);
      t.image[i][j] = float(modes.image[i][j]);
      t.bend[i][j] = float(modes.omega2[i] * modes.image[i][j]);
      t.mass_shape[j][i] = float(modes.image[i][j]);
    }
  }
  t.quiet_s = float(QuietTime(layer));
}

}  // namespace pelt
