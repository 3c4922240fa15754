#include "platform_sim/pipeline/instruction_set.hpp"

#include <algorithm>

#include "core/format.hpp"

namespace pelt {

std::vector<Opcode> ExpandGroups(std::span<const OpcodeGroup> groups) {
  std::vector<Opcode> out;
  for (const OpcodeGroup& group : groups) {
    std::string_view rest = group.mnemonics;
    while (!rest.empty()) {
      const size_t end = std::min(rest.find(' '), rest.size());
      out.push_back({.mnemonic = rest.substr(0, end),
                     .op_class = group.op_class,
                     .operands = group.operands,
                     .flow = group.flow,
                     .access_bytes = group.access_bytes,
                     .is_store = group.is_store});
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }
  std::ranges::stable_sort(out, {}, &Opcode::mnemonic);
  return out;
}

std::optional<Opcode> FindOpcode(std::span<const Opcode> sorted, std::string_view mnemonic) {
  const auto at = std::ranges::lower_bound(sorted, mnemonic, {}, &Opcode::mnemonic);
  if (at == sorted.end() || at->mnemonic != mnemonic) return std::nullopt;
  return *at;
}

std::string RegisterName(const InstructionSet& set, uint32_t reg) {
  if (set.files.size() > 1 && reg == kPpeCount) return "ctr";
  if (set.files.size() > 1 && reg == kPpeLink) return "lr";
  for (const RegisterFile& file : set.files)
    if (reg >= file.first && reg < file.first + file.count) {
      const std::string_view prefix = file.prefixes.substr(file.prefixes.rfind(' ') + 1);
      return Format("{}{}", prefix, reg - file.first);
    }
  return Format("value {}", reg);
}

}  // namespace pelt
