// Drawing orders of a scene's frames: what must hold of them whatever the machine.
#include "bench/accuracy/order_precision.hpp"

#include <gtest/gtest.h>

namespace pelt::accuracy {
namespace {

TEST(OrderPrecision, AnOlderOrderIsNoBetterAndNoneIsFarWorse) {
  const OrderPrecision t = MeasureOrderPrecision(LoadScenario("monster"), {.quick = true});
  const auto find = [&](std::string_view begin) {
    for (const OrderRow& row : t.rows)
      if (row.name.starts_with(begin)) return row;
    ADD_FAILURE() << begin;
    return OrderRow{};
  };
  const OrderRow sorted = find("sorted"), half = find("every 2nd"), eighth = find("every 8th");
  const OrderRow unsorted = find("strand order"), reversed = find("near to far");
  EXPECT_GE(sorted.psnr_db, half.psnr_db);
  EXPECT_GT(half.psnr_db, eighth.psnr_db);
  EXPECT_GT(sorted.psnr_db, unsorted.psnr_db + 3.0);
  EXPECT_GT(unsorted.psnr_db, reversed.psnr_db);
  EXPECT_LT(sorted.wrong_pixels, reversed.wrong_pixels);
  EXPECT_GT(sorted.sort_ns, 0.0);
  EXPECT_EQ(half.sort_ns, 0.5 * sorted.sort_ns);
  EXPECT_EQ(unsorted.sort_ns, 0.0);
  EXPECT_LT(reversed.sort_ns, 0.0);
  // Level of detail leaves something out, and costs less to sort.
  const OrderRow far = find("8 times as far, every frame"),
                 lod = find("8 times as far, every frame, --lod");
  EXPECT_LT(lod.psnr_db, far.psnr_db);
  EXPECT_GT(lod.psnr_db, 20.0);
  EXPECT_GT(lod.wrong_pixels, far.wrong_pixels);
  EXPECT_LT(lod.sort_ns, far.sort_ns);
  EXPECT_GT(lod.sort_ns, 0.0);
  EXPECT_GT(t.drawn_strands, 100.0);
  EXPECT_LE(t.drawn_strands, double(t.strands));
}

}  // namespace
}  // namespace pelt::accuracy
