// A core that kernels are priced on: how code is lowered to it, scheduled for it and timed on it.
#pragma once

#include <optional>
#include <string_view>

#include "core/error.hpp"
#include "platform_sim/platforms/platform.hpp"
#include "platform_sim/pricing/lowering.hpp"
#include "platform_sim/schedule/scheduling_core.hpp"

namespace pelt {

enum class CoreKind : uint8_t { kSpu, kPpe, kXenon };
std::string_view CoreKindName(CoreKind kind);  // "spu", "ppe", "xenon"
std::optional<CoreKind> ParseCoreKind(std::string_view name);

struct PricedCore {
  CoreKind kind;
  uint64_t clock_hz;
  SchedulingCore scheduling;
  // While the core's other hardware thread runs too; a core without one: empty.
  std::function<Result<IssueChart>(Program)> time_shared;
  // Of a call and its return: two branches that nothing foretold.
  uint32_t call_cycles;
  // From a load through a dependent simple operation: what unseen scalar code is charged a word.
  uint32_t scalar_word_cycles;
  uint32_t register_limit;                           // of vectors
  std::optional<CacheMemoryParameters> caches = {};  // none: a local store
};

// The parameters must outlive the core.
PricedCore MakePricedCore(CoreKind kind, const PlatformParameters& platforms);

LoweredCode LowerTo(const PricedCore& core, std::span<const RecordedOperation> operations,
                    uint32_t iterations, const LoweringRules& rules);

}  // namespace pelt
