#include "bench/accuracy/drawn_problem.hpp"

#include <algorithm>
#include <array>

#include "bench/accuracy/body_angles.hpp"
#include "core/random.hpp"

namespace pelt::accuracy {
namespace {

// What is drawn for what: a new purpose does not move the numbers of the others.
enum Purpose : uint64_t { kGait = 1, kShake, kDash, kTurnBy, kHop, kStrand, kLength };

Random RandomOf(uint64_t seed, int motion, Purpose purpose, int index = 0) {
  return Random(MixSeed(MixSeed(MixSeed(seed, uint64_t(motion)), purpose), uint64_t(index)));
}

// On from `begin` to `end`.
struct Window {
  double begin, end, width_in, width_out;

  Jet At(Jet t) const { return Rise(t, begin, width_in) * (Jet(1.0) - Rise(t, end, width_out)); }
};
// Steps this many widths after the begin have not begun there.
constexpr double kQuiet = 5.0;

Window DrawWindow(Random& random, double least_s) {
  Window w{};
  w.width_in = random.Uniform(0.06, 0.15);
  w.width_out = random.Uniform(0.06, 0.15);
  w.begin = std::max(random.Uniform(0.4, 1.6), kQuiet * w.width_in);
  w.end = w.begin + random.Uniform(least_s, 2.4);
  return w;
}

struct Wave {
  double size, hertz, phase;

  Jet At(Jet t) const { return Jet(size) * Sin(Jet(kTurn * hertz) * t + phase); }
};

Wave DrawWave(Random& random, double most, double hertz) {
  const double size = random.Uniform(0.2, 1.0) * most;
  return {size, hertz, random.Uniform(0.0, kTurn)};
}

// Waves of x, y, z and yaw, pitch, roll.
struct Waves {
  bool on = false;
  Window window{};
  std::array<Wave, 6> wave{};
};

Waves DrawGait(Random random) {
  Waves gait{true, DrawWindow(random, 1.0), {}};
  const double stride = random.Uniform(1.2, 2.2);
  static constexpr double kMost[6] = {0.04, 0.03, 0.03, 0.2, 0.15, 0.12};
  for (size_t k = 0; k < 6; ++k) {
    const bool twice = k == 1 || k == 4;  // up and down, and the nod
    gait.wave[k] = DrawWave(random, kMost[k], twice ? 2.0 * stride : stride);
  }
  return gait;
}

Waves DrawShake(Random random) {
  Waves shake{random.Uniform() < 0.5, DrawWindow(random, 0.6), {}};
  static constexpr double kMost[3] = {0.7, 0.2, 0.2};
  for (size_t k = 0; k < 3; ++k)
    shake.wave[3 + k] = DrawWave(random, kMost[k], random.Uniform(1.2, 2.2));
  return shake;
}

// Speed from `begin` to `end`.
struct DrawnDash {
  double speed_x = 0.0, speed_z = 0.0;
  double begin = 1.0, end = 2.0, width_in = 0.1, width_out = 0.1;

  Jet At(Jet t) const { return Ramp(t, begin, width_in) - Ramp(t, end, width_out); }
};

DrawnDash DrawDash(Random random) {
  const bool on = random.Uniform() < 0.5;
  DrawnDash d;
  const double speed = on ? random.Uniform(0.4, 1.6) : 0.0, way = random.Uniform(0.0, kTurn);
  d.speed_x = speed * exact::Cos(way);
  d.speed_z = speed * exact::Sin(way);
  d.width_in = random.Uniform(0.05, 0.15);
  d.width_out = random.Uniform(0.05, 0.15);
  d.begin = std::max(random.Uniform(0.4, 2.0), kQuiet * d.width_in);
  d.end = d.begin + random.Uniform(0.4, 1.4);
  return d;
}

struct Turn {
  double yaw, pitch, roll, at, width;
};

Turn DrawTurn(Random random) {
  const bool on = random.Uniform() < 0.5;
  const double size = on ? random.Uniform(0.3, kTurn / 3.0) : 0.0;
  const double side = random.Uniform() < 0.5 ? -1.0 : 1.0;
  Turn turn{size * side, size * random.Uniform(-0.3, 0.3), size * random.Uniform(-0.3, 0.3), 0, 0};
  turn.width = random.Uniform(0.08, 0.2);
  turn.at = std::max(random.Uniform(0.6, 3.2), kQuiet * turn.width);
  return turn;
}

struct Hop {
  double height;
  Window window;
};

Hop DrawHop(Random random) {
  const bool on = random.Uniform() < 0.5;
  Hop hop{on ? random.Uniform(0.04, 0.2) : 0.0, {}};
  hop.window.width_in = random.Uniform(0.07, 0.12);
  hop.window.width_out = random.Uniform(0.07, 0.12);
  hop.window.begin = random.Uniform(0.7, 3.0);
  hop.window.end = hop.window.begin + random.Uniform(0.3, 0.6);
  return hop;
}

struct Course {
  Waves gait, shake;
  DrawnDash dash;
  Turn turn;
  Hop hop;

