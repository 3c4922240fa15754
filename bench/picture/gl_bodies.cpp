#include <algorithm>
#include <array>

#include "bench/picture/gl_parts.hpp"
#include "bench/picture/relief_coat.hpp"

namespace pelt {
namespace {

// The attributes of relief.vert, one behind the other.
struct ReliefVertex {
  glm::vec3 position, normal, root_colour, tip_colour, axis_u, axis_v;
  glm::vec2 uv;
};
constexpr std::array<GLint, 7> kReliefFloats = {3, 3, 3, 3, 3, 3, 2};
static_assert(sizeof(ReliefVertex) == 20 * sizeof(float));

void AddSheet(const Body& body, const ReliefCoat::Layer& layer, uint32_t sheet,
              std::vector<ReliefVertex>& vertices) {
  const Mesh& mesh = body.character->mesh;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (layer.sheet[t] != sheet) continue;
    for (const uint32_t v : mesh.triangles[t])
      vertices.push_back({body.position[v], body.normal[v], body.fur[v], body.fur_tip[v],
                          body.axes.u[v], body.axes.v[v], mesh.uv[v]});
  }
}

GlTexture UploadMap(const GlApi& gl, const ControlMap& map) {
  return UploadImage(gl, GL_RGBA8, {int(map.width), int(map.height)}, map.rgba.data());
}

}  // namespace

GlRelief::GlRelief(const GlApi& gl, const PictureScene& scene) : gl_(gl) {
  gl_.ActiveTexture(GL_TEXTURE0 + kMakingUnit);
  for (const Body& body : scene.bodies) coats_.push_back(Upload(body));
}

GlRelief::Coat GlRelief::Upload(const Body& body) const {
  if (!body.relief) return {UploadMesh(gl_, {}, kReliefFloats), GlTexture(gl_), {}};
  std::vector<ReliefVertex> vertices;
  std::vector<Part> parts;
  const std::vector<ReliefCoat::Layer>& layers = body.relief->layers();
  for (size_t l = 0; l < layers.size(); ++l)
    for (uint32_t sheet = 0; sheet < layers[l].flow.size(); ++sheet) {
      const size_t first = vertices.size();
      AddSheet(body, layers[l], sheet, vertices);
      parts.push_back({l, UploadMap(gl_, layers[l].flow[sheet]), layers[l].repeat[sheet],
                       layers[l].longest_m, GLint(first), GLsizei(vertices.size() - first)});
    }
  return {UploadMesh(gl_, std::as_bytes(std::span(vertices)), kReliefFloats),
          UploadMap(gl_, body.relief->tile()), std::move(parts)};
}

void GlRelief::Draw(const GlProgram& program, uint32_t actor,
                    const std::function<void(size_t)>& light) const {
  const Coat& coat = coats_[actor];
  gl_.BindVertexArray(coat.mesh.array);
  BindTexture(gl_, kHeightsUnit, GL_TEXTURE_2D, coat.tile);
  for (const Part& part : coat.parts) {
    light(part.layer);
    BindTexture(gl_, kSurfaceUnit, GL_TEXTURE_2D, part.flow);
    program.Set("repeat", part.repeat);
    program.Set("longest", part.longest_m);
    gl_.DrawArrays(GL_TRIANGLES, part.first, part.vertices);
  }
  gl_.BindVertexArray(0);
}

