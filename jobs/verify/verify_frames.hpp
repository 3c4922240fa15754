// The proof that frames of one's own give the same bits on every executor, and the name of what
// keeps them from it: what `pelt verify` does to fur, for any table of streams and kernels.
//
//   const auto make = [] {                          // the same beginning every time
//     const auto sparks = std::make_shared<Fountains>();
//     return [sparks] { return sparks->frame(); };  // the next frame, its input filled in
//   };
//   for (const Finding& finding : VerifyFrames(make, 100, executors))
//     std::puts(DescribeFinding(finding).c_str());
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "jobs/frame.hpp"
#include "jobs/verify/mismatch.hpp"

namespace pelt {

using NextFrame = std::function<Frame()>;

// Runs the frames one item after another: the truth. Then
// - again: what gives other bits remembers something (kHiddenState), and there is no truth;
// - each stage alone between closed pages (guarded_executor.hpp), where the system has them: that
//   names undeclared accesses, hidden state, and what is taken from a port declared Out;
// - on each of `executors`, in step with the truth: that names the first stage, stream, item, row
//   and lane that differ (kOrder; kRace where a second try differs elsewhere, or not at all).
// Empty: the same bits everywhere, and nothing touched that is not declared.
std::vector<Finding> VerifyFrames(const std::function<NextFrame()>& make, uint32_t frames,
                                  std::span<Executor* const> executors);

// "undeclared-read: stage fall, item 3: reads ...".
std::string DescribeFinding(const Finding& finding);

}  // namespace pelt
