// Any method on any vector as a StrandSolver: the strands of a batch in groups of V's lanes.
//
// Method<V, n> has Table, State, Step(table, input, state) and Velocity(table, state, i); State has
// Start and Point. A group's
// state is kept in memory from frame to frame as a solver in a frame would keep it, so timing Step
// is fair.
//
// Compiled once for each instruction set: nothing here may instantiate a shared template
// (std::vector<float>), or the linker could merge an AVX body into the SSE4 path.
#pragma once

#include <new>

#include "bench/accuracy/comparison/lane_input.hpp"
#include "bench/accuracy/comparison/tables.hpp"
#include "bench/accuracy/strand_solver.hpp"

namespace pelt::accuracy {

// Makes the table of a method anew for another frame time.
using TableMaker = void (*)(const ChainMaterial& material, const MethodSettings& settings,
                            double frame_seconds, ComparisonTables& tables);

// The table of a kind among all of them; the second argument only names the kind.
PELT_INLINE const PointTable& TableOf(const ComparisonTables& t, const PointTable*) {
  return t.point;
}
PELT_INLINE const XpbdTable& TableOf(const ComparisonTables& t, const XpbdTable*) { return t.xpbd; }
PELT_INLINE const DirectTable& TableOf(const ComparisonTables& t, const DirectTable*) {
  return t.direct;
}

template <template <class, int> class MethodOf, class V, int n>
class LaneBatch final : public StrandSolver {
 public:
  using Method = MethodOf<V, n>;
  using State = typename Method::State;

  LaneBatch(const ComparisonTables& tables, const ChainMaterial& material, TableMaker make,
            uint32_t lanes)
      : tables_(tables), material_(material), make_(make), groups_(lanes / V::kLanes) {
    states_ = static_cast<State*>(::operator new(sizeof(State) * groups_, kAlignment));
  }
  ~LaneBatch() override { ::operator delete(states_, kAlignment); }
  LaneBatch(const LaneBatch&) = delete;
  LaneBatch& operator=(const LaneBatch&) = delete;

  void Start(const FrameRows& frame, const float* const (*start)[3]) override {
    for (uint32_t g = 0; g < groups_; ++g) {
      Vec3<V> direction[n];
      for (int i = 0; i < n; ++i) direction[i] = Load(start[i], g);
      states_[g].Start(table().step, LoadInput(frame, g), direction);
    }
  }
  void Step(const FrameRows& frame) override {
    for (uint32_t g = 0; g < groups_; ++g) Method::Step(table(), LoadInput(frame, g), states_[g]);
  }
  void SetFrameTime(double seconds) override {
    make_(material_, tables_.settings, seconds, tables_);
  }
  void Points(int i, float* const (&rows)[3]) const override {
    for (uint32_t g = 0; g < groups_; ++g) Store(states_[g].Point(table().step, i), rows, g);
  }
  void Velocities(int i, float* const (&rows)[3]) const override {
    for (uint32_t g = 0; g < groups_; ++g) Store(Method::Velocity(table(), states_[g], i), rows, g);
  }

 private:
  static constexpr std::align_val_t kAlignment{128};

  PELT_INLINE const typename Method::Table& table() const {
    return TableOf(tables_, static_cast<const typename Method::Table*>(nullptr));
  }
  PELT_INLINE static Vec3<V> Load(const float* const (&rows)[3], uint32_t g) {
    const uint32_t lane = g * V::kLanes;
    return {V::Load(rows[0] + lane), V::Load(rows[1] + lane), V::Load(rows[2] + lane)};
  }
  PELT_INLINE static void Store(Vec3<V> p, float* const (&rows)[3], uint32_t g) {
    const uint32_t lane = g * V::kLanes;
    p.x.Store(rows[0] + lane);
    p.y.Store(rows[1] + lane);
    p.z.Store(rows[2] + lane);
  }
  PELT_INLINE static LaneInput<V, n> LoadInput(const FrameRows& frame, uint32_t g) {
    LaneInput<V, n> input;
    input.motion = Load(frame.motion, g);
    input.wind = Load(frame.wind, g);
    for (int i = 0; i < n; ++i) input.rest[i] = Load(frame.rest[i], g);
    return input;
  }

  ComparisonTables tables_;
  ChainMaterial material_;
  TableMaker make_;
  uint32_t groups_;
  State* states_;
};

}  // namespace pelt::accuracy
