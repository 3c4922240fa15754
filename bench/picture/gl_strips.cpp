#include "bench/picture/gl_strips.hpp"

#include <vector>

#include "bench/picture/gl_programs.hpp"
#include "bench/picture/strip_texture.hpp"

namespace pelt {
namespace {

// Of strips that lie side by side, one behind the other.
std::vector<uint8_t> StripByStrip(const std::vector<uint8_t>& texels, uint32_t strips,
                                  uint32_t width, uint32_t height) {
  std::vector<uint8_t> apart;
  apart.reserve(texels.size());
  for (uint32_t strip = 0; strip < strips; ++strip)
    for (uint32_t y = 0; y < height; ++y) {
      const auto row = texels.begin() + ptrdiff_t((size_t(y) * strips + strip) * width);
      apart.insert(apart.end(), row, row + ptrdiff_t(width));
    }
  return apart;
}

GlTexture Upload(const GlApi& gl, const StripTexture& made) {
  gl.ActiveTexture(GL_TEXTURE0 + kMakingUnit);
  GlTexture texture(gl);
  gl.BindTexture(GL_TEXTURE_2D_ARRAY, texture);
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  for (uint32_t level = 0; level < made.levels(); ++level) {
    const uint32_t width = StripTexture::kWidth >> level, height = StripTexture::kHeight >> level;
    gl.TexImage3D(GL_TEXTURE_2D_ARRAY, GLint(level), GL_R8, GLsizei(width), GLsizei(height),
                  GLsizei(made.strips()), 0, GL_RED, GL_UNSIGNED_BYTE,
                  StripByStrip(made.texels(level), made.strips(), width, height).data());
  }
  const auto set = [&](GLenum what, GLint to) { gl.TexParameteri(GL_TEXTURE_2D_ARRAY, what, to); };
  set(GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  set(GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  set(GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  set(GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  set(GL_TEXTURE_MAX_LEVEL, GLint(made.levels()) - 1);  // two texels high: there is one level less
  return texture;
}

}  // namespace

void GlStrips::Bind(uint32_t strips) {
  if (strips > strips_) {
    texture_ = Upload(*gl_, StripTexture(strips));
    strips_ = strips;
  }
  BindTexture(*gl_, kStripsUnit, GL_TEXTURE_2D_ARRAY, texture_);
}

}  // namespace pelt