  BodyAngles At(Jet t) const {
    BodyAngles a;
    Jet* const axes[6] = {&a.position.x, &a.position.y, &a.position.z, &a.yaw, &a.pitch, &a.roll};
    for (const Waves* waves : {&gait, &shake}) {
      if (!waves->on) continue;
      const Jet strength = waves->window.At(t);
      for (size_t k = 0; k < 6; ++k) *axes[k] = *axes[k] + strength * waves->wave[k].At(t);
    }
    const Jet way = dash.At(t), turned = Rise(t, turn.at, turn.width);
    a.position.x = a.position.x + Jet(dash.speed_x) * way;
    a.position.z = a.position.z + Jet(dash.speed_z) * way;
    a.position.y = a.position.y + Jet(hop.height) * hop.window.At(t);
    a.yaw = a.yaw + Jet(turn.yaw) * turned;
    a.pitch = a.pitch + Jet(turn.pitch) * turned;
    a.roll = a.roll + Jet(turn.roll) * turned;
    return a;
  }
};

Strand DrawStrand(Random random, int links) {
  constexpr double kDegree = kTurn / 360.0;
  const Double3 out = DrawDirection(random);
  Strand strand;
  strand.root = out * random.Uniform(0.05, 0.15);
  // A draw a statement: in which order arguments are drawn is the compiler's.
  const double lean = random.Uniform(0.0, 70.0) * kDegree;
  Double3 direction = Unit(TurnAbout(out, DrawAcross(random, out), lean));
  Double3 axis = DrawAcross(random, direction);
  const double share = links > 4 ? 4.0 / links : 1.0;
  const double curl = share * random.Uniform(7.0, 22.0) * kDegree,
               wind = random.Uniform(-1.0, 1.0) * curl;
  for (int i = 0; i < links; ++i) {
    strand.rest[size_t(i)] = direction;
    direction = Unit(TurnAbout(direction, axis, curl));
    axis = Unit(TurnAbout(axis, direction, wind));
  }
  return strand;
}

}  // namespace

Double3 DrawDirection(Random& random) {
  const double height = random.Uniform(-1.0, 1.0), around = random.Uniform(0.0, kTurn);
  const double across = std::sqrt(1.0 - height * height);
  return {across * exact::Cos(around), height, across * exact::Sin(around)};
}

// A unit vector across `up`, turned about it at random.
Double3 DrawAcross(Random& random, Double3 up) {
  const Double3 other = std::abs(up.y) < 0.9 ? Double3{0.0, 1.0, 0.0} : Double3{1.0, 0.0, 0.0};
  return Unit(TurnAbout(Unit(Cross(up, other)), up, random.Uniform(0.0, kTurn)));
}

BodyMotion DrawMotion(uint64_t seed, int index) {
  const Course course{
      DrawGait(RandomOf(seed, index, kGait)), DrawShake(RandomOf(seed, index, kShake)),
      DrawDash(RandomOf(seed, index, kDash)), DrawTurn(RandomOf(seed, index, kTurnBy)),
      DrawHop(RandomOf(seed, index, kHop))};
  return [course](double t) { return ToPose(course.At(Jet(t, 1.0, 0.0))); };
}

std::vector<Strand> DrawStrands(int links, int count, uint64_t seed, int motion) {
  std::vector<Strand> strands;
  for (int s = 0; s < count; ++s)
    strands.push_back(DrawStrand(RandomOf(seed, motion, kStrand, s), links));
  return strands;
}

double DrawLengthScale(uint64_t seed, int motion) {
  return RandomOf(seed, motion, kLength).Uniform(0.7, 1.4);
}

}  // namespace pelt::accuracy
