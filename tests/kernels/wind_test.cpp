// The noise against a double reference and its statistics; the wind kernel; the wind's course over
// time.
#include "core/kernels/wind.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "core/exact_math.hpp"
#include "tests/kernels/run_kernel.hpp"

namespace pelt::test {
namespace {

using Ref = ArrayVec<4>;

struct Triple {
  double c[3];
};

Triple Noise(float x, float y, float z) {
  const Vec3<Ref> n = PerlinVector(Vec3<Ref>{Ref(x), Ref(y), Ref(z)});
  return {{n.x[0], n.y[0], n.z[0]}};
}

// The same noise written the slow way: corner by corner in double.
Triple NoiseReference(double x, double y, double z) {
  const double p[3] = {x, y, z};
  int64_t cell[3];
  double f[3];
  for (int i = 0; i < 3; ++i) {
    cell[i] = int64_t(std::floor(p[i]));
    f[i] = p[i] - double(cell[i]);
  }
  Triple sum{};
  for (int corner = 0; corner < 8; ++corner) {
    uint32_t lattice[3];
    double offset[3], weight = 1.0;
    for (int i = 0; i < 3; ++i) {
      const int side = (corner >> i) & 1;
      lattice[i] = uint32_t(((cell[i] + side) % 256 + 256) % 256);
      offset[i] = f[i] - side;
      const double fade = f[i] * f[i] * f[i] * (f[i] * (f[i] * 6.0 - 15.0) + 10.0);
      weight *= side ? fade : 1.0 - fade;
    }
    const auto mix = [](uint32_t key) {
      key *= 0x9e3779b1u;
      key = (key ^ (key >> 15)) * 0x85ebca6bu;
      return key ^ (key >> 13);
    };
    const uint32_t h =
        (mix(lattice[0] | lattice[1] << 8) ^ mix(lattice[2] | 1u << 16)) * 0xc2b2ae35u;
    double sign[3];
    for (int i = 0; i < 3; ++i) sign[i] = (h >> (31 - i)) & 1 ? -1.0 : 1.0;
    for (int component = 0; component < 3; ++component)
      for (int i = 0; i < 3; ++i)
        sum.c[component] += weight * sign[(i + component) % 3] * offset[i];
  }
  for (double& v : sum.c) v *= 2.0 / 3.0;
  return sum;
}

TEST(Perlin, IsTheDoubleReference) {
  std::mt19937 random(1);
  for (int i = 0; i < 4000; ++i) {
    const float range = i % 2 ? 8.0f : 300.0f;
    const float x = Uniform(random, -range, range), y = Uniform(random, -range, range);
    const float z = Uniform(random, -range, range);
    const Triple a = Noise(x, y, z), b = NoiseReference(x, y, z);
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(a.c[c], b.c[c], 3e-6) << x << " " << y << " " << z;
  }
}

TEST(Perlin, SameBitsOnEveryVector) {
  ForEveryVector([]<class V>(const char* name) {
    SCOPED_TRACE(name);
    std::mt19937 random(2);
    for (int i = 0; i < 2000; ++i) {
      float row[3][V::kLanes];
      for (auto& component : row)
        for (float& v : component) v = Uniform(random, -1.0f, 1.0f) * (i % 3 ? 40.0f : 1e9f);
      if (i % 5 == 0) row[1][1] = -0.0f;
      const Vec3<V> n = PerlinVector(Vec3<V>{V::Load(row[0]), V::Load(row[1]), V::Load(row[2])});
      for (int l = 0; l < V::kLanes; ++l) {
        const Triple expected = Noise(row[0][l], row[1][l], row[2][l]);
        ASSERT_EQ(BitsOf(n.x[l]), BitsOf(float(expected.c[0])));
        ASSERT_EQ(BitsOf(n.y[l]), BitsOf(float(expected.c[1])));
        ASSERT_EQ(BitsOf(n.z[l]), BitsOf(float(expected.c[2])));
      }
    }
  });
}

TEST(Perlin, HasZeroMeanUnitBoundUncorrelatedComponents) {
  std::mt19937 random(3);
  const int count = 60000;
  double mean[3] = {}, square[3] = {}, cross[3] = {}, largest = 0.0;
  for (int i = 0; i < count; ++i) {
    const Triple n = Noise(Uniform(random, 0.0f, 256.0f), Uniform(random, 0.0f, 256.0f),
                           Uniform(random, 0.0f, 256.0f));
    for (int c = 0; c < 3; ++c) {
      mean[c] += n.c[c] / count;
      square[c] += n.c[c] * n.c[c] / count;
      cross[c] += n.c[c] * n.c[(c + 1) % 3] / count;
      largest = std::max(largest, std::fabs(n.c[c]));
    }
  }
  EXPECT_LE(largest, 1.0);
  EXPECT_GT(largest, 0.7);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(mean[c], 0.0, 0.006) << c;
    EXPECT_GT(square[c], 0.03) << c;
    EXPECT_LT(square[c], 0.12) << c;
    EXPECT_NEAR(cross[c] / square[c], 0.0, 0.02) << c;
  }
}

// Gradients of neighbouring lattice points along each axis and diagonal: a weak hash shows here.
TEST(Perlin, NeighbouringCellsAreUncorrelated) {
  const int steps[][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 1, 1},  {1, 0, 1},
                          {2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {1, 1, 1}, {16, 0, 0}, {0, 0, 16}};
  for (const auto& step : steps) {
    double same = 0.0, square = 0.0;
    for (int x = 0; x < 14; ++x) {
      for (int y = 0; y < 14; ++y) {
        for (int z = 0; z < 14; ++z) {
          // Close to a lattice point the noise is that point's ramp alone.
          const float d = 0.01f;
          const Triple a = Noise(float(x) + d, float(y) + d, float(z) + d);
          const Triple b =
              Noise(float(x + step[0]) + d, float(y + step[1]) + d, float(z + step[2]) + d);
          for (int c = 0; c < 3; ++c) same += a.c[c] * b.c[c], square += a.c[c] * a.c[c];
        }
      }
    }
    EXPECT_NEAR(same / square, 0.0, 0.06) << step[0] << " " << step[1] << " " << step[2];
  }
}

TEST(Perlin, IsContinuousAndSmoothAcrossCells) {
  std::mt19937 random(4);
  for (int i = 0; i < 2000; ++i) {
    const float edge = float(int(random() % 200) - 100);
    const float y = Uniform(random, -50.0f, 50.0f), z = Uniform(random, -50.0f, 50.0f);
    const float h = 1.0f / 512.0f;
    const Triple left = Noise(edge - h, y, z), at = Noise(edge, y, z),
                 right = Noise(edge + h, y, z);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(left.c[c], right.c[c], 0.01);
      // Equal slopes on both sides: the second difference is far below the first.
      EXPECT_NEAR(left.c[c] + right.c[c] - 2.0 * at.c[c], 0.0, 2e-4);
    }
  }
}

