// Fur scales with its character: lengths, widths, bounds and shells, from frame to frame.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "tests/jobs/non_finite.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

Scenario CalmScenario() {
  Scenario scenario = EveryOutputScenario();
  scenario.actors[0].teleport_frame = -1;
  scenario.spheres.clear();
  scenario.base.wind = {};
  scenario.base.skip.cull = false;
  return scenario;
}

void Scale(Scenario& scenario, const glm::mat4& placement, glm::vec3 by) {
  scenario.actors[0].placement = placement;
  for (int c = 0; c < 3; ++c) scenario.actors[0].placement[c] *= by[c];
}

struct Sizes {
  double length = 0.0, width = 0.0, shell = 0.0;  // sums over all strands, m
  uint32_t strands = 0;
  bool in_box = true;
};

template <uint32_t kPoints>
double LengthOf(const RootBlock& roots, const PointBlock<kPoints>& points, uint32_t lane) {
  double length = 0.0;
  for (uint32_t i = 0; i < kPoints - 1; ++i) {
    double square = 0.0;
    for (int k = 0; k < 3; ++k) {
      const float upper = i == 0 ? roots.position[k][lane] : points.position[i - 1][k][lane];
      const double d = double(points.position[i][k][lane]) - upper;
      square += d * d;
    }
    length += std::sqrt(square);
  }
  return length;
}

Sizes SizesOf(FurScene& scene) {
  Sizes sizes;
  const FrameMemory& memory = scene.memory();
  for (const LayerDraw& draw : scene.Draws()) {
    for (const ShellVertex& vertex :
         draw.As<ShellVertex>().first(draw.output == Output::kShells ? 16 : 0))
      sizes.shell += std::sqrt(double(vertex.groom[0]) * vertex.groom[0] +
                               double(vertex.groom[1]) * vertex.groom[1] +
                               double(vertex.groom[2]) * vertex.groom[2]);
    std::vector<StrandCurve> curves(draw.live_strands);
    scene.CopyCurves(draw.layer, curves);
    for (const StrandCurve& curve : curves) {
      sizes.width += curve.point[0][3];
      for (const auto& p : curve.point)
        for (int k = 0; k < 3; ++k)
          sizes.in_box = sizes.in_box && p[k] >= draw.low[k] && p[k] <= draw.high[k];
    }
  }
  for (uint32_t c = 0; c < scene.shape().chunk_count; ++c) {
    if (scene.shape().layer_kind[scene.shape().chunk_layer[c]] & kLayerShells) continue;
    const RootBlock& roots = *memory.Of<&Streams::roots>(c);
    for (uint32_t s = 0; s < memory.Of<&Streams::chunk_state>(c)->live_strands; ++s) {
      ++sizes.strands;
      const uint32_t kind = scene.shape().layer_kind[scene.shape().chunk_layer[c]];
      sizes.length += WithPoints(StrandPointsOf(kind), [&]<uint32_t kPoints> {
        return LengthOf(roots, *memory.Of<ChainStreams<kPoints, false>::kPosition>(c), s);
      });
    }
  }
  return sizes;
}

// Position-based solvers keep lengths roughly, and not at once; the modal solver's parts are as long as they were
// groomed but for their bend, and what is smaller is stiffer for its weight.
Scenario With(Solver solver) {
  Scenario scenario = CalmScenario();
  for (LayerParams* layer : LayersOf(scenario)) {
    const Solver own = std::exchange(layer->solver, solver);
    if (FindBadCombination(*layer)) layer->solver = own;
  }
  return scenario;
}

