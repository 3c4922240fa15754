#include "bench/picture/gl_bodies.hpp"

#include <algorithm>
#include <array>

namespace pelt {
namespace {

// The attributes of body.vert, one behind the other.
struct SkinVertex {
  glm::vec3 position, normal, fur, tint;
  glm::vec2 share, uv;
  glm::vec4 paint;  // of the fur above
};
constexpr std::array<GLint, 7> kFloats = {3, 3, 3, 3, 2, 2, 4};
static_assert(sizeof(SkinVertex) == 20 * sizeof(float));

// Corners have their own vertices: materials meet there.
SkinVertex CornerOf(const Body& body, uint32_t triangle, int corner, float depth_floor) {
  const Mesh& mesh = body.character->mesh;
  const uint32_t v = mesh.triangles[triangle][size_t(corner)];
  SurfacePoint point{triangle, glm::vec3(0.0f)};
  point.bary[corner] = 1.0f;
  const bool furry = body.furry_material[mesh.triangle_material[triangle]];
  const float covered = furry ? body.covered[v] : 0.0f;
  const bool known = body.surface->Knows(triangle);
  return {.position = body.position[v],
          .normal = body.normal[v],
          .fur = body.fur[v],
          .tint = known ? body.surface->TintAt(point) : glm::vec3(0.0f),
          .share = {known ? covered : 1.0f, DepthFloor(covered, depth_floor)},
          .uv = body.surface->HasImage(triangle) ? body.surface->ImageUvAt(point) : glm::vec2(0.0f),
          .paint = covered > 0.0f ? body.paint[v] : glm::vec4(0.0f)};
}

GlTexture UploadImage(const GlApi& gl, const ControlMap* image) {
  constexpr uint8_t kWhite[4] = {255, 255, 255, 255};
  const bool is_there = image && !image->rgba.empty();
  GlTexture texture = MakeTexture(gl, GL_RGBA8, 1, 1);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, is_there ? GLsizei(image->width) : 1,
                is_there ? GLsizei(image->height) : 1, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                is_there ? image->rgba.data() : kWhite);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    gl.TexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    gl.TexParameteri(GL_TEXTURE_2D, wrap, GL_REPEAT);
  return texture;
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
  Skin skin{.array = GlVertexArray(gl_), .vertices = GlBuffer(gl_), .parts = {}};
  std::vector<SkinVertex> vertices;
  for (const ControlMap* image : images) {
    const size_t first = vertices.size();
    for (uint32_t t = 0; t < triangles; ++t)
      if (body.surface->ImageOf(t) == image)
        for (int corner = 0; corner < 3; ++corner)
          vertices.push_back(CornerOf(body, t, corner, depth_floor));
    skin.parts.push_back({UploadImage(gl_, image), GLint(first), GLsizei(vertices.size() - first)});
  }
  gl_.BindVertexArray(skin.array);
  gl_.BindBuffer(GL_ARRAY_BUFFER, skin.vertices);
  gl_.BufferData(GL_ARRAY_BUFFER, GLsizeiptr(vertices.size() * sizeof(SkinVertex)), vertices.data(),
                 GL_STATIC_DRAW);
  size_t offset = 0;
  for (size_t i = 0; i < kFloats.size(); ++i) {
    // NOLINTNEXTLINE(performance-no-int-to-ptr): OpenGL's way to say an offset.
    const void* from_start = reinterpret_cast<const void*>(offset);
    gl_.VertexAttribPointer(GLuint(i), kFloats[i], GL_FLOAT, GL_FALSE, sizeof(SkinVertex),
                            from_start);
    gl_.EnableVertexAttribArray(GLuint(i));
    offset += size_t(kFloats[i]) * sizeof(float);
  }
  gl_.BindVertexArray(nothing_);
  return skin;
}

void GlBodies::DrawSkin(uint32_t actor) const {
  gl_.BindVertexArray(skins_[actor].array);
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
