// The wind's course over time: everything that is of time alone, once per frame.
//
// Gusts are the EyePet recipe: a sum of sines whose periods are not multiples of each other, so
// that the swell never repeats, scaled to [-1, 1]. Each phase is wrapped on its own in double
// before its sine is taken; time itself is never turned into a float.
#include <cmath>

#include "core/exact_math.hpp"
#include "core/float_rules.hpp"
#include "core/kernels/wind.hpp"

namespace pelt {
namespace {

// Share of one turn that `time_s` is into a cycle of `period_s`, [0, 1). The remainder is exact.
double Phase(double time_s, double period_s) { return std::fmod(time_s, period_s) / period_s; }

// In [-1, 1]: three sines, the ratio of periods close to the golden mean.
double Swell(double time_s, double period_s) {
  const auto wave = [&](double share) {
    return exact::Sin(2.0 * exact::kPi * Phase(time_s, period_s * share));
  };
  return 0.5 * wave(1.0) + 0.3 * wave(0.6180339887) + 0.2 * wave(0.2763932023);
}

float WrapCells(double cells) {
  const double period = kPerlinPeriod;
  const double wrapped = cells - exact::Floor(cells / period) * period;
  const float result = float(wrapped);
  // Rounding to float may reach the period itself.
  return result >= float(kPerlinPeriod) || result < 0.0f ? 0.0f : result;
}

// A to F: the means of the setup, swung by noise over time.
WindParams MakePublishedWind(const WindSetup& setup, double time_s, const double (&origin)[3]) {
  using V = ArrayVec<4>;
  WindParams params{};
  params.published = 1;
  const V cells(WrapCells(time_s / double(setup.gust_period_s)));
  for (uint32_t i = 0; i < 2; ++i) {
    const uint32_t axis = 2 * i;  // x, z
    const Vec3<V> noise = PerlinVector(Vec3<V>{cells, V(0.5f), V(0.5f + 32.0f * float(i))});
    const auto swung = [&](double mean, const V& by) {
      return mean * (1.0 + double(setup.gust_strength) * double(by[0]));
    };
    const double turns = swung(1.0 / double(setup.turbulence_scale_m), noise.z);
    params.direction_speed[axis] = float(swung(double(setup.velocity[axis]), noise.x));
    const double phase = turns * (time_s + origin[axis]);
    params.sine[i] = {float(swung(double(setup.turbulence), noise.y)), float(turns),
                      float(phase - exact::Floor(phase))};
  }
  return params;
}

}  // namespace

WindParams MakeWindParams(const WindSetup& setup, double time_s, const double (&origin)[3]) {
  if (setup.kind == uint32_t(WindKind::kPublished)) return MakePublishedWind(setup, time_s, origin);
  WindParams params{};
  const double gust = 1.0 + double(setup.gust_strength) * Swell(time_s, setup.gust_period_s);
  for (int c = 0; c < 3; ++c) params.direction_speed[c] = float(setup.velocity[c] * gust);
  if (setup.turbulence == 0.0f) return params;

  params.turbulence = setup.turbulence;
  params.frequency = float(1.0 / setup.turbulence_scale_m);
  // The eddies travel with the mean wind and drift across it with the speed of the turbulence
  // itself, along a fixed slant: without it, turbulence in calm air would stand still.
  static constexpr double kDrift[3] = {0.31, -0.47, 0.23};
  for (int c = 0; c < 3; ++c) {
    const double speed = setup.velocity[c] + kDrift[c] * setup.turbulence;
    params.scroll[c] =
        WrapCells(-speed * time_s * params.frequency + origin[c] * double(params.frequency));
  }
  return params;
}

}  // namespace pelt
