// A groom resampled to the fewest points is the groom that a bake with as many gives, as near as
// strands bent in fewer places can be, and nothing else of it changes.
#include "core/groom/fewer_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>

#include "core/character/builtin_character.hpp"
#include "core/character/pose.hpp"
#include "core/groom/bake.hpp"
#include "core/groom/groom_file.hpp"
#include "tests/source_folder.hpp"

namespace pelt {
namespace {

template <class T>
bool SameBytes(const std::vector<T>& a, const std::vector<T>& b) {
  return std::ranges::equal(std::as_bytes(std::span(a)), std::as_bytes(std::span(b)));
}

struct Resampled {
  Groom from, to, baked;  // `baked`: with four points

  explicit Resampled(const std::string& setup_name) {
    const Character character = MakeBuiltinCharacter({.tiny = true});
    const RestGeometry rest = ComputeRestGeometry(character, 1.0f);
    FurSetup setup =
        ReadFurSetupFile(test::SourceFolder() + "/bench/scenarios/setups/" + setup_name + ".toml");
    from = BakeGroom(character, rest, setup, 1.0f);
    to = ResampleToFewestPoints(from);
    for (LayerSetup& layer : setup.layers) layer.params.points = 4;
    baked = BakeGroom(character, rest, setup, 1.0f);
  }
};

// The largest distance of a point from where the bake has it, in lengths of its strand.
double FarthestApart(const Groom& a, const Groom& b) {
  double most = 0.0;
  for (size_t c = 0; c < a.strand_rest4.size(); ++c)
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
      for (int i = 0; i < 3; ++i) {
        double square = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
          const double d = double(a.strand_rest4[c].offset[i][axis][lane]) -
                           double(b.strand_rest4[c].offset[i][axis][lane]);
          square += d * d;
        }
        most = std::max(most, std::sqrt(square) / double(a.strands[c].length[lane]));
      }
  return most;
}

TEST(FewerPoints, IsTheGroomOfABakeWithFewerPoints) {
  for (const char* name : {"tiny", "eyepet"}) {
    SCOPED_TRACE(name);
    const Resampled r(name);
    EXPECT_TRUE(HasMorePoints(r.from));
    EXPECT_FALSE(HasMorePoints(r.to));
    EXPECT_EQ(FindGroomFault(r.to, name), "");
    EXPECT_TRUE(r.to.strand_rest5.empty());
    ASSERT_EQ(r.to.strand_rest4.size(), r.baked.strand_rest4.size());
    EXPECT_TRUE(SameBytes(r.to.mesh, r.baked.mesh));
    EXPECT_TRUE(SameBytes(r.to.strands, r.baked.strands));
    EXPECT_TRUE(SameBytes(r.to.halo, r.baked.halo));
    EXPECT_TRUE(SameBytes(r.to.vertex_rest, r.baked.vertex_rest));
    EXPECT_LT(FarthestApart(r.to, r.baked), 0.05);
    for (size_t c = 0; c < r.to.strand_rest4.size(); ++c) {
      const RestBlock<4>&is = r.to.strand_rest4[c], &baked = r.baked.strand_rest4[c];
      EXPECT_EQ(std::memcmp(is.strength, baked.strength, sizeof is.strength), 0);
      for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
        ASSERT_NEAR(is.segment_length[lane], baked.segment_length[lane],
                    1e-6 * baked.segment_length[lane]);
    }
  }
}

TEST(FewerPoints, OfNineAreFour) {
  const Character character = MakeBuiltinCharacter({.tiny = true});
  const RestGeometry rest = ComputeRestGeometry(character, 1.0f);
  FurSetup setup = ReadFurSetup(
      "[[layer]]\nname = 'mane'\nchain = 'strand'\npoints = 9\nmax_strands = 200\ncurl = 200\n",
      "mane", ".");
  const Groom from = BakeGroom(character, rest, setup, 1.0f);
  ASSERT_GT(from.strand_rest9.size(), 0u);
  EXPECT_TRUE(from.strand_rest4.empty());
  EXPECT_EQ(FindGroomFault(from, "nine"), "");
  EXPECT_TRUE(HasMorePoints(from));
  const Groom to = ResampleToFewestPoints(from);
  EXPECT_EQ(FindGroomFault(to, "four"), "");
  EXPECT_TRUE(to.strand_rest9.empty());
  setup.layers[0].params.points = 4;
  const Groom baked = BakeGroom(character, rest, setup, 1.0f);
  ASSERT_EQ(to.strand_rest4.size(), baked.strand_rest4.size());
  EXPECT_LT(FarthestApart(to, baked), 0.05);
}

// Layers that have four already keep every bit, wherever they stand among the others.
TEST(FewerPoints, LeavesStrandsOfFourAsTheyAre) {
  const Resampled r("tiny");
  size_t four = 0, chunk = 0, kept = 0;
  for (const GroomLayer& layer : r.from.layers)
    for (uint32_t c = 0; c < layer.chunk_count; ++c, ++chunk) {
      if (layer.params.points != 4) continue;
      EXPECT_EQ(std::memcmp(&r.from.strand_rest4[four++], &r.to.strand_rest4[chunk],
                            sizeof(RestBlock<4>)),
                0);
      ++kept;
    }
  EXPECT_GT(kept, 0u);
  EXPECT_LT(kept, chunk);
  const Groom again = ResampleToFewestPoints(r.to);
  EXPECT_TRUE(SameBytes(again.strand_rest4, r.to.strand_rest4));
}

// A strand folded back on itself has a segment without a direction.
TEST(FewerPoints, AFoldedStrandStaysFinite) {
  Groom groom = Resampled("tiny").from;
  RestBlock<5>& rest = groom.strand_rest5[0];
  for (int i = 0; i < 4; ++i)
    for (int axis = 0; axis < 3; ++axis)
      for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
        rest.offset[i][axis][lane] = axis == 2 && i % 2 == 0 ? rest.segment_length[lane] : 0.0f;
  ASSERT_EQ(FindGroomFault(groom, "folded"), "");
  EXPECT_EQ(FindGroomFault(ResampleToFewestPoints(groom), "folded"), "");
}

}  // namespace
}  // namespace pelt