TEST(Scale, LengthsAndWidthsAreTheCharacters) {
  for (const Solver solver : {Solver::kPbd, Solver::kVerlet, Solver::kModal})
    for (const float scale : {0.25f, 2.0f}) {
      Scenario one = With(solver), other = one;
      Scale(other, one.actors[0].placement, glm::vec3(scale));
      RunningScenario a(one, {}), b(other, {});
      for (uint32_t f = 0; f < 20; ++f) RunFrame(a, f), RunFrame(b, f);
      const Sizes is = SizesOf(b.scene()), was = SizesOf(a.scene());
      EXPECT_GT(was.strands, 300u);
      EXPECT_EQ(is.strands, was.strands);
      const double off = solver == Solver::kModal ? 0.03 : 0.05;
      EXPECT_NEAR(is.length / was.length, scale, off * scale) << int(solver);
      EXPECT_NEAR(is.width / was.width, scale, 1e-3 * scale);
      EXPECT_GT(was.shell, 0.0);
      EXPECT_NEAR(is.shell / was.shell, scale, 1e-3 * scale);
      EXPECT_TRUE(is.in_box) << int(solver) << ", " << scale;
    }
}

TEST(Scale, LengthsFollowInEveryFrame) {
  Scenario scenario = With(Solver::kModal);
  const glm::mat4 placement = scenario.actors[0].placement;
  RunningScenario run(scenario, {});
  double first = 0.0;
  for (uint32_t f = 0; f < 90; ++f) {
    const float scale = 1.0f + float(std::min(f, 60u)) / 60.0f;
    Scale(scenario, placement, glm::vec3(scale));
    RunFrame(run, f);
    ASSERT_EQ(FindNonFinite(run.scene()), "") << f;
    const Sizes sizes = SizesOf(run.scene());
    if (f == 0) first = sizes.length;
    ASSERT_NEAR(sizes.length / first, scale, 0.03 * scale) << f;
  }
}

// The mean of the axes; and no scale of the skeleton's own.
TEST(Scale, IsThatOfThePlacement) {
  Scenario one = With(Solver::kModal), uneven = one, jointed = one;
  Scale(uneven, one.actors[0].placement, {1.0f, 2.0f, 3.0f});
  RunningScenario a(one, {}), b(uneven, {}), c(jointed, {});
  RunFrame(a, 0), RunFrame(b, 0);
  const FrameInput input = c.Prepare(0, jointed.base.skip, jointed.base.lod);
  for (auto& key : c.scene().Pose(0).scale_key)
    for (auto& row : key) row[0] *= 1.5f;
  RunInput(c, input);
  const double whole = SizesOf(a.scene()).length;
  EXPECT_NEAR(SizesOf(b.scene()).length / whole, 2.0, 1e-3);
  EXPECT_NEAR(SizesOf(c.scene()).length / whole, 1.0, 1e-4);
}

// Of a placement that forgets its file's unit, mostly.
TEST(Scale, OverTenTimesWhatWasBakedIsToldOnce) {
  for (const bool meant : {false, true}) {
    Scenario scenario = CalmScenario();
    const glm::mat4 placement = scenario.actors[0].placement;
    RunningScenario run(scenario, {.any_scale = meant});
    uint32_t frame = 0;
    const auto note_of = [&](float scale) {
      Scale(scenario, placement, glm::vec3(scale));
      RunFrame(run, frame++);
      const char* note = run.scene().NextNote();
      return std::string(note ? note : "");
    };
    for (const float near : {1.0f, 10.0f, 0.1f, 0.0f}) EXPECT_EQ(note_of(near), "") << near;
    Scale(scenario, placement, glm::vec3(100.0f));
    RunFrame(run, frame++);
    // As it was when it was found, whenever one asks.
    const std::string note = note_of(1.0f);
    EXPECT_EQ(note.find("character 0 is placed 100 times larger") == 0, !meant) << note;
    for (const float far : {100.0f, 0.01f, 1.0f}) EXPECT_EQ(note_of(far), "") << far;
  }
}

// A character that is hidden by a scale of 0 is no reason to fall apart.
TEST(Scale, OfNothingIsFinite) {
  Scenario scenario = With(Solver::kModal);
  const glm::mat4 placement = scenario.actors[0].placement;
  RunningScenario run(scenario, {});
  for (uint32_t f = 0; f < 30; ++f) {
    Scale(scenario, placement, glm::vec3(f / 5 % 2 ? 0.0f : f > 15 ? 1.0e4f : 1.0f));
    RunFrame(run, f);
    ASSERT_EQ(FindNonFinite(run.scene()), "") << f;
  }
}

}  // namespace
}  // namespace pelt::testing
