// Scenes in which fur meets everything at once: layers of every solver, chain and number of points
// with keys drawn at random, in contact, rubbed, struck, overlapped, clumped, short and long, lit,
// painted.
#pragma once

#include <fmt/format.h>

#include <string>

#include "core/random.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {

template <class T>
const T& Pick(Random& random, std::initializer_list<T> values) {
  return values.begin()[random.Below(uint32_t(values.size()))];
}

// Keys of a layer of the modal solver, drawn from what each may be.
inline std::string RandomModal(Random& random, bool sag_free) {
  const char* const qualities[] = {"fast", "fine", "best"};
  const char* const curls[] = {"root", "parent"};
  std::string keys = fmt::format(
      "solver = 'modal'\nquality = '{}'\nfrequency = {}\ndamping_ratio = {}\n"
      "curl_follows = '{}'\nfriction = {}\nmax_distance = {}\n",
      qualities[random.Below(3)], Pick(random, {0.5, 1.0, 2.0, 8.0, 40.0}),
      Pick(random, {0.02, 0.1, 0.5}), curls[random.Below(2)], Pick(random, {0.0, 0.5, 1.2}),
      Pick(random, {0.0, 0.0, 0.2, 1.0}));
  if (sag_free) return keys + "sag_free = true\n";
  if (random.Below(3) == 0) keys += "inertia = 0.6\ninertia_turn = 0.5\ninertia_speed = 1.0\n";
  return keys;
}

inline std::string RandomLayer(Random& random, uint32_t number, const char* chain, uint32_t points,
                               const std::string& solver) {
  const char* const outputs[] = {"instances", "ribbons", "lines"};
  const char* const masks[] = {"['body', 'head']", "['head', 'arm']", "['body', 'tail', 'leg']"};
  std::string text = fmt::format(
      "[[layer]]\nname = 'layer {0}'\nseed = {1}\nchain = '{2}'\npoints = {3}\noutput = '{4}'\n"
      "density = 60_000\nmax_strands = {5}\nmask = {{ materials = {6} }}\n{7}",
      number, random.Below(1000) + 1, chain, points, outputs[random.Below(3)],
      120 + random.Below(80), masks[random.Below(3)], solver);
  text += fmt::format(
      "length = {{ value = {}, randomise = {} }}\nwidth = 0.001\nelevation = {}\ncurl = {}\n"
      "weight = {}\nbounce = {}\nsurface_hardness = {}\nwind_response = {}\n",
      Pick(random, {0.015, 0.03, 0.07, 0.12}), Pick(random, {0.2, 0.95}),
      Pick(random, {10.0, 40.0, 80.0}), Pick(random, {0.0, 0.0, 300.0}),
      Pick(random, {1.0, 1.0, 4.0}), Pick(random, {0.0, 0.0, 0.4}), Pick(random, {0.0, 0.5, 1.0}),
      Pick(random, {0.0, 2.0}));
  if (random.Below(2) == 0) text += "clump = 0.5\nclump_controls = 16\n";
  if (random.Below(2) == 0)
    text += "strength = { value = 0.8, randomise = 0.5, range = [0.0, 1.0] }\n";
  return text;
}

// Layers of every solver, chain and number of points, lit, painted and shells.
inline Scenario RandomScene(Random& random) {
  std::string text;
  uint32_t number = 0;
  const auto add = [&](const char* chain, uint32_t points, const std::string& solver) {
    text += RandomLayer(random, number++, chain, points, solver);
  };
  for (const bool sag_free : {false, true}) {
    add("vertex", 4, RandomModal(random, sag_free));
    for (const uint32_t points : {4u, 5u, 9u}) add("strand", points, RandomModal(random, sag_free));
  }
  add("vertex", 4, "solver = 'pbd'\n");
  for (const uint32_t points : {4u, 5u})
    for (const char* solver : {"pbd", "verlet"})
      add("strand", points, fmt::format("solver = '{}'\n", solver));
  // And with traits.
  const std::string own =
      "weight_scale = { value = 1, randomise = 0.9 }\nclump_scale = { value = 1, randomise = 1 }\n"
      "bounce_scale = { value = 1, randomise = 0.5 }\n";
  const std::string of_links =
      own + "stiffness_scale = { value = 1, randomise = 0.9 }\nhardness_profile = [1, 0.5, 2";
  const std::string limits =
      "damping_scale = { value = 2, randomise = 1 }\n"
      "angle_limit = { value = 120, randomise = 0.9 }\n";
  add("vertex", 4, RandomModal(random, false) + own);
  for (const uint32_t points : {4u, 5u, 9u})
    add("strand", points, RandomModal(random, false) + own);
  add("vertex", 4, "solver = 'pbd'\n" + of_links + "]\n" + limits);
  for (const uint32_t points : {4u, 5u})
    for (const char* solver : {"pbd", "verlet"})
      add("strand", points,
          fmt::format("solver = '{}'\n{}{}{}", solver, of_links, points == 5 ? ", 0.2]\n" : "]\n",
                      limits));
  Scenario scenario = LoadScenario(ScenarioRequest{.scene = "tiny", .setup_texts = {text}});
  for (GroomLayer& layer : scenario.grooms[0].layers) {
    layer.params.painted = random.Below(2) == 0;
    layer.params.lit = layer.params.painted || random.Below(2) == 0;
  }
  AddShells(scenario);
  scenario.base.lighting = TinyLighting();
  for (const PaintBrush& brush : TinyBrushes())
    scenario.base.brush[scenario.base.brush_count++] = brush;
  scenario.actors[0].teleport_frame = 7;
  return scenario;
}

// What strands lie in, what strokes them, what jumps about, what flies through them, and a bar.
class RandomColliders {
 public:
  explicit RandomColliders(Random& random) : random_(random) {
    for (uint32_t s = 0; s < 3; ++s) Place(centre_[s]);
    for (float& v : velocity_) v = float(random_.Uniform(-1.0, 1.0));
  }
  void Fill(uint32_t frame, bool ground, FrameInput& in) {
    in.sphere_count = 5;
    for (uint32_t s = 0; s < 5; ++s) {
      float speed[3] = {};
      if (s == 2)
        for (uint32_t k = 0; k < 3; ++k) centre_[s][k] += speed[k] = velocity_[k] * float(in.dt_s);
      if (s > 2) Place(centre_[s]);
      for (uint32_t k = 0; k < 3; ++k) {
        in.sphere[s][k] = centre_[s][k];
        if (s == 2) in.sphere_velocity[s][k] = velocity_[k];
        if (s == 4 && frame % 8 == 2)
          in.sphere_velocity[s][k] = float(random_.Uniform(-25.0, 25.0));
      }
      in.sphere[s][3] = s < 2 ? 0.12f : 0.06f;
    }
    in.capsule_count = 1;
    Place(in.capsule[0].from);
    Place(in.capsule[0].to);
    in.capsule[0].radius = 0.04f;
    in.use_ground = ground;
    in.ground[3] = -0.1f;
  }

 private:
  void Place(float (&at)[3]) {
    const double low[3] = {-0.35, 0.3, -0.3}, high[3] = {0.35, 1.2, 0.4};
    for (uint32_t k = 0; k < 3; ++k) at[k] = float(random_.Uniform(low[k], high[k]));
  }
  Random& random_;
  float centre_[5][3] = {}, velocity_[3];
};

}  // namespace pelt::testing