TEST(Perlin, RepeatsEveryPeriodAndVanishesAtLatticePoints) {
  std::mt19937 random(5);
  const float period = float(kPerlinPeriod);
  for (int i = 0; i < 500; ++i) {
    // Sixteenths, so that adding the period is exact.
    const float x = float(random() % 4096) / 16.0f, y = float(random() % 4096) / 16.0f;
    const float z = float(random() % 4096) / 16.0f;
    const Triple a = Noise(x, y, z), b = Noise(x - period, y + period, z + 2 * period);
    for (int c = 0; c < 3; ++c) ASSERT_EQ(a.c[c], b.c[c]);
    const Triple zero = Noise(std::floor(x), std::floor(y), std::floor(z));
    for (double v : zero.c) ASSERT_EQ(v, 0.0);
  }
}

TEST(Perlin, HugePlacesStayFiniteAndBounded) {
  for (float x : {1e7f, -1e7f, 3e38f, -3e38f, 1048576.0f, -1048576.0f, 1e-45f}) {
    const Triple n = Noise(x, -x, x);
    for (double v : n.c) {
      EXPECT_TRUE(std::isfinite(v)) << x;
      EXPECT_LE(std::fabs(v), 1.0) << x;
    }
  }
}

// ---- The kernel ---------------------------------------------------------------------------------

