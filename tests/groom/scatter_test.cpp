// Scatter: evenness of every prefix against the plain way, exact counts, masks, and their errors.
#include "core/groom/scatter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/groom/sample_elimination.hpp"
#include "core/random.hpp"
#include "tests/error_from.hpp"
#include "tests/groom/torus_character.hpp"

namespace pelt::test {
namespace {

struct Torus {
  Character character;
  RestGeometry rest;
  FurSetup setup;
  double area;

  explicit Torus(bool uvs = true) : character(MakeTorus({.uvs = uvs})) {
    rest = ComputeRestGeometry(character, 1.0f);
    area = AreaOf(character, rest);
    setup.path = "torus.toml";
  }
  LayerSetup Layer(uint32_t strands) const {
    LayerSetup layer;
    layer.name = "coat";
    layer.seed = 7;
    layer.density = float(strands / area);
    return layer;
  }
  std::vector<ScatterPoint> Scatter(const LayerSetup& layer) const {
    return ScatterLayer(character, rest, setup, layer, Growth(character, rest, setup, layer));
  }
  // Least distance of a point from the material's triangles, m; from places of a grid on them.
  double NearestTo(const std::string& material, std::span<const ScatterPoint> points) const {
    constexpr int kSteps = 12;
    const Mesh& mesh = character.mesh;
    double least = 1e300;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      if (mesh.materials[mesh.triangle_material[t]] != material) continue;
      for (int i = 0; i <= kSteps; ++i)
        for (int j = 0; i + j <= kSteps; ++j) {
          const glm::vec3 bary = glm::vec3(i, j, kSteps - i - j) / float(kSteps);
          const glm::dvec3 at(Interpolate(rest.position, mesh, {t, bary}));
          for (const ScatterPoint& p : points)
            least = std::min(least, glm::length(glm::dvec3(p.position) - at));
        }
    }
    return least;
  }
  std::string ErrorOf(const LayerSetup& layer) const {
    return ErrorFrom([&] { Scatter(layer); });
  }
};

void ExpectContains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
}

// The obvious way, in double.
double LeastDistanceBruteForce(std::span<const ScatterPoint> points) {
  double least = 1e300;
  for (size_t i = 0; i < points.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      if (glm::dot(points[i].normal, points[j].normal) <= 0.0f) continue;
      least = std::min(
          least, glm::length(glm::dvec3(points[i].position) - glm::dvec3(points[j].position)));
    }
  }
  return least;
}

TEST(DensestPackingRadius, IsHalfTheHexagonalLatticeSpacing) {
  // A lattice of spacing s has 2 / (sqrt(3) s^2) points a unit of area.
  EXPECT_NEAR(DensestPackingRadius(2.0 / (std::sqrt(3.0) * 0.01)), 0.05, 1e-7);
}

std::vector<SamplePoint> RandomSquare(uint32_t count, uint32_t keep, float height, uint64_t seed) {
  Random random(seed);
  std::vector<SamplePoint> points(count);
  for (SamplePoint& p : points) {
    p.position = {float(random.Uniform()), height, float(random.Uniform())};
    p.normal = {0.0f, height < 0.0f ? -1.0f : 1.0f, 0.0f};
    p.radius = DensestPackingRadius(keep);
  }
  return points;
}

TEST(EliminateSamples, KeepsEachPointOnce) {
  for (const uint32_t keep : {0u, 1u, 2u, 3u, 17u, 299u, 300u}) {
    const auto order = EliminateSamples(RandomSquare(300, std::max(keep, 1u), 0.0f, 1), keep);
    EXPECT_EQ(order.size(), keep);
    EXPECT_EQ(std::set<uint32_t>(order.begin(), order.end()).size(), keep);
    for (const uint32_t i : order) EXPECT_LT(i, 300u);
  }
}

