// What tests of setups begin with: a folder of maps, and what is read of a text beside them.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "core/groom/fur_setup.hpp"
#include "tests/error_from.hpp"
#include "tests/groom/png.hpp"
#include "tests/test_folder.hpp"

namespace pelt::test {

// A folder with one map, `m.png`: 2 x 1, red 10 and 200.
class SetupFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.Save("maps/m.png", MakePng(2, 1, 4, {10, 20, 30, 40, 200, 210, 220, 230}));
  }
  FurSetup Read(const std::string& text) {
    return ReadFurSetup(text, "fur.toml", folder_.path().string());
  }
  // The message, or "" when the text is read.
  std::string ErrorOf(const std::string& text) {
    return ErrorFrom([&] { Read(text); });
  }
  // One layer 'head' whose keys begin on line 3.
  std::string LayerError(const std::string& lines) {
    return ErrorOf("[[layer]]\nname = 'head'\n" + lines);
  }
  const TestFolder folder_;
};

}  // namespace pelt::test
