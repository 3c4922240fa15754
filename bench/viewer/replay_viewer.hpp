// What the page shows of a recording (.peltinput): its grooms, and for each frame the input of that frame. Every
// frame's digest is compared with the recorded one. There is no character in a recording: fur alone is drawn.
//
// The frames' input stays as it is. The user may stand elsewhere: the frame that ran is then drawn from there, by a
// frame of no time, which changes no bit of the next. Layers that the recorded camera did not have in sight, and
// strands that were too far from it, are left out all the same.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "bench/picture/frame_blend.hpp"
#include "bench/picture/picture_maps.hpp"
#include "bench/verify/replay.hpp"
#include "bench/viewer/page_settings.hpp"
#include "bench/viewer/page_view.hpp"
#include "jobs/frame_recording.hpp"

namespace pelt {

class ReplayViewer final : public PageView {
 public:
  // `name` is for messages. Fails with the reason, and where in the file it is, when that cannot be replayed, or its
  // first frame cannot run.
  static Result<std::unique_ptr<ReplayViewer>> Open(std::span<const std::byte> file,
                                                    const std::string& name);

  const char* Step() override;
  void Restart() override;
  bool AtEnd() const override { return !course_->HasNext(); }
  void Set(std::string_view key, double value) override;
  void SetCamera(std::optional<PageCamera> camera) override;
  void Look() override;
  PictureScene Gather(float share = 1.0f) const override;
  bool HasInBetween() const override { return before_.HasFrame(); }
  std::string Describe() const override;
  std::string LastFrame() const override;

  const ReplayResult& result() const { return course_->result(); }
  // Of the picture.
  const Camera& camera() const { return camera_; }

 private:
  struct Box {
    glm::vec3 low{1e30f}, high{-1e30f};
  };
  class FrameTimer;

  ReplayViewer(InputLog log, std::string name) : log_(std::move(log)), name_(std::move(name)) {}
  std::string MakeStage();
  std::string Begin();
  uint32_t LastRun() const;
  PictureScene GatherFrame() const;
  void Light(PictureScene& shown) const override;
  PageCamera OrbitFrom(const Camera& own) const;

  InputLog log_;
  std::string name_;
  std::optional<ReplayScene> replay_;
  std::optional<ReplayCourse> course_;
  std::unique_ptr<FrameRecording> times_;
  Scenario stage_;  // characters without bodies, for what draws
  PageSettings settings_{stage_};
  std::unique_ptr<PictureMaps> maps_;
  FrameBlend before_;  // of pictures in between
  Box box_;            // round the fur of the first frame
  std::optional<PageCamera> user_;
  Camera camera_;
  bool is_stale_ = false;  // what was drawn last is not what `camera_` sees
  std::string refusal_;
  double caller_ms_ = 0.0, frame_ms_ = 0.0;
};

}  // namespace pelt
