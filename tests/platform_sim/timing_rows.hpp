// Listings through the SPU's issue, for tests. The measured rows' listings are the table's own
// (platform_sim/rows/row_listings.hpp).
#pragma once

// As in pelt_platform_sim: these tests link no fmt of their own.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "platform_sim/pipeline/listing.hpp"
#include "platform_sim/pipeline/spu_core.hpp"
#include "platform_sim/platforms/spu.hpp"
#include "platform_sim/rows/row_listings.hpp"
#include "tests/source_folder.hpp"
#include "tests/test_folder.hpp"

namespace pelt::testing {

// Statements, a line each.
struct ListingText {
  void Line(const std::string& statement) { text += "  " + statement + "\n"; }

  std::string text;
};

inline IssueChart TimeOnSpu(const std::string& text, const SpuParameters& spu = {},
                            const SpuRules& rules = {}, uint64_t iterations = 100'000) {
  const Listing listing = ReadListing(text, "row.s", SpuInstructionSet()).OrThrow();
  std::vector<TripCount> trips;
  if (const ListingLabel* loop = listing.FindLabel("loop"))
    trips.push_back({loop->index, iterations});
  return pelt::TimeOnSpu(listing.program, trips, rules, spu).OrThrow();
}

inline std::string ReadListingFile(const std::string& name) {
  return test::ReadText(test::SourceFolder() + "/tests/platform_sim/listings/" + name);
}

// The cycles at which the instructions of the first pass are issued.
using At = std::vector<int64_t>;
inline At CyclesOf(const std::string& text, const SpuParameters& spu = {},
                   const SpuRules& rules = {}) {
  At out;
  for (const IssueSlot& slot : TimeOnSpu(text, spu, rules).first_pass) out.push_back(slot.cycle);
  return out;
}

inline void ExpectAllCyclesAccountedFor(const IssueTotals& totals) {
  EXPECT_EQ(uint64_t(totals.cycles), totals.IssueCycles() + totals.AllStallCycles());
  uint64_t unpaired = 0;
  for (const uint64_t count : totals.unpaired) unpaired += count;
  EXPECT_EQ(unpaired, totals.instructions);
  EXPECT_EQ(totals.unpaired[uint32_t(Unpaired::kPaired)], totals.dual_issues);
}

inline double CyclesPerIteration(const IssueChart& chart) {
  return chart.loops.size() == 1 && chart.loops[0].steady ? chart.loops[0].CyclesPerIteration()
                                                          : -1.0;
}

}  // namespace pelt::testing
