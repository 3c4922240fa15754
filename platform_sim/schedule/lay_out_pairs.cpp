#include "platform_sim/schedule/lay_out_pairs.hpp"

namespace pelt {
namespace {

void Pad(uint8_t op_class, FinishedCode& out) {
  Instruction padding;
  padding.op_class = op_class;
  out.program.push_back(padding);
  out.origin.push_back(kPadding);
  ++out.padding;
}

}  // namespace

void LayOutPairs(const IssueOrder& order, const SchedulingCore& core, FinishedCode& code) {
  if (!core.fetch_groups) return;
  const SchedulingCore::FetchGroups& groups = *core.fetch_groups;
  FinishedCode out = code;
  out.program.clear();
  out.origin.clear();
  const auto add = [&](size_t i) {
    out.program.push_back(code.program[i]);
    out.origin.push_back(code.origin[i]);
  };
  const size_t size = code.program.size();
  for (size_t i = 0; i < size;) {
    const bool is_pair = i + 1 < size && order.cycle[i] == order.cycle[i + 1];
    if (is_pair) {
      add(i++);
      add(i++);
      continue;
    }
    // Alone, at the beginning of a group: is it followed by a pair?
    const bool at_group_begin = out.program.size() * core.instruction_bytes % groups.bytes == 0;
    const bool pair_follows = i + 2 < size && order.cycle[i + 1] == order.cycle[i + 2];
    const bool is_first_kind = core.classes[code.program[i].op_class].units & groups.first_units;
    if (at_group_begin && pair_follows && !is_first_kind) Pad(groups.first_padding_class, out);
    add(i++);
    if (at_group_begin && pair_follows && is_first_kind) Pad(groups.second_padding_class, out);
  }
  for (size_t i = 0; i < out.program.size(); ++i) {
    out.program[i].location_bytes = i * core.instruction_bytes;
    if (out.program[i].target != kNoTarget) out.program[i].target = uint32_t(out.program.size());
  }
  code = std::move(out);
}

}  // namespace pelt
