// The sun's maps on the graphics card, as scene_shadows.hpp has them in software: one for each character, the layers
// of one texture.
//
// Invariant: blended by MIN, and by ADD of whole numbers: what is drawn in another order gives the same bits.
#pragma once

#include <vector>

#include "bench/picture/gl_bodies.hpp"
#include "bench/picture/gl_shells.hpp"
#include "bench/picture/gl_strands.hpp"
#include "bench/picture/picture.hpp"

namespace pelt {

class GlShadows {
 public:
  // Draws them, and leaves them bound where passes look for them.
  GlShadows(const GlApi& gl, const GlPrograms& programs, const PictureScene& scene,
            const GlBodies& bodies, const GlStrands& strands, const GlShells& shells);

  // A normal's length by which skin is lifted out of its own shadow, m.
  float Lift(uint32_t actor) const;
  // A character's map: r, g, b the nearest distance, a the coverage, of 255.
  std::vector<glm::vec4> Read(uint32_t actor) const;

 private:
  GlTexture UploadCharacters(const glm::vec3& to_sun) const;
  void DrawMap(const GlPrograms& programs, const PictureScene& scene, const GlBodies& bodies,
               const GlStrands& strands, const GlShells& shells, uint32_t actor) const;
  void Attach(GLuint texture, uint32_t layer) const;

  const GlApi& gl_;
  std::vector<Ball> balls_;
  GlTexture maps_, soft_, characters_;
  GlFramebuffer target_;
};

// Columns: along a map's x and y, to the sun.
glm::mat3 SunAxes(const glm::vec3& to_sun);

// EyePet's lighting buffer: what light does at the skin, in half of the picture's width and height, blurred so that
// hair takes it from where it is seen; a hair then costs no light of its own. What is behind everything has rim light,
// which blurring brings in over the outline.

class GlLighting {
 public:
  // Draws it, and leaves it bound where passes look for it.
  GlLighting(const GlApi& gl, const GlPrograms& programs, const PictureScene& scene,
             const GlBodies& bodies, const GlShadows& shadows, const PictureOptions& options);

 private:
  GlTexture coefficients_;
};

}  // namespace pelt
