// Chains with traits of their own: one like any other keeps its bits, a lane's traits are its own, drag is what a
// layer's would be, and no link bends beyond its limit. Whole frames: tests/jobs/traits_test.cpp.
#include "core/kernels/traits.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "core/exact_math.hpp"
#include "core/kernels/frame_table.hpp"
#include "tests/kernels/chain_scene.hpp"

namespace pelt::test {
namespace {

TraitBlock PlainTraits() {
  TraitBlock own;
  const auto fill = [](auto& row, float value) {
    std::fill(std::begin(row), std::end(row), value);
  };
  for (auto& row : own.stiffness) fill(row, 1.0f);
  for (auto* row : {&own.clump, &own.weight, &own.bounce}) fill(*row, 1.0f);
  fill(own.drag, 0.0f);
  fill(own.least_cosine, -2.0f);
  return own;
}

// A frame of a kernel, with traits where there are some.
template <uint32_t kPoints>
void Step(const std::string& kernel, const TraitBlock* own, ChainScene<kPoints>& s,
          Isa isa = BestIsa()) {
  std::vector<Binding> blocks = {BindOne(s.layer), BindOne(s.state), BindOne(s.rest),
                                 BindOne(s.roots), BindOne(s.wind)};
  if (kernel != "simulate_pbd_vertex") blocks.push_back(BindOne(s.strands));
  blocks.insert(blocks.end(), {BindOne(s.position), BindOne(s.previous)});
  if (own) blocks.push_back(BindOne(*own));
  const KernelDesc& run = *FindKernels(isa)->Find(own ? kernel + "_traits" : kernel);
  ASSERT_EQ(run.ports.size(), blocks.size());
  run.run(&s.params, blocks.data());
  s.state.flags &= ~uint32_t(kChunkRestart);
}

// Calls visit.operator()<kPoints>(kernel).
void ForEverySolver(auto visit) {
  visit.template operator()<4>("simulate_pbd_vertex");
  visit.template operator()<4>("simulate_pbd_4");
  visit.template operator()<5>("simulate_pbd_5");
  visit.template operator()<4>("simulate_verlet_4");
  visit.template operator()<5>("simulate_verlet_5");
}

TEST(Traits, OfAStrandLikeAnyOtherChangeNoBit) {
  const TraitBlock plain = PlainTraits();
  ForEverySolver([&]<uint32_t kPoints>(const char* kernel) {
    auto with = NewScene<kPoints>(), without = NewScene<kPoints>();
    for (uint32_t seed = 1; seed <= 20; ++seed) {
      MakeRandom(*with, seed);
      *without = *with;
      for (int frame = 0; frame < 3; ++frame) {
        Step(kernel, &plain, *with);
        Step(kernel, nullptr, *without);
      }
      EXPECT_TRUE(SameChains(*with, *without)) << kernel << " " << seed;
    }
  });
}

// Of every kind, some at their bounds.
TraitBlock RandomTraits(uint32_t seed) {
  std::mt19937 random(seed);
  TraitBlock own = PlainTraits();
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    for (auto& row : own.stiffness) row[lane] = Uniform(random, 0.0f, 3.0f);
    own.drag[lane] = Uniform(random, -3.0f, 30.0f);
    for (auto* row : {&own.clump, &own.weight, &own.bounce})
      (*row)[lane] = random() % 4 == 0 ? 0.0f : Uniform(random, 0.0f, 3.0f);
    own.least_cosine[lane] = random() % 3 == 0 ? -2.0f : Uniform(random, -1.0f, 1.0f);
  }
  return own;
}

TEST(Traits, HaveTheSameBitsOnEverySet) {
  ForEverySolver([&]<uint32_t kPoints>(const char* kernel) {
    auto start = NewScene<kPoints>(), wanted = NewScene<kPoints>(), got = NewScene<kPoints>();
    for (uint32_t seed = 1; seed <= 8; ++seed) {
      const TraitBlock own = RandomTraits(seed);
      MakeRandom(*start, seed);
      start->params.rest_threshold = seed % 2 ? 0.3f : 0.0f;
      *wanted = *start;
      for (int frame = 0; frame < 3; ++frame) Step(kernel, &own, *wanted, Isa::kReference);
      ExpectFinite(*wanted, wanted->position);
      for (const Isa isa : kAllIsas) {
        if (!FindKernels(isa)) continue;
        *got = *start;
        for (int frame = 0; frame < 3; ++frame) Step(kernel, &own, *got, isa);
        EXPECT_TRUE(SameChains(*wanted, *got)) << kernel << " " << IsaName(isa) << " " << seed;
      }
    }
  });
}

// Chains that are shaken; a lane has traits of its own, none of its neighbours moves by a bit.
TEST(Traits, ActOnTheirLaneAlone) {
  constexpr uint32_t kLane = 37;
  const std::function<void(TraitBlock&)> changes[] = {
      [](TraitBlock& own) { own.stiffness[1][kLane] = 2.0f; },
      [](TraitBlock& own) { own.drag[kLane] = 20.0f; },
      [](TraitBlock& own) { own.clump[kLane] = 0.5f; },
      [](TraitBlock& own) { own.weight[kLane] = 2.0f; },
      [](TraitBlock& own) { own.least_cosine[kLane] = 0.999f; }};
  const auto run = [](const TraitBlock& own) {
    auto s = NewScene<5>();
    MakeOrderly(*s, 3);
    for (uint32_t lane = 16; lane < kStrandsPerChunk; ++lane)  // near what they follow
      for (int k = 0; k < 3; ++k)
        s->roots.position[k][lane] =
            s->roots.position[k][s->strands.control[lane]] + 0.002f * float((lane >> k) % 3);
    s->layer.flags |= kLayerClump;
    s->layer.clump = 0.4f;
    for (int frame = 0; frame < 6; ++frame) {
      MoveRoots(*s, frame % 2 ? 0.01f : -0.01f, 0.0f, 0.0f);
      Step("simulate_pbd_5", &own, *s);
    }
    return s;
  };
  const auto plain = run(PlainTraits());
  for (const auto& change : changes) {
    TraitBlock own = PlainTraits();
    change(own);
    const auto s = run(own);
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
      const double off =
          Length(At(s->position.position[3], lane) - At(plain->position.position[3], lane));
      if (lane == kLane)
        EXPECT_GT(off, 1e-5) << &change - changes;
      else
        EXPECT_EQ(off, 0.0) << &change - changes << ", lane " << lane;
    }
  }
}

