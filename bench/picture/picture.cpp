// Hair is lit after Kajiya and Kay, "Rendering Fur with Three Dimensional Textures" (1989), with
// light that dies away inside the fur (LightMap) and roots darker than tips.
#include "bench/picture/picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "bench/picture/canvas.hpp"
#include "core/error.hpp"
#include "core/ribbon_indices.hpp"

#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

namespace pelt {
namespace {

constexpr uint32_t kCurveKnots = 9;  // a hair is drawn as eight straight pieces
const glm::vec3 kToLight = glm::normalize(glm::vec3(0.45f, 0.8f, 0.55f));
const glm::vec3 kToRim = glm::normalize(glm::vec3(-0.7f, 0.35f, -0.65f));
const glm::vec3 kSun(2.1f, 1.95f, 1.75f), kSky(0.60f, 0.64f, 0.76f), kRim(0.9f, 0.95f, 1.2f);

struct HairKnot {
  glm::vec3 at;
  float width;  // m
};
struct Hair {
  std::array<HairKnot, kCurveKnots> knot;
  uint32_t knots;
  uint32_t base_colour, tip_colour;
  glm::vec3 normal;  // of the skin at the root
};

void ReadCurve(const LayerDraw& draw, uint32_t strand, Hair& hair) {
  const CurveRecord& record = draw.As<CurveRecord>()[strand];
  hair.knots = kCurveKnots;
  hair.base_colour = record.base_colour;
  hair.tip_colour = record.tip_colour;
  for (uint32_t k = 0; k < kCurveKnots; ++k) {
    const float t = float(k) / float(kCurveKnots - 1);
    for (int c = 0; c < 3; ++c)
      hair.knot[k].at[c] =
          record.curve[0][c] +
          t * (record.curve[1][c] + t * (record.curve[2][c] + t * record.curve[3][c]));
    hair.knot[k].width = record.width * (1.0f + (draw.tip_width - 1.0f) * t);
  }
}

void ReadRibbon(const LayerDraw& draw, uint32_t strand, Hair& hair) {
  const auto vertex = draw.As<RibbonVertex>().subspan(size_t(strand) * kRibbonVerticesPerHair,
                                                      kRibbonVerticesPerHair);
  hair.knots = kRibbonPoints;
  hair.base_colour = vertex.front().colour;
  hair.tip_colour = vertex.back().colour;
  for (uint32_t k = 0; k < kRibbonPoints; ++k) {
    const float* l = vertex[2 * k].position;
    const float* r = vertex[2 * k + 1].position;
    const glm::vec3 left(l[0], l[1], l[2]), right(r[0], r[1], r[2]);
    hair.knot[k] = {(left + right) * 0.5f, glm::length(right - left)};
  }
}

void ReadLine(const LayerDraw& draw, uint32_t strand, Hair& hair) {
  const auto vertex = draw.As<LineVertex>().subspan(size_t(strand) * kRibbonPoints, kRibbonPoints);
  hair.knots = kRibbonPoints;
  hair.base_colour = vertex.front().colour;
  hair.tip_colour = vertex.back().colour;
  for (uint32_t k = 0; k < kRibbonPoints; ++k) {
    const float* p = vertex[k].position;
    hair.knot[k] = {{p[0], p[1], p[2]}, vertex[k].width};
  }
}

// For each output, how the vertices of one strand of a draw are read.
constexpr void (*kReaders[])(const LayerDraw&, uint32_t strand, Hair&) = {ReadCurve, ReadRibbon,
                                                                          ReadLine};
static_assert(std::size(kReaders) == kOutputCount);

// All drawn hairs of the frame, layer by layer in the drawing order, each layer far to near.
class DrawnHairs {
 public:
  DrawnHairs(const FurScene& scene, VertexOrder order) : scene_(scene), order_(order) {}

  // visit(hair); then finish_layer().
  template <class Visit, class Finish>
  void ForEach(Visit visit, Finish finish_layer) const {
    for (const LayerDraw& draw : scene_.Draws()) {
      for (uint32_t place = 0; place < draw.strand_count; ++place) visit(HairAt(draw, place));
      finish_layer();
    }
  }