namespace {

// The attributes of body.vert, one behind the other.
struct SkinVertex {
  glm::vec3 position, normal, fur;
  glm::vec4 tint;
  glm::vec3 share;
  glm::vec2 uv;
  glm::vec4 paint;  // of the fur above
  glm::vec2 growth_uv;
  glm::vec4 rate, sheet;
  glm::vec2 cut;
};
constexpr std::array<GLint, 11> kSkinFloats = {3, 3, 3, 4, 3, 2, 4, 2, 4, 4, 2};
static_assert(sizeof(SkinVertex) == 34 * sizeof(float));
static_assert(kMappedLayers == 4);  // that a vec4 holds

// Layers of fur that grow by maps on the triangle: how much, and which of GrowthImages shows where.
void AddMapped(const Body& body, uint32_t triangle, uint32_t v, SkinVertex& vertex) {
  uint32_t first = 0;
  for (size_t i = 0; i < body.mapped.size(); ++i) {
    const MappedFur& mapped = body.mapped[i];
    const uint16_t sheet = mapped.growth->SheetOf(triangle);
    if (sheet != FlowMap::kNoSheet) {
      vertex.rate[int(i)] = mapped.rate[v];
      vertex.sheet[int(i)] = float(first + sheet);
      vertex.share.z = body.unmapped[v];
      vertex.growth_uv = body.character->mesh.uv[v];
    }
    first += uint32_t(mapped.growth->texels().size());
  }
}

std::vector<const ControlMap*> GrowthImages(const Body& body) {
  std::vector<const ControlMap*> images;
  for (const MappedFur& mapped : body.mapped)
    for (const ControlMap& sheet : mapped.growth->texels()) images.push_back(&sheet);
  return images;
}

// Corners have their own vertices: materials meet there.
SkinVertex CornerOf(const Body& body, uint32_t triangle, int corner) {
  const Mesh& mesh = body.character->mesh;
  const uint32_t v = mesh.triangles[triangle][size_t(corner)];
  SurfacePoint point{triangle, glm::vec3(0.0f)};
  point.bary[corner] = 1.0f;
  const bool furry = body.furry_material[mesh.triangle_material[triangle]];
  const bool unlit = body.surface->IsUnlit(triangle);
  const bool known = unlit || body.surface->Knows(triangle);
  SkinVertex vertex{
      .position = body.position[v],
      .normal = body.normal[v],
      .fur = body.fur[v],
      .tint = glm::vec4(known ? body.surface->TintAt(point) : glm::vec3(0.0f), float(unlit)),
      .share = {furry ? body.covered[v] : 0.0f, float(known), 0.0f},
      .uv = body.surface->HasImage(triangle) ? body.surface->ImageUvAt(point) : glm::vec2(0.0f),
      .paint = furry ? body.paint[v] : glm::vec4(0.0f),
      .growth_uv = glm::vec2(0.0f),
      .rate = glm::vec4(0.0f),
      .sheet = glm::vec4(-1.0f),
      .cut = body.surface->AlphaAndCutoffAt(point)};
  if (furry) AddMapped(body, triangle, v, vertex);
  return vertex;
}

// What triangles that are drawn together share.
struct Surface {
  const ControlMap* image;
  std::array<Wrap, 2> wrap;
  bool operator==(const Surface&) const = default;
};

Surface SurfaceOf(const Body& body, uint32_t triangle) {
  return {body.surface->ImageOf(triangle), WrapOn(body.character->mesh, triangle)};
}

GLint GlWrap(Wrap wrap) {
  return wrap == Wrap::kRepeat   ? GL_REPEAT
         : wrap == Wrap::kMirror ? GL_MIRRORED_REPEAT
                                 : GL_CLAMP_TO_EDGE;
}

GlTexture UploadSurface(const GlApi& gl, const Surface& surface) {
  constexpr uint8_t kWhite[4] = {255, 255, 255, 255};
  const ControlMap* image = surface.image;
  if (!image || image->rgba.empty()) return UploadImage(gl, GL_RGBA8, glm::ivec2(1), kWhite);
  GlTexture texture =
      UploadImage(gl, GL_RGBA8, {int(image->width), int(image->height)}, image->rgba.data());
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GlWrap(surface.wrap[0]));
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GlWrap(surface.wrap[1]));
  return texture;
}

}  // namespace

GlBodies::GlBodies(const GlApi& gl, const PictureScene& scene) : gl_(gl), nothing_(gl) {
  gl_.ActiveTexture(GL_TEXTURE0 + kMakingUnit);
  for (const Body& body : scene.bodies) skins_.push_back(Upload(body));
}

GlBodies::Skin GlBodies::Upload(const Body& body) const {
  const uint32_t triangles = uint32_t(body.character->mesh.triangles.size());
  std::vector<Surface> surfaces;
  for (uint32_t t = 0; t < triangles; ++t)
    if (std::ranges::find(surfaces, SurfaceOf(body, t)) == surfaces.end())
      surfaces.push_back(SurfaceOf(body, t));
  std::vector<Part> parts;
  std::vector<SkinVertex> vertices;
  for (const Surface& surface : surfaces) {
    const size_t first = vertices.size();
    for (uint32_t t = 0; t < triangles; ++t)
      if (SurfaceOf(body, t) == surface)
        for (int corner = 0; corner < 3; ++corner) vertices.push_back(CornerOf(body, t, corner));
    parts.push_back({UploadSurface(gl_, surface), GLint(first), GLsizei(vertices.size() - first)});
  }
  return {UploadMesh(gl_, std::as_bytes(std::span(vertices)), kSkinFloats), std::move(parts),
          UploadSheets(gl_, GrowthImages(body))};
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
