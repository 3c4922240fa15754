// The characters' skin and eyes on the graphics card.
#pragma once

#include <vector>

#include "bench/picture/gl_programs.hpp"
#include "bench/picture/picture_scene.hpp"

namespace pelt {

class GlBodies {
 public:
  GlBodies(const GlApi& gl, const PictureScene& scene);

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
  struct Skin {
    GlMesh mesh;
    std::vector<Part> parts;
    GlTexture growth;  // sheets of its mapped layers
  };
  Skin Upload(const Body& body) const;

  const GlApi& gl_;
  GlVertexArray nothing_;
  std::vector<Skin> skins_;
};

}  // namespace pelt
