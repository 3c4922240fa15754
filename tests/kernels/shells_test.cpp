// Shells: the force on a vertex against a reference in double, both cones of shame, and how many
// shells there are at which distance.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/kernels/select_lod.hpp"
#include "core/kernels/select_shells.hpp"
#include "core/kernels/shell_force.hpp"
#include "tests/kernels/run_kernel.hpp"

namespace pelt::test {
namespace {

using accuracy::Length;
using Ref = ArrayVec<4>;

// ---- The cones ----------------------------------------------------------------------------------

// A force of this size that is so many degrees off the normal, to a side that is not an axis.
Vec3<Ref> ForceAt(double degrees, double size) {
  const double angle = degrees * std::numbers::pi / 180.0;
  const double up = size * std::cos(angle), across = size * std::sin(angle);
  return {Ref(float(0.6 * across)), Ref(float(up)), Ref(float(0.8 * across))};
}
const Vec3<Ref> kUp{Ref(0.0f), Ref(1.0f), Ref(0.0f)};

double Length(const Vec3<Ref>& a) {
  return std::hypot(double(a.x[0]), double(a.y[0]), double(a.z[0]));
}

constexpr float kCone = 0.2f;

Vec3<Ref> Published(double degrees, double size, float fur_length = 1.0f) {
  return shell_force_detail::ConeOfShame(ForceAt(degrees, size), kUp, Ref(kCone), Ref(fur_length));
}
Vec3<Ref> Exact(double degrees, double size) {
  return shell_force_detail::KeepInCone(ForceAt(degrees, size), kUp, Ref(kCone),
                                        Ref(std::sqrt(1.0f - kCone * kCone)));
}

// Cosines after correction, worked out from the published lines by hand.
TEST(ConeOfShame, HasThePublishedNumbers) {
  const struct {
    double degrees, cosine;
  } printed[] = {{90, .110432},  {80, .186551},  {100, .056871}, {120, .044368},
                 {150, .482404}, {170, .937689}, {179, .999391}};
  for (const auto& [degrees, cosine] : printed) {
    const Vec3<Ref> force = Published(degrees, 1.0);
    EXPECT_NEAR(double(force.y[0]) / Length(force), cosine, 2e-6) << degrees;
    EXPECT_NEAR(Length(force), 1.0, 1e-6) << degrees;
  }
}

TEST(ConeOfShame, KeepsItsQuirks) {
  // Straight into the skin the force is gone, a degree beside it comes out whole.
  EXPECT_EQ(Length(Published(180, 1.0)), 0.0);
  // A unit normal is mixed with a force of any size.
  const auto cosine = [](double size) {
    const Vec3<Ref> force = Published(90, size);
    return double(force.y[0]) / Length(force);
  };
  EXPECT_NEAR(cosine(2.0), .0555, 5e-5);
  EXPECT_NEAR(cosine(0.1), .7433, 5e-5);
  // What is corrected is as long as the fur, what is not stays as it was.
  EXPECT_NEAR(Length(Published(90, 0.5, 0.03f)), 0.03, 1e-8);
  EXPECT_NEAR(Length(Published(60, 0.5, 0.03f)), 0.5, 1e-6);
  // It never reaches its cone about 90 degrees.
  for (double degrees = 80; degrees <= 130; degrees += 1) {
    const Vec3<Ref> force = Published(degrees, 1.0);
    EXPECT_LT(double(force.y[0]) / Length(force), double(kCone)) << degrees;
  }
  // Not where the mixed vectors cancel, and not without a force.
  EXPECT_EQ(Length(Published(180, 1.5)), 0.0);
  EXPECT_EQ(Length(Published(90, 0.0)), 0.0);
}

TEST(KeepInCone, ReachesTheConeAndKeepsTheForce) {
  const double edge = std::acos(double(kCone)) * 180.0 / std::numbers::pi;
  EXPECT_NEAR(edge, 78.463, 1e-3);
  for (const double size : {1e-3, 0.1, 1.0, 30.0})
    for (double degrees = 0.0; degrees <= 180.0; degrees += 0.25) {
      const Vec3<Ref> force = Exact(degrees, size);
      const double cosine = double(force.y[0]) / Length(force);
      EXPECT_NEAR(Length(force) / size, 1.0, 2e-6) << degrees;
      if (degrees < edge - 0.01)
        EXPECT_NEAR(cosine, std::cos(degrees * std::numbers::pi / 180.0), 1e-6) << degrees;
      else
        EXPECT_NEAR(cosine, double(kCone), 2e-6) << degrees;
      // To the side that it was on.
      if (degrees > 1.0 && degrees < 179.0) {
        EXPECT_NEAR(double(force.x[0]) / double(force.z[0]), 0.75, 1e-5) << degrees;
      }
    }
  EXPECT_EQ(Length(Exact(90.0, 0.0)), 0.0);
}

// No step at the cone's edge, which the published one has.
TEST(KeepInCone, HasNoStepAtItsEdge) {
  const double edge = std::acos(double(kCone)) * 180.0 / std::numbers::pi;
  const Vec3<Ref> before = Exact(edge - 1e-3, 0.5), behind = Exact(edge + 1e-3, 0.5);
  EXPECT_LT(Length(before - behind), 1e-4);
  EXPECT_GT(Length(Published(edge - 1e-3, 0.5) - Published(edge + 1e-3, 0.5)), 0.4);
}

// ---- The kernel ---------------------------------------------------------------------------------

struct Scene {
  LayerBlock layer{};
  ShellLayerBlock shells{};
  RestBlock<4> rest{};
  ShellSkinBlock skin{};
  RootBlock anchors{};
  WindBlock wind{};
  ChunkStateBlock state{};  // of the patch

