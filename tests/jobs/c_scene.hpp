// The scene `tiny` by the C interface.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <memory>
#include <vector>

#include "core/groom/groom_file.hpp"
#include "jobs/pelt.h"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {

struct DestroyScene {
  void operator()(PeltScene* scene) const { pelt_destroy(scene); }
};
using OwnScene = std::unique_ptr<PeltScene, DestroyScene>;

inline const std::vector<std::byte>& TinyGroom() {
  static const std::vector<std::byte> kBytes = WriteGroom(TinyScenario().grooms[0]).OrThrow();
  return kBytes;
}

inline OwnScene MakeCScene(const PeltSceneOptions* options) {
  const PeltBytes groom{TinyGroom().data(), TinyGroom().size()};
  char why[200] = "";
  OwnScene scene(pelt_create(&groom, 1, options, why, sizeof why));
  EXPECT_TRUE(scene) << why;
  return scene;
}

}  // namespace pelt::testing
