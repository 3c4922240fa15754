// Changes of how a frame sorts and of what it draws that this code does not make, tried in the model:
// what a port that is bound by memory could gain by them.
//
// Idea: an item is executed as it is, so its bits stay, and what it then asks of the console is
// what it would ask with the change. All that is timed from there on, frames, ranges, limits, is of
// the changed work: the advice that names a change and a run with it are one thing.
//
//   wider digits       layers that are sorted in pieces take three digits of 11 bits, not four of 8
//   fewer points       strands have the fewest points that kernels take: of the scene's grooms, so
//                      whoever makes the scene does it (core/groom/fewer_points.hpp), the bits are
//                      those of that scene, and the work of its frames is left as it is
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "jobs/frame.hpp"
#include "platform_sim/frame/console_machine.hpp"
#include "platform_sim/frame/item_work.hpp"
#include "platform_sim/frame/moved_data.hpp"

namespace pelt {

inline constexpr WhatIf kAllWhatIfs[] = {WhatIf::kWiderDigits, WhatIf::kFewerPoints};
std::string_view WhatIfName(WhatIf what_if);  // "wider-digits"
std::optional<WhatIf> ParseWhatIf(std::string_view name);
std::string_view DescribeWhatIf(WhatIf what_if);

class WorkChange {
 public:
  explicit WorkChange(WhatIf what_if) : what_if_(what_if) {}

  // False: the pass has nothing to do then.
  bool KeepsPass(const Plan& plan, uint32_t pass) const;
  // `work`: of an item as it is.
  void Apply(const Frame& frame, const MovedData& data, ItemWork& work) const;

 private:
  void WidenDigits(const Frame& frame, const MovedData& data, ItemWork& work) const;

  const WhatIf what_if_;
};

}  // namespace pelt
