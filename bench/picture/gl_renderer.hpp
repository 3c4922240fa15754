// The picture by OpenGL, without window, display or GPU where it has to be: the same scene and the same functions of
// light as in software, drawn as a game would draw them.
//
//   sun's maps, one for each character (MIN, ADD)
//   skin, relief, eyes -> strands of each layer in the frame's order, over each other, premultiplied
//   samples -> pixels, over the room, sRGB
//
// There is one at a time in a process.
//
// No pixel of one driver is promised to be that of another, or of the software's: pictures are compared, not digested.
#pragma once

#include <glm/glm.hpp>
#include <memory>

#include "bench/picture/picture.hpp"
#include "core/error.hpp"

namespace pelt {

class GlRenderer final : public PictureRenderer {
 public:
  // Fails where no OpenGL 3.3 is to be had, and says what is missing.
  static Result<GlRenderer> Open();
  GlRenderer(GlRenderer&&) noexcept;
  GlRenderer& operator=(GlRenderer&&) noexcept;
  ~GlRenderer() override;

  std::vector<uint8_t> Draw(const PictureScene& scene, const PictureOptions& options) override;
  std::string Device() const override;
  // The same into the framebuffer that a window or a page shows, instead of back to the caller.
  void Show(const PictureScene& scene, const PictureOptions& options);

  // The sun's map of a character, texel by texel: the nearest distance thrice, m, and coverage, of 255.
  std::vector<glm::vec4> DrawShadowMap(const PictureScene& scene, uint32_t actor);

 private:
  struct State;
  explicit GlRenderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pelt
