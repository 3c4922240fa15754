// The wind of a frame, as it is set from outside; core/kernels/wind.hpp has what it does.
#pragma once

namespace pelt {

// The wind as the user sets it.
struct WindSetup {
  float velocity[3] = {0.0f, 0.0f, 0.0f};  // mean, m/s
  float gust_strength = 0.0f;              // 0.5: gusts swing the mean by up to half
  float gust_period_s = 4.0f;              // of the slowest sine; must be above 0
  float turbulence = 0.0f;                 // m/s
  float turbulence_scale_m = 1.0f;         // size of an eddy; must be above 0
};

}  // namespace pelt
