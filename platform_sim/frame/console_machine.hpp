// A console as a frame sees it: units, what they share, what handing out work costs.
//
// A plain struct, so that a question such as "what if memory were free" is another struct. Memory's
// numbers are measured when the machine is made, by short streams on the line-level models; the
// rest comes from platforms/.
#pragma once

#include <cstdint>
#include <string>

#include "core/error.hpp"
#include "platform_sim/frame/shared_transfers.hpp"
#include "platform_sim/platforms/cell.hpp"
#include "platform_sim/platforms/dispatch.hpp"
#include "platform_sim/platforms/spu.hpp"
#include "platform_sim/platforms/xenon.hpp"

namespace pelt {

struct ConsoleMachine {
  std::string name;  // "PS3"
  uint64_t clock_hz = 0;
  uint32_t units = 0;             // SPUs, or hardware threads
  uint32_t threads_per_core = 1;  // neighbouring units that share a core
  // Of what the models say: what measured kernels and streams reach. No model applies it, and the
  // times of a frame and of its parts are without it. A verdict takes the frame's time with it, the
  // same on every console: what a budget must hold is the slower of the two, and a console that
  // was never measured must not win by that.
  double availability = 1.0;
  std::string availability_from = {};
  double Available(double ms) const { return ms / availability; }
  bool compute_is_free = false;  // computing takes no time: a question, not a machine
  // Where the code lies in the range of its price: 0 the best schedule, 1 the order it was written
  // in. What a compiler reached: kernel_rows.hpp.
  double code_order = 0.0;

  SharedMemory memory;
  Cycles command_cycles = 0;            // of the unit, for a command (a list is one)
  Cycles wait_cycles = 0;               // of the unit, to ask whether a transfer is through
  uint32_t largest_transfer_bytes = 0;  // of a list element
  uint32_t line_bytes = 128;

  // Local stores; or, where it is 0, caches.
  uint32_t local_store_bytes = 0;
  SpuRuntimeParameters runtime;
  uint32_t l2_bytes = 0;

  // Drawing the next item: the counter's line is with one unit at a time. With a dispatcher (the
  // PPE), which takes items one after another, each for `dispatcher_cycles`, beside the units.
  Cycles draw_cycles = 0;
  Cycles dispatcher_cycles = 0;
  Cycles barrier_cycles = 0;  // from an item's end until units that wait for it see that

  double Milliseconds(double cycles) const { return cycles * 1e3 / double(clock_hz); }
};

// A retail PS3's SPUs; a platform that cannot be is refused.
Result<ConsoleMachine> MakeCell(const CellMemoryParameters& p, const DispatchParameters& dispatch);
// An Xbox 360's hardware threads.
Result<ConsoleMachine> MakeXenon(const XenonParameters& p);

}  // namespace pelt