 private:
  Hair HairAt(const LayerDraw& draw, uint32_t place) const {
    const uint32_t strand = draw.order[place], lane = strand % kStrandsPerChunk;
    const uint32_t first = scene_.shape().layer_first_chunk[draw.layer];
    const auto& roots = *scene_.memory().Of<&Streams::roots>(first + strand / kStrandsPerChunk);
    Hair hair{};
    hair.normal = {roots.normal[0][lane], roots.normal[1][lane], roots.normal[2][lane]};
    kReaders[size_t(draw.output)](draw, order_ == VertexOrder::kSorted ? place : strand, hair);
    return hair;
  }

  const FurScene& scene_;
  VertexOrder order_;
};

// ---- The body -----------------------------------------------------------------------------------

struct Body {
  const Character* character;
  std::vector<glm::vec3> position, normal;  // world
  glm::vec3 skin;                           // linear colour
};

// The colour of the skin: the fur's own at the root.
glm::vec3 SkinColour(const FurScene& scene, uint32_t actor) {
  const SceneShape& shape = scene.shape();
  glm::vec3 sum(0.0f);
  float count = 0.0f;
  for (uint32_t c = 0; c < shape.chunk_count; ++c) {
    if (shape.layer_character[shape.chunk_layer[c]] != actor) continue;
    sum += LinearColour(scene.memory().Of<&Streams::strands>(c)->base_colour[0]);
    count += 1.0f;
  }
  return count > 0.0f ? sum / count : glm::vec3(0.1f);
}

Body PoseBody(const Scenario& scenario, const FurScene& scene, uint32_t actor) {
  Body body;
  body.character = &scenario.characters[scenario.actors[actor].character];
  body.skin = SkinColour(scene, actor);
  const Mesh& mesh = body.character->mesh;
  const auto& palette = *scene.memory().Of<&Streams::palette>(actor);
  for (size_t v = 0; v < mesh.position.size(); ++v) {
    glm::vec3 position(0.0f), normal(0.0f);
    for (int i = 0; i < 4; ++i) {
      const float* m = palette.matrix[mesh.joints[v][size_t(i)]];
      const float weight = mesh.weights[v][i];
      for (int r = 0; r < 3; ++r) {
        const glm::vec3 row(m[4 * r], m[4 * r + 1], m[4 * r + 2]);
        position[r] += weight * (glm::dot(row, mesh.position[v]) + m[4 * r + 3]);
        normal[r] += weight * glm::dot(row, mesh.normal[v]);
      }
    }
    const float length = glm::length(normal);
    body.position.push_back(position);
    body.normal.push_back(length > 0.0f ? normal / length : glm::vec3(0.0f, 1.0f, 0.0f));
  }
  return body;
}

// An eyeball. The mesh only marks where it is: its few triangles have a ragged edge, so a ball is
// drawn over them.
struct Eye {
  glm::vec3 centre{0.0f}, forward{0.0f};  // world
  float radius = 0.0f;                    // m
};

// One for each side of the character's middle that has triangles of the material "eye".
std::vector<Eye> FindEyes(const Body& body) {
  const Mesh& mesh = body.character->mesh;
  std::vector<Eye> eyes;
  for (const bool left : {false, true}) {
    std::vector<uint32_t> corners;
    for (size_t t = 0; t < mesh.triangles.size(); ++t)
      for (const uint32_t v : mesh.triangles[t])
        if (mesh.materials[mesh.triangle_material[t]] == "eye" &&
            (mesh.position[v].x > 0.0f) == left)
          corners.push_back(v);
    if (corners.empty()) continue;
    Eye eye;
    for (const uint32_t v : corners) {
      eye.centre += body.position[v] / float(corners.size());
      eye.forward += body.normal[v];
    }
    eye.forward = glm::normalize(eye.forward);
    for (const uint32_t v : corners)
      eye.radius = std::max(eye.radius, glm::length(body.position[v] - eye.centre));
    eye.radius *= 0.85f;
    eye.centre -= eye.forward * (0.4f * eye.radius);
    eyes.push_back(eye);
  }
  // Both look the same way, or nearly.
  glm::vec3 ahead(0.0f);
  for (const Eye& eye : eyes) ahead += eye.forward;
  for (Eye& eye : eyes) eye.forward = glm::normalize(ahead + 0.35f * eye.forward);
  return eyes;
}

glm::vec3 ShadeSkin(const glm::vec3& colour, const glm::vec3& normal, float light) {
  const float sun = std::max(glm::dot(normal, kToLight), 0.0f) * light;
  return colour * (kSun * sun + kSky * (0.6f + 0.4f * normal.y));
}

glm::vec3 ShadeEye(const Eye& eye, const glm::vec3& normal, const glm::vec3& to_eye) {
  const glm::vec3 white(0.90f, 0.88f, 0.82f), iris(0.75f, 0.36f, 0.03f), pupil(0.005f);
  const float ahead = glm::dot(normal, eye.forward);
  const glm::vec3 colour = ahead > 0.945f ? pupil : ahead > 0.85f ? iris : white;
  const float glint =
      std::pow(std::max(glm::dot(normal, glm::normalize(kToLight + to_eye)), 0.0f), 150.0f);
  return ShadeSkin(colour, normal, 0.6f) + glm::vec3(3.0f * glint);
}

void DrawEye(const Eye& eye, const Projection& projection, Canvas& canvas) {
  const glm::vec3 middle = projection.Project(eye.centre);
  const float reach = 1.2f * eye.radius * projection.SamplesPerMetre(middle.z);
  const auto clamp = [](float v, uint32_t end) {
    return uint32_t(std::clamp(v, 0.0f, float(end)));
  };
  for (uint32_t y = clamp(middle.y - reach, canvas.height());
       y < clamp(middle.y + reach, canvas.height()); ++y)
    for (uint32_t x = clamp(middle.x - reach, canvas.width());
         x < clamp(middle.x + reach, canvas.width()); ++x) {
      const glm::vec3 ray = projection.RayThrough(float(x) + 0.5f, float(y) + 0.5f);
      const glm::vec3 from = projection.eye() - eye.centre;
      const float along = glm::dot(from, ray);
      const float inside = along * along - glm::dot(from, from) + eye.radius * eye.radius;
      if (inside < 0.0f) continue;
      const glm::vec3 at = projection.eye() + ray * (-along - std::sqrt(inside));
      canvas.DrawPoint(x, y, projection.Project(at).z,
                       ShadeEye(eye, (at - eye.centre) / eye.radius, -ray));
    }
}

void DrawBody(const Body& body, const Projection& projection, const LightMap& light,
              Canvas& canvas) {
  const Mesh& mesh = body.character->mesh;
  for (const auto& triangle : mesh.triangles) {
    Canvas::Corner corner[3];
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t v = triangle[k];
      corner[k] = {projection.Project(body.position[v]),
                   ShadeSkin(body.skin, body.normal[v], light.Light(body.position[v], 0.03f, 1))};
    }
    canvas.DrawTriangle(corner[0], corner[1], corner[2]);
  }
  for (const Eye& eye : FindEyes(body)) DrawEye(eye, projection, canvas);
}

// ---- Hair and ground ----------------------------------------------------------------------------

glm::vec3 ShadeHair(const glm::vec3& colour, const glm::vec3& tangent, const glm::vec3& normal,
                    const glm::vec3& to_eye, float t, float light) {
  const auto across = [&](const glm::vec3& d) {
    const float along = glm::dot(tangent, d);
    return std::sqrt(std::max(0.0f, 1.0f - along * along));
  };
  const float wrap = std::clamp((glm::dot(normal, kToLight) + 0.5f) / 1.5f, 0.0f, 1.0f);
  const float depth = 0.35f + 0.65f * t;  // light dies away towards the roots
  const float shine = std::pow(across(glm::normalize(kToLight + to_eye)), 60.0f);
  const float edge = 1.0f - std::abs(glm::dot(normal, to_eye));
  const float rim = edge * edge * std::clamp(0.4f + glm::dot(normal, kToRim), 0.0f, 1.0f);
  glm::vec3 lit = colour * kSun * (across(kToLight) * wrap * light);
  lit += colour * kSky * (0.55f + 0.35f * normal.y);
  lit += (colour * 0.6f + 0.06f) * kSun * (0.55f * shine * wrap * light);
  lit += (colour * 0.7f + 0.05f) * kRim * rim;
  return lit * depth;
}

void DrawHairs(const DrawnHairs& hairs, const Projection& projection, const LightMap& light,
               Canvas& canvas) {
  const auto draw = [&](const Hair& hair) {
    const glm::vec3 base = LinearColour(hair.base_colour), tip = LinearColour(hair.tip_colour);
    const float alpha = float(hair.base_colour >> 24) / 255.0f;
    Canvas::Knot last{};
    for (uint32_t k = 0; k < hair.knots; ++k) {
      const float t = float(k) / float(hair.knots - 1);
      const glm::vec3 at = hair.knot[k].at;
      const glm::vec3 along =
          hair.knot[std::min(k + 1, hair.knots - 1)].at - hair.knot[k ? k - 1 : 0].at;
      const glm::vec3 tangent = along / std::max(glm::length(along), 1e-9f);
      const glm::vec3 to_eye = glm::normalize(projection.eye() - at);
      const glm::vec3 screen = projection.Project(at);
      const Canvas::Knot knot{screen,
                              ShadeHair(glm::mix(base, tip, t), tangent, hair.normal, to_eye, t,
                                        light.Light(at, 0.035f, 1)),
                              hair.knot[k].width * projection.SamplesPerMetre(screen.z)};
      if (k > 0) canvas.DrawHair(last, knot, alpha);
      last = knot;
    }
  };
  hairs.ForEach(draw, [&] { canvas.FinishLayer(); });
}

// A studio: a pale floor that meets a pale wall without an edge.
void DrawGround(const Projection& projection, const LightMap& light, Canvas& canvas) {
  const glm::vec3 floor(0.60f, 0.62f, 0.66f), wall(0.50f, 0.55f, 0.64f);
  for (uint32_t y = 0; y < canvas.height(); ++y)
    for (uint32_t x = 0; x < canvas.width(); ++x) {
      const glm::vec3 ray = projection.RayThrough(float(x) + 0.5f, float(y) + 0.5f);
      const float dip = std::clamp(-ray.y * 4.0f, 0.0f, 1.0f);
      glm::vec3 colour = glm::mix(wall * (1.0f - 0.5f * std::max(ray.y, 0.0f)), floor, dip);
      if (ray.y < -1e-3f && projection.eye().y > 0.0f) {
        const glm::vec3 at = projection.eye() + ray * (-projection.eye().y / ray.y);
        colour *= 0.45f + 0.55f * light.Light(at, 0.05f, 4);
      }
      canvas.SetBackground(x, y, colour);
    }
}

}  // namespace

