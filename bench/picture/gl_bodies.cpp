#include "bench/picture/gl_bodies.hpp"

#include <algorithm>
#include <array>

namespace pelt {
namespace {

constexpr std::array<GLint, 10> kSkinFloats = {3, 3, 3, 4, 3, 2, 4, 2, 4, 4};
static_assert(kMappedLayers == 4);  // that a vec4 holds

std::vector<const ControlMap*> GrowthImages(const Body& body) {
  std::vector<const ControlMap*> images;
  for (const MappedFur& mapped : body.mapped)
    for (const ControlMap& sheet : mapped.growth->texels()) images.push_back(&sheet);
  return images;
}

// What a vertex is made from, but for what is the character's alone.
bool LooksAlike(const Body& a, const Body& b) {
  const auto same_rates = [](const MappedFur& x, const MappedFur& y) { return x.rate == y.rate; };
  return a.position == b.position && a.normal == b.normal && a.fur == b.fur &&
         a.fur_tip == b.fur_tip && a.paint == b.paint && a.covered == b.covered &&
         a.unmapped == b.unmapped && std::ranges::equal(a.mapped, b.mapped, same_rates);
}

// The same character, with the same fur on it.
bool AreOfOne(const Body& a, const Body& b) {
  const auto same_growth = [](const MappedFur& x, const MappedFur& y) {
    return x.growth == y.growth;
  };
  return a.surface == b.surface && a.relief == b.relief && a.furry_material == b.furry_material &&
         std::ranges::equal(a.mapped, b.mapped, same_growth);
}

GlTexture UploadSurface(const GlApi& gl, const ControlMap* image) {
  constexpr uint8_t kWhite[4] = {255, 255, 255, 255};
  if (!image || image->rgba.empty()) return UploadImage(gl, GL_RGBA8, glm::ivec2(1), kWhite);
  return UploadImage(gl, GL_RGBA8, {int(image->width), int(image->height)}, image->rgba.data());
}

}  // namespace

// Corners have their own vertices: materials meet there.
GlBodies::Vertex GlBodies::CornerOf(const Body& body, uint32_t triangle, int corner) {
  SurfacePoint point{triangle, glm::vec3(0.0f)};
  point.bary[corner] = 1.0f;
  const bool unlit = body.surface->IsUnlit(triangle);
  const bool known = unlit || body.surface->Knows(triangle);
  Vertex vertex{};
  vertex.tint = glm::vec4(known ? body.surface->TintAt(point) : glm::vec3(0.0f), float(unlit));
  vertex.share.y = float(known);
  if (body.surface->HasImage(triangle)) vertex.uv = body.surface->ImageUvAt(point);
  vertex.sheet = glm::vec4(-1.0f);
  return vertex;
}

void GlBodies::PoseCorner(const Body& body, uint32_t triangle, uint32_t v, Vertex& vertex) {
  const Mesh& mesh = body.character->mesh;
  vertex.position = body.position[v];
  vertex.normal = body.normal[v];
  vertex.fur = body.fur[v];
  if (!body.furry_material[mesh.triangle_material[triangle]]) return;
  vertex.share.x = body.covered[v];
  vertex.paint = body.paint[v];
  // Layers of fur that grow by maps on the triangle: how much, and which of GrowthImages shows where.
  uint32_t first = 0;
  for (size_t i = 0; i < body.mapped.size(); ++i) {
    const MappedFur& mapped = body.mapped[i];
    const uint16_t sheet = mapped.growth->SheetOf(triangle);
    if (sheet != FlowMap::kNoSheet) {
      vertex.rate[int(i)] = mapped.rate[v];
      vertex.sheet[int(i)] = float(first + sheet);
      vertex.share.z = body.unmapped[v];
      vertex.growth_uv = mesh.uv[v];
    }
    first += uint32_t(mapped.growth->texels().size());
  }
}

bool GlBodies::Take(const PictureScene& scene) {
  gl_.ActiveTexture(GL_TEXTURE0 + kMakingUnit);
  bool changed = skins_.size() != scene.bodies.size();
  while (skins_.size() > scene.bodies.size()) skins_.pop_back();
  for (size_t a = 0; a < scene.bodies.size(); ++a) {
    const Body& body = scene.bodies[a];
    if (a < skins_.size() && AreOfOne(skins_[a].body, body)) {
      if (LooksAlike(skins_[a].body, body)) continue;
      skins_[a].body = body;
    } else if (a < skins_.size()) {
      skins_[a] = Make(body);
    } else {
      skins_.push_back(Make(body));
    }
    Pose(skins_[a]);
    changed = true;
  }
  return changed;
}

GlBodies::Skin GlBodies::Make(const Body& body) const {
  static_assert(sizeof(Vertex) == 32 * sizeof(float));
  const uint32_t triangles = uint32_t(body.character->mesh.triangles.size());
  std::vector<const ControlMap*> images;
  for (uint32_t t = 0; t < triangles; ++t)
    if (std::ranges::find(images, body.surface->ImageOf(t)) == images.end())
      images.push_back(body.surface->ImageOf(t));
  Skin skin{body, UploadMesh(gl_, {}, kSkinFloats), {}, UploadSheets(gl_, GrowthImages(body)), {},
            {}};
  for (const ControlMap* image : images) {
    const size_t first = skin.vertices.size();
    for (uint32_t t = 0; t < triangles; ++t) {
      if (body.surface->ImageOf(t) != image) continue;
      skin.triangles.push_back(t);
      for (int corner = 0; corner < 3; ++corner) skin.vertices.push_back(CornerOf(body, t, corner));
    }
    skin.parts.push_back(
        {UploadSurface(gl_, image), GLint(first), GLsizei(skin.vertices.size() - first)});
  }
  return skin;
}

void GlBodies::Pose(Skin& skin) const {
  for (size_t i = 0; i < skin.vertices.size(); ++i) {
    const uint32_t triangle = skin.triangles[i / 3];
    PoseCorner(skin.body, triangle, skin.body.character->mesh.triangles[triangle][i % 3],
               skin.vertices[i]);
  }
  ReplaceVertices(gl_, skin.mesh, std::as_bytes(std::span(skin.vertices)));
}

void GlBodies::DrawSkin(uint32_t actor) const {
  gl_.BindVertexArray(skins_[actor].mesh.array);
  BindTexture(gl_, kGrowthUnit, GL_TEXTURE_2D_ARRAY, skins_[actor].growth);
  for (const Part& part : skins_[actor].parts) {
    BindTexture(gl_, kSurfaceUnit, GL_TEXTURE_2D, part.image);
    gl_.DrawArrays(GL_TRIANGLES, part.first, part.vertices);
  }
  gl_.BindVertexArray(nothing_);
}

void GlBodies::DrawEyes(const GlProgram& program, const std::vector<Eye>& eyes) const {
  for (const Eye& eye : eyes) {
    program.Set("eyeball", glm::vec4(eye.centre, eye.radius));
    program.Set("eyeball_forward", eye.forward);
    gl_.DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  }
}

}  // namespace pelt
