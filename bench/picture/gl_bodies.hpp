// The characters' skin and eyes on the graphics card. Of a skin that is as it was in the picture before nothing is sent
// again, and of one that moved only its vertices.
#pragma once

#include <vector>

#include "bench/picture/gl_programs.hpp"
#include "bench/picture/picture_scene.hpp"

namespace pelt {

class GlBodies {
 public:
  explicit GlBodies(const GlApi& gl) : gl_(gl), nothing_(gl) {}

  // Whether anything is other than before.
  bool Take(const PictureScene& scene);
  // By the program that is in use: of GlPrograms, `body` or `body_shadow`.
  void DrawSkin(uint32_t actor) const;
  // By GlPrograms' eye, in use.
  void DrawEyes(const GlProgram& program, const std::vector<Eye>& eyes) const;

 private:
  struct Part {  // triangles with one image
    GlTexture image;
    GLint first;
    GLsizei vertices;
  };
  // The attributes of body.vert, one behind the other.
  struct Vertex {
    glm::vec3 position, normal, fur;
    glm::vec4 tint;
    glm::vec3 share;
    glm::vec2 uv;
    glm::vec4 paint;  // of the fur above
    glm::vec2 growth_uv;
    glm::vec4 rate, sheet;
  };
  struct Skin {
    Body body;  // that was taken
    GlMesh mesh;
    std::vector<Part> parts;
    GlTexture growth;                 // sheets of its mapped layers
    std::vector<uint32_t> triangles;  // of the mesh, in the order of the parts
    std::vector<Vertex> vertices;     // their corners
  };
  static Vertex CornerOf(const Body& body, uint32_t triangle, int corner);
  static void PoseCorner(const Body& body, uint32_t triangle, uint32_t v, Vertex& vertex);
  Skin Make(const Body& body) const;
  void Pose(Skin& skin) const;

  const GlApi& gl_;
  GlVertexArray nothing_;
  std::vector<Skin> skins_;
};

}  // namespace pelt
