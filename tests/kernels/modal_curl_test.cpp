// What carries a rest direction along with its parent, against what it is said to be: a rotation,
// and the slope of what it weighs.
#include "core/kernels/modal_curl.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/kernels/chain_scene.hpp"

namespace pelt::test {
namespace {

using V = ArrayVec<4>;

Vec3<V> Splat(const float (&v)[3]) { return {V(v[0]), V(v[1]), V(v[2])}; }

struct Carrying {
  float a[3], d[3], v[3], to[3];

  explicit Carrying(uint32_t seed) {
    std::mt19937 random(seed);
    do {
      RandomUnit(random, a);
      RandomUnit(random, d);
    } while (a[0] * d[0] + a[1] * d[1] + a[2] * d[2] < -0.5f);  // far from where it has no slope
    RandomUnit(random, v);
    RandomUnit(random, to);
  }
  modal::Carried<V> Run() const { return modal::Carry(Splat(a), Splat(d), Splat(v), Splat(to)); }
};

TEST(ModalCurl, CarryTurnsOneDirectionIntoTheOther) {
  for (uint32_t seed = 0; seed < 200; ++seed) {
    Carrying c(seed);
    EXPECT_NEAR(Dot(c.Run().image, c.Run().image)[0], 1.0f, 1e-5f) << "no rotation";
    std::copy_n(c.a, 3, c.v);
    const Vec3<V> image = c.Run().image;
    EXPECT_NEAR(image.x[0], c.d[0], 1e-5f);
    EXPECT_NEAR(image.y[0], c.d[1], 1e-5f);
    EXPECT_NEAR(image.z[0], c.d[2], 1e-5f);
  }
}

TEST(ModalCurl, GradientIsTheSlopeOfWhatTheImageWeighs) {
  constexpr float kStep = 1e-2f;
  for (uint32_t seed = 0; seed < 200; ++seed) {
    const Carrying c(seed);
    const modal::Carried<V> at = c.Run();
    const Vec3<V> w = Splat(c.to) - at.image;
    const float gradient[3] = {at.gradient.x[0], at.gradient.y[0], at.gradient.z[0]};
    for (int k = 0; k < 3; ++k) {
      Carrying more = c, less = c;
      more.d[k] += kStep;
      less.d[k] -= kStep;
      const float slope =
          (Dot(w, more.Run().image)[0] - Dot(w, less.Run().image)[0]) / (2.0f * kStep);
      EXPECT_NEAR(gradient[k], slope, 5e-3f) << "seed " << seed << ", axis " << k;
    }
  }
}

}  // namespace
}  // namespace pelt::test
