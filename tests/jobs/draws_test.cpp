// What a frame gives to those who draw: every layer of the draw list, its vertices where the
// kernels put them, in both vertex orders; and the same strands as points.
#include "jobs/draws.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <map>
#include <set>

#include "core/modal/modal_quality.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

struct Drawn {
  explicit Drawn(VertexOrder order) : running(scenario, {.vertex_order = order}) {
    RunFrame(running, 0);
  }
  FurScene& scene() { return running.scene(); }

  Scenario scenario = EveryOutputScenario();
  RunningScenario running;
};

// The bytes of the strand at `place` of the drawing order.
std::span<const std::byte> BytesAt(const LayerDraw& draw, VertexOrder order, uint32_t place) {
  const uint32_t bytes = draw.format().StrandBytes();
  const uint32_t at = order == VertexOrder::kSorted ? place : draw.order[place];
  return draw.vertices.subspan(size_t(at) * bytes, bytes);
}

// The first strands of each chunk, in drawing order, in either vertex order.
TEST(Draws, ShadowPassesDrawAShareOfEachChunk) {
  for (const VertexOrder order : {VertexOrder::kSorted, VertexOrder::kIndexBuffer}) {
    Scenario scenario = EveryOutputScenario();
    for (LayerParams* layer : LayersOf(scenario)) layer->shadow_share = 0.25f;
    LayersOf(scenario)[1]->shadow_share = 1.0f;
    RunningScenario running(scenario, {.vertex_order = order});
    RunFrame(running, 0);
    const FurScene& scene = running.scene();
    for (const LayerDraw& draw : scene.Draws()) {
      std::vector<uint32_t> expected, places(draw.strand_count);
      const uint32_t first = scene.shape().layer_first_chunk[draw.layer];
      for (uint32_t i = 0; i < draw.strand_count; ++i) {
        const uint32_t strand = draw.order[i], chunk = first + strand / kStrandsPerChunk;
        const uint32_t live = scene.memory().Of<&Streams::chunk_state>(chunk)->live_strands;
        if (draw.layer == 1 || strand % kStrandsPerChunk < (live + 3) / 4)
          expected.push_back(order == VertexOrder::kSorted ? i : strand);
      }
      EXPECT_EQ(scene.ShadowPlaces(draw.layer, {}), expected.size());
      places.resize(scene.ShadowPlaces(draw.layer, places));
      EXPECT_EQ(places, expected) << draw.layer;
    }
    EXPECT_EQ(scene.ShadowPlaces(~0u, {}), 0u);
  }
}

TEST(Draws, AreTheDrawListWithVerticesOfEveryOutput) {
  Drawn drawn(VertexOrder::kSorted);
  const auto& list = *drawn.scene().memory().Of<&Streams::draw_list>(0);
  const auto draws = drawn.scene().Draws();
  ASSERT_EQ(draws.size(), list.count);
  std::set<Output> outputs;
  uint64_t strands = 0;
  for (size_t i = 0; i < draws.size(); ++i) {
    const LayerDraw& draw = draws[i];
    EXPECT_EQ(draw.layer, list.layer[i]);
    EXPECT_EQ(draw.order.size(), draw.strand_count);
    outputs.insert(draw.output);
    if (draw.output == Output::kShells) {
      EXPECT_EQ(draw.strand_count, 0u);
      EXPECT_FALSE(draw.shells.shell.empty());
      EXPECT_EQ(draw.vertices.size(), draw.shells.skin.size() * sizeof(ShellVertexBlock));
      EXPECT_EQ(draw.shells.fins.size(), draw.shells.triangles.size());
      EXPECT_EQ(draw.shells.halo.size(), draw.shells.triangles.size());
      EXPECT_GT(WriteFins(draw.shells, {}), 0u);
      strands += WriteShellIndices(draw.shells, {}) / 3;
      continue;
    }
    EXPECT_TRUE(draw.shells.shell.empty());
    EXPECT_TRUE(draw.shells.fins.empty());
    EXPECT_EQ(draw.vertices.size(), size_t(draw.strand_count) * draw.format().StrandBytes());
    strands += draw.strand_count;
  }
  EXPECT_EQ(outputs.size(), kOutputCount);
  EXPECT_EQ(strands, drawn.scene().DrawnStrands());
}

