#include "platform_sim/schedule/scheduling_core.hpp"

#include <algorithm>

#include "platform_sim/pipeline/instruction_set.hpp"
#include "platform_sim/pipeline/ppe_core.hpp"
#include "platform_sim/pipeline/spu_core.hpp"

namespace pelt {
namespace {

constexpr uint8_t kEven = 1, kOdd = 2;
uint32_t Usable(uint32_t registers, uint32_t reserved) {
  return std::min(registers - std::min(reserved, registers), kMostSchedulingRegisters);
}

constexpr uint32_t kConditionFields = 8;  // PowerPC architecture

SchedulingCore::Class ClassOf(const SpuClassParameters& op, bool is_branch) {
  SchedulingCore::Class out;
  out.units = op.pipe == SpuPipe::kEven ? kEven : kOdd;
  out.latency_cycles = out.latency_into_branch_cycles = op.latency_cycles;
  out.is_branch = is_branch;
  if (op.stall_cycles == 0) return out;
  out.units = out.blocks_units = kEven | kOdd;  // it never pairs either
  out.blocked_cycles = 1 + op.stall_cycles;
  return out;
}

}  // namespace

SchedulingCore SpuForScheduling(const SpuParameters& spu) {
  SchedulingCore core;
  for (uint32_t c = 0; c < kSpuClassCount; ++c)
    core.classes.push_back(ClassOf(spu.classes[c], SpuClass(c) == SpuClass::kBranch));
  core.files[uint32_t(ValueFile::kVector)] = {
      .first = kSpuReservedRegisters,
      .count = Usable(spu.register_count, kSpuReservedRegisters),
      .spills = true,
      .store_class = uint8_t(SpuClass::kStore),
      .load_class = uint8_t(SpuClass::kLoad),
      .slot_bytes = 16};
  core.instruction_bytes = spu.instruction_bytes;
  core.hold = {uint8_t(SpuClass::kFp7), uint8_t(SpuClass::kFp6), spu.fp6_after_fp7_cycles};
  core.fetch_groups = {.bytes = spu.fetch_group_bytes,
                       .first_units = kEven,
                       .first_padding_class = uint8_t(SpuClass::kNop),
                       .second_padding_class = uint8_t(SpuClass::kLnop)};
  core.time = [spu](Program program) { return TimeOnSpu(program, {}, {}, spu); };
  return core;
}

SchedulingCore PpeForScheduling(const PpeParameters& ppe) {
  SchedulingCore core;
  for (uint32_t c = 0; c < kPpeClassCount; ++c) {
    const PpeClassParameters& op = ppe.classes[c];
    const uint32_t into_branch = PpeClass(c) == PpeClass::kFloatCompare
                                     ? ppe.float_compare_to_branch_cycles
                                     : op.latency_cycles;
    const bool is_branch = PpeClass(c) == PpeClass::kBranch;
    core.classes.push_back({.units = op.units,
                            .latency_cycles = op.latency_cycles,
                            .latency_into_branch_cycles = into_branch,
                            .blocks_units = op.blocks_units,
                            .blocked_cycles = op.blocks_units ? op.latency_cycles : 0,
                            .is_branch = is_branch,
                            .ends_cycle = is_branch || op.blocks_units != 0});
  }
  core.files[uint32_t(ValueFile::kVector)] = {.first = kPpeVector,
                                              .count = Usable(ppe.vector_register_count, 0),
                                              .spills = true,
                                              .store_class = uint8_t(PpeClass::kVectorStore),
                                              .load_class = uint8_t(PpeClass::kVectorLoad),
                                              .slot_bytes = 16};
  core.files[uint32_t(ValueFile::kGeneral)] = {
      .first = kPpeGeneral + kPpeReservedRegisters,
      .count = Usable(ppe.general_register_count, kPpeReservedRegisters),
      .spills = true,
      .store_class = uint8_t(PpeClass::kStore),
      .load_class = uint8_t(PpeClass::kLoad),
      .slot_bytes = 8};
  core.files[uint32_t(ValueFile::kCondition)] = {.first = kPpeCr, .count = kConditionFields};
  core.width = ppe.dispatch_width;
  core.store_to_load_cycles = ppe.load_hit_store_cycles;
  core.time = [ppe](Program program) { return TimeOnPpe(program, {}, {}, ppe); };
  return core;
}

int64_t ResourceBoundCycles(Program program, const SchedulingCore& core) {
  std::array<int64_t, 8> busy{};
  for (const Instruction& instruction : program) {
    const SchedulingCore::Class& op = core.classes[instruction.op_class];
    for (uint32_t u = 0; u < busy.size(); ++u) {
      if (op.blocks_units >> u & 1)
        busy[u] += op.blocked_cycles;
      else
        busy[u] += op.units >> u & 1;
    }
  }
  // The last one to block a unit need not be over for the last issue to be.
  int64_t longest = 1;
  for (const SchedulingCore::Class& op : core.classes)
    longest = std::max(longest, int64_t{op.blocked_cycles});
  const int64_t by_width = (int64_t(program.size()) + core.width - 1) / core.width;
  return std::max(by_width, *std::ranges::max_element(busy) - (longest - 1));
}

}  // namespace pelt
