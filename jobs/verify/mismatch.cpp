#include "jobs/verify/mismatch.hpp"

#include <bit>

#include "core/format.hpp"
#include "traces/digest.hpp"

namespace pelt {
namespace {

bool Admits(const Stage& stage, const SceneShape& shape, Domain domain, uint32_t item) {
  if (domain < Domain::kLayer) return true;
  return stage.kinds.Admits(shape.layer_kind[shape.LayerOf(domain, item)]);
}

void NamePlace(const SceneShape& shape, Domain domain, uint32_t item, Mismatch& out) {
  out.domain = domain;
  out.item = item;
  if (domain < Domain::kLayer) return;
  out.layer_index = shape.LayerOf(domain, item);
  if (IsInLayer(domain)) out.place_in_layer = item - shape.LayerFirst(domain, out.layer_index);
}

// Compares one block; true when `out` names a difference.
bool CompareBlock(const FrameMemory& expected, const FrameMemory& found, Stream stream,
                  uint32_t item, Mismatch& out) {
  const StreamDesc& desc = (*expected.table)[stream];
  const std::byte* left = expected.Block(stream, item);
  const std::byte* right = found.Block(stream, item);
  if (!left || !right) return false;
  const uint32_t lanes = expected.LiveLanes(stream, item), have = found.LiveLanes(stream, item);
  out.stream = desc.name;
  NamePlace(*expected.shape, desc.domain, item, out);
  if (lanes != have) {
    out.row = "live lanes";
    out.expected = lanes;
    out.found = have;
    return true;
  }
  const BlockDifference difference = FindDifference(desc, left, right, lanes);
  if (!difference.differs) return false;
  out.row = difference.row->name;
  out.component = difference.component;
  out.lane = difference.lane;
  out.expected = difference.left;
  out.found = difference.right;
  out.is_float = difference.row->type == ElementType::kFloat;
  return true;
}

std::string PlaceOf(const Mismatch& m) {
  if (m.layer_index == Mismatch::kNoLayer) return Format("item {}", m.item);
  const std::string layer =
      m.layer.empty() ? Format("layer {}", m.layer_index) : Format("layer '{}'", m.layer);
  if (!IsInLayer(m.domain)) return layer;
  return Format("{}, {} {} (item {})", layer, DomainName(m.domain), m.place_in_layer, m.item);
}

}  // namespace

std::string_view FindingName(FindingKind kind) {
  constexpr std::string_view kNames[] = {"",
                                         "value",
                                         "order-dependent",
                                         "race",
                                         "undeclared-read",
                                         "undeclared-write",
                                         "reads-out",
                                         "hidden-state",
                                         "float-environment",
                                         "skip-changes-bits",
                                         "sleeper-not-woken",
                                         "wrongly-culled",
                                         "kept-over-rollback",
                                         "digest-incomplete",
                                         "workers",
                                         "executor"};
  return kNames[size_t(kind)];
}

std::string DescribeMismatch(const Mismatch& m) {
  if (!m.reproduced) return Format("frame {} differed once and not again in lock-step", m.frame);
  // Records are hashed as words; most are floats, so both readings are given.
  return Format(
      "frame {}, stage {}, stream {}, {}, row {}[{}], lane {}: expected 0x{:08x}, found 0x{:08x} "
      "(as "
      "float {:.9g} and {:.9g})",
      m.frame, m.stage, m.stream, PlaceOf(m), m.row, m.component, m.lane, m.expected, m.found,
      std::bit_cast<float>(m.expected), std::bit_cast<float>(m.found));
}

std::optional<Mismatch> FindMismatch(const Frame& expected, const Frame& found, bool bookkeeping) {
  const FrameMemory& memory = *expected.memory;
  // Bookkeeping follows from values, so a wrong value is looked for first.
  for (const Role role : {Role::kValue, Role::kBookkeeping}) {
    if (role == Role::kBookkeeping && !bookkeeping) break;
    for (const Stage& stage : expected.plan->stages)
      for (const PortDesc& port : stage.kernel.ports) {
        const StreamDesc& desc = (*memory.table)[port.stream];
        if (!IsWritten(port.access) || desc.role != role) continue;
        for (uint32_t i = 0; i < memory.shape->ItemCount(desc.domain); ++i) {
          if (!Admits(stage, *memory.shape, desc.domain, i)) continue;
          Mismatch out;
          out.stage = stage.kernel.name;
          if (CompareBlock(memory, *found.memory, port.stream, i, out)) return out;
        }
      }
  }
  return std::nullopt;
}

}  // namespace pelt
