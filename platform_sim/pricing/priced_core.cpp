#include "platform_sim/pricing/priced_core.hpp"

#include "platform_sim/pipeline/ppe_core.hpp"

namespace pelt {
namespace {

constexpr std::string_view kNames[] = {"spu", "ppe", "xenon"};

PricedCore MakeSpu(const CellParameters& cell) {
  const SpuParameters& spu = cell.spu;
  return {.kind = CoreKind::kSpu,
          .clock_hz = cell.clock_hz,
          .scheduling = SpuForScheduling(spu),
          .time_shared = {},
          .call_cycles = 2 * spu.mispredict_cycles,
          .scalar_word_cycles =
              spu.Of(SpuClass::kLoad).latency_cycles + spu.Of(SpuClass::kFx2).latency_cycles,
          .register_limit = spu.register_count};
}

PricedCore MakePpe(CoreKind kind, const PpeParameters& ppe, uint64_t clock_hz,
                   const CacheMemoryParameters& caches) {
  PricedCore core{.kind = kind,
                  .clock_hz = clock_hz,
                  .scheduling = PpeForScheduling(ppe),
                  .time_shared = {},
                  .call_cycles = 2 * ppe.mispredict_cycles,
                  .scalar_word_cycles = ppe.Of(PpeClass::kLoad).latency_cycles +
                                        ppe.Of(PpeClass::kInteger).latency_cycles,
                  .register_limit = ppe.vector_register_count,
                  .caches = caches};
  core.time_shared = [&ppe](Program program) { return TimeOnPpe(program, {}, {.smt = true}, ppe); };
  return core;
}

}  // namespace

std::string_view CoreKindName(CoreKind kind) { return kNames[uint32_t(kind)]; }

std::optional<CoreKind> ParseCoreKind(std::string_view name) {
  for (const CoreKind kind : {CoreKind::kSpu, CoreKind::kPpe, CoreKind::kXenon})
    if (CoreKindName(kind) == name) return kind;
  return std::nullopt;
}

PricedCore MakePricedCore(CoreKind kind, const PlatformParameters& platforms) {
  if (kind == CoreKind::kSpu) return MakeSpu(platforms.cell);
  const XenonParameters& xenon = platforms.xenon;
  if (kind == CoreKind::kXenon) return MakePpe(kind, xenon.core, xenon.clock_hz, xenon);
  return MakePpe(kind, platforms.cell.ppe, platforms.cell.clock_hz, PpeMemory(platforms.cell));
}

LoweredCode LowerTo(const PricedCore& core, std::span<const RecordedOperation> operations,
                    uint32_t iterations, const LoweringRules& rules) {
  return core.kind == CoreKind::kSpu ? LowerToSpu(operations, iterations, rules)
                                     : LowerToVmx(operations, iterations, rules);
}

}  // namespace pelt