  Scene() { layer.scale = 1.0f; }

  template <class V>
  ShellVertexBlock Run() {
    return OutputOf<ShellForce<V>, ShellVertexBlock>(nullptr, layer, shells, rest, skin, anchors,
                                                     wind, state);
  }
};

// Not within a ball: more of them point to the corners of a cube.
Double3 RandomDirection(std::mt19937& random) {
  const auto part = [&] { return double(Uniform(random, -1.0f, 1.0f)); };
  Double3 d{0.0, 0.0, 0.0};
  while (Length(d) < 0.1) {
    d.x = part();
    d.y = part();
    d.z = part();
  }
  return Unit(d);
}

Scene MakeScene(uint32_t live, uint32_t seed) {
  Scene scene;
  std::mt19937 random(seed);
  scene.layer.flags = kLayerSimulate | kLayerWind;
  scene.layer.link.stiffness = 0.25f;
  scene.layer.darken = 1.0f;
  scene.layer.gravity[1] = -9.81f;
  scene.shells.cone = kCone;
  scene.state.live_vertices = live;
  for (uint32_t v = 0; v < kVerticesPerChunk; ++v) {
    const Double3 normal = RandomDirection(random);
    const Double3 tangent = Unit(Cross(normal, RandomDirection(random)));
    SetAt(scene.anchors.position, v, RandomDirection(random));
    SetAt(scene.anchors.normal, v, normal);
    SetAt(scene.anchors.tangent, v, tangent);
    SetAt(scene.wind.acceleration, v, RandomDirection(random) * 12.0);
    SetAt(scene.rest.offset[2], v, RandomDirection(random) * 0.03);
    scene.rest.segment_length[v] = Uniform(random, 0.002f, 0.02f);
    scene.rest.strength[v] = v % 5 == 0 ? 0.0f : Uniform(random, 0.0f, 1.0f);
    scene.skin.base_colour[v] = uint32_t(random());
    scene.skin.tip_colour[v] = uint32_t(random());
  }
  return scene;
}

Double3 ReferenceForce(const Scene& s, uint32_t v) {
  if (!(s.layer.flags & kLayerSimulate)) return {0.0, 0.0, 0.0};
  const Double3 n = At(s.anchors.normal, v);
  Double3 a = Of(s.layer.gravity);
  if (s.layer.flags & kLayerWind) a = a + At(s.wind.acceleration, v);
  Double3 f = a * ((1.0 - double(s.layer.link.stiffness)) / 9.80665);
  if (Length(f) > 1.0) f = Unit(f);
  const double c = double(s.shells.cone), size = Length(f);
  const double lean = size > 0.0 ? Dot(f, n) / size : 1.0;
  if (lean < c) {
    if (s.shells.cone_kind == uint32_t(ConeKind::kPublished)) {
      const double share = 0.5 * (c - lean);
      f = Unit(f * (1.0 - share) + n * share);
    } else {
      const Double3 side = Unit(f - n * Dot(f, n));
      f = (n * c + side * std::sqrt(1.0 - c * c)) * size;
    }
  }
  return f * (3.0 * double(s.rest.segment_length[v]) * double(s.rest.strength[v]));
}

void ExpectReference(Scene scene, const char* what) {
  const ShellVertexBlock out = scene.Run<Ref>();
  for (uint32_t v = 0; v < scene.state.live_vertices; ++v) {
    const ShellVertex& vertex = out.vertex[v];
    const Double3 n = At(scene.anchors.normal, v), t = At(scene.anchors.tangent, v);
    const Double3 tip = At(scene.rest.offset[2], v);
    const Double3 groom = t * tip.x + Cross(n, t) * tip.y + n * tip.z;
    EXPECT_EQ(Length(Of(vertex.position) - At(scene.anchors.position, v)), 0.0) << what << v;
    ASSERT_LT(Length(Of(vertex.groom) - groom), 1e-8) << what << v;
    ASSERT_LT(Length(Of(vertex.force) - ReferenceForce(scene, v)), 5e-8) << what << v;
    ASSERT_LE(Length(Of(vertex.force)), 3.00001 * double(scene.rest.segment_length[v]));
    EXPECT_EQ(vertex.base_colour, scene.skin.base_colour[v]) << what << v;
    EXPECT_EQ(vertex.tip_colour, scene.skin.tip_colour[v]) << what << v;
  }
}

TEST(ShellForce, IsTheDoubleReference) {
  for (uint32_t seed = 0; seed < 20; ++seed) {
    Scene scene = MakeScene(kVerticesPerChunk, seed);
    ExpectReference(scene, "exact ");
    scene.shells.cone_kind = uint32_t(ConeKind::kPublished);
    ExpectReference(scene, "published ");
    scene.layer.link.stiffness = 0.97f;  // short of the limit
    ExpectReference(scene, "stiff ");
    scene.layer.flags = kLayerSimulate;
    ExpectReference(scene, "still air ");
    scene.layer.flags = kLayerWind;
    ExpectReference(scene, "not simulated ");
  }
}

// As write_ribbons and the others have them: in lane groups, and no lane more.
TEST(ShellForce, SameVerticesOnEveryVector) {
  for (const uint32_t live : {1u, 15u, 17u, 64u})
    for (const ConeKind kind : {ConeKind::kExact, ConeKind::kPublished}) {
      Scene scene = MakeScene(live, live);
      scene.shells.cone_kind = uint32_t(kind);
      scene.layer.darken = 0.6f;
      scene.layer.dirt = 0.3f;
      const ShellVertexBlock expected = scene.Run<Ref>();
      EXPECT_NE(expected.vertex[0].base_colour, scene.skin.base_colour[0]);
      EXPECT_EQ(expected.vertex[0].base_colour >> 24, scene.skin.base_colour[0] >> 24);
      ExpectOnEveryVector(
          expected, [&]<class V> { return scene.Run<V>(); }, live);
    }
}

TEST(ShellForce, CarriesTheSkinsNormal) {
  Scene scene = MakeScene(kVerticesPerChunk, 3);
  const ShellVertexBlock out = scene.Run<Ref>();
  for (uint32_t v = 0; v < kVerticesPerChunk; ++v) {
    const auto part = [](uint32_t bits) { return double(int16_t(uint16_t(bits))) / 32767.0; };
    const Double3 n = At(scene.anchors.normal, v);
    const double sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
    if (n.z <= 0.0) continue;
    EXPECT_NEAR(part(out.vertex[v].normal & 0xffffu), n.x / sum, 1e-4);
    EXPECT_NEAR(part(out.vertex[v].normal >> 16), n.y / sum, 1e-4);
  }
}

// ---- How many -----------------------------------------------------------------------------------

struct Selection {
  LodBlock lod{};
  BoundsBlock bounds{};
  LayerBlock importance{};
  ShellLayerBlock layer{};
  SelectShellsParams params{};

