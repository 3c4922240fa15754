// A digest that leaves something out, or does not know order, is found.
#include <gtest/gtest.h>

#include "tests/jobs/tiny_scene.hpp"
#include "tests/verify/planting.hpp"
#include "traces/digest.hpp"

namespace pelt::testing {
namespace {

VerifyReport RunDigests(std::function<uint64_t(const FurScene&, Stream)> digest_stream,
                        const Scenario& scenario = Tiny()) {
  VerifyOptions options = NoCases(6);
  options.checks = true;
  options.sections = {"digest"};
  options.digest_stream = std::move(digest_stream);
  return Verify(scenario, options);
}

TEST(VerifyDigests, HealthyDigestsSeeEverything) {
  Scenario scenario = EveryOutputScenario();
  scenario.velocities = true;
  const VerifyReport report = RunDigests({}, scenario);
  EXPECT_TRUE(report.Passed()) << DescribeReport(report);
  uint32_t values = 0;
  for (uint32_t s = 0; s < kStreamCount; ++s)
    values += DescribeStream(Stream(s)).role == Role::kValue;
  // Every value stream with the sorted vertices; all but instances without.
  const auto checks = ChecksOf(report, "digest");
  EXPECT_EQ(checks.size(), 2 + 2 * values - 1);
  for (const CheckResult& c : checks) EXPECT_GT(c.seen, 0u) << c.name;
}

TEST(VerifyDigests, AStreamLeftOutIsFound) {
  const VerifyReport report = RunDigests([](const FurScene& scene, Stream stream) {
    return stream == StreamOf<&Streams::instances> ? 0 : scene.DigestStream(stream);
  });
  const auto checks = ChecksOf(report, "digest");
  EXPECT_TRUE(AnyFailed(checks, FindingKind::kDigest, "stream instances"));
  EXPECT_FALSE(AnyFailed(checks, FindingKind::kDigest, "stream curves"));
}

TEST(VerifyDigests, AnItemOrALaneLeftOutIsFound) {
  const auto without = [](bool lane) {
    return [lane](const FurScene& scene, Stream stream) {
      if (stream != StreamOf<&Streams::roots>) return scene.DigestStream(stream);
      Digest digest;
      uint32_t items = scene.shape().chunk_count;
      const auto block = [&](uint32_t c) { return scene.memory().Block(stream, c); };
      // Layers of shells have none, and others may be out of view.
      const auto live = [&](uint32_t c) { return block(c) ? scene.LiveLanes(stream, c) : 0u; };
      while (items > 0 && live(items - 1) == 0) --items;
      for (uint32_t c = 0; c < (lane ? items : items - 1); ++c)
        if (live(c) > 0)
          AddBlock(digest, DescribeStream(stream), block(c), live(c) - (lane ? 1 : 0));
      return digest.Value();
    };
  };
  for (const bool lane : {false, true}) {
    const VerifyReport report = RunDigests(without(lane));
    EXPECT_TRUE(AnyFailed(ChecksOf(report, "digest"), FindingKind::kDigest, "stream roots"))
        << (lane ? "lane" : "item");
  }
}

// A sum of its words: what a digest must not be.
TEST(VerifyDigests, ADigestThatDoesNotKnowOrderIsFound) {
  const VerifyReport report = RunDigests([](const FurScene& scene, Stream stream) {
    const StreamDesc& desc = DescribeStream(stream);
    uint64_t sum = 0;
    for (uint32_t i = 0; i < scene.shape().ItemCount(desc.domain); ++i) {
      const std::byte* block = scene.memory().Block(stream, i);
      if (!block) continue;
      const uint32_t live = scene.LiveLanes(stream, i);
      for (const RowDesc& row : desc.rows)
        for (uint32_t e = 0; e < row.element_count; ++e) {
          const uint32_t lane =
              row.lane_major ? e / (row.element_count / row.lane_count) : e % row.lane_count;
          if (!desc.lanes.AllHoldValues() && lane >= live) continue;
          Digest word;
          word.Add(RowElement(block, row, e));
          sum += word.Value();
        }
    }
    return sum;
  });
  const auto checks = ChecksOf(report, "digest");
  for (const char* stream : {"stream roots", "stream curves", "stream sort_keys"})
    EXPECT_TRUE(AnyFailed(checks, FindingKind::kDigest, stream)) << stream;
}

}  // namespace
}  // namespace pelt::testing
