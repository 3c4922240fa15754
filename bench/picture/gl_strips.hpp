// Film strips on the graphics card: strip_texture.hpp's levels, a layer of one texture for each strip.
#pragma once

#include <cstdint>

#include "bench/picture/gl_objects.hpp"

namespace pelt {

class GlStrips {
 public:
  explicit GlStrips(const GlApi& gl) : gl_(&gl), texture_(gl) {}

  // At least so many strips, where passes look for them. Those that there are stay for the next picture.
  void Bind(uint32_t strips);

 private:
  const GlApi* gl_;
  GlTexture texture_;
  uint32_t strips_ = 0;
};

}  // namespace pelt
