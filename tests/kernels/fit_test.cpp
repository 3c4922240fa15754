#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/kernels/fit_cubic.hpp"
#include "core/kernels/fit_ribbon.hpp"
#include "tests/kernels/chain_scene.hpp"

namespace pelt::test {
namespace {

using V = Vec<IsaSse4>;

template <uint32_t kPoints>
struct FitScene {
  LayerBlock layer;
  ChunkStateBlock state;
  StrandBlock strands;
  RootBlock roots;
  PointBlock<kPoints> points;
};

template <uint32_t kPoints>
std::unique_ptr<FitScene<kPoints>> MakeScene(uint32_t seed, bool weather) {
  auto chains = std::make_unique<ChainScene<kPoints>>();
  MakeRandom(*chains, seed);
  auto s = std::make_unique<FitScene<kPoints>>();
  s->layer = chains->layer;
  s->state = chains->state;
  s->strands = chains->strands;
  s->roots = chains->roots;
  s->points = chains->position;
  std::mt19937 random(seed);
  s->layer.scale = 1.5f;
  s->layer.darken = weather ? 0.6f : 1.0f;
  s->layer.dirt = weather ? 0.7f : 0.0f;
  for (float& c : s->layer.dirt_colour) c = Uniform(random, 0.0f, 1.0f);
  s->state.live_exact = float(s->state.live_strands) - 0.25f;
  s->state.fade_count = weather ? 20.0f : 0.0f;
  s->strands.first_strand = 7 * kStrandsPerChunk;
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    s->strands.width[lane] = Uniform(random, 1e-4f, 1e-3f);
    s->strands.base_colour[lane] = uint32_t(random());
    s->strands.tip_colour[lane] = uint32_t(random());
    s->strands.film_strip[lane] = uint8_t(random());
  }
  return s;
}

template <class K, class Scene, class Block>
void Fit(Scene& s, Block& out) {
  Poison(out);
  RunOnBlocks<K>(nullptr, s.layer, s.state, s.strands, s.roots, s.points, out);
}

// Colour as the header of strand_look.hpp says, byte by byte.
template <class Scene>
uint32_t WantedColour(const Scene& s, uint32_t colour, uint32_t lane) {
  uint32_t out = 0;
  for (int k = 0; k < 3; ++k) {
    const double clean = double(colour >> (8 * k) & 255) * s.layer.darken;
    const double mixed = clean + (s.layer.dirt_colour[k] * 255.0 - clean) * double(s.layer.dirt);
    out |= uint32_t(std::lround(mixed)) << (8 * k);
  }
  double alpha = colour >> 24;
  if (s.state.fade_count > 0)
    alpha *= std::clamp((double(s.state.live_exact) - lane) / s.state.fade_count, 0.0, 1.0);
  return out | uint32_t(std::lround(alpha)) << 24;
}

// Each byte within one: a sum in floats may fall on the other side of a half.
void ExpectNearColour(uint32_t got, uint32_t wanted, uint32_t lane) {
  for (int k = 0; k < 4; ++k)
    EXPECT_NEAR(int(got >> (8 * k) & 255), int(wanted >> (8 * k) & 255), 1) << lane;
}

template <class Scene, class Record>
void ExpectLook(const Scene& s, const Record& record, uint32_t lane, bool exact) {
  const uint32_t base = WantedColour(s, s.strands.base_colour[lane], lane);
  const uint32_t tip = WantedColour(s, s.strands.tip_colour[lane], lane);
  ExpectNearColour(record.base_colour, base, lane);
  ExpectNearColour(record.tip_colour, tip, lane);
  if (exact) {  // dry, clean, no fade: not a bit changed
    EXPECT_EQ(record.base_colour, s.strands.base_colour[lane]);
    EXPECT_EQ(record.tip_colour, s.strands.tip_colour[lane]);
  }
  EXPECT_FLOAT_EQ(record.width, s.strands.width[lane] * 1.5f);
  EXPECT_EQ(record.tag, (7 * kStrandsPerChunk + lane) | uint32_t(s.strands.film_strip[lane]) << 24);
}

TEST(FitCubic, DirtAloneIsSeen) {
  auto s = MakeScene<4>(19, false);
  s->layer.dirt = 0.4f;
  CurveBlock out;
  Fit<FitCubic<V, 4>>(*s, out);
  for (uint32_t lane = 0; lane < s->state.live_strands; ++lane)
    ExpectLook(*s, out.record[lane], lane, false);
}

Double3 Evaluate(const CurveRecord& r, double t) {
  Double3 sum{};
  for (int j = 3; j >= 0; --j) sum = sum * t + Of(r.curve[j]);
  return sum;
}

template <uint32_t kPoints>
double SumOfSquares(const FitScene<kPoints>& s, const CurveRecord& r, uint32_t lane) {
  double sum = 0.0;
  for (uint32_t i = 0; i + 1 < kPoints; ++i) {
    const Double3 miss =
        Evaluate(r, double(i + 1) / (kPoints - 1)) - At(s.points.position[i], lane);
    sum += Dot(miss, miss);
  }
  return sum;
}

TEST(FitCubic, FourPointsAreMet) {
  auto curves = std::make_unique<CurveBlock>();
  for (uint32_t seed = 1; seed <= 20; ++seed) {
    auto s = MakeScene<4>(seed, seed % 2);
    Fit<FitCubic<V, 4>>(*s, *curves);
    for (uint32_t lane = 0; lane < s->state.live_strands; ++lane) {
      const CurveRecord& r = curves->record[lane];
      for (int k = 0; k < 3; ++k) EXPECT_EQ(r.curve[0][k], s->roots.position[k][lane]);
      EXPECT_LT(SumOfSquares(*s, r, lane), 1e-12);
      ExpectLook(*s, r, lane, seed % 2 == 0);
    }
  }
}

// The reference: the minimum of a quadratic has no downhill direction; probed along every
// coefficient.
template <uint32_t kPoints>
void ExpectTheLeastSquaresFit() {
  auto curves = std::make_unique<CurveBlock>();
  for (uint32_t seed = 1; seed <= 10; ++seed) {
    auto s = MakeScene<kPoints>(seed, false);
    Fit<FitCubic<V, kPoints>>(*s, *curves);
    for (uint32_t lane = 0; lane < s->state.live_strands; ++lane) {
      const CurveRecord& r = curves->record[lane];
      for (int k = 0; k < 3; ++k) EXPECT_EQ(r.curve[0][k], s->roots.position[k][lane]);
      for (int j = 1; j < 4; ++j)
        for (int k = 0; k < 3; ++k) {
          double gradient = 0.0;
          for (uint32_t i = 0; i + 1 < kPoints; ++i) {
            const double t = (i + 1) / double(kPoints - 1);
            const Double3 miss = Evaluate(r, t) - At(s->points.position[i], lane);
            gradient += std::pow(t, j) * (k == 0 ? miss.x : k == 1 ? miss.y : miss.z);
          }
          EXPECT_LT(std::abs(gradient), 2e-6) << "lane " << lane << " c" << j;
        }
      ExpectLook(*s, r, lane, true);
    }
  }
}

TEST(FitCubic, FivePointsAreTheLeastSquaresFit) { ExpectTheLeastSquaresFit<5>(); }
TEST(FitCubic, NinePointsAreTheLeastSquaresFit) { ExpectTheLeastSquaresFit<9>(); }

template <uint32_t kPoints, class Expect>
void ForEachRibbon(Expect expect) {
  auto ribbons = std::make_unique<RibbonBlock>();
  for (uint32_t seed = 1; seed <= 20; ++seed) {
    auto s = MakeScene<kPoints>(seed, seed % 2);
    Fit<FitRibbon<V, kPoints>>(*s, *ribbons);
    for (uint32_t lane = 0; lane < s->state.live_strands; ++lane) {
      const RibbonRecord& r = ribbons->record[lane];
      const auto place = [&](uint32_t q) { return Of(r.point[q]); };
      EXPECT_EQ(Length(place(0) - At(s->roots.position, lane)), 0.0);
      EXPECT_EQ(Length(place(4) - At(s->points.position[kPoints - 2], lane)), 0.0);
      for (uint32_t q = 1; q < 4; ++q) expect(*s, lane, q, place(q));
      ExpectLook(*s, r, lane, seed % 2 == 0);
      EXPECT_EQ(r.pad, 0u);
    }
  }
}

// The reference: Neville's scheme in double.
TEST(FitRibbon, FourPointsLieOnTheCubicThroughThem) {
  ForEachRibbon<4>([](const FitScene<4>& s, uint32_t lane, uint32_t q, Double3 place) {
    Double3 p[4] = {At(s.roots.position, lane)};
    for (int i = 0; i < 3; ++i) p[i + 1] = At(s.points.position[i], lane);
    const double x = 0.75 * q;
    for (int span = 1; span < 4; ++span)
      for (int i = 0; i + span < 4; ++i) p[i] = p[i] + (p[i + 1] - p[i]) * ((x - i) / span);
    EXPECT_LT(Length(place - p[0]), 1e-6) << "lane " << lane << " point " << q;
  });
}
template <uint32_t kPoints>
void ExpectTheStrandsOwnPoints() {
  ForEachRibbon<kPoints>([](const FitScene<kPoints>& s, uint32_t lane, uint32_t q, Double3 place) {
    EXPECT_EQ(Length(place - At(s.points.position[q * (kPoints - 1) / 4 - 1], lane)), 0.0)
        << "lane " << lane << " point " << q;
  });
}
TEST(FitRibbon, HasTheStrandsOwnOfFivePoints) { ExpectTheStrandsOwnPoints<5>(); }
TEST(FitRibbon, HasTheStrandsOwnOfNinePoints) { ExpectTheStrandsOwnPoints<9>(); }

template <template <class> class Kernel, class Block, uint32_t kPoints>
void ExpectSameBitsEverywhere() {
  auto wanted = std::make_unique<Block>(), got = std::make_unique<Block>();
  for (uint32_t seed = 1; seed <= 6; ++seed) {
    auto s = MakeScene<kPoints>(seed, seed % 2);
    Fit<Kernel<V>>(*s, *wanted);
    ForEveryVector([&]<class W>(const char* name) {
      Fit<Kernel<W>>(*s, *got);
      EXPECT_EQ(std::memcmp(wanted.get(), got.get(), sizeof(Block)), 0) << name << " " << seed;
    });
  }
}
template <class W>
using Cubic4 = FitCubic<W, 4>;
template <class W>
using Cubic5 = FitCubic<W, 5>;
template <class W>
using Cubic9 = FitCubic<W, 9>;
template <class W>
using Ribbon4 = FitRibbon<W, 4>;
template <class W>
using Ribbon5 = FitRibbon<W, 5>;
template <class W>
using Ribbon9 = FitRibbon<W, 9>;

TEST(FitCubic, SameBitsOnEveryVector) {
  ExpectSameBitsEverywhere<Cubic4, CurveBlock, 4>();
  ExpectSameBitsEverywhere<Cubic5, CurveBlock, 5>();
  ExpectSameBitsEverywhere<Cubic9, CurveBlock, 9>();
}
TEST(FitRibbon, SameBitsOnEveryVector) {
  ExpectSameBitsEverywhere<Ribbon4, RibbonBlock, 4>();
  ExpectSameBitsEverywhere<Ribbon5, RibbonBlock, 5>();
  ExpectSameBitsEverywhere<Ribbon9, RibbonBlock, 9>();
}

TEST(FitCubic, FadeGoesFromNothingAtTheEndOfThePrefixToAll) {
  auto s = MakeScene<4>(3, false);
  s->state.live_strands = 60;
  s->state.live_exact = 59.5f;
  s->state.fade_count = 10.0f;
  for (uint32_t& c : s->strands.base_colour) c = 0xff102030u;
  auto curves = std::make_unique<CurveBlock>();
  Fit<FitCubic<V, 4>>(*s, *curves);
  EXPECT_EQ(curves->record[49].base_colour, 0xff102030u);
  uint32_t last = 255;
  for (uint32_t lane = 50; lane < 60; ++lane) {
    const uint32_t alpha = curves->record[lane].base_colour >> 24;
    EXPECT_LT(alpha, last);
    last = alpha;
  }
  EXPECT_LT(last, 16u);
}

}  // namespace
}  // namespace pelt::test
