#include "bench/picture/gl_relief.hpp"

#include <array>

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
  for (const ReliefCoat::Layer& layer : body.relief->layers())
    for (uint32_t sheet = 0; sheet < layer.flow.size(); ++sheet) {
      const size_t first = vertices.size();
      AddSheet(body, layer, sheet, vertices);
      parts.push_back({UploadMap(gl_, layer.flow[sheet]), layer.repeat[sheet], layer.longest_m,
                       GLint(first), GLsizei(vertices.size() - first)});
    }
  return {UploadMesh(gl_, std::as_bytes(std::span(vertices)), kReliefFloats),
          UploadMap(gl_, body.relief->tile()), std::move(parts)};
}

void GlRelief::Draw(const GlProgram& program, uint32_t actor) const {
  const Coat& coat = coats_[actor];
  gl_.BindVertexArray(coat.mesh.array);
  BindTexture(gl_, kHeightsUnit, GL_TEXTURE_2D, coat.tile);
  for (const Part& part : coat.parts) {
    BindTexture(gl_, kSurfaceUnit, GL_TEXTURE_2D, part.flow);
    program.Set("repeat", part.repeat);
    program.Set("longest", part.longest_m);
    gl_.DrawArrays(GL_TRIANGLES, part.first, part.vertices);
  }
  gl_.BindVertexArray(0);
}

}  // namespace pelt