  Selection() {
    importance.importance = 1.0f;
    lod.visible = 1;
    for (int axis = 0; axis < 3; ++axis) bounds.low[axis] = -1.0f, bounds.high[axis] = 1.0f;
    layer.most = kMaxShells;
    layer.shadow = 0.3f;
    layer.texture_repeat = 5.0f;
  }
  // From a place so far in front of the box.
  ShellLodBlock At(float distance) {
    params.eye[2] = 1.0f + distance;
    return OutputOf<SelectShells<Ref>, ShellLodBlock>(&params, importance, lod, bounds, layer);
  }
};

TEST(SelectShells, FollowTheTableRowByRow) {
  const struct {
    float metres;
    uint32_t count;
  } table[] = {{0, 40}, {1, 40}, {2, 20}, {3, 13}, {5, 8},
               {7, 5},  {10, 4}, {20, 2}, {40, 1}, {41, 0}};
  Selection selection;
  for (const auto& [metres, count] : table) EXPECT_EQ(selection.At(metres).count, count) << metres;
  for (float metres = 0.25f; metres < 50.0f; metres += 0.25f)
    EXPECT_EQ(selection.At(metres).count, std::min(40u, uint32_t(40.0 / double(metres)))) << metres;
  for (uint32_t n = 1; n <= 40; ++n) {  // each step, from both sides
    EXPECT_EQ(selection.At(40.0f / float(n) * 0.9995f).count, n);
    EXPECT_EQ(selection.At(40.0f / float(n) * 1.0005f).count, n - 1);
  }
  selection.layer.most = 6;
  for (const auto& [metres, count] : table)
    EXPECT_EQ(selection.At(metres).count, std::min(6u, count)) << metres;
}

TEST(SelectShells, AreAsManyAsNearerWhereTheLayerIsImportant) {
  Selection selection;
  selection.importance.importance = 2.0f;
  EXPECT_EQ(selection.At(9.9f).count, 8u) << "as at 4.95 m";
  EXPECT_EQ(selection.At(79.0f).count, 1u);
  selection.importance.importance = 0.5f;
  EXPECT_EQ(selection.At(2.4f).count, 8u);
  EXPECT_EQ(selection.At(21.0f).count, 0u);
}

TEST(SelectShells, HaveTheirFourNumbers) {
  Selection selection;
  const ShellLodBlock out = selection.At(5.0f);
  ASSERT_EQ(out.count, 8u);
  EXPECT_EQ(out.texture_repeat, 5.0f);
  const float shadow[] = {.3875f, .475f, .5625f, .65f, .7375f, .825f, .9125f, 1.0f};
  for (uint32_t i = 0; i < 8; ++i) {
    EXPECT_FLOAT_EQ(out.shell[i].height, float(i + 1) / 8.0f);
    EXPECT_FLOAT_EQ(out.shell[i].shadow, shadow[i]);
    EXPECT_FLOAT_EQ(out.shell[i].threshold, float(i) / 8.0f);
    EXPECT_EQ(out.shell[i].fade, 1.0f);
  }
  for (uint32_t i = 8; i < kMaxShells; ++i) EXPECT_EQ(out.shell[i].height, 0.0f);
}

TEST(SelectShells, TheLastOneFadesOnItsWayOut) {
  Selection selection;
  EXPECT_EQ(selection.At(20.0f).shell[0].fade, 1.0f);
  EXPECT_NEAR(selection.At(30.0f).shell[0].fade, 1.0f / 3.0f, 1e-6f);
  EXPECT_NEAR(selection.At(40.0f).shell[0].fade, 0.0f, 1e-6f);
  float last = 2.0f;
  for (float metres = 20.0f; metres <= 40.0f; metres += 0.5f) {
    const float fade = selection.At(metres).shell[0].fade;
    EXPECT_LE(fade, last);
    last = fade;
  }
}

TEST(SelectShells, LeaveTheBudgetToStrands) {
  LodBlock lod[2]{};
  LayerBlock layers[2]{};
  for (int i = 0; i < 2; ++i)
    lod[i].visible = 1, lod[i].wanted = layers[i].importance = 1.0f, layers[i].strand_count = 100;
  EXPECT_EQ(BudgetScale(lod, layers, 100), 0.5f);
  layers[1].flags = kLayerShells;
  EXPECT_EQ(BudgetScale(lod, layers, 100), 1.0f);
}

TEST(SelectShells, AreNoneOfWhatIsNotSeenAndAllWithoutLevelOfDetail) {
  Selection selection;
  selection.params.all = 1;
  EXPECT_EQ(selection.At(100.0f).count, kMaxShells);
  EXPECT_EQ(selection.At(100.0f).shell[39].fade, 1.0f);
  selection.lod.visible = 0;
  EXPECT_EQ(selection.At(0.0f).count, 0u);
}

}  // namespace
}  // namespace pelt::test
