#include "platform_sim/platforms/cell_memory.hpp"

#include "core/format.hpp"

namespace pelt {
namespace {

constexpr std::string_view kSdk = "IBM SDK 3.0 tutorial";
constexpr std::string_view kKistler =
    "Kistler, Perrone, Petrini, IEEE Micro 2006: 290 cycles in all";
constexpr std::string_view kRings = "D. Krolak (IBM), interview, as quoted";
constexpr std::string_view kChen = "Chen et al., IBM J. R&D 51 (2007): 24.6 GB/s, mixed 21 GB/s";

}  // namespace

std::vector<PlatformNumber> DescribeCellMemory(const CellMemoryParameters& p) {
  using enum Sureness;
  return {
      {"code of the loop over items", double(p.runtime.code_bytes), "B", "the model's", kLead},
      {"stack", double(p.runtime.stack_bytes), "B", "the model's", kLead},
      {"largest DMA command", double(p.largest_command_bytes), "B", kSdk, kPublished},
      {"DMA queue", double(p.queue_commands), "commands", kSdk, kPublished},
      {"DMA list", double(p.list_elements), "elements", "CBE handbook, as quoted", kSecondHand},
      {"tags", double(p.tags), "tags", kSdk, kPublished},
      {"channel operations of a command", double(p.channels_per_command), "operations", kSdk,
       kPublished},
      {"channel operations of a wait", double(p.channels_per_wait), "operations", kSdk, kPublished},
      {"MFC takes up a command", double(p.command_cycles), "cycles", kKistler, kLead},
      {"MFC fetches a list element", double(p.list_element_cycles), "cycles", kKistler, kLead},
      {"lines an MFC has in flight", double(p.lines_in_flight), "lines", "CBE handbook", kLead},
      {"bus cycle", double(p.bus_cycle_cycles), "cycles", "half clock, as quoted", kSecondHand},
      {"rings", double(p.rings), "rings", "as quoted", kSecondHand},
      {"ring width", double(p.ring_bytes), "B/bus cycle", "as quoted", kSecondHand},
      {"transfers on a ring", double(p.transfers_per_ring), "transfers", "as quoted", kSecondHand},
      {"starts on a ring, apart", double(p.ring_start_bus_cycles), "bus cycles", kRings,
       kSecondHand},
      {"snoop", double(p.snoop_cycles), "cycles", kKistler, kLead},
      {"local store of another SPE", double(p.local_store_cycles), "cycles", kKistler, kLead},
      {"memory, a line", double(p.memory_line_cycles), "cycles", "25.6 GB/s, cellmark", kPublished},
      {"memory access", double(p.memory_access_cycles), "cycles", "round trip about 180 ns", kLead},
      {"refresh and scrub every", double(p.refresh_interval_cycles), "cycles",
       "the model's; only the share counts", kLead},
      {"refresh and scrub take", double(p.refresh_cycles), "cycles", kChen, kLead},
      {"memory turns its direction in", double(p.turnaround_cycles), "cycles", kChen, kLead},
      {"lines one way before it turns", double(p.turnaround_lines), "lines", kChen, kLead},
      {"L2, a line for an SPE", double(p.l2_line_cycles), "cycles",
       "7 GB/s in all, Perrone, MIT 6.189, 2007", kPublished},
      {"operating-system call", double(p.os_call_ns), "ns",
       "cellmark: half the mailbox round trip S2, not a prediction", kPublished},
  };
}

bool CheckCellMemory(const CellMemoryParameters& p, std::string& error) {
  const auto refuse = [&](std::string why) {
    error = "Cell platform refused: " + why;
    return false;
  };
  if (!CheckCellSystem(p, error)) return false;
  for (const PlatformNumber& n : DescribeCellMemory(p))
    if (n.value <= 0.0) return refuse(Format("'{}' is zero; it must be positive", n.name));
  if (p.local_store_bytes % p.largest_command_bytes != 0)
    return refuse(
        Format("a local store of {} bytes is not a multiple of the largest DMA "
               "command, {} bytes",
               p.local_store_bytes, p.largest_command_bytes));
  if (p.missing_spe[0] == p.missing_spe[1] || p.missing_spe[0] > 7 || p.missing_spe[1] > 7)
    return refuse("missing_spe must name two of the SPEs 0 to 7");
  if (p.first_spu > 5) return refuse("first_spu must be 0 to 5");
  if (p.rings < 2 || p.rings % 2 != 0 || p.rings > 4)
    return refuse(Format("{} EIB rings; it needs 2 or 4, half of them each way", p.rings));
  if (p.line_bytes % p.ring_bytes != 0 || (p.line_bytes & (p.line_bytes - 1)) != 0)
    return refuse(
        Format("lines of {} bytes; they must be a power of two and whole beats of "
               "{} bytes",
               p.line_bytes, p.ring_bytes));
  if (p.largest_command_bytes % 16 != 0 || p.tags > 32 || p.transfers_per_ring > 3)
    return refuse("commands are multiples of 16 bytes, at most 32 tags, 3 transfers a ring");
  if (p.refresh_cycles >= p.refresh_interval_cycles)
    return refuse("memory refresh takes all the memory's time");
  return true;
}

}  // namespace pelt
