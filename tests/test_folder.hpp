// Files of the running test.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/file_bytes.hpp"

namespace pelt::test {

inline std::string ReadText(const std::string& path) {
  return std::string(AsText(ReadFileBytes("file", path).OrThrow()));
}

inline std::string TestPath(const std::string& ending) {
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  std::string name = std::string("pelt_") + test->test_suite_name() + "_" + test->name() + ending;
  std::ranges::replace(name, '/', '_');
  return ::testing::TempDir() + name;
}

// A file of this text; it stays.
inline std::string TestFile(const std::string& text, const std::string& ending = ".toml") {
  const std::string path = TestPath(ending);
  WriteFileBytes("test", path, AsBytes(text)).OrThrow();
  return path;
}

// An empty folder, removed with all that is in it.
class TestFolder {
 public:
  TestFolder() { std::filesystem::create_directories(path_); }
  ~TestFolder() { std::filesystem::remove_all(path_); }
  TestFolder(const TestFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  // Folders in the name are made; returns the path.
  std::string Save(const std::string& name, std::span<const std::byte> bytes) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    WriteFileBytes("test", *this / name, bytes).OrThrow();
    return *this / name;
  }
  std::string Save(const std::string& name, std::string_view text) const {
    return Save(name, AsBytes(text));
  }
  std::string Save(const std::string& name, const std::vector<uint8_t>& bytes) const {
    return Save(name, std::as_bytes(std::span(bytes)));
  }

 private:
  const std::filesystem::path path_ = TestPath("_" + std::to_string(std::random_device()()));
};

}  // namespace pelt::test
