// Hair and skin are lit by the functions of bench/shading, as shaders on a graphics card would.
#include "bench/picture/picture.hpp"

#include <algorithm>
#include <cmath>

#include "bench/picture/body.hpp"
#include "bench/picture/canvas.hpp"
#include "bench/picture/picture_scene.hpp"
#include "bench/picture/png.hpp"
#include "bench/picture/shadows.hpp"
#include "bench/shading/shading.hpp"

namespace pelt {
namespace {

// A layer of shells as an engine would draw it: each shell a copy of the skin, cut by the texture.
class ShellPainter {
 public:
  ShellPainter(const PictureLook& look, const LayerDraw& draw, const FurTexture& texture,
               const ShellGrowth& growth, const SunShare& sun, const Projection& projection,
               Canvas& canvas)
      : look_(look),
        shells_(draw.shells),
        sun_(sun),
        projection_(projection),
        canvas_(canvas),
        vertices_(draw.As<ShellVertex>()),
        texture_(texture),
        growth_(growth) {
    for (int texel = 0; texel < 256; ++texel) hair_[texel] = float(texel) / 255.0f;
    indices_.resize(WriteShellIndices(draw.shells, {}));
    WriteShellIndices(draw.shells, indices_);
    // Of vertices that no triangle has nothing is known.
    corners_.resize(vertices_.size());
    for (const uint32_t i : indices_) {
      Corner& corner = corners_[i];
      if (corner.known) continue;
      const ShellVertex& vertex = vertices_[i];
      const ShellSkinBlock& skin = draw.shells.skin[i / kVerticesPerChunk];
      const float(&uv)[2] = skin.uv[i % kVerticesPerChunk];
      corner.known = true;
      corner.skin_uv = glm::vec2(uv[0], uv[1]);
      corner.sheet = growth.SheetOf(i);
      corner.uv = corner.skin_uv * draw.shells.texture_repeat;
      corner.stencil = float(vertex.base_colour >> 24) / 255.0f;
      corner.normal = OctahedralNormal(vertex.normal);
    }
  }

  // All shells of a chunk before the next chunk's, as its samples are at hand then; the outermost first, which hides
  // most of the others. Shells that are not opaque cover each other in their own order.
  void Draw(std::span<const Shell> shells) {
    static_assert(kMaxShells < 256);
    if (indices_.empty()) return;
    canvas_.BeginShells();
    const bool opaque =
        std::ranges::all_of(shells, [](const Shell& shell) { return shell.fade == 1.0f; });
    if (!opaque)
      for (size_t i = 0; i < shells.size(); ++i) Draw(shells[i], uint8_t(i + 1), indices_);
    std::span<const uint32_t> left = indices_;
    for (size_t c = 0; opaque && c < shells_.triangles.size(); ++c) {
      const auto chunk = left.first(3 * size_t(shells_.triangles[c].strand_count));
      left = left.subspan(chunk.size());
      for (size_t i = shells.size(); i > 0; --i) Draw(shells[i - 1], uint8_t(i), chunk);
    }
  }

  // Seen from the side: hairs all along the edge, each to its own height, with those of the shells.
  void DrawFins() {
    std::vector<Fin> fins(WriteFins(shells_, {}));
    WriteFins(shells_, fins);
    for (const Fin& fin : fins) DrawFin(fin);
  }

 private:
  struct Corner {
    bool known = false, placed = false;
    uint8_t lit = 0;     // shell that `colour` is of
    uint16_t sheet = 0;  // of ShellGrowth
    glm::vec2 uv, skin_uv;
    float stencil;
    glm::vec3 normal;
    glm::vec3 screen, colour;
  };

  void Draw(const Shell& shell, uint8_t number, std::span<const uint32_t> indices) {
    for (const uint32_t i : indices) corners_[i].placed = false;
    for (const uint32_t i : indices) {
      if (corners_[i].placed) continue;
      corners_[i].placed = true;
      corners_[i].screen = projection_.Project(Place(shell, i));
    }
    for (size_t t = 0; t < indices.size(); t += 3) DrawTriangle(shell, number, &indices[t]);
  }

  glm::vec3 Place(const Shell& shell, size_t i) const {
    const ShellVertex& vertex = vertices_[i];
    return ShellPosition(VecOf(vertex.position), VecOf(vertex.groom), VecOf(vertex.force),
                         shell.height);
  }

