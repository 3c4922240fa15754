#include "bench/verify/lockstep.hpp"

#include <algorithm>
#include <thread>

#include "bench/verify/odd_floats.hpp"
#include "core/error.hpp"
#include "traces/digest.hpp"

namespace pelt {
namespace {

bool Admits(const Stage& stage, const SceneShape& shape, Domain domain, uint32_t item) {
  if (domain < Domain::kLayer) return true;
  return stage.kinds.Admits(
      shape.layer_kind[domain == Domain::kChunk ? shape.chunk_layer[item] : item]);
}

void NamePlace(const FurScene& scene, const StreamDesc& desc, uint32_t item, Mismatch& out) {
  const SceneShape& shape = scene.shape();
  out.item = item;
  if (desc.domain < Domain::kLayer) return;
  const uint32_t layer = desc.domain == Domain::kChunk ? shape.chunk_layer[item] : item;
  out.layer = scene.LayerName(layer);
  if (desc.domain == Domain::kChunk) out.chunk_in_layer = item - shape.layer_first_chunk[layer];
}

// Compares one block; true when `out` names a difference.
bool CompareBlock(FurScene& expected, FurScene& found, Stream stream, uint32_t item,
                  Mismatch& out) {
  const StreamDesc& desc = DescribeStream(stream);
  const std::byte* left = expected.memory().Block(stream, item);
  const std::byte* right = found.memory().Block(stream, item);
  if (!left || !right) return false;
  const uint32_t lanes = expected.LiveLanes(stream, item), have = found.LiveLanes(stream, item);
  out.stream = desc.name;
  if (lanes != have) {
    out.row = "live lanes";
    out.expected = lanes;
    out.found = have;
    NamePlace(expected, desc, item, out);
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
  NamePlace(expected, desc, item, out);
  return true;
}

}  // namespace

SceneOptions SceneOptionsOf(const VerifyCase& what) {
  SceneOptions options;
  options.plan.must_fit = what.executor->local_store;
  options.isa = what.isa;
  options.plan.fuse = what.fuse;
  options.vertex_order = what.vertex_order;
  options.piecewise_sort_chunks = what.piecewise_sort ? 1 : 0;
  return options;
}

uint32_t WorkersOf(const VerifyCase& what) {
  if (!what.executor->HasWorkers()) return 1;
  return what.workers ? what.workers : std::max(1u, std::thread::hardware_concurrency());
}

std::unique_ptr<WatchedExecutor> MakeExecutor(const VerifyCase& what) {
  return what.executor->make({.workers = WorkersOf(what), .order_seed = what.order_seed});
}

SkipSettings NoSkips(bool lod) {
  return {.sleep = false,
          .unmoved = false,
          .sort = false,
          .cull = false,
          .wind = false,
          .light = false,
          .lod = lod};
}

FrameSettings FrameSettingsOf(Settings settings, const Scenario& scenario) {
  FrameSettings all;
  if (settings == Settings::kNoSkips) all.skip = NoSkips();
  if (settings == Settings::kLod) {
    all.skip.lod = true;
    all.lod.strand_budget = uint32_t(scenario.StrandCount() / 2);
  }
  return all;
}

CaseRun::CaseRun(Scenario& scenario, const VerifyCase& what, const FrameSettings& settings,
                 const std::function<void(const VerifyCase&, Plan&)>& tamper)
    : odd_floats_(what.odd_floats),
      running_(scenario, SceneOptionsOf(what)),
      plan_(running_.scene().plan()),
      settings_(settings) {
  const OddFloats odd(odd_floats_);  // its threads inherit them
  executor_ = MakeExecutor(what);
  if (tamper) tamper(what, plan_);
}

void CaseRun::RunFrame(uint32_t frame, const Change& change) {
  if (!TryRunFrame(frame, change)) throw Error(running_.RefusalText(frame));
}

bool CaseRun::TryRunFrame(uint32_t frame, const Change& change) {
  FrameInput input = running_.Prepare(frame, settings_.skip, settings_.lod);
  if (change) change(input, running_.scene());
  const OddFloats odd(odd_floats_);
  if (!running_.TryBegin(input)) return false;
  Frame work = running_.scene().CurrentFrame();
  work.plan = &plan_;
  executor_->Run(work);
  return true;
}

std::optional<Mismatch> FindMismatch(CaseRun& expected, CaseRun& found, uint32_t frame,
                                     bool bookkeeping) {
  const SceneShape& shape = expected.scene().shape();
  Mismatch out;
  out.frame = frame;
  // Bookkeeping follows from values, so a wrong value is looked for first.
  for (const Role role : {Role::kValue, Role::kBookkeeping}) {
    if (role == Role::kBookkeeping && !bookkeeping) break;
    for (const Stage& stage : expected.plan().stages)
      for (const PortDesc& port : stage.kernel.ports) {
        const StreamDesc& desc = DescribeStream(port.stream);
        if (!IsWritten(port.access) || desc.role != role) continue;
        for (uint32_t i = 0; i < shape.ItemCount(desc.domain); ++i) {
          if (!Admits(stage, shape, desc.domain, i)) continue;
          out.stage = stage.kernel.name;
          if (CompareBlock(expected.scene(), found.scene(), port.stream, i, out)) return out;
        }
      }
  }
  return std::nullopt;
}

}  // namespace pelt
