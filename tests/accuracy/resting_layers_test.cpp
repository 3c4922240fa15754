// What a whole scene's strands come to rest as, against the exact balance of the same curves: curl that
// follows the strand or the root, and grooms that are held up against gravity.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "bench/accuracy/curve_motion.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::accuracy {
namespace {

template <class Rows>
Double3 At(const Rows& rows, uint32_t lane) {
  return {rows[0][lane], rows[1][lane], rows[2][lane]};
}

// `tiny` without anything that moves or touches, its modal layers alone enabled.
Scenario StillScenario(const std::function<void(LayerSetup&)>& change) {
  Scenario scenario = testing::TinyScenario();
  FurSetup setup = LoadSetup("tiny");
  for (LayerSetup& layer : setup.layers) {
    layer.params.enabled = layer.params.solver == Solver::kModal;
    layer.params.surface_hardness = 0.0f;
    layer.params.clump = layer.params.wet_clump = 0.0f;
    if (layer.params.enabled) change(layer);
  }
  scenario.grooms[scenario.actors[0].groom] = testing::BakeForActor(scenario, setup);
  scenario.actors[0].clip = -1;
  scenario.actors[0].teleport_frame = -1;
  scenario.spheres.clear();
  scenario.capsules.clear();
  scenario.base.use_ground = false;
  scenario.base.wind = {};
  scenario.weather_course = {};
  return scenario;
}

void RunFrames(RunningScenario& run, uint32_t first, uint32_t count) {
  SkipSettings skip;
  skip.cull = skip.lod = false;
  for (uint32_t f = first; f < first + count; ++f) testing::RunFrame(run, f, skip, {});
}

// ---- Curl --------------------------------------------------------------------------------------

constexpr float kLength_m = 0.06f;

// The rest curve of the strand of a lane, which turns by `turn`, rad, from root to tip, in its root's frame.
RestCurve HelixOf(uint32_t lane, double turn) {
  const double way = 2.0 * M_PI * lane / kStrandsPerChunk;
  const Double3 tangent = Unit({0.3 * std::cos(way), 0.3 * std::sin(way), 1.0});
  const Double3 across = Unit(Cross(tangent, {std::cos(3.0 * way), 1.0, 0.2}));
  return {kZero3, tangent, Unit(across + tangent * 0.4), turn};
}

// The parts of a strand along it, unit.
std::array<Double3, 3> PartsOf(const RestCurve& rest) {
  std::array<Double3, 3> parts{};
  for (size_t part = 0; part < 3; ++part) {
    for (int k = 0; k < 32; ++k)
      parts[part] = parts[part] + rest.TangentAt((double(part) + (k + 0.5) / 32) / 3.0);
    parts[part] = Unit(parts[part]);
  }
  return parts;
}

void BendEveryStrand(Groom& groom, double turn) {
  for (RestBlock<4>& rest : groom.strand_rest4)
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
      Double3 end{};
      for (int i = 0; const Double3& part : PartsOf(HelixOf(lane, turn))) {
        end = end + part * (double(kLength_m) / 3.0);
        const double point[3] = {end.x, end.y, end.z};
        for (int k = 0; k < 3; ++k) rest.offset[i][k][lane] = float(point[k]);
        ++i;
      }
      rest.segment_length[lane] = kLength_m / 3.0f;
      rest.strength[lane] = 1.0f;
    }
}

struct Off {
  double rms = 0.0, worst = 0.0;  // of tips, over the length
};

