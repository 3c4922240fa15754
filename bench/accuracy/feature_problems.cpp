// What features are measured on.
#include "bench/accuracy/feature_errors.hpp"
#include "bench/accuracy/solver_run.hpp"
#include "core/exact_math.hpp"
#include "core/random.hpp"

namespace pelt::accuracy {
namespace {

constexpr double kRootDistance = 0.1;  // m from the body's centre
constexpr uint32_t kStrands = 2 * kLaneGroup;

// Strands around `axis`, leaning up to `spread` from it; link i rests turned by i * `curl` from the
// first, about an axis across it.
std::vector<Strand> Tuft(int links, Double3 axis, double spread, double curl) {
  std::vector<Strand> strands;
  Random random(7);
  for (uint32_t s = 0; s < kStrands; ++s) {
    const auto part = [&] { return random.Uniform(-spread, spread); };
    const double x = part(), y = part(), z = part();
    Strand strand;
    const Double3 up = Unit(axis + Double3{x, y, z});
    const Double3 across = Unit(Cross(up, Double3{0.3, 0.2, 1.0}));
    strand.root = up * kRootDistance;
    for (int i = 0; i < links; ++i)
      strand.rest[size_t(i)] = up * exact::Cos(i * curl) + across * exact::Sin(i * curl);
    strands.push_back(strand);
  }
  return strands;
}

}  // namespace

std::vector<FeatureProblem> FeatureProblems(int links) {
  const ChainMaterial medium = MakeMaterial(kPresets[2], links);
  const Double3 side = {1.0, 0.0, 0.0}, down = {1.0, -0.6, 0.0};
  ModalFeatures bare;
  bare.wind = false;
  const auto with = [&](auto change) {
    ModalFeatures features = bare;
    change(features);
    return features;
  };
  // Curled so far that tips brush the surface. Pressed harder (1.6) the folded strands have more
  // than one place to go, and the reference itself does not converge.
  const auto curled = Tuft(links, side, 0.3, links == 3 ? 1.56 : 1.04);
  const auto straight = Tuft(links, side, 0.3, 0.1), leaning = Tuft(links, down, 0.2, 0.1);
  const double ground = 0.085;  // below the root, m; the walk's lowest dip 3 mm under it
  const auto surface = [](ModalFeatures& f) { f.surface_hardness = 1.0f; };
  const auto on_ground = [=](ModalFeatures& f) { f.use_ground = true, f.ground_offset = ground; };
  const auto to_and_fro = [](ModalFeatures& f) {
    f.swing = {0.0, 0.0, 0.02};
    f.swing_period = 0.5;
  };
  const auto bar = [](double radius, double z, ModalFeatures& f) {
    f.capsule_radius = radius;
    f.capsule_from = {0.16, -0.1, z}, f.capsule_to = {0.16, 0.1, z};
  };
  std::vector<FeatureProblem> problems;
  problems.push_back({"bare", medium, straight, Motion::kHeadshake, bare});
  problems.push_back({"surface", medium, curled, Motion::kHeadshake, with(surface)});
  // In the way of the tips, from the side. (Head on, a strand may pass a sphere on either side, and
  // no solver can know which.)
  problems.push_back({"sphere", medium, straight, Motion::kHeadshake, with([](ModalFeatures& f) {
                        f.sphere_radius = 0.1;
                        f.sphere_centre = {0.16, 0.0, 0.16};
                      })});
  // To and fro through their tips at up to 0.25 m/s.
  problems.push_back(
      {"moving sphere", medium, straight, Motion::kHeadshake, with([=](ModalFeatures& f) {
         f.sphere_radius = 0.05;
         f.sphere_centre = {0.16, 0.0, 0.09};
         to_and_fro(f);
       })});
  problems.push_back({"ground", medium, leaning, Motion::kWalk, with(on_ground)});
  problems.push_back({"bounce", medium, leaning, Motion::kWalk, with([=](ModalFeatures& f) {
                        on_ground(f);
                        f.bounce = 0.5f;
                      })});
  problems.push_back(
      {"ground, friction", medium, leaning, Motion::kWalk, with([=](ModalFeatures& f) {
         on_ground(f);
         f.friction = 0.3f;
       })});
  problems.push_back({"capsule", medium, straight, Motion::kHeadshake,
                      with([=](ModalFeatures& f) { bar(0.1, 0.16, f); })});
  problems.push_back(
      {"moving capsule", medium, straight, Motion::kHeadshake, with([=](ModalFeatures& f) {
         bar(0.05, 0.09, f);
         to_and_fro(f);
       })});
  problems.push_back({"moving capsule, friction", medium, straight, Motion::kHeadshake,
                      with([=](ModalFeatures& f) {
                        bar(0.05, 0.09, f);
                        to_and_fro(f);
                        f.friction = 0.3f;
                      })});
  // One strand's tip 4 mm inside from the start, and another's root.
  const auto upright = Tuft(links, side, 0.0, 0.0);
  const LinkDirections rests = FindEquilibrium(medium, upright[0]);
  Double3 tip = upright[0].root;
  for (int i = 0; i < links; ++i) tip = tip + rests[size_t(i)] * medium.length[size_t(i)];
  // 3 cm at 10 m/s after half a second, past the lower side of all of them: where it meets a strand
  // in the middle, no solver can know on which side the strand gets out of its way.
  problems.push_back({"fast sphere", medium, Tuft(links, side, 0.02, 0.1), Motion::kStill,
                      with([=](ModalFeatures& f) {
                        f.sphere_radius = 0.015;
                        f.sphere_centre = tip + Double3{-0.006, -0.0125, -5.0};
                        f.going = {0.0, 0.0, 10.0};
                      }),
                      1.0, Promise::kNone, 16});
  // A bar as thick and as fast over the tops of them.
  problems.push_back({"fast capsule", medium, Tuft(links, side, 0.02, 0.1), Motion::kStill,
                      with([=](ModalFeatures& f) {
                        f.capsule_radius = 0.015;
                        f.capsule_from = tip + Double3{0.008, -0.05, -5.0};
                        f.capsule_to = tip + Double3{0.008, 0.05, -5.0};
                        f.going = {0.0, 0.0, 10.0};
                      }),
                      1.0, Promise::kNone, 16});
  problems.push_back({"overlap", medium, upright, Motion::kStill, with([=](ModalFeatures& f) {
                        f.sphere_radius = 0.02;
                        f.sphere_centre = tip + Double3{0.0, 0.0, 0.016};
                      }),
                      0.0, Promise::kLeavesSlowly});
  problems.push_back({"root inside", medium, upright, Motion::kStill, with([=](ModalFeatures& f) {
                        f.sphere_radius = 0.03;
                        f.sphere_centre = upright[0].root + Double3{0.0275, 0.004, 0.006};
                      }),
                      0.0, Promise::kComesToRest});
  problems.push_back({"limit", medium, straight, Motion::kHeadshake,
                      with([](ModalFeatures& f) { f.max_distance = 0.2f; })});
  problems.push_back({"clump", medium, straight, Motion::kHeadshake,
                      with([](ModalFeatures& f) { f.clump = 0.3f; })});
  problems.push_back({"strength 0.5", medium, straight, Motion::kHeadshake,
                      with([](ModalFeatures& f) { f.strength = 0.5f; })});
  problems.push_back(
      {"wind", medium, straight, Motion::kWind, with([](ModalFeatures& f) { f.wind = true; })});
  return problems;
}

}  // namespace pelt::accuracy
