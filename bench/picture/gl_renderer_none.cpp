// In builds without OpenGL's headers.
#include "bench/picture/gl_renderer.hpp"

namespace pelt {

struct GlRenderer::State {};

GlRenderer::GlRenderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
GlRenderer::GlRenderer(GlRenderer&&) noexcept = default;
GlRenderer& GlRenderer::operator=(GlRenderer&&) noexcept = default;
GlRenderer::~GlRenderer() = default;

Result<GlRenderer> GlRenderer::Open() {
  return Failure{
      "no OpenGL: this build was made without its headers (Debian: apt-get install libegl-dev "
      "libgl-dev, then run CMake again)"};
}

std::vector<uint8_t> GlRenderer::Draw(const PictureScene&, const PictureOptions&) { return {}; }
std::string GlRenderer::Device() const { return {}; }
// NOLINTNEXTLINE(readability-convert-member-functions-to-static): the other build's is none.
std::vector<glm::vec4> GlRenderer::DrawShadowMap(const PictureScene&, uint32_t) { return {}; }

}  // namespace pelt