// How far tips come to rest from where curves of `model` have their balance, the body turned by `tilt` degrees.
Off DistanceToBalance(double turn, double tilt, CurlFollows follows, CurlModel model) {
  constexpr double kFrequency = 1.5, kDrag = 8.0, kDamping = 0.3;
  Scenario scenario = StillScenario([&](LayerSetup& layer) {
    layer.params.enabled = layer.name == "modal4";
    layer.params.frequency_hz = float(kFrequency);
    layer.params.velocity_damping = float(kDrag);
    layer.params.damping_ratio = float(kDamping);
    layer.params.curl_follows = follows;
  });
  BendEveryStrand(scenario.grooms[scenario.actors[0].groom], turn);
  scenario.actors[0].placement =
      glm::rotate(glm::mat4(1.0f), float(tilt * M_PI / 180.0), glm::vec3(0.8f, 0.0f, 0.6f));
  RunningScenario run(scenario, {});
  RunFrames(run, 0, 300);

  const CurveStrand nodes = NodesOfStrand("3 nodes", kThreeNodes);
  const FrameMemory& memory = run.scene().memory();
  Off off;
  uint32_t count = 0;
  for (uint32_t c = 0; c < run.scene().shape().chunk_count; ++c) {
    if (!memory.Of<&Streams::strand_modal4>(c)) continue;
    const RootBlock& roots = *memory.Of<&Streams::roots>(c);
    const PointBlock<4>& points = *memory.Of<&Streams::strand_points4>(c);
    for (uint32_t s = 0; s < memory.Of<&Streams::chunk_state>(c)->live_strands; s += 5, ++count) {
      const Double3 normal = At(roots.normal, s), tangent = At(roots.tangent, s);
      const auto turned = [&](Double3 v) {
        return tangent * v.x + Cross(normal, tangent) * v.y + normal * v.z;
      };
      RestCurve rest = HelixOf(s, turn);
      rest.tangent = turned(rest.tangent), rest.axis = turned(rest.axis);
      const CurveDynamics dynamics(nodes, {"", kLength_m, kFrequency, kDrag, kDamping}, rest,
                                   model);
      const UnknownVectors balance = dynamics.Equilibrium(StillPose());
      Double3 tip{};
      for (const Double3& part : PartsOf(rest)) tip = tip + part * (1.0 / 3.0);
      for (size_t i = 0; i < dynamics.count(); ++i)
        tip = tip + (balance[i] - dynamics.rest()[i]) * nodes.place.back()[i];
      const Double3 found = (At(points.position[2], s) - At(roots.position, s)) * (1.0 / kLength_m);
      const double distance = Length(found - tip);
      off.rms += distance * distance;
      off.worst = std::max(off.worst, distance);
    }
  }
  EXPECT_GT(count, 20u);
  off.rms = std::sqrt(off.rms / count);
  return off;
}

TEST(RestingLayers, CurlTurnsWithTheStrand) {
  for (const double tilt : {0.0, 70.0}) {
    const Off off = DistanceToBalance(0.8, tilt, CurlFollows::kParent, CurlModel::kParent);
    const Off root = DistanceToBalance(0.8, tilt, CurlFollows::kRoot, CurlModel::kParent);
    std::printf(
        "0.8 rad, tilted by %2.0f: tips %.5f of the length off (worst %.5f); "
        "with curl_follows = \"root\" %.3f\n",
        tilt, off.rms, off.worst, root.rms);
    // The form at nodes is near that of the energy, no more.
    EXPECT_LT(off.worst, 0.08) << tilt;
    EXPECT_LT(off.rms, 0.35 * root.rms) << tilt;
    EXPECT_GT(root.rms, 0.04) << "the models do not differ here: nothing was tested";
  }
}

TEST(RestingLayers, CurlThatFollowsTheRootDoesWhenAskedTo) {
  const Off off = DistanceToBalance(0.8, 70.0, CurlFollows::kRoot, CurlModel::kRoot);
  EXPECT_LT(off.worst, 0.02);
}

// ---- Grooms held up ----------------------------------------------------------------------------

