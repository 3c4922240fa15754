// jobs/pelt.h where C++ can look at it: what is refused out of turn, and bits.
// (tests/porting/outside/c_program.c is the engine in C.)
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <tuple>

#include "core/kernels/wind.hpp"
#include "tests/jobs/c_scene.hpp"

namespace pelt::testing {
namespace {

OwnScene MakeScene(const PeltSceneOptions& options = {}) { return MakeCScene(&options); }

std::string Text(const char* text) { return text ? text : ""; }

PeltFrame FrameOf(uint32_t frame) {
  PeltFrame input;
  pelt_default_frame(&input);
  input.time_s = frame / 60.0;
  input.wind_velocity[0] = 2.0f;
  return input;
}

void SetPose(PeltScene* scene, uint32_t frame) {
  const float x = 0.01f * float(frame);
  const float root[12] = {1, 0, 0, x, 0, 1, 0, 0, 0, 0, 1, 0};
  ASSERT_EQ(Text(pelt_place(scene, 0, root, 0)), "");
}

uint64_t PlaceAndRun(PeltScene* scene, uint32_t frame) {
  SetPose(scene, frame);
  const PeltFrame input = FrameOf(frame);
  EXPECT_EQ(Text(pelt_begin(scene, &input)), "");
  EXPECT_EQ(Text(pelt_run(scene, nullptr)), "");
  return pelt_digest(scene);
}

TEST(CInterface, ABudgetNeedsCostsAndIsKeptTo) {
  const auto digest_within = [](uint32_t us) {
    const OwnScene scene = MakeScene();
    for (uint32_t f = 0; f < 3; ++f) {
      PeltFrame input = FrameOf(f);
      input.skip |= PELT_LOD;
      input.budget_us = us;
      if (us > 0 && f == 0) {
        const std::string fault = Text(pelt_begin(scene.get(), &input));
        EXPECT_NE(fault.find("budget_us is given without costs"), std::string::npos) << fault;
      }
      input.strand_ns = input.node_ns[3] = 20.0f;
      SetPose(scene.get(), f);
      EXPECT_EQ(Text(pelt_begin(scene.get(), &input)), "");
      EXPECT_EQ(Text(pelt_run(scene.get(), nullptr)), "");
    }
    return pelt_digest(scene.get());
  };
  EXPECT_EQ(digest_within(1'000'000), digest_within(0));
  EXPECT_NE(digest_within(1), digest_within(0));
}

TEST(CInterface, AForceVolumePushesWhatItHolds) {
  PeltForce force{{0, 1, 0}, {2, 2, 2}, PELT_FORCE_BALL, PELT_FORCE_PULL, {0, 1, 0}, 5,
                  0,         0,         PELT_FREE};
  const auto digest_with = [&force](uint32_t count) {
    const OwnScene scene = MakeScene();
    for (uint32_t f = 0; f < 3; ++f) {
      PeltFrame input = FrameOf(f);
      input.forces = &force;
      input.force_count = count;
      EXPECT_EQ(Text(pelt_begin(scene.get(), &input)), "");
      EXPECT_EQ(Text(pelt_run(scene.get(), nullptr)), "");
    }
    return pelt_digest(scene.get());
  };
  EXPECT_NE(digest_with(1), digest_with(0));
  force.centre[0] = 100.0f;
  EXPECT_EQ(digest_with(1), digest_with(0));
}

TEST(CInterface, ThePublishedWindIsThatOfTheFrame) {
  PeltFrame frame = FrameOf(100);
  frame.turbulence = 1.5f;
  const double origin[3] = {3.0, 0.0, -1.25};
  PeltWindWaves waves;
  pelt_wind_waves(&frame, origin, &waves);
  EXPECT_EQ(waves.mean[0] + waves.along_x[0], 0.0f) << "gusts";
  frame.wind_kind = PELT_PUBLISHED_WIND;
  pelt_wind_waves(&frame, origin, &waves);
  const WindSetup setup{.velocity = {2.0f}, .turbulence = 1.5f, .kind = PELT_PUBLISHED_WIND};
  const WindParams wind = MakeWindParams(setup, frame.time_s, origin);
  EXPECT_EQ(std::memcmp(waves.mean, wind.direction_speed, sizeof waves.mean), 0);
  EXPECT_EQ(std::memcmp(waves.along_x, &wind.sine[0], sizeof waves.along_x), 0);
  EXPECT_EQ(std::memcmp(waves.along_z, &wind.sine[1], sizeof waves.along_z), 0);
}

// Everything that writes what a frame reads, called while one is begun, and from its door.
struct Intruder {
  PeltScene* scene;
  const char* reason;
  uint32_t calls = 0;