struct Scene {
  ChunkStateBlock state{};
  LayerBlock layer{};
  RootBlock roots{};
  WindBlock wind;
};

std::unique_ptr<Scene> MakeScene(uint32_t live_strands, uint32_t live_vertices) {
  auto scene = std::make_unique<Scene>();
  std::mt19937 random(6);
  scene->state.live_strands = live_strands;
  scene->state.live_chains = live_vertices;
  scene->layer.wind_response = 1.75f;
  for (auto& row : scene->roots.position)
    for (float& v : row) v = Uniform(random, -3.0f, 3.0f);
  return scene;
}

const WindParams kBreeze = {{2.0f, -0.5f, 1.0f}, 0.8f, 3.0f, {10.25f, 255.5f, 0.125f}};

template <class V, bool kVertexChains>
void RunWind(const WindParams& params, Scene& scene) {
  Poison(scene.wind);
  RunOnBlocks<Wind<V, kVertexChains>>(&params, scene.state, scene.layer, scene.roots, scene.wind);
}

TEST(Wind, IsTheDoubleReference) {
  const auto scene = MakeScene(kStrandsPerChunk, 0);
  RunWind<Ref, false>(kBreeze, *scene);
  for (uint32_t s = 0; s < kStrandsPerChunk; ++s) {
    double place[3];
    for (int c = 0; c < 3; ++c)
      place[c] = double(scene->roots.position[c][s]) * kBreeze.frequency + kBreeze.scroll[c];
    const Triple noise = NoiseReference(place[0], place[1], place[2]);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(scene->wind.acceleration[c][s],
                  1.75 * (kBreeze.direction_speed[c] + kBreeze.turbulence * noise.c[c]), 3e-4)
          << s;
    }
  }
}

TEST(Wind, LanesAreVerticesOrStrandsAndBitsAreTheSame) {
  const auto scene = MakeScene(40, 20);
  RunWind<Ref, false>(kBreeze, *scene);
  const WindBlock expected = scene->wind;
  ForEveryVector([&]<class V>(const char* name) {
    SCOPED_TRACE(name);
    RunWind<V, false>(kBreeze, *scene);
    ExpectSameBits(scene->wind.acceleration, expected.acceleration, 48, "strands");
    EXPECT_EQ(BitsOf(scene->wind.acceleration[0][48]), 0xffffffffu);

    RunWind<V, true>(kBreeze, *scene);
    ExpectSameBits(scene->wind.acceleration, expected.acceleration, 32, "vertices");
    EXPECT_EQ(BitsOf(scene->wind.acceleration[0][32]), 0xffffffffu);
  });
}

TEST(Wind, StillAirIsExactlyZero) {
  const auto scene = MakeScene(64, 64);
  const WindParams params = MakeWindParams(WindSetup{}, 12345.678);
  for (float v : params.direction_speed) EXPECT_EQ(v, 0.0f);
  for (float v : params.scroll) EXPECT_EQ(v, 0.0f);
  EXPECT_EQ(params.turbulence, 0.0f);
  EXPECT_EQ(params.frequency, 0.0f);
  RunWind<ArrayVec<8>, false>(params, *scene);
  for (const auto& row : scene->wind.acceleration)
    for (uint32_t s = 0; s < 64; ++s) ASSERT_EQ(row[s], 0.0f);
}

// ---- Force volumes ------------------------------------------------------------------------------

