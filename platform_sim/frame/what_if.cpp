#include "platform_sim/frame/what_if.hpp"

#include <algorithm>
#include <array>

#include "core/kernels/sort_pieces.hpp"

namespace pelt {
namespace {

// 32 bits in three digits of 11 instead of four of 8: eight times the places, a round less.
constexpr uint32_t kDroppedDigit = 1;
constexpr uint64_t kMorePlaces = (1u << 11) / (1u << 8);

struct Names {
  WhatIf what_if;
  std::string_view name, text;
};
constexpr Names kNames[] = {
    {WhatIf::kNothing, "nothing", "as it is"},
    {WhatIf::kWiderDigits, "wider-digits",
     "layers that are sorted in pieces sorted on three digits of 11 bits"},
    {WhatIf::kFewerPoints, "fewer-points",
     "strands of 5 points resampled to 4, as a bake with points = 4 would"},
};

template <size_t kCount>
bool IsOneOf(std::string_view name, const std::string_view (&names)[kCount]) {
  return std::ranges::find(names, name) != std::end(names);
}

using sort_pieces_detail::kCountNames, sort_pieces_detail::kOffsetNames,
    sort_pieces_detail::kScatterNames;

}  // namespace

std::string_view WhatIfName(WhatIf what_if) { return kNames[size_t(what_if)].name; }
std::string_view DescribeWhatIf(WhatIf what_if) { return kNames[size_t(what_if)].text; }
std::optional<WhatIf> ParseWhatIf(std::string_view name) {
  const auto at = std::ranges::find(kNames, name, &Names::name);
  return at == std::end(kNames) ? std::nullopt : std::optional(at->what_if);
}

bool WorkChange::KeepsPass(const Plan& plan, uint32_t pass) const {
  if (what_if_ != WhatIf::kWiderDigits) return true;
  const std::string_view dropped[] = {kCountNames[kDroppedDigit], kOffsetNames[kDroppedDigit],
                                      kScatterNames[kDroppedDigit]};
  const Pass& p = plan.passes[pass];
  for (uint32_t s = p.first_stage; s < p.first_stage + p.stage_count; ++s)
    if (!IsOneOf(plan.stages[s].kernel.name, dropped)) return true;
  return false;
}

void WorkChange::Apply(const Frame& frame, const MovedData& data, ItemWork& work) const {
  if (what_if_ == WhatIf::kWiderDigits) WidenDigits(frame, data, work);
}

void WorkChange::WidenDigits(const Frame& frame, const MovedData& data, ItemWork& work) const {
  for (ItemWork::StageTime& stage : work.stages)
    if (IsOneOf(frame.plan->stages[stage.stage].kernel.name, kOffsetNames))
      for (ItemWork::CodeTime* time : {&stage.as_written, &stage.scheduled}) {
        time->cycles *= double(kMorePlaces);
        time->shared_cycles *= double(kMorePlaces);
      }
  for (ItemWork::StreamBytes& moved : work.streams) {
    if (moved.stream != StreamOf<&Streams::digits>) continue;
    const auto widen = [&](uint64_t& bytes, TransferShape& shape) {
      if (bytes == 0) return;
      data.Replace(data.Whole(bytes), data.Whole(bytes * kMorePlaces), shape);
      bytes *= kMorePlaces;
    };
    widen(moved.get_bytes, work.get);
    widen(moved.put_bytes, work.put);
  }
}

}  // namespace pelt
