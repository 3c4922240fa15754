// The picture of a frame with every output, and what it knows of the fur on the skin.
#include "bench/picture/picture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "bench/picture/body.hpp"
#include "bench/picture/hairs.hpp"
#include "bench/picture/relief_coat.hpp"
#include "bench/picture/skin_fur.hpp"
#include "bench/shading/default_look.hpp"
#include "core/groom/surface_colour.hpp"
#include "tests/error_from.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

struct Drawn {
  explicit Drawn(VertexOrder order, Scenario drawn = EveryOutputScenario(), uint32_t frame = 0)
      : order(order), scenario(std::move(drawn)), running(scenario, {.vertex_order = order}) {
    RunFrame(running, frame);
  }
  std::vector<std::byte> Picture(const std::vector<std::string>& relief = {}) {
    const Camera camera = scenario.PrepareFrame(0, running.scene()).camera;
    std::vector<std::string> notes;
    return DrawPicture(scenario, running.scene(), camera, order, {160, 120, 2}, notes, relief);
  }

  VertexOrder order;
  Scenario scenario;
  RunningScenario running;
};

TEST(Picture, IsTheSameInBothVertexOrders) {
  EXPECT_EQ(Drawn(VertexOrder::kSorted).Picture(), Drawn(VertexOrder::kIndexBuffer).Picture());
}

TEST(Picture, ShowsMoreThanABackground) {
  Scenario scenario = EveryOutputScenario();
  scenario.base.lighting = {};  // in the studio's light
  const std::vector<std::byte> png = Drawn(VertexOrder::kSorted, scenario).Picture();
  const ControlMap image =
      ReadControlMap({reinterpret_cast<const uint8_t*>(png.data()), png.size()}, "picture");
  ASSERT_EQ(image.width, 160u);
  ASSERT_EQ(image.height, 120u);
  std::set<uint32_t> colours;
  for (size_t i = 0; i < image.rgba.size(); i += 4)
    colours.insert(uint32_t(image.rgba[i] | image.rgba[i + 1] << 8 | image.rgba[i + 2] << 16));
  EXPECT_GT(colours.size(), 1500u);
}

// Fur on the skin in place of hairs, of the layers that are named and no others.
TEST(Picture, ReliefTakesThePlaceOfHairs) {
  Drawn drawn(VertexOrder::kSorted);
  const std::vector<std::byte> hairs = drawn.Picture(), all = drawn.Picture({"all"}),
                               one = drawn.Picture({"vertex"});
  EXPECT_NE(all, hairs);
  EXPECT_NE(one, hairs);
  EXPECT_NE(one, all);
  std::vector<std::string> each;
  for (const LayerSetup& layer : drawn.scenario.setups[0].layers) each.push_back(layer.name);
  EXPECT_EQ(drawn.Picture(each), all);
}

TEST(Picture, ReliefLeavesTheOthersTheirHairs) {
  Drawn drawn(VertexOrder::kSorted);
  const FurScene& scene = drawn.running.scene();
  const auto all = ReadHairs(scene, VertexOrder::kSorted);
  auto left = all;
  std::vector<LayerDraw> draws(scene.Draws().begin(), scene.Draws().end());
  const std::vector<std::string> names = {"vertex", "modal4"};
  RemoveRelief(drawn.scenario, scene, names, false, left, draws);
  for (size_t d = 0; d < all.size(); ++d) {
    const std::string_view name = scene.LayerName(scene.Draws()[d].layer);
    if (!scene.Draws()[d].format().OfStrands()) continue;
    ASSERT_FALSE(all[d].empty()) << name;
    EXPECT_EQ(left[d].size(), name == names[0] || name == names[1] ? 0 : all[d].size()) << name;
  }
}

TEST(Picture, ReliefTakesThePlaceOfShellsToo) {
  Scenario scenario = EveryOutputScenario();
  FurSetup& setup = scenario.setups[scenario.actors[0].groom];
  setup.layers.push_back(setup.layers.front());
  setup.layers.back().name = "shells";
  Drawn drawn(VertexOrder::kSorted, scenario);
  std::vector<std::string> notes, names;
  const auto shells = [&] {
    const PictureScene shown = GatherPicture(drawn.scenario, drawn.running.scene(), {},
                                             VertexOrder::kSorted, notes, names);
    return std::ranges::count_if(shown.draws,
                                 [](const LayerDraw& draw) { return !draw.shells.shell.empty(); });
  };
  EXPECT_EQ(shells(), 1);
  names = {"vertex"};
  EXPECT_EQ(shells(), 1);
  names = {"shells"};
  EXPECT_EQ(shells(), 0);
}

