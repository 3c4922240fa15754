// What the page's module shows: a scenario that can be changed (viewer.hpp) or a recording (replay_viewer.hpp); and
// what both do alike.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/picture/picture_scene.hpp"

namespace pelt {

// Where the user stands. Unset, the camera is what is shown's own.
struct PageCamera {
  glm::vec3 target{0.0f};  // m
  double yaw_rad = 0.0, elevation_rad = 0.0, distance_m = 1.0;
};

// `own` from where the user stands.
Camera StandAt(const PageCamera& user, const Camera& own);

// The page's clock is far away: a profile doubles what a small scene's frame costs.
inline constexpr uint32_t kFramesAProfile = 16;

class PageView {
 public:
  virtual ~PageView() = default;
  // Runs the next frame. Returns null, or why it was refused.
  virtual const char* Step() = 0;
  // Frame 0 again, as it was.
  virtual void Restart() = 0;
  // Whether no frame is left; Step begins again.
  virtual bool AtEnd() const { return false; }
  // Of its entries of PageEntries(), by key. Throws Error for one that is not there, or is out of bounds.
  virtual void Set(std::string_view key, double value) = 0;
  virtual void SetCamera(std::optional<PageCamera> camera) = 0;
  virtual void SetViewport(uint32_t, uint32_t) {}
  // Before Gather.
  virtual void Look() {}
  // What there is to draw of the last frame; or, where there is something in between, at `share` of the way to it from
  // the one before. Kept, and gathered again where more than camera and light has changed; good until the next call.
  const PictureScene& Picture(float share);
  // The same, gathered.
  virtual PictureScene Gather(float share) const = 0;
  virtual bool HasInBetween() const { return false; }
  // JSON. All that the page builds its controls from; and what the last frame was.
  virtual std::string Describe() const = 0;
  virtual std::string LastFrame() const = 0;

 protected:
  // Where more than camera and light is other than it was; and where characters, or what is on them, are, too.
  void ForgetPicture() { is_kept_ = false; }
  void ForgetPoses() {
    posed_.clear();
    ForgetPicture();
  }
  // For GatherPicture.
  std::span<const Body> posed() const { return posed_; }
  // Camera and light of a picture that has all else.
  virtual void Light(PictureScene& shown) const = 0;

 private:
  PictureScene kept_;
  bool is_kept_ = false;
  std::vector<Body> posed_;  // the last frame's
};

}  // namespace pelt