  void TryAll() {
    const PeltJoint joint{{0.3f, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}};
    const PeltJointVelocity velocity{};
    const float root[12] = {2, 0, 0, 9, 0, 2, 0, 0, 0, 0, 2, 0};
    const double origin[3] = {1.0, 2.0, 3.0};
    const PeltFrame input = FrameOf(7);
    std::vector<std::byte> bytes(pelt_snapshot_bytes(scene));
    const PeltDoor other{[](PeltTask task, void* context, void*, const char*) -> void* {
                           task(context);
                           return nullptr;
                         },
                         [](void*, void*) {}, this, 3};
    for (const char* text :
         {pelt_set_joint(scene, 0, 0, &joint), pelt_place(scene, 0, root, 1),
          pelt_set_joint_velocity(scene, 0, 0, &velocity), pelt_place_velocity(scene, 0, root),
          pelt_set_origin(scene, 0, origin), pelt_begin(scene, &input),
          pelt_snapshot(scene, bytes.data(), bytes.size()),
          pelt_restore(scene, bytes.data(), bytes.size())})
      EXPECT_NE(Text(text).find(reason), std::string::npos) << Text(text);
    if (calls++ == 0) return;  // begun, and not run
    EXPECT_NE(Text(pelt_run(scene, &other)).find("running already"), std::string::npos);
  }
};

TEST(CInterface, NothingThatAFrameReadsIsSetWhileItRuns) {
  PeltSceneOptions options{};
  options.velocities = options.origins = 1;
  const OwnScene straight = MakeScene(options), disturbed = MakeScene(options);
  ASSERT_TRUE(straight && disturbed);
  for (uint32_t f = 0; f < 3; ++f) {
    const uint64_t truth = PlaceAndRun(straight.get(), f);
    SetPose(disturbed.get(), f);
    const PeltFrame input = FrameOf(f);
    ASSERT_EQ(Text(pelt_begin(disturbed.get(), &input)), "");
    Intruder intruder{disturbed.get(), "begun and was not run"};
    intruder.TryAll();
    intruder.reason = "is running";
    const PeltDoor door{[](PeltTask task, void* context, void* user, const char*) -> void* {
                          static_cast<Intruder*>(user)->TryAll();
                          task(context);
                          return user;
                        },
                        [](void*, void* user) { static_cast<Intruder*>(user)->TryAll(); },
                        &intruder, 2};
    ASSERT_EQ(Text(pelt_run(disturbed.get(), &door)), "");
    EXPECT_GT(intruder.calls, 2u);
    EXPECT_EQ(Text(pelt_door_faults(disturbed.get())), "");
    EXPECT_EQ(pelt_digest(disturbed.get()), truth) << "frame " << f;
  }
}

TEST(CInterface, LayersAndStrandsAreSwitchedFrameByFrame) {
  PeltSceneOptions options{};
  options.strand_writes = 1;
  const OwnScene owner = MakeScene(options);
  PeltScene* const scene = owner.get();
  const uint32_t layers = pelt_layer_count(scene), places = pelt_strand_places(scene, 0);
  EXPECT_GE(places, pelt_strand_count(scene, 0));
  EXPECT_EQ(pelt_strand_places(scene, layers), 0u);
  EXPECT_EQ(pelt_layer_character(scene, layers - 1), 0u);
  EXPECT_EQ(pelt_layer_character(scene, layers), UINT32_MAX);
  std::vector<float> importance(layers, 1.0f);
  importance[1] = 0.0f;
  uint32_t all_places = 0;
  for (uint32_t l = 0; l < layers; ++l) all_places += pelt_strand_places(scene, l);
  std::vector<uint8_t> cut(all_places, 0);
  std::fill_n(cut.begin(), places, uint8_t{1});
  const PeltStrandWrite write{2, 0, 0xff112233, 0xff445566, 0.002f, 5};
  const auto drawn = [scene](const PeltFrame& input) {
    EXPECT_EQ(Text(pelt_begin(scene, &input)), "");
    EXPECT_EQ(Text(pelt_run(scene, nullptr)), "");
    return pelt_draws(scene, nullptr, 0);
  };
  const uint32_t all = drawn(FrameOf(0));
  PeltFrame input = FrameOf(1);
  input.importance = importance.data();
  input.cut = cut.data();
  input.strand_write_count = 1;
  EXPECT_EQ(Text(pelt_begin(scene, &input)), "the strand writes are null");
  input.strand_writes = &write;
  EXPECT_EQ(drawn(input) + 2, all) << "the one cut off, the other off";
  PeltStrandCurve curve{};
  ASSERT_EQ(pelt_copy_curves(scene, 2, &curve, 1), 1u);
  EXPECT_EQ(curve.base_colour, write.base_colour);
  EXPECT_EQ(curve.film_strip, 5u);
  EXPECT_EQ(pelt_copy_curves(scene, 0, &curve, 1), 0u);
  EXPECT_GT(pelt_shadow_places(scene, 2, nullptr, 0), 0u);
  EXPECT_EQ(pelt_shadow_places(nullptr, 2, nullptr, 0), 0u);
  EXPECT_EQ(drawn(FrameOf(2)), all);
}

// Of two grooms that share their first byte each is read as far as it goes.
TEST(CInterface, GroomsThatSharePointersAreReadByTheirOwnSizes) {
  const PeltBytes whole{TinyGroom().data(), TinyGroom().size()};
  const PeltBytes cut{TinyGroom().data(), TinyGroom().size() / 2};
  char why[200] = "";
  for (const auto& pair : {std::array{whole, cut}, std::array{cut, whole}}) {
    EXPECT_FALSE(OwnScene(pelt_create(pair.data(), 2, nullptr, why, sizeof why)));
    EXPECT_NE(std::string(why).find("cut or extended"), std::string::npos) << why;
  }
  const std::array<PeltBytes, 2> same{whole, whole};
  EXPECT_TRUE(OwnScene(pelt_create(same.data(), 2, nullptr, why, sizeof why))) << why;
}

TEST(CInterface, HasTheTexturesOfStrands) {
  Groom groom = TinyScenario().grooms[0];
  StrandTexture made{.width = 4, .height = 1, .strips = 2, .rgba = {}};
  for (uint8_t i = 0; i < 16; ++i) made.rgba.push_back(uint8_t(10 * i));
  groom.layers[1].params.lit = groom.layers[1].params.painted = true;
  made.channels = StrandChannels::kWeather;
  groom.layers[1].strand_texture = std::make_shared<const StrandTexture>(made);
  const std::vector<std::byte> file = WriteGroom(groom).OrThrow();
  const PeltBytes bytes{file.data(), file.size()};
  const OwnScene scene(pelt_create(&bytes, 1, nullptr, nullptr, 0));
  ASSERT_TRUE(scene);
  PeltStrandTexture texture{};
  EXPECT_EQ(pelt_strand_texture(scene.get(), 0, &texture), 0);
  EXPECT_EQ(pelt_strand_texture(scene.get(), 1, nullptr), 0);
  EXPECT_EQ(pelt_strand_texture(scene.get(), pelt_layer_count(scene.get()), &texture), 0);
  ASSERT_EQ(pelt_strand_texture(scene.get(), 1, &texture), 1);
  EXPECT_EQ(std::tuple(texture.width, texture.height, texture.strips, texture.channels),
            std::tuple(4u, 1u, 2u, uint32_t(PELT_STRAND_WEATHER)));
  EXPECT_TRUE(std::equal(made.rgba.begin(), made.rgba.end(), texture.rgba));
}

TEST(CInterface, GoesBackToASnapshot) {
  const OwnScene straight = MakeScene(), other = MakeScene();
  std::vector<uint64_t> truth;
  std::vector<std::byte> bytes(pelt_snapshot_bytes(straight.get()));
  for (uint32_t f = 0; f < 9; ++f) {
    if (f == 4) {
      ASSERT_EQ(Text(pelt_snapshot(straight.get(), bytes.data(), bytes.size())), "");
    }
    truth.push_back(PlaceAndRun(straight.get(), f));
  }
  for (PeltScene* scene : {straight.get(), other.get()}) {
    ASSERT_EQ(Text(pelt_restore(scene, bytes.data(), bytes.size())), "");
    EXPECT_EQ(pelt_draws(scene, nullptr, 0), 0u);
    for (uint32_t f = 4; f < 9; ++f) EXPECT_EQ(PlaceAndRun(scene, f), truth[f]) << "frame " << f;
    EXPECT_GT(pelt_draws(scene, nullptr, 0), 0u);
  }
  EXPECT_NE(Text(pelt_snapshot(straight.get(), bytes.data(), bytes.size() - 1)), "");
  EXPECT_NE(Text(pelt_restore(straight.get(), bytes.data(), bytes.size() - 1)), "");
  EXPECT_NE(Text(pelt_snapshot(straight.get(), nullptr, 0)), "");
  EXPECT_NE(Text(pelt_restore(straight.get(), nullptr, 0)), "");
  EXPECT_NE(Text(pelt_restore(nullptr, bytes.data(), bytes.size())), "");
  EXPECT_EQ(pelt_snapshot_bytes(nullptr), 0u);
}

}  // namespace
}  // namespace pelt::testing
