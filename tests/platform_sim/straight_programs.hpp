// Straight code for the tests of scheduling: seeded random programs, and kernels whose best cycles
// are known.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <random>
#include <string>
#include <vector>

#include "platform_sim/schedule/schedule.hpp"
#include "tests/platform_sim/check_finished.hpp"

namespace pelt::testing {

class StraightBuilder {
 public:
  uint32_t Value(ValueFile file = ValueFile::kVector) {
    code.file.push_back(file);
    return code.value_count() - 1;
  }
  template <class List>
  uint32_t Compute(uint8_t op_class, const List& reads, ValueFile file = ValueFile::kVector) {
    Instruction& added = Add(op_class);
    for (const uint32_t value : reads) added.reads.Add(value);
    const uint32_t out = Value(file);
    code.program.back().writes.Add(out);
    return out;
  }
  uint32_t Compute(uint8_t op_class, std::initializer_list<uint32_t> reads) {
    return Compute(op_class, std::vector<uint32_t>(reads));
  }
  uint32_t Load(uint8_t op_class, int32_t address, uint32_t size = 16,
                ValueFile file = ValueFile::kVector) {
    Add(op_class).address = {.displacement_bytes = address, .size_bytes = size};
    const uint32_t out = Value(file);
    code.program.back().writes.Add(out);
    return out;
  }
  void Store(uint8_t op_class, int32_t address, uint32_t value, uint32_t size = 16) {
    Instruction& added = Add(op_class);
    added.reads.Add(value);
    added.address = {.displacement_bytes = address, .size_bytes = size, .is_store = true};
  }
  void Branch(uint8_t op_class, uint32_t condition) {
    Instruction& added = Add(op_class);
    added.reads.Add(condition);
    added.flow = Flow::kConditional;
  }
  StraightCode Finish() {
    code.EndBranches();
    return code;
  }

  StraightCode code;