  // Lit when it is first seen, which many are not.
  const glm::vec3& Colour(const Shell& shell, uint8_t number, uint32_t i) {
    Corner& corner = corners_[i];
    if (corner.lit == number) return corner.colour;
    corner.lit = number;
    return corner.colour = Light(shell, i);
  }

  glm::vec3 Light(const Shell& shell, uint32_t i) const {
    const ShellVertex& vertex = vertices_[i];
    const glm::vec3 at = Place(shell, i);
    constexpr float kNoNoise = 0.5f;
    const HairPoint point{
        .colour = glm::mix(LinearColour(vertex.base_colour), LinearColour(vertex.tip_colour),
                           shell.height) *
                  look_.hair.tint,
        .tangent = ShellDirection(VecOf(vertex.groom), VecOf(vertex.force), shell.height),
        .normal = corners_[i].normal,
        .to_eye = glm::normalize(projection_.eye() - at),
        .depth_light = shell.shadow,
        .sun_share = sun_(at, corners_[i].normal),
        .noise = kNoNoise};
    return ShadeHair(look_.light, look_.hair, point);
  }

  void DrawTriangle(const Shell& shell, uint8_t number, const uint32_t* index) {
    const Corner &a = corners_[index[0]], &b = corners_[index[1]], &c = corners_[index[2]];
    const auto shade = [&](const glm::vec3& bary, glm::vec4& colour) {
      const glm::vec2 uv = a.uv * bary.x + b.uv * bary.y + c.uv * bary.z;
      const float hair = HairAt(uv);
      if (hair <= shell.threshold) return false;  // for any stencil; most places end here
      const float covered =
          ShellCoverage(hair, StencilAt(a, b, c, bary), shell.threshold) * shell.fade;
      if (covered <= 0.0f) return false;
      const glm::vec3 first = Colour(shell, number, index[0]) * bary.x,
                      second = Colour(shell, number, index[1]) * bary.y,
                      third = Colour(shell, number, index[2]) * bary.z;
      colour = glm::vec4(first + second + third, covered);
      return true;
    };
    canvas_.DrawShellTriangle(a.screen, b.screen, c.screen, number, shade);
  }

  void DrawFin(const Fin& fin) const {
    const float fade = float(fin.fade) / 255.0f * shells_.shell.back().fade;
    FinRow low = RowAt(fin, 0);
    for (uint32_t step = 1; step <= kFinSteps; ++step) {
      const FinRow high = RowAt(fin, step);
      DrawFinTriangle(low.from, low.to, high.from, {low.height, low.height, high.height}, fade);
      DrawFinTriangle(low.to, high.from, high.to, {low.height, high.height, high.height}, fade);
      low = high;
    }
  }

  struct FinRow {
    float height;
    Corner from, to;
  };
  FinRow RowAt(const Fin& fin, uint32_t step) const {
    const float height = FinHeight(step);
    const Shell at{.height = height,
                   .shadow = glm::mix(shells_.shadow, 1.0f, height),
                   .threshold = height,
                   .fade = 1.0f};
    FinRow row{height, corners_[fin.from], corners_[fin.to]};
    for (const auto& [corner, i] : {std::pair(&row.from, fin.from), std::pair(&row.to, fin.to)}) {
      corner->screen = projection_.Project(Place(at, i));
      corner->colour = Light(at, i);
    }
    return row;
  }

  void DrawFinTriangle(const Corner& a, const Corner& b, const Corner& c, const glm::vec3& heights,
                       float fade) const {
    canvas_.DrawThinTriangle(a.screen, b.screen, c.screen, [&](const glm::vec3& bary) {
      const glm::vec2 uv = a.uv * bary.x + b.uv * bary.y + c.uv * bary.z;
      const float covered =
          ShellCoverage(HairAt(uv), StencilAt(a, b, c, bary), glm::dot(heights, bary));
      const glm::vec3 colour = a.colour * bary.x + b.colour * bary.y + c.colour * bary.z;
      return glm::vec4(colour, covered * fade);
    });
  }

  // Corners of a triangle are on one sheet: those that grow hang together, and so lie on one.
  float StencilAt(const Corner& a, const Corner& b, const Corner& c, const glm::vec3& bary) const {
    if (!growth_.sheets) return a.stencil * bary.x + b.stencil * bary.y + c.stencil * bary.z;
    return growth_.sheets->At(a.sheet,
                              a.skin_uv * bary.x + b.skin_uv * bary.y + c.skin_uv * bary.z);
  }

