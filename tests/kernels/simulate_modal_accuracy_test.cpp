// The modal kernel against fixed values: motions whose exact solution two independent programs
// found to nine digits (high-order integration in double), and what must not depend on frame rate.
#include <gtest/gtest.h>

#include "tests/kernels/modal_scene.hpp"

namespace pelt::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Mueller's pendulum challenge: three masses on a chain of 0.3 m links, from (0.3, 0), (0.3, 0.3),
// (0.3, 0.6) at rest; the third point's place after one second.
double PendulumMiss(ModalQuality quality, void (*spoil)(ModalTableBlock&) = nullptr) {
  auto s = std::make_unique<ModalScene<4>>(UniformLinks(3, 0.0, 0.0, 0.0), 1);
  s->quality = quality;
  s->layer.gravity[1] = -10.0f;
  s->SetRest(0, 0.3, {1, 0, 0});
  s->Step(1.0 / 60.0);
  s->SetDirection(0, 1, {0, 1, 0});
  s->SetDirection(0, 2, {0, 1, 0});
  for (int frame = 0; frame < 60; ++frame) {
    if (!spoil) {
      s->Step(1.0 / 60.0);
      continue;
    }
    FillModalTable(s->material, quality, {{1.0 / 60, 1.0 / 60, 1.0 / 60}}, &s->table);
    spoil(s->table);
    s->Run(BestIsa());
  }
  return Length(s->Tip(0) - Double3{-0.617362810, -0.086025600, 0.0});
}

TEST(SimulateModalAccuracy, PendulumChallengeWithinAMillimetre) {
  const double miss = PendulumMiss(ModalQuality::kBest);
  RecordProperty("miss_um", int(miss * 1e6));
  EXPECT_LT(miss, 0.001);
}

TEST(SimulateModalAccuracy, PendulumNoticesWhatIsLeftOut) {
  // The constraint's impulse, and the tangent velocities.
  EXPECT_GT(PendulumMiss(ModalQuality::kBest, [](ModalTableBlock& t) { t.impulse[2] = 0.0f; }),
            0.005);
  EXPECT_GT(PendulumMiss(ModalQuality::kBest,
                         [](ModalTableBlock& t) { t.slope[2][2] = t.slope[1][1] = 0.0f; }),
            0.001);
}

// Medium fur let go from straight out, 3 or 4 equal links of a 4 cm strand.
template <uint32_t kPoints>
std::unique_ptr<ModalScene<kPoints>> MakeRelease() {
  auto s = std::make_unique<ModalScene<kPoints>>(UniformLinks(kPoints - 1, 5.0, 0.05, 6.0), 1);
  s->SetRest(0, 0.04 / (kPoints - 1), {1, 0, 0});
  s->Step(1.0 / 60.0);
  for (uint32_t i = 0; i + 1 < kPoints; ++i)
    for (int k = 0; k < 3; ++k) s->chain.velocity[i][k][0] = 0.0f;
  return s;
}

struct Sample {
  double time, x, y;
};
constexpr Sample kRelease3[] = {
    {0.05, 0.0384172067, -0.0109294530}, {0.1, 0.0348790825, -0.0191269922},
    {0.2, 0.0393052139, -0.0073033411},  {0.5, 0.0376600073, -0.0132016435},
    {1.0, 0.0380801792, -0.0119979949},  {4.0, 0.0380514679, -0.0120845556}};
constexpr Sample kRelease4[] = {{0.05, 0.0382675956, -0.0113379254},
                                {0.1, 0.0344707858, -0.0196480577},
                                {0.2, 0.0392428490, -0.0075681544},
                                {1.0, 0.0379126747, -0.0124005781},
                                {4.0, 0.0378892854, -0.0124674222}};

// Largest distance from the samples, as a share of the strand's length.
template <uint32_t kPoints, size_t kCount>
double ReleaseMiss(const Sample (&samples)[kCount], ModalQuality quality) {
  auto s = MakeRelease<kPoints>();
  s->quality = quality;
  double worst = 0.0;
  int frame = 0;
  for (const Sample& sample : samples) {
    for (; frame < int(sample.time * 60.0 + 0.5); ++frame) s->Step(1.0 / 60.0);
    worst = std::max(worst, Length(s->Tip(0) - Double3{sample.x, sample.y, 0.0}) / 0.04);
  }
  return worst;
}

TEST(SimulateModalAccuracy, ReleasedStrandSwingsAsItMust) {
  EXPECT_LT(ReleaseMiss<4>(kRelease3, ModalQuality::kFast), 0.02);
  EXPECT_LT(ReleaseMiss<4>(kRelease3, ModalQuality::kFine), 0.003);
  EXPECT_LT(ReleaseMiss<4>(kRelease3, ModalQuality::kBest), 0.001);
  EXPECT_LT(ReleaseMiss<5>(kRelease4, ModalQuality::kFine), 0.003);
  EXPECT_LT(ReleaseMiss<5>(kRelease4, ModalQuality::kBest), 0.001);
}

