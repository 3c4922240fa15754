// What models are measured on.
#include <algorithm>
#include <array>
#include <vector>

#include "bench/accuracy/body_angles.hpp"
#include "bench/accuracy/model_error.hpp"
#include "core/random.hpp"

namespace pelt::accuracy {
namespace {

constexpr double kDegree = kTurn / 360.0;

// By how much everyday motions are smaller than wild ones of the same family.
constexpr double kEverydayShare = 0.45, kShakeShare = 0.5;

struct Wave {
  double size, hertz, phase;

  Jet At(Jet t) const { return Jet(size) * Sin(Jet(kTurn * hertz) * t + phase); }
};
Wave DrawWave(Random& random, double most, double hertz) {
  const double size = random.Uniform(0.3, 1.0) * most;
  return {size, hertz, random.Uniform(0.0, kTurn)};
}

using Course = std::function<BodyAngles(Jet)>;

// A gait that sets in, goes somewhere and stops.
Course DrawGait(Random random) {
  const double begin = random.Uniform(0.4, 0.7), in = random.Uniform(0.06, 0.13);
  const double end = random.Uniform(2.0, 2.6), out = random.Uniform(0.08, 0.15);
  const double stride = random.Uniform(1.2, 2.3), speed = random.Uniform(0.4, 2.0);
  static constexpr double kMost[6] = {0.02, 0.035, 0.03, 0.22, 0.15, 0.14};
  static constexpr bool kTwice[6] = {true, true, false, false, true, false};
  std::array<Wave, 6> wave;
  for (size_t k = 0; k < 6; ++k)
    wave[k] = DrawWave(random, kMost[k], kTwice[k] ? 2.0 * stride : stride);
  const Wave heel = DrawWave(random, 0.006, 4.0 * stride);
  return [=](Jet t) {
    const Jet on = Rise(t, begin, in) - Rise(t, end, out);
    BodyAngles a;
    a.position = {on * wave[0].At(t) + Jet(speed) * (Ramp(t, begin, in) - Ramp(t, end, out)),
                  on * (wave[1].At(t) + heel.At(t)), on * wave[2].At(t)};
    a.yaw = on * wave[3].At(t);
    a.pitch = on * wave[4].At(t);
    a.roll = on * wave[5].At(t);
    return a;
  };
}

// Two jumps: a crouch, a flight under gravity, a landing; a lean with each, a turn in one.
Course DrawJumps(Random random) {
  struct Jump {
    double off, on, speed, across, soft;
  };
  std::array<Jump, 2> jumps;
  double at = random.Uniform(0.45, 0.65);
  for (Jump& jump : jumps) {
    jump.speed = random.Uniform(1.2, 2.5);
    jump.soft = random.Uniform(0.03, 0.06);
    jump.off = at;
    jump.on = jump.off + 2.0 * jump.speed / 9.81;
    jump.across = random.Uniform(-1.5, 2.2);
    at = jump.on + random.Uniform(0.35, 0.7);
  }
  const double crouch = random.Uniform(0.02, 0.08), lean = random.Uniform(0.1, 0.4);
  const double turn = random.Uniform(-1.2, 1.2), turn_at = random.Uniform(0.8, 2.2);
  return [=](Jet t) {
    BodyAngles a;
    for (const Jump& j : jumps) {
      const Jet air = Rise(t, j.off, j.soft) - Rise(t, j.on, j.soft);
      a.position.y = a.position.y + air * Jet(0.5 * 9.81) * (t - Jet(j.off)) * (Jet(j.on) - t) -
                     Jet(crouch) * (Rise(t, j.off - 0.15, 0.05) - Rise(t, j.off, 0.05)) -
                     Jet(crouch) * (Rise(t, j.on + 0.04, 0.05) - Rise(t, j.on + 0.3, 0.07));
      a.position.x =
          a.position.x + Jet(j.across) * (Ramp(t, j.off, j.soft) - Ramp(t, j.on, 1.3 * j.soft));
      a.pitch = a.pitch - Jet(lean) * Rise(t, j.off, 0.06) + Jet(1.6 * lean) * Rise(t, j.on, 0.05) -
                Jet(0.6 * lean) * Rise(t, j.on + 0.25, 0.06);
    }
    a.yaw = Jet(turn) * Rise(t, turn_at, 0.12);
    return a;
  };
}

// Turns, and a dash beside them.
Course DrawTurns(Random random) {
  struct Turn {
    double at, width, yaw, pitch, roll;
  };
  std::vector<Turn> turns(2 + random.Below(2));
  double at = random.Uniform(0.5, 0.8);
  for (Turn& turn : turns) {
    const double side = random.Below(2) ? 1.0 : -1.0;
    turn = {at, random.Uniform(0.06, 0.15), side * random.Uniform(0.4, 2.1),
            random.Uniform(-0.4, 0.4), random.Uniform(-0.3, 0.3)};
    at += random.Uniform(0.6, 0.9);
  }
  const double speed = random.Uniform(0.4, 1.6), way = random.Uniform(0.0, kTurn);
  const double begin = random.Uniform(0.5, 0.9), end = begin + random.Uniform(0.5, 1.3);
  const double in = random.Uniform(0.05, 0.12), out = random.Uniform(0.04, 0.1);
  return [=](Jet t) {
    BodyAngles a;
    const Jet gone = Jet(speed) * (Ramp(t, begin, in) - Ramp(t, end, out));
    a.position = {Jet(exact::Cos(way)) * gone, Jet(0.0), Jet(exact::Sin(way)) * gone};
    for (const Turn& turn : turns) {
      const Jet turned = Rise(t, turn.at, turn.width);
      a.yaw = a.yaw + Jet(turn.yaw) * turned;
      a.pitch = a.pitch + Jet(turn.pitch) * turned;
      a.roll = a.roll + Jet(turn.roll) * turned;
    }
    return a;
  };
}

// One or two waves in every axis, as slow as they are large.
Course DrawWaves(Random random) {
  const double begin = random.Uniform(0.4, 0.7), in = random.Uniform(0.06, 0.15);
  std::array<std::vector<Wave>, 6> waves;
  for (size_t k = 0; k < 6; ++k) {
    const uint32_t count = 1 + random.Below(2);
    for (uint32_t i = 0; i < count; ++i) {
      const double hertz = random.Uniform(0.6, 3.2), omega = kTurn * hertz;
      double size = k < 3 ? random.Uniform(1.0, 6.0) / (omega * omega)
                          : std::min(0.5, random.Uniform(0.5, 4.0) / omega);
      if (k > 3) size *= 0.7;
      waves[k].push_back({size, hertz, random.Uniform(0.0, kTurn)});
    }
  }
  return [=](Jet t) {
    BodyAngles a;
    Jet* const axes[6] = {&a.position.x, &a.position.y, &a.position.z, &a.yaw, &a.pitch, &a.roll};
    const Jet on = Rise(t, begin, in);
    for (size_t k = 0; k < 6; ++k)
      for (const Wave& wave : waves[k])
        *axes[k] = *axes[k] + on * (wave.At(t) - Jet(wave.size * exact::Sin(wave.phase)));
    return a;
  };
}

Course DrawShake(Random random) {
  const double begin = random.Uniform(0.5, 0.8), end = begin + random.Uniform(1.0, 1.8);
  const double hertz = random.Uniform(3.2, 5.2), roll = random.Uniform(0.5, 1.1);
  const double yaw = random.Uniform(0.05, 0.2), across = random.Uniform(0.002, 0.01);
  const double nod = random.Uniform(0.0, kTurn);
  return [=](Jet t) {
    const Jet on = Rise(t, begin, 0.12) - Rise(t, end, 0.15);
    const Jet phase = Jet(kTurn * hertz) * t;
    BodyAngles a;
    a.position = {on * Jet(across) * Sin(phase + 0.7), on * Jet(0.008) * Sin(phase * 2.0),
                  Jet(0.0)};
    a.yaw = on * Jet(yaw) * Sin(phase + 1.1);
    a.pitch = on * Jet(0.2) * Sin(Jet(kTurn * 0.9) * t + nod);
    a.roll = on * Jet(roll) * Sin(phase);
    return a;
  };
}

Course DrawViolence(Random random) {
  const double speed = random.Uniform(1.5, 3.0), yaw = random.Uniform(-2.2, 2.2);
  const double hop = random.Uniform(0.2, 0.4);
  return [=](Jet t) {
    BodyAngles a;
    a.position = {Jet(speed) * (Ramp(t, 0.5, 0.03) - Ramp(t, 1.5, 0.02)),
                  Jet(hop) * (Rise(t, 2.4, 0.045) - Rise(t, 2.8, 0.045)), Jet(0.0)};
    a.yaw = Jet(yaw) * Rise(t, 2.0, 0.05);
    return a;
  };
}

BodyMotion MotionOf(const Course& course, double share) {
  return [=](double t) {
    BodyAngles a = course(Jet(t, 1.0, 0.0));
    for (Jet* axis : {&a.position.x, &a.position.y, &a.position.z, &a.yaw, &a.pitch, &a.roll})
      *axis = *axis * Jet(share);
    return ToPose(a);
  };
}

// On a body that sways a little.
BodyMotion DrawWind(Random random) {
  const double speed = random.Uniform(1.5, 5.0), way = random.Uniform(0.0, kTurn);
  const double along = random.Uniform(0.8, 2.5), aside = random.Uniform(0.8, 2.5);
  const double end = random.Uniform(1.6, 2.4);
  const Wave sway = DrawWave(random, 0.01, 1.2);
  return [=](double t) {
    const Jet now(t, 1.0, 0.0);
    BodyAngles a;
    a.position.y = Rise(now, 0.4, 0.1) * sway.At(now);
    BodyPose pose = ToPose(a);
    const double on = Rise(now, 0.5, 0.12).value - Rise(now, end, 0.12).value;
    const double front = on * speed * (1.0 + 0.4 * exact::Sin(kTurn * along * t));
    const double side = on * speed * 0.3 * exact::Sin(kTurn * aside * t);
    const double c = exact::Cos(way), s = exact::Sin(way);
    pose.wind = {c * front - s * side, 0.1 * side, s * front + c * side};
    return pose;
  };
}

Course DrawCourse(int kind, Random random) {
  switch (kind) {
    case 0:
      return DrawGait(random);
    case 1:
      return DrawJumps(random);
    case 2:
      return DrawTurns(random);
  }
  return DrawWaves(random);
}

RestCurve DrawRest(Random random) {
  const Double3 out = DrawDirection(random);
  RestCurve rest;
  rest.root = out * random.Uniform(0.05, 0.15);
  // A draw a statement: in which order arguments are drawn is the compiler's.
  const double from_skin = random.Uniform(0.0, 50.0) * kDegree;
  rest.tangent = Unit(TurnAbout(out, DrawAcross(random, out), from_skin));
  const double lean = random.Uniform(-0.5, 0.5);
  rest.axis = Unit(DrawAcross(random, rest.tangent) + rest.tangent * lean);
  rest.turn = random.Uniform(21.0, 66.0) * kDegree;
  return rest;
}

BodyMotion DrawBody(MotionFamily family, uint64_t seed, int index) {
  const Random random(MixSeed(MixSeed(seed, uint64_t(index)), 1));
  switch (family) {
    case MotionFamily::kEveryday:
      return MotionOf(DrawCourse(index % 4, random), kEverydayShare);
    case MotionFamily::kWild:
      return MotionOf(DrawCourse(index % 4, random), 1.0);
    case MotionFamily::kDrawn:
      return DrawMotion(seed, index);
    case MotionFamily::kWind:
      return DrawWind(random);
    case MotionFamily::kShake:
      return MotionOf(DrawShake(random), kShakeShare);
    case MotionFamily::kViolent:
      break;
  }
  return MotionOf(DrawViolence(random), kShakeShare);
}

}  // namespace

std::vector<MotionFamily> AllMotionFamilies() {
  std::vector<MotionFamily> families;
  for (size_t i = 0; i < std::size(kMotionFamilies); ++i) families.push_back(MotionFamily(i));
  return families;
}

RodProblem DrawRodProblem(MotionFamily family, uint64_t seed, int index) {
  const uint64_t own = MixSeed(seed, uint64_t(index));
  return {DrawBody(family, seed, index), DrawRest(Random(MixSeed(own, 2))),
          Random(MixSeed(own, 3)).Uniform(0.8, 1.25)};
}

}  // namespace pelt::accuracy