// A rim is the layer's fins, as they are without relief, and no shell.
TEST(Picture, ReliefWithARimKeepsTheFins) {
  Scenario scenario = EveryOutputScenario();
  FurSetup& setup = scenario.setups[scenario.actors[0].groom];
  setup.layers.push_back(setup.layers.front());
  setup.layers.back().name = "shells";
  const std::vector<std::string> names = {"shells"};
  EXPECT_NE(test::ErrorFrom([&] { CheckRelief(scenario, names, true); }).find("has fins"),
            std::string::npos);
  setup.layers.back().params.fins = true;
  Drawn drawn(VertexOrder::kSorted, scenario);
  const PictureMaps maps(drawn.scenario, names, true);
  const PictureScene shown =
      GatherPicture(drawn.scenario, maps, drawn.running.scene(), {}, VertexOrder::kSorted);
  for (size_t d = 0; d < shown.draws.size(); ++d) {
    const ShellDraw &rim = shown.draws[d].shells, &all = drawn.running.scene().Draws()[d].shells;
    if (rim.shell.empty()) continue;
    EXPECT_EQ(WriteFins(rim, {}), WriteFins(all, {}));
    EXPECT_GT(WriteFins(rim, {}), 0u);
    ASSERT_EQ(rim.shell.size(), 1u);
    EXPECT_EQ(rim.shell[0].threshold, 1.0f);
    EXPECT_EQ(rim.shell[0].fade, all.shell.back().fade);
    return;
  }
  FAIL() << "no layer has a rim";
}

// Frames that are accumulated differ by their jitter alone, and one without it is none of them.
TEST(Picture, ReliefIsJitteredByFrame) {
  Drawn drawn(VertexOrder::kSorted);
  std::vector<std::string> notes;
  const std::vector<std::string> names = {"all"};
  const Camera camera = drawn.scenario.PrepareFrame(0, drawn.running.scene()).camera;
  PictureScene shown = GatherPicture(drawn.scenario, drawn.running.scene(), camera,
                                     VertexOrder::kSorted, notes, names);
  SoftwareRenderer renderer;
  const PictureOptions options{160, 120, 1};
  const std::vector<uint8_t> plain = renderer.Draw(shown, options);
  const ReliefCount count = renderer.ReliefSteps();
  EXPECT_GT(count.places, 100u);
  EXPECT_LT(count.steps, 28.0 * double(count.places));
  shown.relief.march.least = shown.relief.march.most = 2.0f;
  renderer.Draw(shown, options);
  EXPECT_LT(renderer.ReliefSteps().steps, 0.75 * count.steps);
  shown.relief.march.most = 16.0f;
  shown.relief.frame = 0;
  const std::vector<uint8_t> first = renderer.Draw(shown, options);
  EXPECT_NE(first, plain);
  EXPECT_EQ(DrawFrames(renderer, shown, options, 1), first);
  EXPECT_NE(DrawFrames(renderer, shown, options, 4), first);
  shown.relief.frame = 1;
  EXPECT_NE(renderer.Draw(shown, options), first);
  shown.relief.march.wind = {0.02f, 0.0f, 0.0f};
  shown.relief.frame = 0;
  EXPECT_NE(renderer.Draw(shown, options), first);
}

TEST(Picture, ReliefNeedsTheSetupAndKnownLayers) {
  Drawn drawn(VertexOrder::kSorted);
  const auto reason = [&](const std::vector<std::string>& names) {
    return test::ErrorFrom([&] { CheckRelief(drawn.scenario, names); });
  };
  EXPECT_EQ(reason({}), "");
  EXPECT_EQ(reason({"all"}), "");
  EXPECT_EQ(reason({"vertex", "modal4"}), "");
  EXPECT_NE(reason({"vertex", "beard"}).find("no layer 'beard'"), std::string::npos);
  std::vector<glm::vec2>& uv = drawn.scenario.characters[0].mesh.uv;
  const std::vector<glm::vec2> kept = std::exchange(uv, {});
  EXPECT_NE(reason({"all"}).find("needs texture coordinates"), std::string::npos);
  uv = kept;
  EXPECT_EQ(reason({"all"}), "");
  drawn.scenario.setups.clear();
  EXPECT_NE(reason({"all"}).find("fur setup"), std::string::npos);
}

