// Hair and skin are lit by the functions of bench/view, as shaders on a graphics card would.
#include "bench/picture/picture.hpp"

#include <algorithm>

#include "bench/picture/canvas.hpp"
#include "bench/picture/png.hpp"
#include "bench/picture/scene_shadows.hpp"
#include "bench/picture/shade_hair.hpp"
#include "bench/picture/shells.hpp"
#include "bench/view/studio.hpp"

namespace pelt {
namespace {

void DrawHair(const Hair& hair, const PictureLook& look, float floor, const Projection& projection,
              const SceneShadows& shadows, const StripTexture& strips, Canvas& canvas) {
  const float depth = hair.DepthOfLight();
  HairEnd last{};
  for (uint32_t k = 0; k < hair.knots; ++k) {
    const glm::vec3 at = hair.knot[k].at;
    const HairEnd end = ShadeKnot(hair, k, look.light, look.hair,
                                  DepthShadow(at, hair.root, hair.normal, depth, floor),
                                  shadows.OnActor(hair.actor, at), projection);
    const float pieces = float(hair.knots - 1);
    const CardPiece card{&strips, hair.film_strip, float(k - 1) / pieces, float(k) / pieces};
    if (k > 0) canvas.DrawHair(last, end, hair.Alpha(), hair.is_card ? &card : nullptr);
    last = end;
  }
}

glm::vec3 ShadeGround(const glm::vec3& eye, const glm::vec3& ray, const glm::vec3& room,
                      const SceneShadows& shadows) {
  const float away = FloorDistance(eye.y, ray.y);
  return room * StudioColour(ray, away < 0.0f ? 0.0f : shadows.OnGround(eye + ray * away));
}

// Once for each pixel: nothing in it is as fine as a sample.
void DrawGround(const Projection& projection, const glm::vec3& room, const SceneShadows& shadows,
                uint32_t samples, Canvas& canvas) {
  const float half = 0.5f * float(samples);
  for (uint32_t y = 0; y < canvas.height(); y += samples)
    for (uint32_t x = 0; x < canvas.width(); x += samples) {
      const glm::vec3 ray = projection.RayThrough(float(x) + half, float(y) + half);
      canvas.SetBackground(x, y, samples, ShadeGround(projection.eye(), ray, room, shadows));
    }
}

}  // namespace

std::vector<uint8_t> SoftwareRenderer::Draw(const PictureScene& scene,
                                            const PictureOptions& options) {
  const uint32_t samples = options.samples ? options.samples : 3;
  Canvas canvas(options.width_px * samples, options.height_px * samples);
  const Projection projection(scene.camera, canvas.width(), canvas.height());
  const SceneShadows shadows(scene);
  DrawGround(projection, scene.look.room, shadows, samples, canvas);
  const auto sun_on = [&shadows](uint32_t actor) {
    return [&shadows, actor](const glm::vec3& at, const glm::vec3& normal) {
      return shadows.OnActor(actor, at + normal * shadows.Lift(actor));
    };
  };
  for (uint32_t a = 0; a < scene.bodies.size(); ++a)
    DrawBody(scene.bodies[a], scene.body_looks[a], sun_on(a), projection, canvas);
  const StripTexture strips(std::max(CountStrips(scene.layers), 1u));
  for (size_t i = 0; i < scene.draws.size(); ++i) {
    const PictureLook& look = scene.layer_looks[i];
    DrawShells(scene, i, sun_on(scene.actors[i]), projection, canvas);
    for (const Hair& hair : scene.layers[i])
      DrawHair(hair, look, DepthFloor(scene.bodies[hair.actor].mean_covered, look.depth_floor),
               projection, shadows, strips, canvas);
    canvas.FinishLayer();
  }
  return canvas.Resolve(samples);
}

std::vector<std::byte> DrawPicture(const Scenario& scenario, const FurScene& scene,
                                   const Camera& camera, VertexOrder order,
                                   const PictureOptions& options, std::vector<std::string>& notes,
                                   std::span<const std::string> relief) {
  const PictureScene shown = GatherPicture(scenario, scene, camera, order, notes, relief);
  return EncodePng(SoftwareRenderer().Draw(shown, options), options.width_px, options.height_px, 3);
}

}  // namespace pelt
