// What one item of a pass asks of a console, whichever unit takes it and whenever: known from
// running it, and enough to time the frame again under other numbers.
#pragma once

#include <cstdint>
#include <vector>

#include "core/stream_table.hpp"
#include "jobs/frame_graph.hpp"
#include "platform_sim/frame/shared_transfers.hpp"

namespace pelt {

struct ItemWork {
  struct CodeTime {
    double cycles;         // with the core to itself
    double shared_cycles;  // while the core's other thread computes too
  };
  struct StageTime {
    uint32_t stage;
    CodeTime as_written, scheduled;  // the ends of its price
  };
  struct StreamBytes {
    Stream stream;
    uint64_t get_bytes, put_bytes;
  };
  std::vector<StageTime> stages;     // that ran, in order
  std::vector<StreamBytes> streams;  // to and from main memory
  TransferShape get, put;

  void Clear() {
    stages.clear();
    streams.clear();
    get = put = {};
  }
};

struct PassWork {
  uint32_t pass = 0;
  bool double_buffered = true;
  uint64_t code_bytes = 0;  // that a unit must have to run it
  uint64_t parameter_bytes = 0;
  std::vector<ItemWork> items;
  std::vector<uint32_t> rank;  // of open items the least is taken first; empty: the item itself
};

// All that the timing of a frame depends on, beside the machine.
struct FrameWork {
  uint32_t stage_count = 0, stream_count = 0;
  std::vector<PassWork> passes;
  FrameGraph graph;
};

}  // namespace pelt