// Headshake with curl (rest shape carried by the root): tip at 0.5, 1, 2 and 4 s.
double HeadshakeMiss(ModalQuality quality) {
  constexpr struct {
    double time;
    Double3 tip;
  } kSamples[] = {{0.5, {0.0829467752, 0.1004301265, 0.0170030881}},
                  {1.0, {0.0877730275, 0.0911681354, 0.0343395718}},
                  {2.0, {0.0919583606, 0.0929390339, 0.0086427242}},
                  {4.0, {0.0879352326, 0.1014664776, 0.0145745875}}};
  const auto turn = [](double t, Double3 p) {
    const double on =
        0.5 * (1 + std::tanh((t - 0.5) / 0.1)) * (1 - 0.5 * (1 + std::tanh((t - 2.5) / 0.08)));
    const double yaw = 0.7 * on * std::sin(2 * kPi * 2 * t);
    const double pitch = 0.15 * on * std::sin(2 * kPi * 1.3 * t);
    const Double3 q = {p.x, std::cos(pitch) * p.y - std::sin(pitch) * p.z,
                       std::sin(pitch) * p.y + std::cos(pitch) * p.z};
    return Double3{std::cos(yaw) * q.x + std::sin(yaw) * q.z, q.y,
                   std::cos(yaw) * q.z - std::sin(yaw) * q.x};
  };
  auto s = std::make_unique<ModalScene<4>>(UniformLinks(3, 5.0, 0.05, 6.0), 1);
  s->quality = quality;
  double worst = 0.0;
  int frame = 0;
  for (const auto& sample : kSamples)
    for (; frame <= int(sample.time * 60.0 + 0.5); ++frame) {
      const double t = frame / 60.0;
      std::vector<Double3> rest;
      for (const double a : {0.0, 0.35, 0.7})
        rest.push_back(turn(t, {0.6 * std::cos(a), 0.8 * std::cos(a), std::sin(a)}));
      s->SetRest(0, 0.04 / 3, rest);
      s->MoveRoot(0, turn(t, {0.06, 0.08, 0}));
      s->Step(1.0 / 60.0);
      if (frame == int(sample.time * 60.0 + 0.5))
        worst = std::max(worst, Length(s->Tip(0) - sample.tip) / 0.04);
    }
  return worst;
}

TEST(SimulateModalAccuracy, HeadshakeWithCurl) {
  EXPECT_LT(HeadshakeMiss(ModalQuality::kFast), 0.02);
  EXPECT_LT(HeadshakeMiss(ModalQuality::kFine), 0.005);
  EXPECT_LT(HeadshakeMiss(ModalQuality::kBest), 0.003);
}

TEST(SimulateModalAccuracy, StaticShapeIsTheSameAtEveryFrameRate) {
  const Double3 exact = {0.0380514679, -0.0120845556, 0.0};
  for (const double rate : {15.0, 24.0, 30.0, 60.0, 120.0, 240.0}) {
    for (const bool uneven : {false, true}) {
      auto s = MakeRelease<4>();
      s->params.rest_threshold = kRestThreshold;
      for (int frame = 0; frame < 6 * rate; ++frame)
        s->Step((uneven ? 0.7 + 0.2 * (frame % 4) : 1.0) / rate);
      EXPECT_LT(Length(s->Tip(0) - exact) / 0.04, 1e-4) << rate << (uneven ? " uneven" : "");
    }
  }
}

TEST(SimulateModalAccuracy, SmallSwingHasItsModesFrequencyAndDecay) {
  constexpr double kAmplitude = 1e-3;
  const ModalMaterial material = UniformLinks(3, 3.0, 0.03, 2.0);
  const ModalModes modes = FindModes(material);
  for (const double rate : {15.0, 60.0, 240.0})
    for (uint32_t mode : {0u, 1u}) {
      auto s = std::make_unique<ModalScene<4>>(material, 1);
      s->layer.gravity[1] = 0.0f;
      s->Step(1.0 / rate);
      const double scale = kAmplitude / modes.shape[2][mode];
      for (uint32_t i = 0; i < 3; ++i) {
        const double angle = scale * modes.shape[i][mode];
        s->SetDirection(0, i, {std::cos(angle), std::sin(angle), 0});
      }
      const double decay =
          0.5 * (material.drag_per_s + material.bend_damping_s * modes.omega2[mode]);
      const double omega = std::sqrt(modes.omega2[mode] - decay * decay);
      for (int frame = 1; frame <= int(rate); ++frame) {
        s->Step(1.0 / rate);
        const double t = frame / rate;
        const double expected = kAmplitude * std::exp(-decay * t) *
                                (std::cos(omega * t) + decay / omega * std::sin(omega * t));
        ASSERT_NEAR(s->chain.direction[2][1][0], expected, 5e-3 * kAmplitude)
            << rate << " fps, mode " << mode << ", frame " << frame;
      }
    }
}

}  // namespace
}  // namespace pelt::test