std::vector<std::byte> DrawPicture(const Scenario& scenario, const FurScene& scene,
                                   const Camera& camera, VertexOrder order,
                                   const PictureOptions& options) {
  Canvas canvas(options.width_px * options.samples, options.height_px * options.samples);
  const Projection projection(camera, canvas.width(), canvas.height());
  std::vector<Body> bodies;
  glm::vec3 low(1e30f), high(-1e30f);
  for (uint32_t a = 0; a < scenario.actors.size(); ++a) {
    bodies.push_back(PoseBody(scenario, scene, a));
    for (const glm::vec3& p : bodies.back().position) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  }
  const float radius = 0.6f * glm::length(high - low) + 0.1f;
  LightMap light(kToLight, (low + high) * 0.5f, radius, 512);
  for (const Body& body : bodies)
    for (const glm::vec3& p : body.position) light.Add(p);
  const DrawnHairs hairs(scene, order);
  hairs.ForEach(
      [&](const Hair& hair) {
        for (uint32_t k = 0; k < hair.knots; ++k) light.Add(hair.knot[k].at);
      },
      [] {});
  DrawGround(projection, light, canvas);
  for (const Body& body : bodies) DrawBody(body, projection, light, canvas);
  DrawHairs(hairs, projection, light, canvas);
  const std::vector<uint8_t> rgb = canvas.Resolve(options.samples);
  std::vector<std::byte> png;
  const auto append = [](void* to, void* data, int bytes) {
    const std::byte* first = static_cast<const std::byte*>(data);
    static_cast<std::vector<std::byte>*>(to)->insert(
        static_cast<std::vector<std::byte>*>(to)->end(), first, first + bytes);
  };
  if (!stbi_write_png_to_func(append, &png, int(options.width_px), int(options.height_px), 3,
                              rgb.data(), int(options.width_px) * 3))
    throw Error("picture: no memory to write it as PNG");
  return png;
}

}  // namespace pelt
