// The pieces of work behind the Cell's DMA and bus rows.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "platform_sim/memory/spu_program.hpp"

namespace pelt::testing {

inline SpuRun MustRun(const CellMemoryParameters& p, std::vector<SpuProgram::NextStep> programs) {
  SpuRun run;
  std::string error;
  EXPECT_TRUE(RunSpus(p, std::move(programs), run, error)) << error;
  return run;
}

// Every SPU moves `bytes_each` in blocks, `in_flight` at one time.
inline SpuRun Stream(const CellMemoryParameters& p, uint32_t spus, uint32_t block_bytes,
                     uint32_t in_flight, bool get = true, bool put = false,
                     uint32_t bytes_each = 1 << 20, DmaFar far = DmaFar::kMemory) {
  std::vector<SpuProgram::NextStep> programs;
  for (uint32_t s = 0; s < spus; ++s) {
    StreamWork work;
    work.far = far;
    work.get_address = uint64_t(s) << 24;
    work.put_address = (uint64_t(s) << 24) + (1 << 23);
    work.block_bytes = block_bytes;
    work.block_count = bytes_each / block_bytes;
    work.buffers = in_flight;
    work.get = get;
    work.put = put;
    programs.push_back(DoubleBuffer(work));
  }
  return MustRun(p, std::move(programs));
}

// SPU s reads the local store of reads[s]; -1: it does nothing.
inline SpuRun ReadLocalStores(const CellMemoryParameters& p, const std::vector<int>& reads,
                              uint32_t blocks = 32) {
  std::vector<SpuProgram::NextStep> programs;
  for (const int far : reads) {
    StreamWork work;
    work.far = DmaFar::kLocalStore;
    work.far_spu = far < 0 ? 0 : uint32_t(far);
    work.block_count = far < 0 ? 0 : blocks;
    work.window_bytes = 128 * 1024;
    work.buffers = 8;
    programs.push_back(DoubleBuffer(work));
  }
  return MustRun(p, std::move(programs));
}

// As hardware would show it: with the share of the time that the console takes away.
inline double Measured(const CellMemoryParameters& p, const SpuRun& run) {
  return run.GigabytesPerSecond(p) * p.availability_permille / 1000.0;
}

struct MeanAndRange {
  double mean = 0.0, least = 1e9, most = 0.0;
};

// Three pairs both ways, over every console: which two of the eight SPEs it lacks is not known.
inline MeanAndRange PairsOverConsoles(CellMemoryParameters p) {
  MeanAndRange rate;
  int consoles = 0;
  for (uint32_t a = 0; a < 8; ++a)
    for (uint32_t b = a + 1; b < 8; ++b, ++consoles) {
      p.missing_spe[0] = a;
      p.missing_spe[1] = b;
      const double rate_here = Measured(p, ReadLocalStores(p, {1, 0, 3, 2, 5, 4}));
      rate.mean += rate_here;
      rate.least = std::min(rate.least, rate_here);
      rate.most = std::max(rate.most, rate_here);
    }
  rate.mean /= consoles;
  return rate;
}

}  // namespace pelt::testing
