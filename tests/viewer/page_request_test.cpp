#include "bench/viewer/page_request.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"

namespace pelt {
namespace {

TEST(PageRequest, ComesBackAsItWas) {
  ScenarioRequest request;
  request.character = "a \"quoted\" name.glb";
  request.setup = "fur\\wild.toml";
  request.lights = "overcast";
  request.clip = "walk";
  request.once = true;
  request.seed = 18446744073709551615ull;
  request.solver = Solver::kVerlet;
  request.quality = ModalQuality::kBest;
  const ScenarioRequest read = ReadRequest(WriteRequest(request));
  EXPECT_EQ(read.character, request.character);
  EXPECT_EQ(read.setup, request.setup);
  EXPECT_EQ(read.lights, request.lights);
  EXPECT_EQ(read.clip, request.clip);
  EXPECT_TRUE(read.once);
  EXPECT_EQ(read.seed, request.seed);
  EXPECT_EQ(read.solver, request.solver);
  EXPECT_EQ(read.quality, request.quality);
}

TEST(PageRequest, ASceneHasNoCharacterOfItsOwn) {
  EXPECT_EQ(WriteRequest({.scene = "tiny"}), "scene = \"tiny\"\n");
}

TEST(PageRequest, RefusesWhatItDoesNotKnow) {
  EXPECT_THROW((void)ReadRequest("sceen = \"tiny\""), Error);
  EXPECT_THROW((void)ReadRequest("solver = \"quick\""), Error);
  EXPECT_THROW((void)ReadRequest("scene ="), Error);
}

}  // namespace
}  // namespace pelt
