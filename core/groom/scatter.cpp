#include "core/groom/scatter.hpp"

#include <algorithm>
#include <cmath>

#include "core/exact_math.hpp"
#include "core/float_environment.hpp"
#include "core/float_rules.hpp"
#include "core/format.hpp"
#include "core/groom/sample_elimination.hpp"
#include "core/groom/setup_names.hpp"
#include "core/random.hpp"

namespace pelt {
namespace {

constexpr uint64_t kCandidateSeed = 0x63616e64;  // "cand"
constexpr uint32_t kCandidatesPerStrand = 3;
constexpr uint32_t kEstimateCandidates = 1u << 17;
// Masks of pictures can leave a speck of a large surface; more looks than this are a slip too.
constexpr double kCandidatesLimit = double(1u << 27);

struct Candidate {
  SurfacePoint place;
  float share;
};

struct Area {
  std::vector<double> weight;  // of each triangle: m^2 * limit of its share
  double sum = 0.0;
};

Area WeighTriangles(const Mesh& mesh, const RestGeometry& rest, const Growth& growth) {
  Area area;
  area.weight.resize(mesh.triangles.size());
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    const glm::dvec3 a = rest.position[v[0]], b = rest.position[v[1]], c = rest.position[v[2]];
    const glm::dvec3 cross = glm::cross(b - a, c - a);
    area.weight[t] = 0.5 * std::sqrt(glm::dot(cross, cross)) * double(growth.TriangleLimit(t));
    area.sum += area.weight[t];
  }
  return area;
}

double Fraction(double x) { return x - exact::Floor(x); }

// About `count` places by weight, thinned so that each stays with its share of the triangle's limit
// as probability. The plastic-number sequence (Roberts' R2) fills every triangle evenly; the jitter
// breaks its lattice.
std::vector<Candidate> DrawCandidates(const Mesh& mesh, const Growth& growth, const Area& area,
                                      uint64_t count, uint64_t seed) {
  std::vector<Candidate> drawn;
  Random random(MixSeed(seed, kCandidateSeed));
  const double step = area.sum / double(count);
  const double jitter = 0.5 / std::sqrt(double(count) / double(mesh.triangles.size()) + 1.0);
  double next = step * random.Uniform(), passed = 0.0;
  double u = random.Uniform(), v = random.Uniform();
  float due = float(random.Uniform());
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const float limit = growth.TriangleLimit(t);
    passed += area.weight[t];
    for (; next < passed; next += step) {
      u = Fraction(u + 0.75487766624669276);
      v = Fraction(v + 0.56984029099805327);
      const double x = Fraction(u + jitter * random.Uniform()),
                   y = Fraction(v + jitter * random.Uniform());
      const SurfacePoint place = PlaceInTriangle(t, x, y);
      const float share = growth.Share(place);
      due += std::min(share / limit, 1.0f);
      if (due < 1.0f) continue;
      due -= 1.0f;
      drawn.push_back({place, share});
    }
  }
  return drawn;
}

float MedianSpacing(std::span<const ScatterPoint> points) {
  std::vector<float> radius;
  for (const ScatterPoint& point : points) radius.push_back(point.radius);
  const auto middle = radius.begin() + std::ptrdiff_t(radius.size() / 2);
  std::nth_element(radius.begin(), middle, radius.end());
  return 2.0f * *middle;
}

}  // namespace

glm::vec3 InterpolateNormal(const Mesh& mesh, const RestGeometry& rest, const SurfacePoint& place) {
  const glm::vec3 n = Interpolate(rest.normal, mesh, place);
  const float square = glm::dot(n, n);
  if (square > 1e-12f) return n / std::sqrt(square);
  return rest.normal[mesh.triangles[place.triangle][0]];
}

std::vector<ScatterPoint> ScatterLayer(const Character& character, const RestGeometry& rest,
                                       const FurSetup& setup, const LayerSetup& layer,
                                       const Growth& growth, ScatterDensity* density) {
  const FloatEnvironment guard;
  const Mesh& mesh = character.mesh;
  const Area area = WeighTriangles(mesh, rest, growth);
  auto fail_empty = [&]() {
    FailLayerKey(setup, layer, "mask", "no strand is left: " + growth.ExplainEmpty());
  };
  double strands = double(growth.densest()) * area.sum;  // where no map takes any away
  if (!(strands > 0.0)) fail_empty();
  double scale = 1.0, asked = 0.0;
  if (layer.max_strands > 0 && strands > double(layer.max_strands)) {
    const size_t kept = DrawCandidates(mesh, growth, area, kEstimateCandidates, layer.seed).size();
    const double estimate = strands * double(kept) / double(kEstimateCandidates);
    // A little above the cap: the elimination makes it exact.
    asked = estimate;
    scale = std::min(1.0, 1.05 * double(layer.max_strands) / std::max(estimate, 1.0));
  }
  strands *= scale;
  if (strands * kCandidatesPerStrand > kCandidatesLimit) {
    FailLayerKey(setup, layer, "density",
                 Format("would look for strands in {:.3g} places; lower it, set max_strands, "
                        "or narrow the layer with mask.joints, mask.materials or mask.range",
                        strands * kCandidatesPerStrand));
  }
  const uint64_t count = uint64_t(strands * kCandidatesPerStrand) + 1;
  const std::vector<Candidate> drawn = DrawCandidates(mesh, growth, area, count, layer.seed);
  // Each candidate stands for an equal part of the wanted number.
  const double per_candidate = strands / double(count);
  uint64_t keep = uint64_t(double(drawn.size()) * per_candidate + 0.5);
  if (layer.max_strands > 0) keep = std::min<uint64_t>(keep, layer.max_strands);
  if (keep == 0) fail_empty();
  if (keep > kMostStrandsOfLayer) {
    FailLayerKey(setup, layer, "density",
                 Format("would grow {} strands, more than {}; lower it or set max_strands", keep,
                        kMostStrandsOfLayer));
  }
  // What the layer reaches after the cap.
  const double reached = double(growth.densest()) * scale * double(keep) /
                         std::max(double(drawn.size()) * per_candidate, 1e-9);
  std::vector<SamplePoint> samples(drawn.size());
  for (size_t i = 0; i < drawn.size(); ++i) {
    const double density = std::max(reached * double(drawn[i].share), reached * 1e-6);
    samples[i] = {Interpolate(rest.position, mesh, drawn[i].place),
                  InterpolateNormal(mesh, rest, drawn[i].place), DensestPackingRadius(density)};
  }
  const std::vector<uint32_t> order = EliminateSamples(samples, uint32_t(keep));
  std::vector<ScatterPoint> points(order.size());
  for (size_t i = 0; i < order.size(); ++i) {
    const SamplePoint& sample = samples[order[i]];
    points[i] = {drawn[order[i]].place, sample.position, sample.normal, sample.radius};
  }
  if (density) *density = {std::max(asked, double(keep)), uint32_t(keep), MedianSpacing(points)};
  return points;
}

}  // namespace pelt
