// Hair and skin are lit by the functions of bench/view, as shaders on a graphics card would.
#include "bench/picture/picture.hpp"

#include <algorithm>
#include <cmath>

#include "bench/picture/canvas.hpp"
#include "bench/picture/scene_shadows.hpp"
#include "bench/picture/shade_hair.hpp"
#include "bench/view/default_look.hpp"
#include "core/error.hpp"

#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

namespace pelt {
namespace {

// How far above the skin light is whole: the tip's height, or for hair that lies flat a share of its length.
float DepthOf(const Hair& hair) {
  float length = 0.0f;
  for (uint32_t k = 1; k < hair.knots; ++k)
    length += glm::length(hair.knot[k].at - hair.knot[k - 1].at);
  const float height = glm::dot(hair.knot[hair.knots - 1].at - hair.root, hair.normal);
  return std::max({height, 0.35f * length, 1e-4f});
}

void DrawHair(const Hair& hair, const LightSet& light, float floor, const Projection& projection,
              const SceneShadows& shadows, Canvas& canvas) {
  const float depth = DepthOf(hair);
  HairEnd last{};
  for (uint32_t k = 0; k < hair.knots; ++k) {
    const glm::vec3 at = hair.knot[k].at;
    const HairEnd end =
        ShadeKnot(hair, k, light, DepthShadow(at, hair.root, hair.normal, depth, floor),
                  shadows.OnActor(hair.actor, at), projection);
    if (k > 0) canvas.DrawHair(last, end, hair.Alpha());
    last = end;
  }
}

// A studio: a pale floor that meets a pale wall without an edge.
glm::vec3 ShadeGround(const glm::vec3& eye, const glm::vec3& ray, const SceneShadows& shadows) {
  const glm::vec3 floor(0.62f, 0.60f, 0.60f), wall(0.46f, 0.55f, 0.66f);
  const glm::vec3 shade(0.46f, 0.47f, 0.56f);  // of the floor where no sun is
  const float dip = std::clamp(-ray.y * 4.0f, 0.0f, 1.0f);
  const glm::vec3 colour = glm::mix(wall * (1.0f - 0.5f * std::max(ray.y, 0.0f)), floor, dip);
  if (ray.y >= -1e-3f || eye.y <= 0.0f) return colour;
  const float dark = shadows.OnGround(eye + ray * (-eye.y / ray.y));
  return colour * glm::mix(glm::vec3(1.0f), shade, dark);
}

// Once for each pixel: nothing in it is as fine as a sample.
void DrawGround(const Projection& projection, const SceneShadows& shadows, uint32_t samples,
                Canvas& canvas) {
  const float half = 0.5f * float(samples);
  for (uint32_t y = 0; y < canvas.height(); y += samples)
    for (uint32_t x = 0; x < canvas.width(); x += samples) {
      const glm::vec3 ray = projection.RayThrough(float(x) + half, float(y) + half);
      canvas.SetBackground(x, y, samples, ShadeGround(projection.eye(), ray, shadows));
    }
}

std::vector<std::byte> EncodePng(const std::vector<uint8_t>& rgb, uint32_t width, uint32_t height) {
  std::vector<std::byte> png;
  const auto append = [](void* to, void* data, int bytes) {
    const std::byte* first = static_cast<const std::byte*>(data);
    static_cast<std::vector<std::byte>*>(to)->insert(
        static_cast<std::vector<std::byte>*>(to)->end(), first, first + bytes);
  };
  if (!stbi_write_png_to_func(append, &png, int(width), int(height), 3, rgb.data(), int(width) * 3))
    throw Error("picture: no memory to write it as PNG");
  return png;
}

}  // namespace

std::vector<std::byte> DrawPicture(const Scenario& scenario, const FurScene& scene,
                                   const Camera& camera, VertexOrder order,
                                   const PictureOptions& options, std::vector<std::string>& notes) {
  Canvas canvas(options.width_px * options.samples, options.height_px * options.samples);
  const Projection projection(camera, canvas.width(), canvas.height());
  const LightSet light = options.light ? *options.light : DefaultLights();
  std::vector<Body> bodies;
  std::vector<std::shared_ptr<const SurfaceColour>> surfaces;
  for (const Character& character : scenario.characters) {
    surfaces.push_back(std::make_shared<const SurfaceColour>(character));
    const auto& faults = surfaces.back()->faults();
    notes.insert(notes.end(), faults.begin(), faults.end());
  }
  for (uint32_t a = 0; a < scenario.actors.size(); ++a)
    bodies.push_back(PoseBody(scenario, scene, a, surfaces[scenario.actors[a].character]));
  const std::vector<std::vector<Hair>> layers = ReadHairs(scene, order);
  const SceneShadows shadows(light.to_sun, bodies, layers);
  DrawGround(projection, shadows, options.samples, canvas);
  for (uint32_t a = 0; a < bodies.size(); ++a) {
    const auto sun = [&](const glm::vec3& at, const glm::vec3& normal) {
      return shadows.OnActor(a, at + normal * shadows.Lift(a));
    };
    DrawBody(bodies[a], light, kDefaultHair, sun, projection, canvas);
  }
  for (const std::vector<Hair>& hairs : layers) {
    for (const Hair& hair : hairs)
      DrawHair(hair, light, DepthFloor(bodies[hair.actor].mean_covered), projection, shadows,
               canvas);
    canvas.FinishLayer();
  }
  return EncodePng(canvas.Resolve(options.samples), options.width_px, options.height_px);
}

}  // namespace pelt
