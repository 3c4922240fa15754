#include "platform_sim/platforms/ppe.hpp"

#include "core/format.hpp"

namespace pelt {

std::vector<PlatformNumber> DescribeNumbers(const PpeParameters& ppe) {
  std::vector<PlatformNumber> out;
  for (const PpeClassParameters& c : ppe.classes)
    out.push_back({Format("{} latency{}", c.name, c.blocks_units ? ", not pipelined" : ""),
                   double(c.latency_cycles), "cycles", c.source, c.sure});
  const auto add = [&](const char* name, double value, const char* unit, const char* source,
                       Sureness sure = Sureness::kPublished) {
    out.push_back({name, value, unit, source, sure});
  };
  add("load to a dependent address", ppe.load_to_address_cycles, "cycles",
      "PPE User's Manual as quoted by cellmark: 4 to 6, chained loads at the upper end",
      Sureness::kSecondHand);
  add("integer to a dependent address", ppe.integer_to_address_cycles, "cycles", "GCC");
  add("FP compare to branch", ppe.float_compare_to_branch_cycles, "cycles", "GCC");
  add("mtctr to bctr", ppe.count_to_register_branch_cycles, "cycles", "GCC");
  add("load-hit-store, at most", ppe.load_hit_store_cycles, "cycles", "MS");
  add("dispatch", ppe.dispatch_width, "instructions a cycle", "GCC");
  add("mispredicted branch", ppe.mispredict_cycles, "cycles", "widely repeated", Sureness::kLead);
  add("hardware threads", ppe.smt_threads, "threads", "GCC");
  add("general registers", ppe.general_register_count, "registers", "architecture");
  add("FP registers", ppe.float_register_count, "registers", "architecture");
  add("vector registers", ppe.vector_register_count, "registers", "architecture");
  return out;
}

}  // namespace pelt
