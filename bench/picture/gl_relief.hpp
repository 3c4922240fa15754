// Fur as relief on the graphics card: the skin's triangles once more for each of its layers, over the skin.
#pragma once

#include <vector>

#include "bench/picture/gl_programs.hpp"
#include "bench/picture/picture_scene.hpp"

namespace pelt {

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

}  // namespace pelt