TEST(EliminateSamples, SurvivesPointsInOnePlaceAndOnALine) {
  std::vector<SamplePoint> same(200, {{1.0f, 2.0f, 3.0f}, {0.0f, 1.0f, 0.0f}, 0.01f});
  EXPECT_EQ(EliminateSamples(same, 50).size(), 50u);
  std::vector<SamplePoint> line = same;
  for (size_t i = 0; i < line.size(); ++i) {
    line[i].position.x = float(i) * 1e-3f;
    line[i].radius = 0.005f;
  }
  const auto order = EliminateSamples(line, 20);
  std::vector<float> x;
  for (const uint32_t i : order) x.push_back(line[i].position.x);
  std::sort(x.begin(), x.end());
  // 200 places in 20 equal shares are 10 apart.
  for (size_t i = 1; i < x.size(); ++i) EXPECT_GT(x[i] - x[i - 1], 4e-3f);
}

TEST(EliminateSamples, FollowsADensityThatVariesSixteenfold) {
  // The left half wants 16 times the density of the right.
  const double dense = 3200.0, sparse = 200.0;
  Random random(3);
  std::vector<SamplePoint> points;
  while (points.size() < 5100) {
    const float x = float(random.Uniform()), z = float(random.Uniform());
    const bool left = x < 0.5f;
    if (!left && random.Uniform() > sparse / dense) continue;
    points.push_back({{x, 0.0f, z}, {0, 1, 0}, DensestPackingRadius(left ? dense : sparse)});
  }
  const uint32_t keep = uint32_t((dense + sparse) / 2);
  const auto order = EliminateSamples(points, keep);
  for (const uint32_t prefix : {keep / 8, keep / 2, keep}) {
    const auto left = std::count_if(order.begin(), order.begin() + prefix,
                                    [&](uint32_t i) { return points[i].position.x < 0.5f; });
    EXPECT_NEAR(double(left) / prefix, dense / (dense + sparse), 0.02) << prefix;
  }
  // Distances in the sparse half are those of its own density.
  double least = 1e300;
  for (size_t i = 0; i < order.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      const glm::vec3 a = points[order[i]].position, b = points[order[j]].position;
      if (a.x > 0.6f && b.x > 0.6f) least = std::min(least, double(glm::length(a - b)));
    }
  }
  EXPECT_GT(least, 0.5 * 2.0 * double(DensestPackingRadius(sparse)));
}

TEST(EliminateSamples, TwoSidesOfAThinSheetDoNotSeeEachOther) {
  const uint32_t keep = 500;  // each
  auto points = RandomSquare(3 * keep, keep, 1e-4f, 5);
  const auto below = RandomSquare(3 * keep, keep, -1e-4f, 6);
  points.insert(points.end(), below.begin(), below.end());
  const auto order = EliminateSamples(points, 2 * keep);
  for (const uint32_t prefix : {keep / 4, keep, 2 * keep}) {
    const auto above = std::count_if(order.begin(), order.begin() + prefix,
                                     [&](uint32_t i) { return points[i].position.y > 0.0f; });
    EXPECT_NEAR(double(above) / prefix, 0.5, 0.06);
  }
  // Seen as one sheet they would be spaced for 1000; seen apart, points of the two come together.
  double least_same = 1e300, least_other = 1e300;
  for (size_t i = 0; i < order.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      const SamplePoint &a = points[order[i]], &b = points[order[j]];
      double& least = a.normal == b.normal ? least_same : least_other;
      least = std::min(least, double(glm::length(a.position - b.position)));
    }
  }
  EXPECT_GT(least_same, 0.55 * 2.0 * double(DensestPackingRadius(keep)));
  EXPECT_LT(least_other, 0.2 * 2.0 * double(DensestPackingRadius(keep)));
}

