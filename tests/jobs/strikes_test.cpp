// A ball that flies through a coat within a frame: the strands in its way are met where it is, and
// followed closely until they have calmed down. What its way misses and hits:
// tests/kernels/simulate_modal_collider_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "bench/accuracy/double3.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

using accuracy::Double3, accuracy::Length;

constexpr double kFrame_s = 1.0 / 60.0;
constexpr float kSpeed = 20.0f;  // m/s, along z: 33 cm in a frame
constexpr float kRadius = 0.3f;  // m

// `tiny` in its rest pose with straight strands on its head, and nothing that moves or touches them.
Scenario CoatScenario() {
  Scenario scenario = TinyScenario();
  for (GroomLayer& layer : scenario.grooms[0].layers) layer.params.enabled = false;
  AddLayers(scenario,
            "[[layer]]\n"
            "name = 'coat'\n"
            "solver = 'modal'\n"
            "frequency = 3\n"
            "chain = 'strand'\n"
            "points = 4\n"
            "density = 100_000\n"
            "max_strands = 2000\n"
            "mask = { materials = ['head'] }\n"
            "length = 0.08\n"
            "elevation = 90\n"
            "surface_hardness = 0\n"
            "backface_cull = false\n");
  scenario.actors[0].clip = -1;
  scenario.actors[0].teleport_frame = -1;
  scenario.spheres.clear();
  scenario.base.use_ground = false;
  scenario.base.wind = {};
  scenario.base.gravity[1] = 0.0f;
  scenario.weather_course = {};
  return scenario;
}

struct Strand {
  Double3 point[4];  // from the root
  float quiet_s;
};

class Coat {
 public:
  // Two frames without a ball, so that nothing moves.
  Coat() : run_(scenario_, {}) {
    RunFrame();
    RunFrame();
  }
  // The ball is at `at` when the frame ends, and went there all the time.
  void RunWithBall(const Double3& at) {
    ball_ = at;
    RunFrame(1);
  }
  void RunFrame(uint32_t balls = 0) {
    FrameInput input = run_.Prepare(frame_++, {}, {});
    input.skip.cull = false;
    input.sphere_count = balls;
    const float ball[4] = {float(ball_.x), float(ball_.y), float(ball_.z), kRadius};
    std::copy_n(ball, 4, input.sphere[0]);
    input.sphere_velocity[0][2] = kSpeed;
    RunInput(run_, input);
  }
  std::vector<Strand> Strands() const {
    std::vector<Strand> all;
    const FrameMemory& memory = run_.scene().memory();
    for (uint32_t c = 0; c < run_.scene().shape().chunk_count; ++c) {
      const auto* chain = memory.Of<&Streams::strand_modal4>(c);
      if (!chain) continue;
      const auto& roots = *memory.Of<&Streams::roots>(c);
      const auto& points = *memory.Of<&Streams::strand_points4>(c);
      for (uint32_t s = 0; s < memory.Of<&Streams::chunk_state>(c)->live_strands; ++s) {
        Strand strand{{At(roots.position, s)}, chain->quiet_s[s]};
        for (int i = 0; i < 3; ++i) strand.point[i + 1] = At(points.position[i], s);
        all.push_back(strand);
      }
    }
    return all;
  }

 private:
  static Double3 At(const auto& rows, uint32_t lane) {
    return {rows[0][lane], rows[1][lane], rows[2][lane]};
  }

  Scenario scenario_ = CoatScenario();
  RunningScenario run_;
  Double3 ball_{};
  uint32_t frame_ = 0;
};

// From the ball's surface to the nearest point of the strand, m; below 0 inside.
double Gap(const Strand& strand, const Double3& ball) {
  double nearest = 1.0e3;
  for (int i = 0; i < 3; ++i) {
    const Double3 link = strand.point[i + 1] - strand.point[i], to = ball - strand.point[i];
    const double share = std::clamp(Dot(to, link) / Dot(link, link), 0.0, 1.0);
    nearest = std::min(nearest, Length(to - link * share));
  }
  return nearest - double(kRadius);
}

// Ends of the ball's way, one after the other through the coat.
std::vector<Double3> EndsOfWays(const std::vector<Strand>& strands) {
  Double3 low = strands[0].point[0], high = low;
  for (const Strand& s : strands)
    for (const Double3& p : s.point) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  std::vector<Double3> ends;
  for (int i = 1; i < 24; ++i)
    ends.push_back({0.5 * (low.x + high.x), high.y + double(kRadius) - 0.06,
                    low.z + (high.z - low.z) * i / 24.0});
  return ends;
}

// What the ball met within its last half millisecond lies against it, and not ahead of it by what it
// goes until it is looked for again (2.5 mm). The middle strand of them: some whip away from it.
TEST(Strikes, MeetStrandsWhereTheBallIs) {
  const std::vector<Strand> rest = Coat().Strands();
  const Double3 late = {0.0, 0.0, double(kSpeed) * 5.0e-4};
  std::vector<double> gaps;
  for (const Double3& end : EndsOfWays(rest)) {
    Coat coat;
    coat.RunWithBall(end);
    const std::vector<Strand> now = coat.Strands();
    ASSERT_EQ(now.size(), rest.size());
    for (size_t s = 0; s < now.size(); ++s) {
      // Roots that it goes over are another matter.
      const bool has_root = Length(rest[s].point[0] - end) < double(kRadius) + 0.01;
      if (!has_root && Gap(rest[s], end) < -5.0e-4 && Gap(rest[s], end - late) > 0.0)
        gaps.push_back(Gap(now[s], end));
    }
  }
  ASSERT_GT(gaps.size(), 50u);
  std::ranges::sort(gaps);
  const double middle = gaps[gaps.size() / 2];
  std::printf("%zu strands, %.3f mm from the ball\n", gaps.size(), 1e3 * middle);
  EXPECT_GT(middle, -1.0e-4);
  EXPECT_LT(middle, 2.0e-5);
}

// For a tenth of a second from when it was last struck, or turned fast: that is counted up to 0.
TEST(Strikes, AreFollowedUntilStrandsTurnSlowly) {
  constexpr float kFor = 0.1f;
  Coat coat;
  coat.RunWithBall(EndsOfWays(coat.Strands())[16]);
  std::vector<Strand> before = coat.Strands();
  const auto count_struck = [](const std::vector<Strand>& strands) {
    return std::ranges::count_if(strands, [](const Strand& s) { return s.quiet_s < 0.0f; });
  };
  const auto struck = count_struck(before);
  EXPECT_GT(struck, 50);
  EXPECT_LT(struck, ptrdiff_t(before.size()));
  for (const Strand& s : before) EXPECT_TRUE(s.quiet_s >= 0.0f || s.quiet_s == -kFor);
  uint32_t frames = 0;
  for (; frames < 120 && count_struck(before) > 0; ++frames) {
    coat.RunFrame();
    const std::vector<Strand> now = coat.Strands();
    for (size_t s = 0; s < now.size(); ++s) {
      if (!(before[s].quiet_s < 0.0f)) continue;
      const float later = std::min(before[s].quiet_s + float(kFrame_s), 0.0f);
      EXPECT_TRUE(now[s].quiet_s == -kFor || now[s].quiet_s == later)
          << "frame " << frames << ", strand " << s << ": " << now[s].quiet_s;
    }
    before = now;
  }
  EXPECT_GE(frames, 6u);
  EXPECT_EQ(count_struck(before), 0);
}

}  // namespace
}  // namespace pelt::testing
