// A command with a folder of its own, and what it said.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "core/error.hpp"
#include "tests/test_folder.hpp"

namespace pelt::test {

class CommandFixture : public ::testing::Test {
 protected:
  // Its exit code, -1 for an error.
  template <class Command>
  int Catch(const Command& command) {
    ::testing::internal::CaptureStdout();
    int code = -1;
    std::string error;
    try {
      code = command();
    } catch (const Error& e) {
      error = e.what();
    }
    out_ = ::testing::internal::GetCapturedStdout() + error;
    return code;
  }
  bool Said(const std::string& words) const { return out_.find(words) != std::string::npos; }
  std::string Path(const std::string& name) const { return folder_ / name; }

  std::string out_;
  const TestFolder folder_;
};

}  // namespace pelt::test
