// Wind at the chain roots: the day's wind with its gusts, and turbulence carried along by it.
//
//   acceleration = response * (mean(t) + turbulence * noise(frequency * position + scroll(t)))
//
// Everything that needs time (sums of sines, the travelled way of the noise) is worked out once a
// frame on the caller's thread by MakeWindParams; the kernel sees a place and a few numbers.
//
// Invariant: no wind gives exactly 0. What breaks if scroll is not wrapped by the noise's period:
// after minutes the noise falls onto ever coarser floats.
#pragma once

#include <string_view>

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/simd/perlin.hpp"
#include "core/streams.hpp"
#include "core/wind_setup.hpp"

namespace pelt {

struct WindParams {
  float direction_speed[3];  // mean wind of this frame, gusts included, m/s
  float turbulence;          // largest component that the noise adds, m/s
  float frequency;           // noise cells a metre
  float scroll[3];           // noise offset of this frame, cells, in [0, kPerlinPeriod)
};

// Wind of the moment `time_s` (0 or later), in core/wind_setup.cpp. Exact for weeks: phases are
// wrapped in double. Still air (velocity and turbulence 0) is all zeros. The noise travels at the
// mean velocity, so a change of velocity in mid-run makes it jump; gusts do not.
// `origin`: of the places it is asked at, world, m.
WindParams MakeWindParams(const WindSetup& setup, double time_s,
                          const double (&origin)[3] = {0.0, 0.0, 0.0});

// Lanes are mesh vertices with kVertexChains, strands otherwise.
template <class V, bool kVertexChains>
struct Wind {
  static constexpr std::string_view kName = kVertexChains ? "wind_vertices" : "wind_strands";
  using Params = WindParams;
  using Of = ChainStreams<4, kVertexChains>;  // those of strands are the same for all points
  struct Ports {
    In<Of::kState> state;
    Shared<&Streams::layers> layer;
    In<Of::kRoots> roots;
    Out<Of::kWind> wind;
  };

  static void Run(const Params& params, const Ports& ports) {
    const uint32_t live = kVertexChains ? ports.state->live_chains : ports.state->live_strands;
    const uint32_t lanes = RoundUpToLaneGroups(live);
    const V response(ports.layer->wind_response);
    const Vec3<V> mean = {V(params.direction_speed[0]), V(params.direction_speed[1]),
                          V(params.direction_speed[2])};
    const Vec3<V> scroll = {V(params.scroll[0]), V(params.scroll[1]), V(params.scroll[2])};
    for (uint32_t lane = 0; lane < lanes; lane += V::kLanes) {
      Vec3<V> wind = mean;
      if (params.turbulence != 0.0f) {
        const Vec3<V> place = Load3<V>(ports.roots->position, lane) * V(params.frequency) + scroll;
        wind = wind + PerlinVector(place) * V(params.turbulence);
      }
      Store3<V>(ports.wind->acceleration, lane, wind * response);
    }
  }
};

}  // namespace pelt
