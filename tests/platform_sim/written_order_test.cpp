// One order, whichever operand a compiler computed first.
#include <algorithm>
#include <utility>
#include <vector>

#include "core/kernels/unrolled.hpp"
#include "platform_sim/pricing/trace.hpp"
#include "tests/platform_sim/recording.hpp"

namespace pelt::testing {
namespace {

void ExpectSame(const Trace& a, const Trace& b) {
  EXPECT_EQ(a.value_count, b.value_count);
  ASSERT_EQ(a.operations.size(), b.operations.size());
  for (size_t o = 0; o < a.operations.size(); ++o) {
    SCOPED_TRACE(o);
    const RecordedOperation &x = a.operations[o], &y = b.operations[o];
    EXPECT_EQ(RecordedKindName(x.kind), RecordedKindName(y.kind));
    EXPECT_EQ(x.result, y.result);
    EXPECT_EQ(x.operand, y.operand);
    EXPECT_EQ(x.address, y.address);
    EXPECT_EQ(x.bits, y.bits);
    EXPECT_EQ(x.is_side, y.is_side);
  }
}

// Both operands, the left or the right one first, as a compiler may.
template <class Left, class Right>
auto Both(bool right_first, Left left, Right right) {
  std::pair<decltype(left()), decltype(right())> out;
  if (right_first) out.second = right();
  out.first = left();
  if (!right_first) out.second = right();
  return out;
}

TEST(WrittenOrder, IsTheSameWhicheverOperandCameFirst) {
  const auto record = [](bool right_first) {
    return Record([=](Rows& rows) {
      alignas(64) float temporary[2][16];
      const auto [a, b] = Both(
          right_first,
          [&] {
            const auto [x, y] = Both(
                right_first, [&] { return V::Load(rows.row[0]); }, [&] { return V(3.0f); });
            return x * y;
          },
          [&] { return V(5.0f) * Rsqrt(V::Load(rows.row[1])); });
      (a - b).Store(temporary[right_first]);
      V::Load(temporary[right_first]).Store(rows.row[2]);
    });
  };
  const Trace left = record(false), right = record(true);
  const RecordedOperation &l = left.operations[0], &r = right.operations[0];
  ASSERT_FALSE(l.kind == r.kind && l.address == r.address) << "recorded in one order";
  ExpectSame(InWrittenOrder(left), InWrittenOrder(right));
}

// What one operation does to vectors side by side is one operation.
template <class W>
void ExpectOneOrder() {
  const auto record = [](bool right_first) {
    return Record([=](Rows& rows) {
      const auto load = [&](int row) { return W::Load(rows.row[row]); };
      const auto [a, b] = Both(
          right_first,
          [&] {
            const W loaded = load(0) * W(3.0f);
            return loaded + W(2.0f) * W(3.0f);
          },
          [&] {
            const W constant = W(5.0f) * W(3.0f);  // beside another of constants
            return Select(W(1.0f) < load(1), Rsqrt(load(2)), constant);
          });
      (a - b).Store(rows.row[3]);
    });
  };
  const Trace left = record(false), right = record(true);
  const auto first_load = [](const Trace& trace) {
    return std::ranges::find(trace.operations, Kind::kLoad, &RecordedOperation::kind)->address;
  };
  ASSERT_NE(first_load(left), first_load(right)) << "recorded in one order";
  ExpectSame(InWrittenOrder(left), InWrittenOrder(right));
}

TEST(WrittenOrder, TakesVectorsSideBySideAsOne) {
  ExpectOneOrder<V>();
  ExpectOneOrder<Unrolled<V>>();
  ExpectOneOrder<Unrolled<Unrolled<V>>>();
}

TEST(WrittenOrder, IsTheSameTheSecondTime) {
  const Trace once = InWrittenOrder(Record([](Rows& rows) {
    const V late = V::Load(rows.row[0]) + V(1.0f), early = V::Load(rows.row[1]) * V(2.0f);
    early.Store(rows.row[2]);
    static_cast<void>(Any(late < early));
    late.Store(rows.row[1]);
  }));
  ExpectSame(InWrittenOrder(once), once);
}

TEST(WrittenOrder, LeavesOutWhatNobodyNeeds) {
  const Trace trace = InWrittenOrder(Record([](Rows& rows) {
    const V a = V::Load(rows.row[0]);
    [[maybe_unused]] const V unused = a * a + V(7.0f);
    a.Store(rows.row[1]);
  }));
  ASSERT_EQ(trace.operations.size(), 2u);
  EXPECT_EQ(trace.operations[1].kind, Kind::kStore);
}

// A value that was loaded early and is needed late is what was there early.
TEST(WrittenOrder, LoadsStayBeforeTheStoresThatOverwriteThem) {
  for (const int lane : {0, 2, 4}) {
    const Trace trace = InWrittenOrder(Record([&](Rows& rows) {
      const V before = V::Load(rows.row[0]);
      V(1.0f).Store(rows.row[0] + lane);
      before.Store(rows.row[1]);
    }));
    ASSERT_EQ(trace.operations.size(), 4u);
    EXPECT_EQ(trace.operations[0].kind, Kind::kLoad) << lane;
    EXPECT_EQ(trace.operations[2].kind, Kind::kStore) << lane;
  }
}

TEST(WrittenOrder, AStoreOfTheSecondIterationDoesNotTakeTheFirstIterationsLoad) {
  const Trace trace = InWrittenOrder(Record([](Rows& rows) {
    V carried = V::Load(rows.row[0]);
    for (int iteration = 0; iteration < 3; ++iteration) {
      const V next = V::Load(rows.row[0]) + V(1.0f);
      next.Store(rows.row[0]);
      (carried * carried).Store(rows.row[1 + iteration]);
      carried = next;
    }
  }));
  uint32_t stores = 0, loads = 0;
  for (const RecordedOperation& operation : trace.operations) {
    if (operation.kind == Kind::kLoad) {
      // The carried one and the first iteration's; then one after each store of the row.
      EXPECT_EQ(stores, loads < 2 ? 0 : 2 * (loads - 1)) << loads;
      ++loads;
    }
    stores += operation.kind == Kind::kStore;
  }
  EXPECT_EQ(loads, 4u);
  EXPECT_EQ(stores, 6u);
}

// No work of a later statement goes before an earlier one's, and no iteration of a loop into
// another, regardless of what depends on what: that is a scheduler's doing.
TEST(WrittenOrder, StatementsAndIterationsStayOneAfterAnother) {
  const Trace trace = InWrittenOrder(Record([](Rows& rows) {
    V sum(0.0f), product(1.0f);
    for (int iteration = 0; iteration < 3; ++iteration) {
      const V x = V::Load(rows.row[iteration]);
      const V shallow = Min(x, V(2.0f));
      const V deep = x * x * x * x;
      sum = sum + deep;
      product = product + shallow + deep;
    }
    sum.Store(rows.row[4]);
    product.Store(rows.row[5]);
  }));
  std::vector<Kind> kinds;
  for (const RecordedOperation& operation : trace.operations)
    if (operation.kind != Kind::kSplat) kinds.push_back(operation.kind);
  const std::vector<Kind> iteration = {Kind::kLoad,     Kind::kMin,      Kind::kMultiply,
                                       Kind::kMultiply, Kind::kMultiply, Kind::kAdd,
                                       Kind::kAdd,      Kind::kAdd};
  ASSERT_EQ(kinds.size(), 3 * iteration.size() + 2);
  for (size_t i = 0; i < 3 * iteration.size(); ++i)
    EXPECT_EQ(RecordedKindName(kinds[i]), RecordedKindName(iteration[i % iteration.size()])) << i;
}

// What stands before an expression and is read in one operand of it only goes with that operand:
// the trace does not say whether it was a statement or a part of it.
TEST(WrittenOrder, WhatOneOperandAloneReadsGoesWithIt) {
  const auto record = [](bool right_first) {
    return Record([=](Rows& rows) {
      const V x = V::Load(rows.row[0]), y = V::Load(rows.row[1]), z = V::Load(rows.row[2]);
      const V before = y * z;
      const auto [a, b] = Both(
          right_first, [&] { return x + y; },
          [&] {
            const auto [p, q] = Both(
                right_first, [&] { return before - x; }, [&] { return before + z; });
            return p / q;
          });
      (a * b).Store(rows.row[3]);
    });
  };
  const Trace left = InWrittenOrder(record(false));
  ExpectSame(left, InWrittenOrder(record(true)));
  std::vector<Kind> kinds;
  for (const RecordedOperation& operation : left.operations) kinds.push_back(operation.kind);
  EXPECT_EQ(kinds, (std::vector<Kind>{Kind::kLoad, Kind::kLoad, Kind::kAdd, Kind::kLoad,
                                      Kind::kMultiply, Kind::kSubtract, Kind::kAdd, Kind::kDivide,
                                      Kind::kMultiply, Kind::kStore}));
}

}  // namespace
}  // namespace pelt::testing