// As much hair as leaves the texture's share of a chunk's skin bare.
double ShellHairArea(const FurScene& scene, uint32_t chunk) {
  const FrameMemory& memory = scene.memory();
  const StrandBlock& block = *memory.Of<&Streams::strands>(chunk);
  uint32_t side = 0;
  const std::vector<uint8_t> texels = scene.FurTexture(scene.shape().chunk_layer[chunk], side);
  const auto bare = double(std::count(texels.begin(), texels.end(), uint8_t(0)));
  double area = 0.0;
  for (uint32_t t = 0; t < block.strand_count; ++t) {
    glm::dvec3 p[3];
    for (int k = 0; k < 3; ++k) {
      const auto [patch, lane] = FindVertex(memory, chunk, block.vertex[k][t]);
      const ShellVertex& vertex = memory.Of<&Streams::shell_vertices>(patch)->vertex[lane];
      for (int axis = 0; axis < 3; ++axis) p[k][axis] = double(vertex.position[axis]);
    }
    area += 0.5 * glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
  }
  return area * -std::log(bare / double(texels.size()));
}

TEST(Picture, IsLitByTheFrameWhereThatIsLit) {
  Drawn drawn(VertexOrder::kSorted);
  const FurScene& scene = drawn.running.scene();
  const FrameLight light(scene);
  for (uint32_t l = 0; l < scene.shape().layer_count; ++l) {
    const PictureLook& lit = light.OnLayer(l);
    if (!(scene.shape().layer_kind[l] & kLayerLit)) {
      EXPECT_EQ(lit.light.sky[0], light.OnActor(0).light.sky[0]);
      continue;
    }
    const auto& block = *scene.memory().Of<&Streams::layer_light>(l);
    EXPECT_EQ(lit.light.sky[3].y, block.harmonics[1][3]);
    EXPECT_EQ(lit.light.sun.x, 1.5f);
    EXPECT_EQ(lit.hair.rim_exponent, block.rim_exponent);
  }
  // Light that comes from no side, and none at all, is a studio's.
  Scenario dark = EveryOutputScenario();
  dark.base.lighting = {};
  EXPECT_EQ(FrameLight(Drawn(VertexOrder::kSorted, dark).running.scene()).OnActor(0).light.sun,
            DefaultLights().sun);
  EXPECT_EQ(FrameLight(Drawn(VertexOrder::kSorted, TinyScenario()).running.scene())
                .OnActor(0)
                .light.to_sun,
            DefaultLights().to_sun);
}

// Lights at places where some characters are out of reach; without a sun.
void LightBy(Scenario& scenario, const glm::vec3& at, const glm::vec3& colour, float range) {
  Lighting& in = scenario.base.lighting = {};
  in.light_count = 1;
  SphereLight& light = in.light[0];
  for (int k = 0; k < 3; ++k) {
    light.position[k] = at[k];
    light.rgb[k] = colour[k];
  }
  light.range = range;
}

PictureLook LookUnder(const Scenario& scenario) {
  return FrameLight(Drawn(VertexOrder::kSorted, scenario).running.scene()).OnActor(0);
}

TEST(Picture, TheRoomIsAsBrightAsTheLightThere) {
  Scenario scenario = EveryOutputScenario();
  scenario.base.lighting = {};
  EXPECT_EQ(LookUnder(scenario).room, glm::vec3(1.0f));
  LightBy(scenario, {0, 2.5f, 0}, {0.3f, 0.2f, 0.1f}, 0.0f);
  const glm::vec3 dim = LookUnder(scenario).room;
  EXPECT_LT(dim.x, 0.2f);
  EXPECT_GT(dim.z, 0.0f);
  EXPECT_GT(dim.x / dim.z, 2.0f);  // as red as the lamp
  LightBy(scenario, {0, 2.5f, 0}, {0.6f, 0.4f, 0.2f}, 0.0f);
  const glm::vec3 brighter = LookUnder(scenario).room;
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(brighter[k], 2.0f * dim[k], 1e-4f) << k;
  // The sun alone: 0.8 on the floor and 0.6 on one of four walls.
  scenario.base.lighting = {};
  const float direction[3] = {0.0f, 0.8f, 0.6f};
  for (int k = 0; k < 3; ++k) {
    scenario.base.lighting.sun_direction[k] = direction[k];
    scenario.base.lighting.sun_rgb[k] = 1.0f;
  }
  const glm::vec3 sun = LookUnder(scenario).room;
  scenario.base.lighting.sun_direction[1] = -0.8f;  // from below: that wall alone
  const glm::vec3 below = LookUnder(scenario).room;
  EXPECT_NEAR(sun.x / below.x, (0.8f + 0.15f) / 0.15f, 1e-3f);
}