// Of every layer, how far points get from where they began, over the length.
std::vector<Off> FindSag(Scenario& scenario, float wetness) {
  scenario.weather_course = {wetness, 0.0f, 0};
  RunningScenario run(scenario, {});
  RunFrames(run, 0, 1);
  const FurScene& scene = run.scene();
  const auto read = [&] {
    std::vector<std::vector<Double3>> tips(scene.shape().layer_count);
    for (uint32_t c = 0; c < scene.shape().chunk_count; ++c) {
      const uint32_t layer = scene.shape().chunk_layer[c];
      if (!(scene.shape().layer_kind[layer] & kLayerModal)) continue;
      WithPoints(StrandPointsOf(scene.shape().layer_kind[layer]), [&]<uint32_t kPoints> {
        const auto& points = *scene.memory().Of<ChainStreams<kPoints, false>::kPosition>(c);
        const auto& rest = *scene.memory().Of<ChainStreams<kPoints, false>::kRest>(c);
        constexpr uint32_t tip = kPoints - 2;
        const RootBlock& roots = *scene.memory().Of<&Streams::roots>(c);
        for (uint32_t s = 0; s < scene.memory().Of<&Streams::chunk_state>(c)->live_strands; ++s)
          tips[layer].push_back((At(points.position[tip], s) - At(roots.position, s)) *
                                (1.0 / (double(rest.segment_length[s]) * (tip + 1))));
      });
    }
    return tips;
  };
  const auto groomed = read();
  RunFrames(run, 1, 300);
  const auto rested = read();
  std::vector<Off> sag(groomed.size());
  for (size_t l = 0; l < groomed.size(); ++l) {
    for (size_t i = 0; i < groomed[l].size(); ++i) {
      const double distance = Length(rested[l][i] - groomed[l][i]);
      sag[l].rms += distance * distance / double(groomed[l].size());
      sag[l].worst = std::max(sag[l].worst, distance);
    }
    sag[l].rms = std::sqrt(sag[l].rms);
  }
  return sag;
}

// Soft, and curled by up to 30 degrees a joint, so that without it they hang down.
Scenario HeldScenario(bool sag_free, float frequency, CurlFollows follows) {
  return StillScenario([&](LayerSetup& layer) {
    layer.params.sag_free = sag_free;
    layer.params.frequency_hz = frequency;
    layer.params.damping_ratio = 0.3f;
    layer.params.velocity_damping = 8.0f;
    layer.params.curl_follows = follows;
    layer.strength = Attribute(1.0f);
    layer.curl = Attribute(900.0f);
  });
}

TEST(RestingLayers, SagFreeGroomsRestAsTheyWereGroomed) {
  for (const float frequency : {3.0f, 1.0f})
    for (const CurlFollows follows : {CurlFollows::kParent, CurlFollows::kRoot}) {
      Scenario held = HeldScenario(true, frequency, follows);
      Scenario loose = HeldScenario(false, frequency, follows);
      const std::vector<Off> sag = FindSag(held, 0.0f), before = FindSag(loose, 0.0f);
      uint32_t layers = 0;
      for (size_t l = 0; l < sag.size(); ++l) {
        if (before[l].worst == 0.0) continue;
        ++layers;
        std::printf(
            "%.0f Hz, curl follows %s, layer %zu: tips sag by %.3f of the length (worst "
            "%.3f), sag-free %.5f (worst %.5f)\n",
            double(frequency), follows == CurlFollows::kParent ? "parent" : "root", l,
            before[l].rms, before[l].worst, sag[l].rms, sag[l].worst);
        EXPECT_LT(sag[l].worst, 0.01) << frequency << ", layer " << l;
        EXPECT_GT(before[l].rms, 0.1) << frequency << ", layer " << l;
      }
      EXPECT_EQ(layers, 3u);
    }
}

// Held up against its dry weight: what water adds, pulls it down.
TEST(RestingLayers, SagFreeGroomsHangWhenSoaked) {
  Scenario held = HeldScenario(true, 2.0f, CurlFollows::kParent);
  const std::vector<Off> sag = FindSag(held, 1.0f);
  uint32_t wet = 0;
  for (const Off& off : sag) wet += off.rms > 0.03;
  EXPECT_EQ(wet, 3u);
}

// It is held up against gravity as groomed, and not fixed in the world: upside down it hangs.
TEST(RestingLayers, SagFreeGroomsHangWhenTurnedOver) {
  Scenario held = HeldScenario(true, 2.0f, CurlFollows::kParent);
  held.actors[0].placement = glm::rotate(glm::mat4(1.0f), 3.1f, glm::vec3(1.0f, 0.0f, 0.0f));
  uint32_t hanging = 0;
  for (const Off& off : FindSag(held, 0.0f)) hanging += off.rms > 0.1;
  EXPECT_EQ(hanging, 3u);
}

}  // namespace
}  // namespace pelt::accuracy