TEST(Draws, HaveTheSameStrandsInBothVertexOrders) {
  Drawn sorted(VertexOrder::kSorted), indexed(VertexOrder::kIndexBuffer);
  const auto a = sorted.scene().Draws(), b = indexed.scene().Draws();
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].strand_count, b[i].strand_count);
    for (uint32_t place = 0; place < a[i].strand_count; ++place) {
      const auto x = BytesAt(a[i], VertexOrder::kSorted, place);
      const auto y = BytesAt(b[i], VertexOrder::kIndexBuffer, place);
      ASSERT_TRUE(std::equal(x.begin(), x.end(), y.begin(), y.end()))
          << "layer " << a[i].layer << " place " << place;
    }
  }
}

TEST(Draws, AreReadAsTheirOwnVerticesOnly) {
  Drawn drawn(VertexOrder::kSorted);
  for (const LayerDraw& draw : drawn.scene().Draws()) {
    const auto vertices = [&](Output output, uint32_t per_strand) {
      return draw.output == output ? draw.strand_count * per_strand : 0u;
    };
    EXPECT_EQ(draw.As<CurveRecord>().size(), vertices(Output::kInstances, 1));
    EXPECT_EQ(draw.As<RibbonVertex>().size(), vertices(Output::kRibbons, 10));
    EXPECT_EQ(draw.As<LineVertex>().size(), vertices(Output::kLines, 5));
    EXPECT_EQ(draw.As<ShellVertex>().size(), draw.shells.skin.size() * kVerticesPerChunk);
  }
}

// Found by the strand's number, which every vertex carries, in either order of vertices.
TEST(Draws, OfLitLayersHaveALookForEveryStrand) {
  for (const VertexOrder order : {VertexOrder::kSorted, VertexOrder::kIndexBuffer}) {
    Drawn drawn(order);
    const FrameMemory& memory = drawn.scene().memory();
    uint32_t lit = 0;
    for (const LayerDraw& draw : drawn.scene().Draws()) {
      const bool is_lit = drawn.scene().shape().layer_kind[draw.layer] & kLayerLit;
      EXPECT_EQ(draw.light != nullptr, is_lit);
      EXPECT_EQ(draw.looks.empty(), !is_lit || draw.output == Output::kShells);
      if (!is_lit) continue;
      ++lit;
      EXPECT_EQ(draw.light, memory.Of<&Streams::layer_light>(draw.layer));
      const uint32_t first = drawn.scene().shape().layer_first_chunk[draw.layer];
      for (const uint32_t strand : draw.order) {
        ASSERT_LT(strand, draw.looks.size());
        const uint32_t chunk = first + strand / kStrandsPerChunk, lane = strand % kStrandsPerChunk;
        EXPECT_EQ(draw.looks[strand].uv, memory.Of<&Streams::strand_uv>(chunk)->uv[lane]);
        // Up and down are distinguished by the word's fold: the skin's own z.
        const float z = memory.Of<&Streams::roots>(chunk)->normal[2][lane];
        const auto part = [](uint32_t bits) { return float(int16_t(uint16_t(bits))) / 32767.0f; };
        const uint32_t normal = draw.looks[strand].normal;
        const float folded = 1.0f - std::abs(part(normal & 0xffffu)) - std::abs(part(normal >> 16));
        if (std::abs(z) > 1e-3f) {
          EXPECT_EQ(folded > 0.0f, z > 0.0f);
        }
      }
    }
    EXPECT_GT(lit, 0u);
  }
}

TEST(Draws, LieInTheirBox) {
  Drawn drawn(VertexOrder::kSorted);
  for (const LayerDraw& draw : drawn.scene().Draws()) {
    std::vector<StrandCurve> curves(draw.live_strands);
    ASSERT_EQ(drawn.scene().CopyCurves(draw.layer, curves), draw.live_strands);
    for (const StrandCurve& curve : curves)
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(curve.point[0][axis], draw.low[axis]);
        EXPECT_LE(curve.point[0][axis], draw.high[axis]);
      }
  }
}

// Point i of the strand at `place` lies where the curve has it.
void ExpectOnCurve(const LayerDraw& draw, uint32_t place, uint32_t i, const float* point) {
  for (int axis = 0; axis < 3; ++axis) {
    if (draw.output == Output::kLines) {
      const LineVertex& vertex = draw.As<LineVertex>()[place * 5 + i];
      EXPECT_NEAR(vertex.position[axis], point[axis], 1e-6f);
      EXPECT_NEAR(vertex.width, point[3], 1e-9f);
    } else {
      const RibbonVertex* pair = &draw.As<RibbonVertex>()[place * 10 + 2 * i];
      EXPECT_NEAR(0.5f * (pair[0].position[axis] + pair[1].position[axis]), point[axis], 1e-5f);
    }
  }
}

