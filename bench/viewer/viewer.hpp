// What the page shows and changes: a scenario that runs frame by frame, the same bits as `pelt run` as long as nothing
// but the picture is changed, and what is said of it in JSON. Without a page around it, so that tests run it natively.
//
//   Viewer viewer({.scene = "monster"});
//   viewer.Step();
//   viewer.LastFrame();                    // digests, times, what ran
//   viewer.ChangeKey(0, "head", "frequency", "8");
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "bench/picture/frame_blend.hpp"
#include "bench/picture/picture.hpp"
#include "bench/picture/picture_maps.hpp"
#include "bench/viewer/page_settings.hpp"
#include "bench/viewer/page_view.hpp"
#include "jobs/frame_recording.hpp"

namespace pelt {

// A ray of the picture: where it starts, and its direction, unit.
struct PageRay {
  glm::vec3 from, along;
};

class Viewer final : public PageView {
 public:
  // Throws Error as LoadScenario does.
  explicit Viewer(ScenarioRequest request);

  const char* Step() override;
  void Restart() override;
  uint32_t next_frame() const { return next_frame_; }
  // Digests are taken of frames below this one; at first of all. They are a good part of a frame's time.
  void TakeDigests(uint32_t frames) { digest_frames_ = frames; }

  // One of the scene's setups in which a layer's key has another value, and the scene that it makes. It goes on from
  // the state that there is, at the frame that is next; on its groom where it has other strands
  // (FurScene::ReplaceGrooms). Throws Error and changes nothing where the setup or the value is not taken.
  void ChangeKey(size_t setup, std::string_view layer, std::string_view key,
                 std::string_view value);
  void ReplaceSetup(size_t setup, std::string text);
  size_t setup_count() const { return scenario_->setups.size(); }
  // Empty of one that is a groom's file.
  const std::string& setup_text(size_t setup) const { return scenario_->setups.at(setup).text; }

  void Set(std::string_view key, double value) override;
  void SetCamera(std::optional<PageCamera> camera) override;
  // Another camera, or other skips and detail: the frame that ran is drawn once more by one of no time, which changes
  // no bit of the next.
  void Look() override;
  void SetViewport(uint32_t width_px, uint32_t height_px) override;
  // The user's ball: where it is, in frames from the next one on; `radius` is a setting.
  void MoveSphere(const glm::vec3& centre) { sphere_centre_ = centre; }
  // Paints at a place in the next frame. The first one has all layers of strands lit and painted, which is another
  // scene, and as one of another setup begins on its groom.
  void Paint(uint32_t channel, const glm::vec3& centre);

  // Of the pixel as it was drawn last, 0 to 1 from the left and from the top.
  PageRay RayAt(double x, double y) const;
  // Where in the picture a place of the world is: the same shares, and how far in front of the eye, m.
  glm::vec3 ShareOf(const glm::vec3& place) const;
  // Where the ray meets the characters first.
  struct Hit {
    glm::vec3 position;  // world
    uint32_t actor;
    SurfacePoint place;
  };
  std::optional<Hit> FindHit(const PageRay& ray) const;
  std::optional<glm::vec3> Pick(const PageRay& ray) const;
  // As they stand in the last frame, one for each actor; good until the next.
  std::span<const Body> Bodies() const;
  // How high the picture is so far in front of the eye, m.
  double HeightAt(double depth_m) const { return 2.0 * depth_m * FindLens().height; }
  const Scenario& scenario() const { return *scenario_; }
  // How many scenarios there were.
  uint64_t loads() const { return loads_; }

  PictureScene Gather(float share = 1.0f) const override;
  bool HasInBetween() const override { return before_.HasFrame(); }
  std::string Describe() const override;
  std::string LastFrame() const override;

  FurScene& scene() { return running_->scene(); }
  uint64_t run_digest() const { return run_digest_.Value(); }

 private:
  struct Lens {
    glm::vec3 eye, ahead, right, up;
    double width, height;
  };
  Lens FindLens() const;
  void ForgetPoses() {
    bodies_.clear();
    PageView::ForgetPoses();
  }
  const Camera& StandFor(const Camera& own);
  PictureScene GatherFrame() const;
  void Light(PictureScene& shown) const override;
  void ApplyLook(PictureScene& shown) const;
  void KeepForBlend();
  void Load();
  void Begin(Scenario& scenario, Isa isa);
  void ChangeKernels();
  void AddOwn(FrameInput& input);

  ScenarioRequest request_;
  std::unique_ptr<Scenario> scenario_;
  std::unique_ptr<PageSettings> settings_;
  std::map<const PageEntry*, double> set_;  // by the user, for the scenario that comes next
  std::unique_ptr<PictureMaps> maps_;
  mutable std::vector<Body> bodies_;  // of Bodies(), where no picture has them
  uint64_t loads_ = 0;
  std::unique_ptr<RunningScenario> running_;
  std::unique_ptr<FrameRecording> times_;
  FrameBlend before_;  // of pictures in between
  std::optional<PageCamera> camera_;
  Camera last_camera_;                    // of the picture
  std::optional<Camera> held_camera_;     // of the frame, where it is another
  std::optional<FrameInput> last_input_;  // with the scenario's own camera
  bool is_stale_ = false;                 // what was drawn last is not what is asked for
  std::optional<glm::vec3> sphere_centre_, last_sphere_;
  std::optional<PaintBrush> brush_;
  bool painted_ = false, is_begun_ = false;  // a frame has run since the strands lay on their groom
  uint32_t width_px_ = 1280, height_px_ = 720;
  uint32_t next_frame_ = 0;
  double caller_ms_ = 0.0, frame_ms_ = 0.0;
  uint32_t digest_frames_ = ~0u;
  Digest run_digest_;
};

}  // namespace pelt