TEST(MeasureSpacing, KnowsTheHexagonalPackingAndAgreesWithBruteForce) {
  std::vector<ScatterPoint> lattice;
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j) {
      lattice.push_back(
          {{}, {float(i) + 0.5f * float(j % 2), 0.0f, float(j) * 0.8660254f}, {0, 1, 0}, 0.5f});
    }
  }
  const SpacingStats ideal = MeasureSpacing(lattice, 1.0f);
  EXPECT_NEAR(ideal.mean, 1.0, 1e-4);
  EXPECT_NEAR(ideal.least, 1.0, 1e-4);
  EXPECT_LT(ideal.variation, 1e-3);

  const Torus torus;
  const auto points = torus.Scatter(torus.Layer(700));
  const SpacingStats stats = MeasureSpacing(points, 1.0f);
  EXPECT_NEAR(stats.least * 2.0 * double(points[0].radius), LeastDistanceBruteForce(points), 1e-6);
}

TEST(Scatter, ReachesTheDensityAndRepeats) {
  const Torus torus;
  const LayerSetup layer = torus.Layer(5000);
  const auto points = torus.Scatter(layer), again = torus.Scatter(layer);
  EXPECT_NEAR(double(points.size()), 5000.0, 2.0);
  ASSERT_EQ(points.size(), again.size());
  for (size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(points[i].place.triangle, again[i].place.triangle);
    ASSERT_EQ(points[i].place.bary, again[i].place.bary);
    EXPECT_NEAR(points[i].place.bary.x + points[i].place.bary.y + points[i].place.bary.z, 1.0f,
                1e-6f);
    for (int k = 0; k < 3; ++k) EXPECT_GE(points[i].place.bary[k], 0.0f);
  }
  LayerSetup other = layer;
  other.seed = 8;
  EXPECT_NE(torus.Scatter(other)[0].position, points[0].position);
}

TEST(Scatter, EveryPrefixIsFarMoreEvenThanRejectionSampling) {
  const Torus torus;
  const LayerSetup layer = torus.Layer(20000);
  const Growth growth(torus.character, torus.rest, torus.setup, layer);
  const auto points = torus.Scatter(layer);
  const auto strands = ListPatchStrands(torus.character.mesh, points);
  const auto chunks = CutChunks(strands);
  const auto patches = PackVertices(torus.character.mesh, strands, chunks);
  const LayerScatterStats stats =
      MeasureLayerScatter(torus.character, torus.rest, layer, growth, points, chunks, patches);
  ASSERT_EQ(stats.prefix[0].share, 0.125);
  ASSERT_EQ(stats.prefix[3].share, 1.0);
  for (const PrefixStats& prefix : stats.prefix) {
    SCOPED_TRACE(prefix.share);
    EXPECT_GT(prefix.layer.mean, 0.72);
    EXPECT_GT(prefix.layer.least, 0.58);
    EXPECT_LT(prefix.layer.variation, 0.14);
    EXPECT_GT(prefix.every_chunk.mean, 0.71);
    EXPECT_GT(prefix.every_chunk.least, 0.45);
    EXPECT_LT(prefix.every_chunk.variation, 0.15);
    EXPECT_GT(prefix.inside_chunks.mean, 0.72);
    EXPECT_GT(prefix.inside_chunks.least, 0.58);
    EXPECT_LT(prefix.inside_chunks.variation, 0.25);
    // The plain way, measured alike: about 0.465, 0 and 0.52.
    EXPECT_LT(prefix.plain_every_chunk.mean, 0.5);
    EXPECT_LT(prefix.plain_every_chunk.least, 0.1);
    EXPECT_GT(prefix.plain_every_chunk.variation, 0.45);
    EXPECT_LT(prefix.plain_inside_chunks.mean, 0.6);
    EXPECT_LT(prefix.plain_inside_chunks.least, 0.3);
  }
  EXPECT_EQ(stats.name, "coat");
  EXPECT_EQ(stats.prefix[0].share, 0.125);
  EXPECT_EQ(stats.chunk_count, chunks.size());
  EXPECT_EQ(stats.patch_count, patches.size());
  // Of this dense layer every vertex of the mesh is in one patch, and in the halos of some chunks.
  const auto vertices = double(torus.character.mesh.position.size());
  EXPECT_NEAR(stats.vertex_fill * double(patches.size() * kVerticesPerChunk), vertices, 1e-6);
  size_t uses = 0;
  for (const ChunkPart& chunk : chunks) uses += chunk.vertices.size();
  EXPECT_NEAR(stats.chunks_per_vertex, double(uses) / vertices, 1e-9);
  EXPECT_GT(stats.chunks_per_vertex, 1.0);
}

