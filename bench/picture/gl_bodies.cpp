#include "bench/picture/gl_bodies.hpp"

#include <algorithm>
#include <array>

namespace pelt {
namespace {

// The attributes of body.vert, one behind the other.
struct SkinVertex {
  glm::vec3 position, normal, fur;
  glm::vec4 tint;
  glm::vec2 share, uv;
  glm::vec4 paint;  // of the fur above
};
constexpr std::array<GLint, 7> kSkinFloats = {3, 3, 3, 4, 2, 2, 4};
static_assert(sizeof(SkinVertex) == 21 * sizeof(float));

// Corners have their own vertices: materials meet there.
SkinVertex CornerOf(const Body& body, uint32_t triangle, int corner, float depth_floor) {
  const Mesh& mesh = body.character->mesh;
  const uint32_t v = mesh.triangles[triangle][size_t(corner)];
  SurfacePoint point{triangle, glm::vec3(0.0f)};
  point.bary[corner] = 1.0f;
  const bool furry = body.furry_material[mesh.triangle_material[triangle]];
  const float covered = furry ? body.covered[v] : 0.0f;
  const bool unlit = body.surface->IsUnlit(triangle);
  const bool known = unlit || body.surface->Knows(triangle);
  return {.position = body.position[v],
          .normal = body.normal[v],
          .fur = body.fur[v],
          .tint = glm::vec4(known ? body.surface->TintAt(point) : glm::vec3(0.0f), float(unlit)),
          .share = {known ? covered : 1.0f, DepthFloor(covered, depth_floor)},
          .uv = body.surface->HasImage(triangle) ? body.surface->ImageUvAt(point) : glm::vec2(0.0f),
          .paint = covered > 0.0f ? body.paint[v] : glm::vec4(0.0f)};
}

GlTexture UploadSurface(const GlApi& gl, const ControlMap* image) {
  constexpr uint8_t kWhite[4] = {255, 255, 255, 255};
  if (!image || image->rgba.empty()) return UploadImage(gl, GL_RGBA8, glm::ivec2(1), kWhite);
  return UploadImage(gl, GL_RGBA8, {int(image->width), int(image->height)}, image->rgba.data());
}

}  // namespace

GlBodies::GlBodies(const GlApi& gl, const PictureScene& scene) : gl_(gl), nothing_(gl) {
  gl_.ActiveTexture(GL_TEXTURE0 + kMakingUnit);
  for (const Body& body : scene.bodies) skins_.push_back(Upload(body, scene.look.depth_floor));
}

GlBodies::Skin GlBodies::Upload(const Body& body, float depth_floor) const {
  const uint32_t triangles = uint32_t(body.character->mesh.triangles.size());
  std::vector<const ControlMap*> images;
  for (uint32_t t = 0; t < triangles; ++t)
    if (std::ranges::find(images, body.surface->ImageOf(t)) == images.end())
      images.push_back(body.surface->ImageOf(t));
  std::vector<Part> parts;
  std::vector<SkinVertex> vertices;
  for (const ControlMap* image : images) {
    const size_t first = vertices.size();
    for (uint32_t t = 0; t < triangles; ++t)
      if (body.surface->ImageOf(t) == image)
        for (int corner = 0; corner < 3; ++corner)
          vertices.push_back(CornerOf(body, t, corner, depth_floor));
    parts.push_back({UploadSurface(gl_, image), GLint(first), GLsizei(vertices.size() - first)});
  }
  return {UploadMesh(gl_, std::as_bytes(std::span(vertices)), kSkinFloats), std::move(parts)};
}

void GlBodies::DrawSkin(uint32_t actor) const {
  gl_.BindVertexArray(skins_[actor].mesh.array);
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