// A ball that pushes, a turned box that pulls, and a ball that repels.
const ForceParams kForces = {
    3,
    {{{{0.3f, 0, 0.1f, 0.1f}, {0, 0.5f, 0, 0}, {-0.1f, 0, 0.4f, 0}}, {3, -1, 2}, 0, 2, 0},
     {{{0.4f, 0, 0.3f, 0}, {0, 0.5f, 0, -0.2f}, {-0.6f, 0, 0.8f, 1}}, {1, 0, -1}, 7, 10, 3},
     {{{0.6f, 0, 0, 1}, {0, 0.6f, 0, 0}, {0, 0, 0.6f, 0}}, {-1.5f, 0, 0}, -4, 1, kForcePulls}}};

// Adds to the acceleration; whether the force acts there.
bool Act(const PlacedForce& force, const double (&place)[3], double (&acceleration)[3]) {
  double square = 0.0, largest = 0.0, way[3], distance = 0.0;
  for (int r = 0; r < 3; ++r) {
    double own = force.own[r][3];
    for (int k = 0; k < 3; ++k) own += force.own[r][k] * place[k];
    square += own * own;
    largest = std::max(largest, std::fabs(own));
    way[r] = force.push[r] - place[r];
    distance = std::hypot(distance, way[r]);
  }
  const double out = force.flags & kForceBox ? largest : std::sqrt(square);
  const double share = std::clamp((1.0 - out) * force.steepness, 0.0, 1.0);
  for (int k = 0; k < 3; ++k)
    acceleration[k] +=
        share * (force.flags & kForcePulls ? force.pull * way[k] / distance : force.push[k]);
  return share > 0.0;
}

TEST(Wind, ForceVolumesAreTheDoubleReferenceAndNothingOutside) {
  const auto scene = MakeScene(kStrandsPerChunk, 0);
  RunWind<Ref, false>(kBreeze, *scene);
  const WindBlock without = scene->wind;
  WindParams params = kBreeze;
  params.forces = kForces;
  RunWind<Ref, false>(params, *scene);
  ExpectSameBits(scene->wind.acceleration, without.acceleration, kStrandsPerChunk, "not pushed");
  scene->layer.flags = kLayerPushed;
  RunWind<Ref, false>(params, *scene);
  const WindBlock with = scene->wind;
  uint32_t inside[4] = {};  // of each, and of none
  for (uint32_t s = 0; s < kStrandsPerChunk; ++s) {
    double place[3], push[3] = {};
    for (int c = 0; c < 3; ++c) place[c] = double(scene->roots.position[c][s]);
    bool none = true;
    for (uint32_t f = 0; f < 3; ++f) {
      const bool acts = Act(kForces.force[f], place, push);
      inside[f] += acts;
      none = none && !acts;
    }
    inside[3] += none;
    for (int c = 0; c < 3; ++c) {
      const float found = with.acceleration[c][s], still = without.acceleration[c][s];
      EXPECT_NEAR(found, double(still) + push[c], 1e-4) << s;
      ASSERT_TRUE(!none || BitsOf(found) == BitsOf(still)) << s;
    }
  }
  for (const uint32_t count : inside) EXPECT_GT(count, 3u);
  ForEveryVector([&]<class V>(const char* name) {
    RunWind<V, false>(params, *scene);
    ExpectSameBits(scene->wind.acceleration, with.acceleration, kStrandsPerChunk, name);
  });
}

// ---- The course over time -----------------------------------------------------------------------

TEST(WindSetup, GustsSwingTheMeanWithinTheirStrength) {
  WindSetup setup;
  setup.velocity[0] = 4.0f;
  setup.velocity[2] = -2.0f;
  setup.gust_strength = 0.5f;
  double low = 1e9, high = -1e9, mean = 0.0, before = 0.0;
  const int frames = 60 * 600;
  for (int i = 0; i < frames; ++i) {
    const WindParams params = MakeWindParams(setup, i / 60.0);
    const double speed = params.direction_speed[0];
    EXPECT_NEAR(params.direction_speed[2], -0.5 * speed, 1e-6);
    ASSERT_TRUE(i == 0 || std::fabs(speed - before) < 0.3) << "gusts are continuous";
    before = speed;
    low = std::min(low, speed);
    high = std::max(high, speed);
    mean += speed / frames;
  }
  EXPECT_GE(low, 2.0 - 1e-5);
  EXPECT_LE(high, 6.0 + 1e-5);
  EXPECT_LT(low, 2.7);
  EXPECT_GT(high, 5.3);
  EXPECT_NEAR(mean, 4.0, 0.05);
}

