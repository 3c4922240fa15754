// Shapes against brute force: the nearest of many points of what they are made of, in double.
#include "core/kernels/collider.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "core/kernels/modal_contact.hpp"
#include "tests/kernels/run_kernel.hpp"

namespace pelt::test {
namespace {

// Everything within `radius` of many points; a plane: of one, very far below.
struct BruteForce {
  std::vector<Double3> core;
  double radius;

  Double3 Nearest(Double3 p) const {
    return *std::min_element(core.begin(), core.end(),
                             [&](Double3 a, Double3 b) { return Length(p - a) < Length(p - b); });
  }
  double Distance(Double3 p) const { return Length(p - Nearest(p)) - radius; }
  Double3 Normal(Double3 p) const { return Unit(p - Nearest(p)); }
};

template <class V>
struct Lanes {
  alignas(64) float x[V::kLanes], y[V::kLanes], z[V::kLanes];
  explicit Lanes(Vec3<V> v) {
    v.x.Store(x);
    v.y.Store(y);
    v.z.Store(z);
  }
  Double3 At(int lane) const { return {x[lane], y[lane], z[lane]}; }
};

template <class V>
Vec3<V> Everywhere(Double3 p) {
  return {V(float(p.x)), V(float(p.y)), V(float(p.z))};
}

class Shapes {
 public:
  explicit Shapes(uint32_t seed) : random_(seed) {}

  float Uniform(float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random_);
  }
  Double3 Random(float size) {
    return {Uniform(-size, size), Uniform(-size, size), Uniform(-size, size)};
  }
  Double3 RandomUnit() {
    Double3 p{};
    while (Length(p) < 0.1) p = Random(1.0f);
    return Unit(p);
  }

  template <class V>
  Plane<V> MakePlane(BruteForce& same) {
    const Double3 normal = RandomUnit();
    const float height = Uniform(-0.3f, 0.3f);
    constexpr double kFar = 1.0e8;
    same = {{normal * (-height - kFar)}, kFar};
    return {Everywhere<V>(normal), V(height)};
  }
  template <class V>
  Sphere<V> MakeSphere(BruteForce& same) {
    const Double3 centre = Random(0.5f);
    const float radius = Uniform(0.05f, 0.5f);
    same = {{centre}, radius};
    return {{V(radius)}, Everywhere<V>(centre)};
  }
  template <class V>
  Capsule<V> MakeCapsule(BruteForce& same) {
    const Double3 from = Random(0.5f), axis = RandomUnit();
    const float radius = Uniform(0.05f, 0.5f), length = Uniform(0.0f, 1.0f);
    same = {{}, radius};
    constexpr int kSamples = 2000;
    for (int s = 0; s <= kSamples; ++s)
      same.core.push_back(from + axis * (double(length) * s / kSamples));
    return {{V(radius)}, Everywhere<V>(from), Everywhere<V>(axis), V(length)};
  }

  // Calls check(shape, brute force) for one of each.
  template <class V, class Check>
  void ForEach(Check check) {
    BruteForce same;
    const auto plane = MakePlane<V>(same);
    check(plane, same);
    const auto sphere = MakeSphere<V>(same);
    check(sphere, same);
    const auto capsule = MakeCapsule<V>(same);
    check(capsule, same);
  }

  template <class V>
  Vec3<V> RandomPoints(float size) {
    alignas(64) float p[3][V::kLanes];
    for (auto& row : p)
      for (float& v : row) v = Uniform(-size, size);
    return {V::Load(p[0]), V::Load(p[1]), V::Load(p[2])};
  }

