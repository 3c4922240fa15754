// EyePet's lighting buffer: what light does at the skin, in half of the picture's width and height, blurred so that
// hair takes it from where it is seen; a hair then costs no light of its own. What is behind everything has rim light,
// which blurring brings in over the outline.
#pragma once

#include "bench/picture/gl_shadows.hpp"
#include "bench/picture/picture.hpp"

namespace pelt {

class GlLighting {
 public:
  // Draws it, and leaves it bound where passes look for it.
  GlLighting(const GlApi& gl, const GlPrograms& programs, const PictureScene& scene,
             const GlBodies& bodies, const GlShadows& shadows, const PictureOptions& options);

 private:
  GlTexture coefficients_;
};

}  // namespace pelt