  float HairAt(const glm::vec2& uv) const {
    const glm::vec2 part = uv - glm::floor(uv);
    const auto texel = [&](float share) {
      return std::min(uint32_t(share * float(texture_.side)), texture_.side - 1);
    };
    return hair_[texture_.texels[size_t(texel(part.y)) * texture_.side + texel(part.x)]];
  }

  const PictureLook& look_;
  const ShellDraw& shells_;
  const SunShare& sun_;
  const Projection& projection_;
  Canvas& canvas_;
  std::span<const ShellVertex> vertices_;
  const FurTexture& texture_;
  const ShellGrowth& growth_;
  std::vector<uint32_t> indices_;
  std::vector<Corner> corners_;
  float hair_[256];  // length of a texel's hair, of the longest
};

// The scene's draw in that place.
void DrawShells(const PictureScene& scene, size_t draw, const SunShare& sun,
                const Projection& projection, Canvas& canvas) {
  const LayerDraw& layer = scene.draws[draw];
  if (layer.shells.shell.empty()) return;
  ShellPainter painter(scene.layer_looks[draw], layer, scene.textures[draw], scene.growth[draw],
                       sun, projection, canvas);
  painter.Draw(layer.shells.shell);
  painter.DrawFins();
}

void DrawHair(const Hair& hair, const PictureLook& look, float floor, const Projection& projection,
              const SceneShadows& shadows, CardPiece card, Canvas& canvas) {
  card.strip = hair.film_strip;
  card.wet_dirty = WetAndDirty(hair.paint);
  const float depth = hair.DepthOfLight();
  HairEnd last{};
  for (uint32_t k = 0; k < hair.knots; ++k) {
    const glm::vec3 at = hair.knot[k].at;
    const HairEnd end = ShadeKnot(hair, k, look.light, look.hair,
                                  DepthShadow(at, hair.root, hair.normal, depth, floor),
                                  shadows.OnActor(hair.actor, at), projection);
    const float pieces = float(hair.knots - 1);
    card.from = float(k - 1) / pieces;
    card.to = float(k) / pieces;
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
  relief_steps_ = {};
  for (uint32_t a = 0; a < scene.bodies.size(); ++a)
    DrawBody(scene.bodies[a], scene.body_looks[a], scene.relief_looks[a], scene.relief, sun_on(a),
             projection, canvas, relief_steps_);
  const StripTexture strips(std::max(CountStrips(scene.layers), 1u));
  for (size_t i = 0; i < scene.draws.size(); ++i) {
    const PictureLook& look = scene.layer_looks[i];
    DrawShells(scene, i, sun_on(scene.actors[i]), projection, canvas);
    const StripTexture& shown = scene.strips[i] ? *scene.strips[i] : strips;
    const CardPiece card{.texture = &shown, .tint = TintOfStrands(scene.draws[i])};
    for (const Hair& hair : scene.layers[i])
      DrawHair(hair, look, DepthFloor(scene.bodies[hair.actor].mean_covered, look.depth_floor),
               projection, shadows, card, canvas);
    canvas.FinishLayer();
  }
  return canvas.Resolve(samples);
}

std::vector<uint8_t> DrawFrames(PictureRenderer& renderer, PictureScene scene,
                                const PictureOptions& options, uint32_t frames) {
  std::vector<uint32_t> sum;
  scene.relief.frame = std::max(scene.relief.frame, 0);
  for (uint32_t f = 0; f < frames; ++f, ++scene.relief.frame) {
    const std::vector<uint8_t> rgb = renderer.Draw(scene, options);
    sum.resize(rgb.size());
    for (size_t i = 0; i < rgb.size(); ++i) sum[i] += rgb[i];
  }
  std::vector<uint8_t> mean;
  for (const uint32_t bytes : sum) mean.push_back(uint8_t((bytes + frames / 2) / frames));
  return mean;
}

std::vector<std::byte> DrawPicture(const Scenario& scenario, const FurScene& scene,
                                   const Camera& camera, VertexOrder order,
                                   const PictureOptions& options, std::vector<std::string>& notes,
                                   std::span<const std::string> relief) {
  const PictureScene shown = GatherPicture(scenario, scene, camera, order, notes, relief);
  return EncodePng(SoftwareRenderer().Draw(shown, options), options.width_px, options.height_px, 3);
}

}  // namespace pelt