TEST(Scatter, MaxStrandsThinsEvenly) {
  const Torus torus;
  LayerSetup layer = torus.Layer(20000);
  layer.max_strands = 3000;
  layer.mask.uv = MakeMap([](float u, float) { return u < 0.5f ? 1.0f : 0.25f; });
  const auto points = torus.Scatter(layer);
  ASSERT_EQ(points.size(), 3000u);
  const SpacingStats stats = MeasureSpacing(points, 1.0f);
  EXPECT_GT(stats.mean, 0.72);
  EXPECT_LT(stats.mean, 0.82);
  const auto dense = std::count_if(points.begin(), points.end(),
                                   [](const ScatterPoint& p) { return p.position.z > 0.0f; });
  EXPECT_NEAR(double(dense) / 3000.0, 0.8, 0.03);
}

TEST(Scatter, MapsScaleTheDensity) {
  const Torus torus;
  LayerSetup layer = torus.Layer(8000);
  layer.density_map = MakeMap([](float, float) { return 128.0f / 255.0f; }, 2);
  EXPECT_NEAR(double(torus.Scatter(layer).size()), 8000.0 * 128 / 255, 20.0);
  layer.density_map.high = 2.0f;  // where the map is full there is twice the density
  EXPECT_NEAR(double(torus.Scatter(layer).size()), 16000.0 * 128 / 255, 40.0);
  layer.density_map.high = 1.0f;
  layer.mask.bald = MakeMap([](float u, float) { return u < 0.5f ? 1.0f : 0.0f; });
  const auto points = torus.Scatter(layer);
  EXPECT_NEAR(double(points.size()), 4000.0 * 128 / 255, 60.0);
  for (const ScatterPoint& p : points) EXPECT_LT(p.position.z, 0.02f);
}

TEST(Scatter, DensityRandomisesByTriangleAndIsClamped) {
  const Torus torus;
  LayerSetup layer = torus.Layer(20000);
  layer.density_randomise = 0.8f;
  const Growth growth(torus.character, torus.rest, torus.setup, layer);
  float least = 1.0f, most = 0.0f;
  for (uint32_t t = 0; t < torus.character.mesh.triangles.size(); ++t) {
    const float share = growth.Share({t, {0.2f, 0.3f, 0.5f}});
    EXPECT_EQ(share, growth.Share({t, {0.6f, 0.3f, 0.1f}}));
    least = std::min(least, share);
    most = std::max(most, share);
  }
  EXPECT_LT(least, 0.15f);
  EXPECT_GT(most, 0.95f);
  layer.density_range = glm::vec2(layer.density * 0.9f, layer.density * 1.1f);
  const Growth clamped(torus.character, torus.rest, torus.setup, layer);
  EXPECT_FLOAT_EQ(clamped.densest(), layer.density * 1.1f);
  for (uint32_t t = 0; t < torus.character.mesh.triangles.size(); ++t) {
    EXPECT_GE(clamped.Share({t, {0.2f, 0.3f, 0.5f}}), 0.9f / 1.1f - 1e-5f);
  }
}

