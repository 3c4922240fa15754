// The rows' pieces of work on the Cell's memory, for tests that hold them to properties.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "platform_sim/rows/row_work.hpp"

namespace pelt::testing {

inline SpuRun MustRun(const CellMemoryParameters& p, std::vector<SpuProgram::NextStep> programs) {
  SpuRun run;
  std::string error;
  EXPECT_TRUE(RunSpus(p, std::move(programs), run, error)) << error;
  return run;
}

inline SpuRun MoveBlocks(const CellMemoryParameters& p, const StreamOfBlocks& stream) {
  std::string error;
  const auto run = RunStream(p, stream, error);
  EXPECT_TRUE(run) << error;
  return run.value_or(SpuRun{});
}

inline SpuRun ReadLocalStores(const CellMemoryParameters& p, const std::vector<int>& reads) {
  std::string error;
  const auto run = RunLocalStoreReads(p, reads, 8, error);
  EXPECT_TRUE(run) << error;
  return run.value_or(SpuRun{});
}

}  // namespace pelt::testing