TEST(Traits, DragIsWhatALayersWouldBe) {
  for (const float drag : {-3.0f, 0.5f, 30.0f}) {
    auto of_lanes = NewScene<4>(), of_layer = NewScene<4>();
    MakeOrderly(*of_lanes, 7);
    of_lanes->params.rest_threshold = 0.0f;
    *of_layer = *of_lanes;
    const double keep = double(of_lanes->layer.link.velocity_keep);
    of_layer->layer.link.velocity_keep = float(keep * std::exp(-double(drag) / 60.0));
    TraitBlock own = PlainTraits();
    std::fill(std::begin(own.drag), std::end(own.drag), drag);
    for (int frame = 0; frame < 30; ++frame) {
      for (auto* s : {&*of_lanes, &*of_layer}) MoveRoots(*s, frame < 10 ? 0.01f : 0.0f, 0, 0);
      Step("simulate_pbd_4", &own, *of_lanes);
      Step("simulate_pbd_4", nullptr, *of_layer);
    }
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
      EXPECT_LT(Length(At(of_lanes->position.position[2], lane) -
                       At(of_layer->position.position[2], lane)),
                2e-5)
          << drag << ", lane " << lane;
  }
}

// Of any links of a chain: the largest angle between where one is and where the link above it would carry it from
// the groom, degrees.
template <uint32_t kPoints>
double WorstBend(const ChainScene<kPoints>& s, uint32_t lane) {
  const std::vector<Double3> groom = GroomOf(s.rest, s.roots, lane);
  Double3 before = At(s.roots.position, lane), groom_before = before, above{}, groom_above{};
  double worst = 0.0;
  for (uint32_t i = 0; i + 1 < kPoints; ++i) {
    const Double3 point = At(s.position.position[i], lane);
    const Double3 link = Unit(point - before), straight = Unit(groom[i] - groom_before);
    Double3 carried = straight;
    if (i > 0) {
      const Double3 axis = Cross(groom_above, above);
      const double cosine = Dot(groom_above, above);
      carried =
          straight * cosine + Cross(axis, straight) + axis * (Dot(axis, straight) / (1.0 + cosine));
    }
    const double bend = std::acos(std::min(1.0, Dot(carried, link))) / exact::kRadiansPerDegree;
    worst = std::max(worst, bend);
    before = point, groom_before = groom[i], above = link, groom_above = straight;
  }
  return worst;
}

constexpr double kLimit_degrees = 20.0;

// Soft chains that hang and are shaken; even lanes have the limit.
template <uint32_t kPoints>
std::unique_ptr<ChainScene<kPoints>> MakeSoft(TraitBlock& own) {
  auto s = NewScene<kPoints>();
  MakeOrderly(*s, 11);
  s->layer.link.angular_middle = s->layer.link.angular_end = s->layer.link.stiffness = 0.02f;
  s->layer.surface_hardness = 0.0f;
  own = PlainTraits();
  for (uint32_t lane = 0; lane < kStrandsPerChunk; lane += 2)
    own.least_cosine[lane] = float(std::cos(kLimit_degrees * exact::kRadiansPerDegree));
  return s;
}

TEST(Traits, NoLinkBendsBeyondItsLimit) {
  ForEverySolver([&]<uint32_t kPoints>(const char* kernel) {
    TraitBlock own;
    auto s = MakeSoft<kPoints>(own);
    s->params.rest_threshold = 0.0f;
    double limited = 0.0, free = 0.0;
    for (int frame = 0; frame < 120; ++frame) {
      MoveRoots(*s, frame % 20 < 10 ? 0.01f : -0.01f, 0.0f, 0.0f);
      Step(kernel, &own, *s);
      for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
        double& worst = lane % 2 == 0 ? limited : free;
        worst = std::max(worst, WorstBend(*s, lane));
      }
    }
    EXPECT_LT(limited, kLimit_degrees + 0.1) << kernel;
    EXPECT_GT(limited, kLimit_degrees - 0.1) << kernel << ": some reach it";
    EXPECT_GT(free, 2.0 * kLimit_degrees) << kernel;
  });
}

// A limit turns a link without turning the one above it back: still no chain goes on for ever.
TEST(Traits, ChainsComeToRestOnTheirLimits) {
  ForEverySolver([&]<uint32_t kPoints>(const char* kernel) {
    TraitBlock own;
    auto s = MakeSoft<kPoints>(own);
    int frame = 0;
    do {
      Step(kernel, &own, *s);
    } while (s->state.state_changed != 0 && ++frame < 600);
    RecordProperty(std::string("frames_to_rest ") + kernel, frame);
    EXPECT_LT(frame, 600) << kernel;
  });
}

}  // namespace
}  // namespace pelt::test