// The mean of the picture's upper corners, where nothing stands.
double Backdrop(const Scenario& scenario) {
  const std::vector<std::byte> png = Drawn(VertexOrder::kSorted, scenario).Picture();
  const ControlMap image =
      ReadControlMap({reinterpret_cast<const uint8_t*>(png.data()), png.size()}, "picture");
  double sum = 0.0;
  for (size_t y = 0; y < 8; ++y)
    for (const size_t x : {size_t(0), size_t(image.width) - 1})
      for (size_t c = 0; c < 3; ++c) sum += image.rgba[(y * image.width + x) * 4 + c];
  return sum / (8 * 2 * 3);
}

TEST(Picture, DimLightsDarkenTheBackdrop) {
  Scenario scenario = EveryOutputScenario();
  scenario.base.lighting = {};
  const double studio = Backdrop(scenario);
  LightBy(scenario, {0, 2.5f, 0}, {0.3f, 0.3f, 0.3f}, 0.0f);
  EXPECT_LT(Backdrop(scenario), 0.5 * studio);
}

TEST(Picture, WhatNoLightReachesIsBlackBesideWhatIsLit) {
  Scenario scenario = EveryOutputScenario();
  scenario.actors.push_back(scenario.actors[0]);
  scenario.actors[1].placement[3] += glm::vec4(20.0f, 0.0f, 0.0f, 0.0f);
  LightBy(scenario, {0, 1, 2}, glm::vec3(1.0f), 5.0f);
  const Drawn drawn(VertexOrder::kSorted, scenario);
  const FrameLight light(drawn.running.scene());
  EXPECT_GT(light.OnActor(0).light.sky[0].x, 0.0f);
  EXPECT_EQ(light.OnActor(1).light.sky[0], glm::vec3(0.0f));
  EXPECT_EQ(light.OnActor(1).room, light.OnActor(0).room);
}

// Fewer strands in shadow maps, each as many times wider.
TEST(Picture, ShadowsOfAShareOfTheStrandsAreAsDense) {
  const auto covered = [](float share, uint32_t& casting) {
    Scenario scenario = TinyScenario();
    for (LayerParams* layer : LayersOf(scenario)) layer->shadow_share = share;
    Drawn drawn(VertexOrder::kSorted, scenario);
    double sum = 0.0;
    casting = 0;
    for (const std::vector<Hair>& hairs : ReadHairs(drawn.running.scene(), VertexOrder::kSorted))
      for (const Hair& hair : hairs) {
        casting += hair.shadow > 0.0f;
        sum += double(hair.shadow * hair.knot[0].width);
      }
    return sum;
  };
  uint32_t all = 0, some = 0;
  const double whole = covered(1.0f, all), part = covered(0.25f, some);
  EXPECT_NEAR(double(some) / all, 0.25, 0.05);
  EXPECT_NEAR(part / whole, 1.0, 0.1);
}

// On hair and on the skin below it, where the brush was and nowhere else.
TEST(Picture, PaintIsOnHairAndSkin) {
  Scenario scenario = EveryOutputScenario();
  scenario.base.brush_count = 1;
  scenario.base.brush[0] = {{0, 0.5f, 0}, 0.4f, 1.0f, uint32_t(PaintChannel::kMud), 1.0f};
  for (LayerParams* layer : LayersOf(scenario))
    layer->lit = layer->painted = layer->output != Output::kShells;
  Drawn drawn(VertexOrder::kSorted, scenario);
  const glm::vec3 centre(0, 0.5f, 0);
  uint32_t muddy = 0, clean = 0;
  for (const std::vector<Hair>& hairs : ReadHairs(drawn.running.scene(), VertexOrder::kSorted))
    for (const Hair& hair : hairs) {
      const bool is_in = glm::distance(hair.root, centre) < 0.4f;
      EXPECT_EQ(hair.paint, is_in ? glm::vec4(1, 0, 0, 0) : glm::vec4(0.0f));
      (is_in ? muddy : clean) += 1;
    }
  EXPECT_GT(muddy, 0u);
  EXPECT_GT(clean, 0u);
  const Body body = PoseBody(drawn.scenario, drawn.running.scene(), 0,
                             std::make_shared<const SurfaceColour>(scenario.characters[0]));
  float most = 0.0f;
  for (size_t v = 0; v < body.paint.size(); ++v) {
    // Strands stand within an edge's length of the vertices that they lean on.
    if (body.paint[v].x > 0.0f) {
      EXPECT_LT(glm::distance(body.position[v], centre), 0.8f);
    }
    most = std::max(most, body.paint[v].x);
  }
  EXPECT_NEAR(most, 1.0f, 1e-5f);
}