 private:
  Instruction& Add(uint8_t op_class) {
    code.program.emplace_back().op_class = op_class;
    return code.program.back();
  }
};

// What the programs below need of a core.
struct CoreUnderTest {
  std::string name;
  SchedulingCore core;
  uint8_t real, simple, estimate, permute, load, store, branch, compare;
  std::vector<uint8_t> odd_ones;  // not pipelined, and such
  bool general_decides;           // conditions come of general registers, not of vectors
};

inline CoreUnderTest SpuUnderTest(const SpuParameters& spu = {}) {
  const auto id = [](SpuClass c) { return uint8_t(c); };
  return {"SPU",
          SpuForScheduling(spu),
          id(SpuClass::kFp6),
          id(SpuClass::kFx2),
          id(SpuClass::kEstimate),
          id(SpuClass::kShuffle),
          id(SpuClass::kLoad),
          id(SpuClass::kStore),
          id(SpuClass::kBranch),
          id(SpuClass::kFx2),
          {id(SpuClass::kFp7), id(SpuClass::kFpd), id(SpuClass::kFx3)},
          false};
}
inline CoreUnderTest PpeUnderTest(uint32_t vector_registers = 32) {
  const auto id = [](PpeClass c) { return uint8_t(c); };
  PpeParameters ppe;
  ppe.vector_register_count = vector_registers;
  return {vector_registers == 32 ? "PPE" : "Xenon",
          PpeForScheduling(ppe),
          id(PpeClass::kVectorFloat),
          id(PpeClass::kVectorSimple),
          id(PpeClass::kVectorEstimate),
          id(PpeClass::kVectorPermute),
          id(PpeClass::kVectorLoad),
          id(PpeClass::kVectorStore),
          id(PpeClass::kBranch),
          id(PpeClass::kCompare),
          {id(PpeClass::kVectorComplex)},
          true};
}
inline std::vector<CoreUnderTest> CoresUnderTest() {
  return {SpuUnderTest(), PpeUnderTest(), PpeUnderTest(128)};
}

// What a random program is like.
struct RandomShape {
  uint32_t instructions = 300;
  uint32_t reach = 40;     // operands are among the last so many values
  uint32_t words = 64;     // of memory that is loaded and stored, 4 bytes each
  bool one_chain = false;  // each reads the result before it
  uint32_t entry_values = 8;
};

inline StraightCode RandomProgram(const CoreUnderTest& on, uint32_t seed,
                                  const RandomShape& shape) {
  std::mt19937 random(seed);
  const auto below = [&](size_t n) { return uint32_t(random() % n); };
  StraightBuilder b;
  std::vector<uint32_t> vectors, generals;
  for (uint32_t v = 0; v < shape.entry_values; ++v) vectors.push_back(b.Value());
  if (on.general_decides)
    for (uint32_t v = 0; v < 4; ++v) generals.push_back(b.Value(ValueFile::kGeneral));
  const auto recent = [&](const std::vector<uint32_t>& of) {
    return of[of.size() - 1 - below(std::min<size_t>(of.size(), shape.reach))];
  };
  const std::array<uint32_t, 4> sizes = {1, 4, 8, 16};
  while (b.code.program.size() < shape.instructions) {
    const uint32_t size = sizes[below(4)];
    const int32_t address = int32_t(below(shape.words) * 4 + (size == 1 ? below(4) : 0));
    const uint32_t kind = below(20);
    if (kind < 3) {
      vectors.push_back(b.Load(on.load, address, size));
    } else if (kind < 5) {
      b.Store(on.store, address, recent(vectors), size);
    } else if (kind == 5 && on.general_decides) {
      const uint8_t integer = uint8_t(PpeClass::kInteger);
      generals.push_back(
          b.Compute(integer, std::vector{recent(generals), recent(generals)}, ValueFile::kGeneral));
    } else if (kind == 6 && below(3) == 0) {
      const uint32_t decides = recent(on.general_decides ? generals : vectors);
      const ValueFile file = on.general_decides ? ValueFile::kCondition : ValueFile::kVector;
      b.Branch(on.branch, b.Compute(on.compare, std::vector{decides}, file));
    } else {
      const std::array<uint8_t, 6> pool = {on.real,    on.real,
                                           on.simple,  on.estimate,
                                           on.permute, on.odd_ones[below(on.odd_ones.size())]};
      std::vector<uint32_t> reads = {shape.one_chain ? vectors.back() : recent(vectors)};
      for (uint32_t more = below(3); more > 0; --more) reads.push_back(recent(vectors));
      vectors.push_back(b.Compute(pool[below(pool.size())], reads));
    }
  }
  return b.Finish();
}

// A position-based sweep over a chain: each constraint needs the one before it. `groups` copies,
// which share constants and nothing else: four lanes of strands each.
inline StraightCode ChainSweep(const CoreUnderTest& on, uint32_t groups, uint32_t points,
                               uint32_t sweeps) {
  StraightBuilder b;
  const uint32_t half = b.Value(), one = b.Value(), weight = b.Value();
  for (uint32_t group = 0; group < groups; ++group) {
    const int32_t rows = int32_t(group * 64 * points);
    std::vector<uint32_t> p;
    for (uint32_t i = 0; i < 3 * points; ++i) p.push_back(b.Load(on.load, rows + int32_t(16 * i)));
    for (uint32_t c = 0; c < sweeps * (points - 1); ++c) {
      const uint32_t at = c % (points - 1) * 3;
      std::array<uint32_t, 3> d{};
      for (uint32_t x = 0; x < 3; ++x) d[x] = b.Compute(on.real, {p[at + 3 + x], p[at + x]});
      uint32_t square = b.Compute(on.real, {d[0], d[0]});
      square = b.Compute(on.real, {d[1], d[1], square});
      square = b.Compute(on.real, {d[2], d[2], square});
      const uint32_t estimate = b.Compute(on.estimate, {square});
      const uint32_t scaled = b.Compute(on.real, {square, half});
      const uint32_t twice = b.Compute(on.real, {estimate, estimate});
      const uint32_t rest = b.Compute(on.real, {twice, scaled, one});
      const uint32_t root = b.Compute(on.real, {estimate, rest, estimate});
      const uint32_t move = b.Compute(on.real, {root, weight, one});
      for (uint32_t x = 0; x < 3; ++x) {
        p[at + x] = b.Compute(on.real, {d[x], move, p[at + x]});
        p[at + 3 + x] = b.Compute(on.real, {d[x], move, p[at + 3 + x]});
      }
    }
    for (uint32_t i = 0; i < 3 * points; ++i) b.Store(on.store, rows + int32_t(16 * i), p[i]);
  }
  return b.Finish();
}

inline FinishedCode InOrder(const StraightCode& code, const SchedulingCore& core) {
  return AllocateInOrder(code, core).OrThrow();
}
inline FinishedCode Scheduled(const StraightCode& code, const SchedulingCore& core) {
  return Schedule(code, core).OrThrow();
}
inline int64_t CyclesOf(const FinishedCode& code, const SchedulingCore& core) {
  return core.time(code.program).OrThrow().totals.cycles;
}
inline ::testing::AssertionResult IsRight(const StraightCode& code, const FinishedCode& finished,
                                          const SchedulingCore& core) {
  std::string error;
  if (CheckFinishedCode(code, finished, core, error)) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << error;
}

}  // namespace pelt::testing
