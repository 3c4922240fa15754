// Sampled motion between its keys: as it was where it was smooth, still where it was still.
#include <gtest/gtest.h>

#include <cmath>

#include "core/character/clips.hpp"
#include "core/character/gltf_import.hpp"
#include "core/character/pose.hpp"
#include "core/exact_math.hpp"
#include "tests/character/shared_files.hpp"

namespace pelt::test {
namespace {

constexpr double kTwoPi = 2.0 * exact::kPi;

Track Sampled(Channel channel, int keys, double seconds, auto value) {
  Track track{0, channel, Interpolation::kLinear, {}, {}};
  for (int k = 0; k < keys; ++k) {
    const double t = seconds * k / (keys - 1);
    track.time_s.push_back(float(t));
    track.value.push_back(glm::vec4(value(t)));
  }
  return track;
}

Character With(std::vector<Track> tracks) {
  Character character;
  character.skeleton.name = {"root"};
  character.skeleton.parent = {-1};
  character.skeleton.rest.resize(1);
  character.skeleton.inverse_bind.resize(1);
  character.clips = {{"swing", tracks[0].time_s.back(), std::move(tracks)}};
  return character;
}

glm::dvec4 Swing(double t) { return {exact::Sin(kTwoPi * t), exact::Cos(kTwoPi * t), 0.0, 0.0}; }
// About z, up to 60 degrees.
glm::dvec4 Turn(double t) {
  const double half = 0.5 * exact::Sin(kTwoPi * t) * exact::kPi / 3.0;
  return {0.0, 0.0, exact::Sin(half), exact::Cos(half)};
}

// Where the only joint is, of the four keys that a pose blends.
glm::dvec4 At(const Character& character, Channel channel, double t) {
  const auto pose =
      std::make_unique<PoseBlock>(MakePose(character.skeleton, &character.clips[0], t, false, {}));
  glm::dvec4 sum(0.0);
  for (size_t k = 0; k < 4; ++k)
    for (int c = 0; c < (channel == Channel::kRotation ? 4 : 3); ++c)
      sum[c] += channel == Channel::kRotation ? double(pose->rotation_key[k][size_t(c)][0]) *
                                                    double(pose->rotation_weight[k][0])
                                              : double(pose->translation_key[k][size_t(c)][0]) *
                                                    double(pose->translation_weight[k][0]);
  if (channel == Channel::kRotation) sum /= std::sqrt(glm::dot(sum, sum));
  return sum;
}

// The largest distance from `value` over the clip's second.
double Furthest(const Character& character, Channel channel, auto value) {
  double most = 0.0;
  for (int i = 0; i <= 1000; ++i) {
    const glm::dvec4 by = At(character, channel, i / 1000.0) - value(i / 1000.0);
    most = std::max(most, std::sqrt(glm::dot(by, by)));
  }
  return most;
}

TEST(SmoothClips, GoWhereTheMotionWentThatWasSampled) {
  for (const auto& [channel, motion] :
       {std::pair{Channel::kTranslation, &Swing}, std::pair{Channel::kRotation, &Turn}}) {
    Character character = With({Sampled(channel, 25, 1.0, motion)});
    const double lines = Furthest(character, channel, motion);
    SmoothClips(character);
    EXPECT_EQ(character.clips[0].tracks[0].interpolation, Interpolation::kCubicSpline);
    EXPECT_LT(Furthest(character, channel, motion), 0.1 * lines);
    ASSERT_EQ(character.notes.size(), 1u);
    EXPECT_NE(character.notes[0].find("1 of 1 tracks"), std::string::npos) << character.notes[0];
  }
}

// Fur feels a corner as a blow: before and behind a key it moves alike, where the clip loops too.
TEST(SmoothClips, HaveNoCorners) {
  Character character = With({Sampled(Channel::kTranslation, 25, 1.0, Swing)});
  SmoothClips(character);
  const Track& track = character.clips[0].tracks[0];
  for (size_t k = 0; k < track.time_s.size(); ++k)
    EXPECT_EQ(track.value[3 * k], track.value[3 * k + 2]);
  EXPECT_EQ(track.value[0], track.value[track.value.size() - 3]);
}

// A still joint lets its chunks sleep.
TEST(SmoothClips, HoldStillWhatWasStill) {
  const auto steps = [](double t) { return glm::dvec4(std::floor(4.0 * t), 0.0, 0.0, 0.0); };
  Character character = With({Sampled(Channel::kTranslation, 41, 1.0, steps)});
  SmoothClips(character);
  const double places[] = {0.0, 0.05, 0.1, 0.15, 0.2};
  for (const double t : places) EXPECT_EQ(At(character, Channel::kTranslation, t).x, 0.0) << t;
  EXPECT_EQ(At(character, Channel::kTranslation, 0.3).x, 1.0);
}

TEST(SmoothClips, LeaveWhatIsNotSampledMotion) {
  const auto still = [](double) { return glm::dvec4(1.0, 1.0, 1.0, 0.0); };
  const auto spin = [](double t) {  // three turns in twelve keys
    return glm::dvec4(0.0, 0.0, exact::Sin(3.0 * exact::kPi * t), exact::Cos(3.0 * exact::kPi * t));
  };
  Track stepped = Sampled(Channel::kTranslation, 25, 1.0, Swing);
  stepped.interpolation = Interpolation::kStep;
  for (const Track& track :
       {Sampled(Channel::kTranslation, 11, 1.0, Swing), Sampled(Channel::kScale, 25, 1.0, still),
        Sampled(Channel::kRotation, 12, 1.0, spin), Sampled(Channel::kTranslation, 2, 0.1, Swing),
        stepped}) {
    Character character = With({track});
    SmoothClips(character);
    EXPECT_EQ(character.clips[0].tracks[0].interpolation, track.interpolation);
    EXPECT_EQ(character.clips[0].tracks[0].value, track.value);
    EXPECT_TRUE(character.notes.empty());
  }
}

// A rotation may come back as the other of the two quaternions that it is.
TEST(SmoothClips, ALoopMayEndOnTheOtherQuaternion) {
  Track track = Sampled(Channel::kRotation, 25, 1.0, Turn);
  track.value.back() = -track.value.front();
  for (size_t k = 13; k < 24; ++k) track.value[k] = -track.value[k];
  Character character = With({track});
  SmoothClips(character);
  EXPECT_LT(Furthest(character, Channel::kRotation,
                     [&](double t) {
                       const glm::dvec4 is = At(character, Channel::kRotation, t);
                       return glm::dot(is, Turn(t)) < 0.0 ? -Turn(t) : Turn(t);
                     }),
            5e-4);
}

TEST(SmoothClips, RealFiles) {
  const std::string fox = FindShared("Fox.glb");
  if (fox.empty()) GTEST_SKIP() << "Fox.glb is not there (set PELT_SHARED)";
  Character character = ImportGltfFile(fox);
  SmoothClips(character);
  size_t cubic = 0, all = 0;
  for (const Clip& clip : character.clips)
    for (const Track& track : clip.tracks) {
      ++all;
      cubic += track.interpolation == Interpolation::kCubicSpline;
    }
  EXPECT_GT(cubic, all / 2);
}

}  // namespace
}  // namespace pelt::test
