// The wind of a frame, as it is set from outside; core/kernels/wind.hpp has what it does.
#pragma once

namespace pelt {

// The wind as the user sets it: mean velocity, which gusts make stronger and weaker along its
// direction, and turbulence, which it carries along. With velocity and turbulence 0 no wind blows.
struct WindSetup {
  float velocity[3] = {0.0f, 0.0f, 0.0f};  // mean of the air over time, world, m/s
  float gust_strength = 0.0f;              // 0.5: gusts swing the velocity by up to half of it
  float gust_period_s = 4.0f;              // of the slowest sine; from 1e-3 on
  float turbulence = 0.0f;                 // most that an eddy adds along an axis, m/s
  float turbulence_scale_m = 1.0f;         // size of an eddy; from 1e-3 on
};

}  // namespace pelt