TEST(Mask, MaterialsJointsRangeAndBoxKeepToTheirRegions) {
  const Torus torus(/*uvs=*/false);
  const Mesh& mesh = torus.character.mesh;
  LayerSetup layer = torus.Layer(6000);
  layer.mask.materials = {"back"};
  auto points = torus.Scatter(layer);
  EXPECT_NEAR(double(points.size()), 3000.0, 3.0);
  for (const auto& p : points) EXPECT_EQ(mesh.triangle_material[p.place.triangle], 1);

  layer = torus.Layer(6000);
  layer.mask.joints = {{"ring_2", false, 0.5f, 0.5f}};
  points = torus.Scatter(layer);
  EXPECT_NEAR(double(points.size()), 6000.0 / 8.0, 40.0);
  for (const auto& p : points) {  // ring_2 lies at +z
    EXPECT_GT(p.position.z, std::abs(p.position.x) * 2.0f);
  }

  layer.mask.joints = {{"ring_4", true, 0.5f, 0.5f}};  // ring_4 .. ring_7: half of the ring
  EXPECT_NEAR(double(torus.Scatter(layer).size()), 3000.0, 100.0);
  layer.mask.joints = {{"ring_2", false, 0.5f, 0.5f}, {"ring_6", false, 0.5f, 0.5f}};
  EXPECT_NEAR(double(torus.Scatter(layer).size()), 1500.0, 80.0);

  layer = torus.Layer(6000);
  layer.mask.range = Mask::Range{{0.0f, 0.5f, 0.0f}, {1.0f, 1.0f, 1.0f}};
  points = torus.Scatter(layer);
  EXPECT_NEAR(double(points.size()), 3000.0, 40.0);
  for (const auto& p : points) EXPECT_GE(p.position.y, -1e-4f);

  // Along the seams of `back`, which is half of it, nothing of `front` is nearer than that.
  layer = torus.Layer(6000);
  layer.mask.materials = {"front"};
  const size_t all = torus.Scatter(layer).size();
  layer.mask.away_from = Mask::AwayFrom{{"back"}, 0.05f};
  points = torus.Scatter(layer);
  EXPECT_LT(double(points.size()), 0.97 * double(all));
  EXPECT_GT(double(points.size()), 0.5 * double(all));
  EXPECT_GT(torus.NearestTo("back", points), 0.05 - 1e-4);
  EXPECT_LT(torus.NearestTo("back", points), 0.06);

  layer = torus.Layer(6000);  // a picture seen from above: u along x, rows along z
  layer.mask.box =
      Mask::Box{'y', MakeMap([](float u, float v) { return u < 0.5f && v < 0.5f ? 1.0f : 0.0f; })};
  points = torus.Scatter(layer);
  EXPECT_NEAR(double(points.size()), 1500.0, 150.0);
  for (const auto& p : points) {
    EXPECT_LT(p.position.x, 0.02f);
    EXPECT_LT(p.position.z, 0.02f);
  }
  layer.mask.box = Mask::Box{'x', MakeMap([](float, float v) { return v < 0.5f ? 1.0f : 0.0f; })};
  for (const auto& p : torus.Scatter(layer)) EXPECT_GT(p.position.y, -0.01f);  // first row: top
}

TEST(Mask, SharesNeverExceedTheTriangleLimit) {
  const Torus torus;
  LayerSetup layer = torus.Layer(6000);
  layer.mask.joints = {{"ring_2", false, 0.2f, 0.9f}, {"ring_5", false, 0.5f, 0.6f}};
  layer.mask.range = Mask::Range{{0.1f, 0.2f, 0.0f}, {0.9f, 0.8f, 1.0f}};
  const Growth growth(torus.character, torus.rest, torus.setup, layer);
  Random random(11);
  uint32_t growing = 0;
  for (int i = 0; i < 20000; ++i) {
    const uint32_t t = random.Below(uint32_t(torus.character.mesh.triangles.size()));
    float x = float(random.Uniform()), y = float(random.Uniform());
    if (x + y > 1.0f) x = 1.0f - x, y = 1.0f - y;
    const float share = growth.Share({t, {1.0f - x - y, x, y}});
    growing += share > 0.0f;
    ASSERT_LE(share, growth.TriangleLimit(t));
  }
  EXPECT_GT(growing, 500u);
}

