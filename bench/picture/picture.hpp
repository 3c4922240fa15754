// A picture of the last frame, drawn from what the frame wrote: the draw list, the sorted instances and ribbons, and
// the palette for the body under them. Here the renderer in software; gl_renderer.hpp has the one on a graphics card.
//
//   const PictureScene shown = GatherPicture(scenario, scene, camera, order, notes);
//   const std::vector<uint8_t> rgb = SoftwareRenderer().Draw(shown, options);  // png.hpp
//
// For people who want to see what they measure. Nothing of the frame is timed here.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bench/picture/picture_scene.hpp"

namespace pelt {

struct PictureOptions {
  uint32_t width_px = 1200, height_px = 900;
  uint32_t samples = 0;            // a side of each pixel; 0: the renderer's default
  bool lighting_buffer = false;    // OpenGL alone: hair lit by GlLighting
  bool shells_one_by_one = false;  // OpenGL alone: a draw for each shell instead of an instance
};

class PictureRenderer {
 public:
  virtual ~PictureRenderer() = default;
  // 8-bit sRGB, rows from the top. Throws Error for what it cannot draw.
  virtual std::vector<uint8_t> Draw(const PictureScene& scene, const PictureOptions& options) = 0;
  // What draws: "software", or what the driver calls itself.
  virtual std::string Device() const = 0;
  // Of the last picture's relief; none where there was none, or it is not counted.
  virtual ReliefCount ReliefSteps() const { return {}; }
};

class SoftwareRenderer final : public PictureRenderer {
 public:
  std::vector<uint8_t> Draw(const PictureScene& scene, const PictureOptions& options) override;
  std::string Device() const override { return "software"; }
  ReliefCount ReliefSteps() const override { return relief_steps_; }

 private:
  ReliefCount relief_steps_;
};

// The mean of `frames` pictures, 1 or more, each with another jitter of relief, from the scene's on: what accumulated
// frames show.
std::vector<uint8_t> DrawFrames(PictureRenderer& renderer, PictureScene scene,
                                const PictureOptions& options, uint32_t frames);

// A PNG of the scene's last frame as `camera` saw it, in software: GatherPicture has `notes` and `relief`.
std::vector<std::byte> DrawPicture(const Scenario& scenario, const FurScene& scene,
                                   const Camera& camera, VertexOrder order,
                                   const PictureOptions& options, std::vector<std::string>& notes,
                                   std::span<const std::string> relief = {});

}  // namespace pelt
