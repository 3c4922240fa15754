// The view against a projection in double, and select_lod against a plain double reference,
// geometry and the promises its head makes: conservative, monotone, steady inside the band.
#include "core/kernels/select_lod.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/view.hpp"
#include "tests/kernels/run_kernel.hpp"

namespace pelt::test {
namespace {

// Whether a point is on the screen, by projecting it; `slack` shrinks the screen.
bool IsOnScreen(const Camera& c, Double3 point, double slack) {
  const Double3 forward = Unit(Of(c.target) - Of(c.eye));
  const Double3 right = Unit(Cross(forward, Of(c.up)));
  const Double3 up = Cross(right, forward);
  const Double3 p = point - Of(c.eye);
  const double depth = Dot(p, forward);
  if (depth < c.near_m + slack || depth > c.far_m - slack) return false;
  const double tan_y = std::tan(0.5 * double(c.vertical_fov_rad));
  const double tan_x = tan_y * c.viewport_width_px / c.viewport_height_px;
  return std::abs(Dot(p, right)) < depth * tan_x - slack &&
         std::abs(Dot(p, up)) < depth * tan_y - slack;
}

Camera RandomCamera(std::mt19937& random) {
  Camera c;
  for (int i = 0; i < 3; ++i) {
    c.eye[i] = Uniform(random, -5.0f, 5.0f);
    c.target[i] = Uniform(random, -5.0f, 5.0f);
  }
  c.vertical_fov_rad = Uniform(random, 0.2f, 2.0f);
  c.viewport_width_px = Uniform(random, 300.0f, 2000.0f);
  c.near_m = 0.1f;
  c.far_m = 50.0f;
  return c;
}

SelectLodParams MakeParams(const Camera& camera) {
  SelectLodParams p{};
  p.view = MakeView(camera);
  p.full_detail_pixels = 400.0f;
  p.min_fraction = 0.1f;
  p.hysteresis = 0.1f;
  p.budget_scale = 1.0f;
  p.fade_share = 0.1f;
  p.flags = kLodOn | kCullOn;
  return p;
}

struct World {
  Blocks<LayerBlock> layer{1, 0};
  Blocks<BoundsBlock> bounds{1, 0};
  Blocks<LodBlock> lod{1, 0};
  World() {
    layer[0].flags = kLayerEnabled;
    layer[0].strand_count = 1000;
    layer[0].importance = 1.0f;
  }
  void SetBox(float x, float y, float z, float half) {
    const float centre[3] = {x, y, z};
    for (int i = 0; i < 3; ++i) {
      bounds[0].low[i] = centre[i] - half;
      bounds[0].high[i] = centre[i] + half;
    }
  }
  template <class V = ArrayVec<4>>
  const LodBlock& Run(const SelectLodParams& p) {
    RunKernel<SelectLod<V>>(p, {layer.Bind(), bounds.Bind(), lod.Bind()});
    return lod[0];
  }
};

TEST(View, PlanesAgreeWithAProjection) {
  std::mt19937 random(1);
  int inside_count = 0, outside_count = 0;
  for (int i = 0; i < 20000; ++i) {
    const Camera camera = RandomCamera(random);
    const View view = MakeView(camera);
    const Double3 p{Uniform(random, -9.0f, 9.0f), Uniform(random, -9.0f, 9.0f),
                    Uniform(random, -9.0f, 9.0f)};
    double least = 1e9;
    for (const auto& plane : view.planes)
      least = std::min(least, plane[0] * p.x + plane[1] * p.y + plane[2] * p.z + plane[3]);
    if (IsOnScreen(camera, p, 1e-3)) {
      EXPECT_GE(least, 0.0);
      ++inside_count;
    } else if (!IsOnScreen(camera, p, -1e-3)) {
      EXPECT_LT(least, 0.0);
      ++outside_count;
    }
  }
  EXPECT_GT(inside_count, 1000);
  EXPECT_GT(outside_count, 1000);
}

TEST(View, PixelsOfAMetreAheadAreThePinholeFormula) {
  Camera camera;
  camera.vertical_fov_rad = 1.0f;
  camera.viewport_height_px = 1000.0f;
  EXPECT_NEAR(MakeView(camera).pixels_per_unit_at_1m, 500.0 / std::tan(0.5), 1e-2);
}

TEST(View, FaultyCamerasAreNamedAndStillGiveFiniteViews) {
  std::vector<Camera> cameras(6);
  cameras[0].eye[1] = std::nanf("");
  std::memcpy(cameras[1].target, cameras[1].eye, sizeof cameras[1].target);
  cameras[2].vertical_fov_rad = 4.0f;
  cameras[3].viewport_width_px = 0.0f;
  cameras[4].far_m = 0.01f;
  cameras[5].near_m = -1.0f;
  for (const Camera& c : cameras) {
    EXPECT_NE(FindCameraFault(c), nullptr);
    const View v = MakeView(c);
    for (float f : v.forward) EXPECT_TRUE(std::isfinite(f));
    for (const auto& plane : v.planes) {
      for (float f : plane) EXPECT_TRUE(std::isfinite(f));
      EXPECT_NEAR(std::hypot(plane[0], plane[1], plane[2]), 1.0, 1e-5);
    }
    EXPECT_GT(v.pixels_per_unit_at_1m, 0.0f);
  }
  EXPECT_EQ(FindCameraFault(Camera{}), nullptr);
  Camera overhead;  // looking along `up` is no fault: another axis takes its place
  overhead.eye[1] = 9.0f;
  overhead.eye[2] = 0.0f;
  EXPECT_EQ(FindCameraFault(overhead), nullptr);
  EXPECT_NEAR(MakeView(overhead).forward[1], -1.0, 1e-6);
}

TEST(SelectLod, ABoxWithAPointOnTheScreenIsVisible) {
  std::mt19937 random(2);
  int seen = 0, dropped = 0;
  for (int i = 0; i < 5000; ++i) {
    const Camera camera = RandomCamera(random);
    World world;
    float low[3], high[3];
    for (int a = 0; a < 3; ++a) {
      low[a] = Uniform(random, -9.0f, 9.0f);
      high[a] = low[a] + Uniform(random, 0.0f, 2.0f);
      world.bounds[0].low[a] = low[a];
      world.bounds[0].high[a] = high[a];
    }
    const bool visible = world.Run(MakeParams(camera)).visible != 0;
    bool on_screen = false;
    for (int s = 0; s < 64; ++s) {
      const auto pick = [&](int a) {
        const int bit = (s >> a) & 1;
        if (s < 8) return bit ? high[a] : low[a];
        return low[a] + (high[a] - low[a]) * Uniform(random, 0.0f, 1.0f);
      };
      on_screen |= IsOnScreen(camera, {pick(0), pick(1), pick(2)}, 0.0);
    }
    EXPECT_TRUE(visible || !on_screen);
    seen += visible;
    dropped += !visible;
  }
  EXPECT_GT(seen, 200);
  EXPECT_GT(dropped, 1000);
}

TEST(SelectLod, EmptyDisabledAndUnculledLayers) {
  World world;
  world.SetBox(0, 1, 30, 0.5f);  // behind the default camera
  SelectLodParams p = MakeParams(Camera{});
  EXPECT_EQ(world.Run(p).visible, 0u);
  EXPECT_EQ(world.lod[0].fraction, 0.0f);
  p.flags = kLodOn;
  EXPECT_EQ(world.Run(p).visible, 1u);
  EXPECT_EQ(world.lod[0].was_visible, 0u);
  world.layer[0].flags = 0;
  EXPECT_EQ(world.Run(p).visible, 0u);
  EXPECT_EQ(world.lod[0].was_visible, 1u);
  world.layer[0].flags = kLayerEnabled;
  world.layer[0].strand_count = 0;
  EXPECT_EQ(world.Run(p).visible, 0u);
}

TEST(SelectLod, WithoutLodEveryStrandLives) {
  World world;
  world.SetBox(0, 1, -40, 0.01f);
  SelectLodParams p = MakeParams(Camera{});
  p.flags = kCullOn;
  p.budget_scale = 0.25f;
  EXPECT_EQ(world.Run(p).fraction, 1.0f);
  EXPECT_EQ(world.lod[0].fade, 0.0f);
}

TEST(SelectLod, WantedAgreesWithDoubleReference) {
  std::mt19937 random(3);
  for (int i = 0; i < 2000; ++i) {
    const Camera camera = RandomCamera(random);
    SelectLodParams p = MakeParams(camera);
    p.flags = kLodOn;
    p.full_detail_pixels = Uniform(random, 50.0f, 3000.0f);
    World world;
    double diagonal2 = 0, distance2 = 0;
    for (int a = 0; a < 3; ++a) {
      const float low = Uniform(random, -9.0f, 9.0f), high = low + Uniform(random, 0.0f, 2.0f);
      world.bounds[0].low[a] = low;
      world.bounds[0].high[a] = high;
      const double eye = camera.eye[a];
      const double gap = std::max({0.0, low - eye, eye - high});
      diagonal2 += std::pow(double(high) - low, 2);
      distance2 += gap * gap;
    }
    const double distance = std::max(std::sqrt(distance2), double(camera.near_m));
    const double ppu =
        0.5 * camera.viewport_height_px / std::tan(0.5 * double(camera.vertical_fov_rad));
    const double size = std::sqrt(diagonal2) * ppu / distance;
    const double wanted = std::clamp(size / p.full_detail_pixels, 0.1, 1.0);
    EXPECT_NEAR(world.Run(p).wanted, wanted, 2e-5);
  }
}

TEST(SelectLod, NearerNeverAsksForLess) {
  SelectLodParams p = MakeParams(Camera{});
  float last = 0.0f;
  for (float z = -90.0f; z < 3.0f; z += 0.01f) {
    World world;
    world.SetBox(0, 1, z, 0.3f);
    const float wanted = world.Run(p).wanted;
    EXPECT_GE(wanted, last);
    EXPECT_GE(wanted, p.min_fraction);
    last = wanted;
  }
  EXPECT_EQ(last, 1.0f);
}

TEST(SelectLod, TheShareMovesOnlyOutsideItsBandAndReachesOne) {
  SelectLodParams p = MakeParams(Camera{});
  World world;
  std::mt19937 random(4);
  float z = -20.0f;
  int kept = 0, changed = 0;
  for (int frame = 0; frame < 5000; ++frame) {
    z = std::clamp(z + Uniform(random, -0.4f, 0.4f), -40.0f, 1.0f);
    world.SetBox(0, 1, z, 0.3f);
    const float before = world.lod[0].fraction;
    const bool was_visible = world.lod[0].visible != 0;
    const LodBlock& lod = world.Run(p);
    ASSERT_EQ(lod.visible, 1u);
    if (lod.wanted == 1.0f) {
      EXPECT_EQ(lod.fraction, 1.0f);
    } else if (!was_visible) {
      EXPECT_EQ(lod.fraction, lod.wanted);
    } else if (lod.fraction == before) {
      EXPECT_LE(std::abs(lod.wanted - before), p.hysteresis * before * 1.0001f);
      ++kept;
    } else {
      EXPECT_EQ(lod.fraction, lod.wanted);
      EXPECT_GT(std::abs(lod.wanted - before), p.hysteresis * before * 0.9999f);
      ++changed;
    }
    EXPECT_GE(lod.fade, 0.0f);
    EXPECT_LE(lod.fade, 1.0f - lod.fraction);
    EXPECT_LE(lod.fade, p.fade_share * lod.fraction);
  }
  EXPECT_GT(kept, 100);
  EXPECT_GT(changed, 20);
}

TEST(SelectLod, AnOscillatingSizeDoesNotFlicker) {
  SelectLodParams p = MakeParams(Camera{});
  World world;
  world.SetBox(0, 1, -15, 0.3f);
  world.Run(p);
  const float settled = world.lod[0].fraction;
  ASSERT_LT(settled, 1.0f);
  for (int frame = 0; frame < 100; ++frame) {
    world.SetBox(0, 1, -15.0f + (frame % 2 ? 0.7f : -0.7f), 0.3f);
    EXPECT_EQ(world.Run(p).fraction, settled);
  }
}

TEST(SelectLod, ComingIntoViewTakesTheWantedShareAtOnce) {
  SelectLodParams p = MakeParams(Camera{});
  World world;
  world.SetBox(0, 1, -15, 0.3f);
  world.Run(p);
  world.SetBox(0, 1, 90, 0.3f);
  EXPECT_EQ(world.Run(p).visible, 0u);
  world.SetBox(0, 1, -15.5f, 0.3f);  // inside the band of the first share
  const LodBlock& lod = world.Run(p);
  EXPECT_EQ(lod.fraction, lod.wanted);
}

TEST(SelectLod, BudgetScaleHoldsTheBudgetAndDoesNotSwing) {
  SelectLodParams p = MakeParams(Camera{});
  p.hysteresis = 0.0f;
  Blocks<LayerBlock> layers(20, 0);
  Blocks<BoundsBlock> bounds(20, 0);
  Blocks<LodBlock> lod(20, 0);
  for (uint32_t l = 0; l < 20; ++l) {
    layers[l].flags = kLayerEnabled;
    layers[l].importance = 1.0f;
    layers[l].strand_count = 1000 + 100 * l;
    for (int a = 0; a < 3; ++a) {
      bounds[l].low[a] = (a == 2 ? -float(l) : 0.0f) - 0.2f;
      bounds[l].high[a] = (a == 2 ? -float(l) : 0.0f) + 0.2f;
    }
  }
  bounds[3].low[2] += 100.0f;  // behind the camera: not counted
  bounds[3].high[2] += 100.0f;
  const auto run_frame = [&] {
    p.budget_scale = BudgetScale({lod.begin(), 20}, {layers.begin(), 20}, 4000);
    double strands = 0;
    for (uint32_t l = 0; l < 20; ++l) {
      RunKernel<SelectLod<ArrayVec<4>>>(p, {layers.Bind(l), bounds.Bind(l), lod.Bind(l)});
      strands += double(lod[l].fraction) * layers[l].strand_count;
    }
    return strands;
  };
  EXPECT_GT(run_frame(), 4000.0);  // nothing known yet
  for (int frame = 0; frame < 5; ++frame) EXPECT_NEAR(run_frame(), 4000.0, 1.0);
  EXPECT_EQ(BudgetScale({lod.begin(), 20}, {layers.begin(), 20}, 0), 1.0f);
  EXPECT_EQ(BudgetScale({lod.begin(), 20}, {layers.begin(), 20}, 1000000), 1.0f);
}

TEST(SelectLod, ImportanceIsAFactorOnTheSizeAndOnWhatTheBudgetLeaves) {
  SelectLodParams p = MakeParams(Camera{});
  World plain, doubled;
  plain.SetBox(0, 1, -10, 0.3f);
  doubled.SetBox(0, 1, -10, 0.3f);
  doubled.layer[0].importance = 2.0f;
  const float wanted = plain.Run(p).wanted;
  ASSERT_GT(wanted, p.min_fraction);
  ASSERT_LT(wanted, 0.5f);
  EXPECT_FLOAT_EQ(doubled.Run(p).wanted, 2.0f * wanted);
  p.hysteresis = 0.0f;
  p.budget_scale = 0.3f;
  EXPECT_FLOAT_EQ(plain.Run(p).fraction, 0.3f * wanted);
  EXPECT_FLOAT_EQ(doubled.Run(p).fraction, 0.6f * 2.0f * wanted);
  p.budget_scale = 0.7f;
  EXPECT_FLOAT_EQ(doubled.Run(p).fraction, 2.0f * wanted) << "no more than it wants";
}

TEST(SelectLod, BudgetScaleLeavesImportantLayersMore) {
  LodBlock lod[2]{};
  LayerBlock layers[2]{};
  for (int i = 0; i < 2; ++i)
    lod[i].visible = 1, lod[i].wanted = 1.0f, layers[i].strand_count = 1000;
  layers[0].importance = 3.0f;
  layers[1].importance = 1.0f;
  EXPECT_EQ(BudgetScale(lod, layers, 1000), 0.25f) << "750 and 250";
  EXPECT_FLOAT_EQ(BudgetScale(lod, layers, 1600), 0.6f) << "all 1000, and 600";
  EXPECT_EQ(BudgetScale(lod, layers, 2000), 1.0f);
  layers[1].importance = 0.25f;
  EXPECT_FLOAT_EQ(BudgetScale(lod, layers, 1600), 2.4f) << "the same strands";
  EXPECT_GE(BudgetScale(lod, layers, 2000) * 0.25f, 1.0f) << "there is room";
  EXPECT_GE(BudgetScale(lod, layers, 0) * 0.25f, 1.0f) << "there is no budget";
  layers[1].importance = 0.0f;  // off, and in view in the last frame
  EXPECT_EQ(BudgetScale(lod, layers, 600), 0.2f) << "600 of the first's";
}

// A layer that has this share of its strands: of its least, as far off as it is.
void HoldAt(float fraction, SelectLodParams& p) {
  p.full_detail_pixels = 1e9f;
  p.min_fraction = fraction;
}

// With LOD or without.
TEST(SelectLod, ALayerSimulatesItsOwnShareOfItsChains) {
  for (const float fraction : {1.0f, 0.51f, 0.01f}) {
    World world;
    world.SetBox(0, 1, 0, 0.5f);
    world.layer[0].flags |= 2u << kLayerChainLevelShift;
    SelectLodParams p = MakeParams(Camera{});
    HoldAt(fraction, p);
    EXPECT_EQ(world.Run(p).chain_level, fraction < 0.25f ? 3u : 2u) << fraction;
    p.flags = kCullOn;
    EXPECT_EQ(world.Run(p).chain_level, 2u) << fraction;
  }
}

TEST(SelectLod, ChainsThinByHalvesTwiceAsFastAsTheStrands) {
  struct Case {
    float fraction, least_chains;
    uint32_t level;
  };
  constexpr Case kCases[] = {{1.0f, 0.0f, 0},   {0.99f, 0.0f, 1}, {0.51f, 0.0f, 1},
                             {0.5f, 0.0f, 2},   {0.26f, 0.0f, 2}, {0.25f, 0.0f, 3},
                             {0.01f, 0.0f, 3},  {0.01f, 1.0f, 0}, {0.01f, 0.5f, 1},
                             {0.01f, 0.26f, 1}, {0.01f, 0.25f, 2}};
  for (const Case& c : kCases) {
    World world;
    world.SetBox(0, 1, 0, 0.5f);
    SelectLodParams p = MakeParams(Camera{});
    HoldAt(c.fraction, p);
    p.least_chains = c.least_chains;
    const LodBlock& lod = world.Run(p);
    EXPECT_EQ(lod.chain_level, c.level) << c.fraction << ", " << c.least_chains;
    EXPECT_EQ(lod.parent_share, 0.0f) << "comes into view as it stays";
    p.flags = kCullOn;
    EXPECT_EQ(world.Run(p).chain_level, 0u) << "without LOD all live";
  }
  World shells;
  shells.layer[0].flags |= kLayerShells;
  shells.SetBox(0, 1, 0, 0.5f);
  SelectLodParams p = MakeParams(Camera{});
  HoldAt(0.1f, p);
  EXPECT_EQ(shells.Run(p).chain_level, 0u);
}

// From level to level what is seen moves by 1/16 per frame, whichever way it goes and when it turns.
TEST(SelectLod, ChainsComeAndGoSlowly) {
  World world;
  world.SetBox(0, 1, 0, 0.5f);
  SelectLodParams p = MakeParams(Camera{});
  p.hysteresis = 0.0f;
  const auto kept = [&](float fraction) {
    HoldAt(fraction, p);
    const LodBlock& lod = world.Run(p);
    EXPECT_TRUE(lod.parent_share >= 0.0f && lod.parent_share <= 1.0f);
    EXPECT_TRUE(lod.chain_level < kChainLevels - 1 || lod.parent_share == 0.0f);
    return float(kChainLevels) - float(lod.chain_level) - lod.parent_share;
  };
  EXPECT_EQ(kept(1.0f), 4.0f);
  float last = 4.0f;
  constexpr std::pair<float, int> kCourse[] = {{0.1f, 48}, {0.3f, 34}, {1.0f, 10},
                                               {0.1f, 5},  {1.0f, 12}, {0.4f, 40}};
  for (const auto& [fraction, frames] : kCourse)
    for (int f = 0; f < frames; ++f) {
      const float now = kept(fraction);
      EXPECT_LE(std::abs(now - last), 1.0f / 16.0f) << fraction << ", " << f;
      last = now;
    }
  EXPECT_EQ(last, 2.0f) << "0.4 of the strands, a quarter of the chains";
  EXPECT_EQ(world.lod[0].parent_share, 0.0f);
}

TEST(SelectLod, ABoxAroundTheEyeOrWithoutSizeStaysFinite) {
  World world;
  SelectLodParams p = MakeParams(Camera{});
  world.SetBox(0, 1, 3, 0.0f);
  p.flags = kLodOn;
  p.min_fraction = 0.0f;
  EXPECT_EQ(world.Run(p).visible,
            0u);  // wants no strand: not seen, and no chunk is left half alive
  world.SetBox(0, 1, 3, 4.0f);
  EXPECT_EQ(world.Run(p).fraction, 1.0f);
  p.full_detail_pixels = 0.0f;
  world.SetBox(0, 1, -500, 0.001f);
  EXPECT_EQ(world.Run(p).fraction, 1.0f);
}

TEST(SelectLod, SameBitsOnEveryVector) {
  ForEveryVector([]<class V>(const char* name) {
    std::mt19937 random(5);
    World world, reference;
    for (int i = 0; i < 500; ++i) {
      const SelectLodParams p = MakeParams(RandomCamera(random));
      const float x = Uniform(random, -4, 4), z = Uniform(random, -9, 9);
      world.SetBox(x, 0, z, 0.5f);
      reference.SetBox(x, 0, z, 0.5f);
      world.Run<V>(p);
      reference.Run<ArrayVec<4>>(p);
      ASSERT_TRUE(world.lod.SameBits(reference.lod)) << name;
    }
  });
}

}  // namespace
}  // namespace pelt::test