TEST(Mask, UnknownNamesAreErrorsThatListTheKnown) {
  const Torus torus;
  LayerSetup layer = torus.Layer(1000);
  layer.mask.materials = {"bakc"};
  std::string error = torus.ErrorOf(layer);
  ExpectContains(error, "torus.toml: layer 'coat': key 'mask.materials'");
  ExpectContains(error, "no material 'bakc'");
  EXPECT_LT(error.find("'back'"), error.find("'front'"));
  layer = torus.Layer(1000);
  layer.mask.away_from = Mask::AwayFrom{{"bakc"}, 0.1f};
  ExpectContains(torus.ErrorOf(layer),
                 "key 'mask.away_from.materials': the character has no material");
  layer = torus.Layer(1000);
  layer.mask.joints = {{"ring2", true, 0.0f, 1.0f}};
  error = torus.ErrorOf(layer);
  ExpectContains(error, "mask.joints");
  ExpectContains(error, "the most alike first: 'ring_");
}

TEST(Mask, MapsWithoutTextureCoordinatesAreErrors) {
  const Torus torus(/*uvs=*/false);
  const MapChannel map = MakeMap([](float, float) { return 1.0f; });
  auto expect = [&](const std::string& key, auto set) {
    LayerSetup layer = torus.Layer(1000);
    set(layer);
    const std::string error = torus.ErrorOf(layer);
    ExpectContains(error, "layer 'coat': key '" + key + "'");
    ExpectContains(error, "mask.joints");
  };
  expect("density", [&](LayerSetup& l) { l.density_map = map; });
  expect("mask.uv", [&](LayerSetup& l) { l.mask.uv = map; });
  expect("mask.bald", [&](LayerSetup& l) { l.mask.bald = map; });
  expect("length", [&](LayerSetup& l) { l.length.map = map; });
  expect("strength", [&](LayerSetup& l) { l.strength.map = map; });
  expect("colour_map", [&](LayerSetup& l) { l.colour_map = map; });
}

TEST(Mask, AnEmptyLayerNamesWhatEmptiedIt) {
  const Torus torus;
  LayerSetup layer = torus.Layer(1000);
  layer.mask.uv = MakeMap([](float, float) { return 0.0f; });
  ExpectContains(torus.ErrorOf(layer), "'mask.uv' alone leaves nothing");
  layer = torus.Layer(1000);
  layer.density = 0.0f;
  ExpectContains(torus.ErrorOf(layer), "'density' alone");
  layer = torus.Layer(1000);
  layer.mask.joints = {{"root", false, 0.1f, 0.2f}};  // moves nothing
  ExpectContains(torus.ErrorOf(layer), "'mask.joints' alone");
  layer = torus.Layer(1000);
  layer.mask.uv = MakeMap([](float u, float) { return u > 0.2f && u < 0.4f ? 1.0f : 0.0f; });
  layer.mask.bald = MakeMap([](float u, float) { return u < 0.6f ? 1.0f : 0.0f; });
  ExpectContains(torus.ErrorOf(layer), "do not overlap");
}

TEST(Scatter, AbsurdDensitiesAreErrors) {
  const Torus torus;
  LayerSetup layer = torus.Layer(1000);
  layer.density = 1e12f;
  const std::string error = torus.ErrorOf(layer);
  ExpectContains(error, "key 'density'");
  ExpectContains(error, "max_strands");
  layer.max_strands = 500;
  EXPECT_EQ(torus.Scatter(layer).size(), 500u);
}

TEST(Scatter, DensitySaysWhatMaxStrandsLeft) {
  const Torus torus;
  for (const uint32_t most : {0u, 100u, 500u, 5000u}) {
    LayerSetup layer = torus.Layer(2000);
    layer.max_strands = most;
    ScatterDensity density;
    const auto points =
        ScatterLayer(torus.character, torus.rest, torus.setup, layer,
                     Growth(torus.character, torus.rest, torus.setup, layer), &density);
    EXPECT_EQ(density.grown, points.size());
    EXPECT_NEAR(density.asked, 2000.0, 100.0) << most;
    // Strands on a hexagonal grid: s = sqrt(2 / sqrt(3) area / n).
    const double spacing = std::sqrt(1.1547 * torus.area / double(points.size()));
    EXPECT_NEAR(double(density.spacing_m), spacing, 0.1 * spacing) << most;
  }
}

}  // namespace
}  // namespace pelt::test