// Soaked, the skin below is as dark as the fur, painted or not.
TEST(Picture, WetSkinIsAsDarkAsWetFur) {
  for (const bool painted : {false, true}) {
    Scenario scenario = TinyScenario();
    scenario.weather_course = {1.0f, 0.0f, 0};
    float darken = 0.0f;
    for (LayerParams* layer : LayersOf(scenario)) {
      layer->lit = layer->painted = painted;
      darken = layer->wet_darken = 0.25f;
    }
    Drawn drawn(VertexOrder::kSorted, scenario, 40);
    const Mesh& mesh = scenario.characters[0].mesh;
    const SkinFur fur = FindSkinFur(drawn.running.scene(), 0, mesh);
    uint32_t wet = 0;
    for (size_t v = 0; v < fur.paint.size(); ++v) {
      if (fur.area[v] <= 0.0f) continue;
      EXPECT_NEAR(fur.paint[v].z, 1.0f - darken, 1e-3f) << painted;
      ++wet;
    }
    EXPECT_GT(wet, 0u);
  }
}

TEST(Picture, SkinHasTheAreaOfAllStrands) {
  Drawn drawn(VertexOrder::kSorted);
  const FurScene& scene = drawn.running.scene();
  const Mesh& mesh = drawn.scenario.characters[drawn.scenario.actors[0].character].mesh;
  const SkinFur fur = FindSkinFur(scene, 0, mesh);
  double strands = 0.0, skin = 0.0;
  const SceneShape& shape = scene.shape();
  for (uint32_t c = 0; c < shape.chunk_count; ++c) {
    if (shape.layer_character[shape.chunk_layer[c]] != 0) continue;
    const StrandBlock& block = *scene.memory().Of<&Streams::strands>(c);
    if (shape.layer_kind[shape.chunk_layer[c]] & kLayerShells) {
      strands += ShellHairArea(scene, c);
      continue;
    }
    for (uint32_t s = 0; s < block.strand_count; ++s) strands += block.length[s] * block.width[s];
  }
  std::set<std::array<float, 3>> counted;  // vertices at one place have one share
  for (size_t v = 0; v < mesh.position.size(); ++v)
    if (counted.insert({mesh.position[v].x, mesh.position[v].y, mesh.position[v].z}).second)
      skin += fur.area[v];
  ASSERT_GT(strands, 0.0);
  EXPECT_NEAR(skin / strands, 1.0, 1e-3);
}

TEST(Picture, FurCoversOnlyWhereItGrows) {
  Drawn drawn(VertexOrder::kSorted, LoadScenario("monster"));  // whose eyes are bare
  const Character& character = drawn.scenario.characters[drawn.scenario.actors[0].character];
  const Body body = PoseBody(drawn.scenario, drawn.running.scene(), 0,
                             std::make_shared<const SurfaceColour>(character));
  const SkinFur fur = FindSkinFur(drawn.running.scene(), 0, character.mesh);
  int bare = 0, covered = 0;
  for (size_t v = 0; v < body.covered.size(); ++v) {
    ASSERT_EQ(body.covered[v] > 0.0f, fur.area[v] > 0.0f) << v;
    ASSERT_LE(body.covered[v], 1.0f);
    (body.covered[v] > 0.0f ? covered : bare) += 1;
  }
  EXPECT_GT(bare, 0);
  EXPECT_GT(covered, 0);
  EXPECT_GT(body.mean_covered, 0.0f);
  EXPECT_GT(DepthFloor(0.0f), DepthFloor(body.mean_covered));
  for (size_t m = 0; m < character.mesh.materials.size(); ++m)
    EXPECT_FALSE(character.mesh.materials[m] == "eye" && body.furry_material[m]);
}

}  // namespace
}  // namespace pelt::testing
