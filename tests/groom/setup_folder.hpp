// What tests of setups begin with: a folder of maps, and what is read of a text beside them.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "core/groom/fur_setup.hpp"
#include "tests/error_from.hpp"
#include "tests/groom/png.hpp"

namespace pelt::test {

// A folder with one map, `m.png`: 2 x 1, red 10 and 200.
class SetupFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              ("pelt_fur_setup_" + std::to_string(reinterpret_cast<uintptr_t>(this)) + "_" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_ / "maps");
    const auto png = MakePng(2, 1, 4, {10, 20, 30, 40, 200, 210, 220, 230});
    Save("maps/m.png", std::string(png.begin(), png.end()));
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  void Save(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  FurSetup Read(const std::string& text) {
    return ReadFurSetup(text, "fur.toml", folder_.string());
  }
  // The message, or "" when the text is read.
  std::string ErrorOf(const std::string& text) {
    return ErrorFrom([&] { Read(text); });
  }
  // One layer 'head' whose keys begin on line 3.
  std::string LayerError(const std::string& lines) {
    return ErrorOf("[[layer]]\nname = 'head'\n" + lines);
  }
  std::filesystem::path folder_;
};

}  // namespace pelt::test
