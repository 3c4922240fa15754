#include "bench/viewer/page_view.hpp"

#include <fmt/format.h>

#include "bench/viewer/data_views.hpp"
#include "bench/viewer/page_json.hpp"
#include "core/exact_math.hpp"

namespace pelt {

Camera StandAt(const PageCamera& user, const Camera& own) {
  Camera camera = own;
  const double level = user.distance_m * exact::Cos(user.elevation_rad);
  const glm::vec3 from(float(level * exact::Sin(user.yaw_rad)),
                       float(user.distance_m * exact::Sin(user.elevation_rad)),
                       float(level * exact::Cos(user.yaw_rad)));
  for (int c = 0; c < 3; ++c) {
    camera.target[c] = user.target[c];
    camera.eye[c] = user.target[c] + from[c];
  }
  return camera;
}

const PictureScene& PageView::Picture(float share) {
  // Of all views, as one renderer may show several.
  static uint64_t gathered = 0;
  if (is_kept_ && share == 1.0f) {
    Light(kept_);
    return kept_;
  }
  kept_ = Gather(share);
  kept_.content = ++gathered;
  // In between, nothing is where the frame has it.
  is_kept_ = share == 1.0f;
  if (is_kept_ && posed_.empty()) posed_ = kept_.bodies;
  return kept_;
}

PageJson DescribeEntry(const PageEntry& entry, const PageSettings& settings) {
  return {{"key", entry.key},          {"group", entry.group}, {"unit", entry.unit},
          {"low", entry.low},          {"high", entry.high},   {"text", entry.text},
          {"switch", entry.is_switch}, {"words", entry.words}, {"value", entry.get(settings)}};
}

PageJson DescribeOrbit(const PageCamera& camera) {
  return {{"target", {camera.target.x, camera.target.y, camera.target.z}},
          {"yaw", camera.yaw_rad},
          {"elevation", camera.elevation_rad},
          {"distance", camera.distance_m}};
}

PageJson DescribeViews() {
  PageJson views = PageJson::array();
  for (const DataView& view : DataViews())
    views.push_back({{"name", view.name}, {"text", view.text}});
  return views;
}

PageJson DescribeJoints(std::span<const std::string> names) {
  PageJson joints = PageJson::array();
  for (uint32_t j = 0; j < names.size(); ++j) {
    const uint32_t colour = ColourOfJoint(j);
    joints.push_back({{"name", names[j]},
                      {"colour", fmt::format("#{:02x}{:02x}{:02x}", colour & 255u,
                                             colour >> 8 & 255u, colour >> 16 & 255u)}});
  }
  return joints;
}

PageJson DescribePasses(const FurScene& scene) {
  PageJson passes = PageJson::array();
  for (const Pass& pass : scene.plan().passes) {
    PageJson stages = PageJson::array();
    for (uint32_t s = 0; s < pass.stage_count; ++s)
      stages.push_back(scene.plan().stages[pass.first_stage + s].kernel.name);
    passes.push_back({{"domain", DomainName(pass.domain)},
                      {"items", scene.shape().ItemCount(pass.domain)},
                      {"stages", stages},
                      {"resident_bytes", pass.resident_bytes},
                      {"get_bytes", pass.get_bytes},
                      {"put_bytes", pass.put_bytes}});
  }
  return passes;
}

PageJson DescribeStages(const FurScene& scene, const FrameRecording& times) {
  const Plan& plan = scene.plan();
  const double ms_per_tick = times.NsPerTick() * 1e-6;
  PageJson stages = PageJson::array();
  for (uint32_t s = 0; s < plan.stages.size(); ++s) {
    uint64_t ticks = 0;
    uint32_t ran = 0;
    const uint32_t items = scene.shape().ItemCount(plan.stages[s].domain);
    for (uint32_t i = 0; i < items; ++i) {
      const Slice slice = times.Stage(s, i);
      if (!slice.Ran()) continue;
      ++ran;
      ticks += slice.Ticks();
    }
    stages.push_back({{"name", plan.stages[s].kernel.name},
                      {"ms", double(ticks) * ms_per_tick},
                      {"ran", ran},
                      {"of", items}});
  }
  return stages;
}

PageJson DescribeLayerCosts(const Scenario& scenario, const FurScene& scene,
                            const FrameRecording& times) {
  const SceneShape& shape = scene.shape();
  std::vector<uint64_t> ticks(shape.layer_count);
  for (uint32_t s = 0; s < scene.plan().stages.size(); ++s) {
    const Domain domain = scene.plan().stages[s].domain;
    if (domain < Domain::kLayer) continue;  // of the scene or a whole character
    for (uint32_t i = 0; i < shape.ItemCount(domain); ++i)
      if (const Slice slice = times.Stage(s, i); slice.Ran())
        ticks[shape.LayerOf(domain, i)] += slice.Ticks();
  }
  PageJson costs(scenario.setups.size(), PageJson::object());
  for (uint32_t l = 0; l < shape.layer_count; ++l) {
    PageJson& of_setup = costs[scenario.actors[shape.layer_character[l]].groom];
    const std::string name(scene.LayerName(l));
    of_setup[name] = of_setup.value(name, 0.0) + double(ticks[l]) * times.NsPerTick();
  }
  return costs;
}

}  // namespace pelt