TEST(WindSetup, ScrollIsWrappedAndStaysPreciseForWeeks) {
  WindSetup setup;
  setup.velocity[0] = 7.3f;
  setup.turbulence = 1.0f;
  setup.turbulence_scale_m = 0.4f;
  for (double start : {0.0, 100.0, 86400.0, 14 * 86400.0}) {
    for (int i = 0; i < 400; ++i) {
      const double t = start + i / 60.0;
      const WindParams a = MakeWindParams(setup, t), b = MakeWindParams(setup, t + 1.0 / 60.0);
      for (int c = 0; c < 3; ++c) {
        ASSERT_GE(a.scroll[c], 0.0f);
        ASSERT_LT(a.scroll[c], float(kPerlinPeriod));
      }
      // The noise is carried along by the wind: a fixed step per frame, also after two weeks.
      double step = double(b.scroll[0]) - a.scroll[0];
      step -= kPerlinPeriod * std::floor(step / kPerlinPeriod + 0.5);
      ASSERT_NEAR(step, -(7.3f + 0.31) / 0.4f / 60.0, 1e-4) << t;
    }
  }
}

// x = A + B sin(C (t + x)), z = D + E sin(F (t + z)), each of A to F swung by noise.
TEST(WindSetup, ThePublishedWindIsItsFormula) {
  const WindSetup setup{{3.0f, 9.0f, -2.0f}, 0.4f, 3.0f, 2.0f, 0.5f, 1};
  const double origin[3] = {0.25, 100.0, -0.5};
  const auto scene = MakeScene(kStrandsPerChunk, 0);
  for (const double time_s : {0.0, 1.7, 9.3}) {
    const WindParams params = MakeWindParams(setup, time_s, origin);
    RunWind<Ref, false>(params, *scene);
    const WindBlock found = scene->wind;
    for (int i = 0; i < 2; ++i) {
      const Triple noise = Noise(float(time_s / 3.0), 0.5f, 0.5f + 32.0f * float(i));
      const auto swung = [&](double mean, int c) { return mean * (1.0 + 0.4 * noise.c[c]); };
      const double a = swung(i ? -2.0 : 3.0, 0), b = swung(2.0, 1);
      const double c = swung(2.0 * exact::kPi / 0.5, 2);
      for (uint32_t s = 0; s < kStrandsPerChunk; ++s) {
        const double x = origin[2 * i] + double(scene->roots.position[2 * i][s]);
        const double blows = 1.75 * (a + b * std::sin(c * (time_s + x)));
        EXPECT_NEAR(found.acceleration[2 * i][s], blows, 2e-4) << time_s << " s, " << s;
        EXPECT_EQ(found.acceleration[1][s], 0.0f);
      }
    }
    ForEveryVector([&]<class V>(const char* name) {
      RunWind<V, false>(params, *scene);
      ExpectSameBits(scene->wind.acceleration, found.acceleration, kStrandsPerChunk, name);
    });
  }
}

TEST(WindSetup, TurbulenceInCalmAirStillChanges) {
  WindSetup setup;
  setup.turbulence = 0.5f;
  const WindParams a = MakeWindParams(setup, 1.0), b = MakeWindParams(setup, 2.0);
  EXPECT_EQ(a.direction_speed[0], 0.0f);
  EXPECT_NE(a.scroll[0], b.scroll[0]);
}

}  // namespace
}  // namespace pelt::test
