// The characters' skin and eyes on the graphics card.
#pragma once

#include <vector>

#include "bench/picture/gl_objects.hpp"
#include "bench/picture/picture_scene.hpp"

namespace pelt {

// Fur as relief on the graphics card: the skin's triangles once more for each of its layers, over the skin.

class GlRelief {
 public:
  GlRelief(const GlApi& gl, const PictureScene& scene);

  bool Has(uint32_t actor) const { return !coats_[actor].parts.empty(); }
  // By GlPrograms' relief, in use, where the skin has been drawn: layers in the setup's order.
  void Draw(const GlProgram& program, uint32_t actor) const;

 private:
  struct Part {  // triangles of a layer with one sheet of its flow map
    GlTexture flow;
    glm::vec2 repeat;
    float longest_m;
    GLint first;
    GLsizei vertices;
  };
  struct Coat {
    GlMesh mesh;
    GlTexture tile;
    std::vector<Part> parts;
  };
  Coat Upload(const Body& body) const;

  const GlApi& gl_;
  std::vector<Coat> coats_;
};

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