 private:
  std::mt19937 random_;
};

TEST(Collider, DistanceAndNormalAreThoseOfBruteForce) {
  ForEveryVector([]<class V>(const char* name) {
    Shapes random(1);
    for (int iteration = 0; iteration < 20; ++iteration)
      random.ForEach<V>([&](const auto& shape, const BruteForce& same) {
        const Vec3<V> p = random.RandomPoints<V>(1.5f);
        const Lanes<V> at(p), normal(shape.Normal(p));
        alignas(64) float distance[V::kLanes], inside[V::kLanes];
        shape.Distance(p).Store(distance);
        Select(shape.IsInside(p), V(1.0f), V(0.0f)).Store(inside);
        for (int l = 0; l < V::kLanes; ++l) {
          const double wanted = same.Distance(at.At(l));
          EXPECT_NEAR(distance[l], wanted, 2e-6) << name;
          if (std::abs(wanted) > 1e-5) {
            EXPECT_EQ(inside[l] != 0.0f, wanted < 0.0) << name;
          }
          // Nearer to the core, the direction to its next sample is another one.
          if (wanted + same.radius > 0.1) {
            EXPECT_LT(Length(normal.At(l) - same.Normal(at.At(l))), 5e-3) << name;
          }
        }
      });
  });
}

TEST(Collider, PointsArePushedToTheSurfaceOrKeepTheirBits) {
  using V = ArrayVec<8>;
  Shapes random(2);
  uint32_t pushed = 0;
  for (int iteration = 0; iteration < 200; ++iteration)
    random.ForEach<V>([&](const auto& shape, const BruteForce& same) {
      const Vec3<V> p = random.RandomPoints<V>(0.8f);
      const Lanes<V> before(p), after(shape.PushOut(p));
      for (int l = 0; l < V::kLanes; ++l) {
        const double distance = same.Distance(before.At(l));
        if (distance > 1e-5) {
          EXPECT_EQ(Length(after.At(l) - before.At(l)), 0.0);
        }
        if (distance > -1e-5) continue;
        ++pushed;
        EXPECT_NEAR(same.Distance(after.At(l)), 0.0, 3e-6);
        EXPECT_NEAR(Length(after.At(l) - before.At(l)), -distance, 3e-6) << "the shortest way";
      }
    });
  EXPECT_GT(pushed, 500u);
}

TEST(Collider, InOtherUnitsItIsTheSameShape) {
  using V = ArrayVec<4>;
  Shapes random(3);
  for (int iteration = 0; iteration < 50; ++iteration)
    random.ForEach<V>([&](const auto& shape, const BruteForce&) {
      const V scale(random.Uniform(0.1f, 10.0f));
      const Vec3<V> origin = random.RandomPoints<V>(1.0f), p = random.RandomPoints<V>(1.0f);
      alignas(64) float wanted[V::kLanes], found[V::kLanes];
      (shape.Distance(p) * scale).Store(wanted);
      shape.In(scale, origin).Distance(p * scale - origin).Store(found);
      for (int l = 0; l < V::kLanes; ++l) EXPECT_NEAR(found[l], wanted[l], 2e-5);
    });
}

TEST(Collider, ACapsuleWithoutLengthIsASphere) {
  using V = ArrayVec<4>;
  Shapes random(4);
  for (int iteration = 0; iteration < 50; ++iteration) {
    const Vec3<V> centre = random.RandomPoints<V>(0.5f), p = random.RandomPoints<V>(0.5f);
    const V radius(random.Uniform(0.1f, 0.6f)), none(0.0f);
    const Sphere<V> sphere{{radius}, centre};
    const Capsule<V> capsule{{radius}, centre, {none, none, none}, none};
    const Lanes<V> a(sphere.PushOut(p)), b(capsule.PushOut(p));
    for (int l = 0; l < V::kLanes; ++l) EXPECT_EQ(Length(a.At(l) - b.At(l)), 0.0);
  }
}

// Whether Lean puts all of a link outside, not only its end: it does for a sphere.
template <class Shape>
inline constexpr bool kIsWhole = false;
template <class V>
inline constexpr bool kIsWhole<Sphere<V>> = true;

// A link whose upper end is outside is turned until its lower end is. As often as the finish walks
// over a link (kContactPasses), by the code it uses.
TEST(Collider, ALinkThatLeansAsToldEndsOutside) {
  using V = ArrayVec<8>;
  Shapes random(5);
  uint32_t turned = 0;
  double worst = 0.0, farthest = 0.0;
  for (int iteration = 0; iteration < 400; ++iteration)
    random.ForEach<V>([&](const auto& shape, const BruteForce& same) {
      const float length = random.Uniform(0.05f, 0.3f);
      const V per_length = V(1.0f / length);
      const Vec3<V> from = shape.PushOut(random.RandomPoints<V>(0.6f));
      Vec3<V> d = Everywhere<V>(random.RandomUnit());
      const Lanes<V> start(from), before(from + d * V(length));
      for (int pass = 0; pass < modal::kContactPasses; ++pass) {
        const LeanLimit<V> out = shape.Lean(from, d, per_length);
        LeanAlong(out.u, out.least, modal::kReach, V(0.0f), d);
      }
      const Lanes<V> after(from + d * V(length)), direction(d);
      for (int l = 0; l < V::kLanes; ++l) {
        EXPECT_NEAR(Length(direction.At(l)), 1.0, 1e-5);
        const auto nearest = [&](const Lanes<V>& end) {
          double distance = same.Distance(end.At(l));
          for (int part = 1; part < 40; ++part)
            distance = std::min(
                distance, same.Distance(start.At(l) + (end.At(l) - start.At(l)) * (part / 40.0)));
          return distance;
        };
        if (nearest(before) > 1e-5) {
          EXPECT_EQ(Length(after.At(l) - before.At(l)), 0.0);
          continue;
        }
        if (same.Distance(start.At(l)) < -1e-5) continue;
        if constexpr (kIsWhole<std::decay_t<decltype(shape)>>)
          EXPECT_GT(nearest(after), -5e-3 * double(length));
        else if (same.Distance(before.At(l)) > 1e-5)
          continue;
        ++turned;
        const double distance = same.Distance(after.At(l)) / length;
        worst = std::max(worst, -distance);
        farthest = std::max(farthest, distance);
      }
    });
  EXPECT_GT(turned, 1000u);
  EXPECT_LT(worst, 1e-3) << "in links";
  EXPECT_LT(farthest, 1.0);
}

}  // namespace
}  // namespace pelt::test
