#include "platform_sim/pipeline/ppe_core.hpp"

#include <algorithm>

#include "platform_sim/pipeline/instruction_set.hpp"
#include "platform_sim/pipeline/issue_walk.hpp"
#include "platform_sim/pipeline/ppe_thread.hpp"

namespace pelt {
namespace {

class PpeDispatch final : public IssueModel {
 public:
  PpeDispatch(Program program, const PpeRules& rules, const PpeParameters& ppe)
      : rules_(rules), ppe_(ppe), thread_(RegisterEnd(program), ppe) {}

  IssueSlot Issue(const Instruction& instruction, uint32_t index, bool taken) override {
    const IssueSlot slot =
        thread_.Propose(instruction, index, units_, [&](int64_t cycle) { return OwnCycle(cycle); });
    thread_.Commit(instruction, slot, taken, units_);
    return slot;
  }

  uint32_t BusyCycles(const Instruction& instruction, uint32_t unit) const override {
    const PpeClassParameters& op = ppe_.classes[instruction.op_class];
    if (op.blocks_units >> unit & 1) return op.latency_cycles;
    return op.units >> unit & 1;
  }

  void AppendState(std::vector<int64_t>& state) const override {
    const int64_t now = thread_.last_cycle();
    thread_.AppendState(now, state);
    for (const int64_t cycle : units_.free_at) state.push_back(std::max<int64_t>(cycle - now, 0));
    if (rules_.smt) state.push_back(now % ppe_.smt_threads);
  }

  void Leap(int64_t cycles) override {
    thread_.Leap(cycles);
    for (int64_t& cycle : units_.free_at) cycle += cycles;
  }

  uint32_t PipeCount() const override { return kPpeUnitCount; }

 private:
  int64_t OwnCycle(int64_t cycle) const {
    const int64_t threads = rules_.smt ? ppe_.smt_threads : 1;
    return (cycle + threads - 1) / threads * threads;
  }

  const PpeRules rules_;
  const PpeParameters& ppe_;
  PpeThread thread_;
  PpeUnits units_;
};

}  // namespace

Result<IssueChart> TimeOnPpe(Program program, std::span<const TripCount> trips,
                             const PpeRules& rules, const PpeParameters& ppe) {
  std::string error;
  if (!CheckProgram(program, kPpeClassCount, error)) return Failure{error};
  IssueChart chart;
  chart.pipes = {"fixed point", "load/store", "branch unit", "VSU1", "VSU2"};
  PpeDispatch model(program, rules, ppe);
  if (!RunWalk(program, trips, model, chart, error)) return Failure{error};
  chart.live = {{"general", MostLiveRegisters(program, kPpeGeneral, kPpeFloat - kPpeGeneral),
                 ppe.general_register_count},
                {"FP", MostLiveRegisters(program, kPpeFloat, kPpeVector - kPpeFloat),
                 ppe.float_register_count},
                {"vector", MostLiveRegisters(program, kPpeVector, kPpeCr - kPpeVector),
                 ppe.vector_register_count}};
  return chart;
}

}  // namespace pelt