TEST(Curves, RunAlongTheVertices) {
  Drawn drawn(VertexOrder::kSorted);
  for (const LayerDraw& draw : drawn.scene().Draws()) {
    if (draw.output == Output::kInstances) continue;
    std::vector<StrandCurve> curves(draw.live_strands);
    drawn.scene().CopyCurves(draw.layer, curves);
    std::map<uint32_t, const StrandCurve*> by_strand;
    for (const StrandCurve& curve : curves) by_strand[curve.strand] = &curve;
    ASSERT_EQ(by_strand.size(), curves.size()) << "every strand once";
    for (uint32_t place = 0; place < draw.strand_count; ++place) {
      const StrandCurve& curve = *by_strand.at(draw.order[place]);
      for (uint32_t i = 0; i < kRibbonPoints; ++i) ExpectOnCurve(draw, place, i, curve.point[i]);
    }
  }
}

TEST(Curves, AreAsManyAsThereIsRoomFor) {
  Drawn drawn(VertexOrder::kSorted);
  std::vector<StrandCurve> curves(3);
  EXPECT_EQ(drawn.scene().CopyCurves(0, curves), 3u);
  EXPECT_EQ(drawn.scene().CopyCurves(0, {}), 0u);
  EXPECT_EQ(drawn.scene().CopyCurves(drawn.scene().shape().layer_count, curves), 0u);
}

// The most that a curve is off its `pieces`, looked at in 8 places beside each, m.
double OffItsPieces(const CurveRecord& record, uint32_t pieces) {
  const auto at = [&](double t) {
    glm::dvec3 point;
    for (int c = 0; c < 3; ++c)
      point[c] = record.curve[0][c] +
                 t * (record.curve[1][c] + t * (record.curve[2][c] + t * record.curve[3][c]));
    return point;
  };
  double most = 0.0;
  for (uint32_t i = 0; i < pieces; ++i) {
    const glm::dvec3 from = at(double(i) / pieces), to = at(double(i + 1) / pieces);
    for (uint32_t k = 1; k < 8; ++k) {
      const glm::dvec3 way = at((i + k / 8.0) / pieces) - from, along = glm::normalize(to - from);
      most = std::max(most, glm::length(way - along * glm::dot(way, along)));
    }
  }
  return most;
}

// Nine of ten strands within a quarter of a pixel and nearly all within one, from near and far; in scenes that sway
// less than `tiny`, within half.
TEST(Draws, PiecesKeepToTheCurve) {
  std::set<uint32_t> seen;
  for (const double distance_m : {1.0, 2.0, 4.0, 8.0}) {
    Scenario scenario = TinyScenario();
    scenario.camera.radius_m = distance_m;
    RunningScenario running(scenario, {});
    for (uint32_t f = 0; f < 40; ++f) RunFrame(running, f);
    FurScene& scene = running.scene();
    const View view = MakeView(scenario.PrepareFrame(39, scene).camera);
    std::vector<double> off_px;
    for (const LayerDraw& draw : scene.Draws()) {
      if (draw.output != Output::kInstances || draw.pieces == kMostPieces) continue;
      const float px = LengthOnScreenPx(view, *scene.memory().Of<&Streams::bounds>(draw.layer), 1);
      for (const CurveRecord& record : draw.As<CurveRecord>().first(draw.strand_count))
        off_px.push_back(OffItsPieces(record, draw.pieces) * double(px));
      seen.insert(draw.pieces);
    }
    std::ranges::sort(off_px);
    EXPECT_LT(off_px[off_px.size() * 9 / 10], 0.32) << distance_m;
    // Grooms of other chunks are others.
    EXPECT_LT(off_px[off_px.size() * 99 / 100], kStrandsPerChunk == 128 ? 1.0 : 1.05) << distance_m;
  }
  EXPECT_GE(seen.size(), 4u) << "2 to 7";
  EXPECT_EQ(CurvePieces(0.0f), 2u);
  EXPECT_EQ(CurvePieces(86.0f), 8u);
  EXPECT_EQ(CurvePieces(1.0e30f), 8u);
}

TEST(Draws, AreNotThereWhileAFrameIsOpen) {
  Drawn drawn(VertexOrder::kSorted);
  ASSERT_FALSE(drawn.scene().Draws().empty());
  drawn.running.Begin(1);
  std::vector<StrandCurve> curves(1);
  EXPECT_TRUE(drawn.scene().Draws().empty());
  EXPECT_EQ(drawn.scene().CopyCurves(0, curves), 0u);
}

}  // namespace
}  // namespace pelt::testing
