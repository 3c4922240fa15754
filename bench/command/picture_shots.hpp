// The pictures of a run: which of its frames are drawn, in which light, and into which files.
//
// They are drawn between frames, outside of what is timed, and their own times are a section of
// their own in the report.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/command/output_path.hpp"
#include "bench/report/report_tree.hpp"
#include "bench/scenarios/scenarios.hpp"

namespace pelt {

// Of bench/picture, which a build may be without (without_pictures.cpp).
class PictureMaps;
class PictureRenderer;
struct AnimationFrame;
struct PictureScene;

// Throws Error in a build without; before work that would come to a picture.
void RequirePictures();

// 8 bits a channel, 1 to 4 channels, rows from the top; `what` as WriteOutput has it.
void WritePng(std::string_view what, const OutputPath& path, std::span<const uint8_t> pixels,
              uint32_t width, uint32_t height, uint32_t channels);

// MakeSkinMap of bench/picture/skin_map.hpp.
std::vector<uint8_t> DrawSkinMap(const Character& character, const FurSetup& setup,
                                 const Groom& groom, uint32_t side,
                                 std::vector<std::string>& notes);

struct PictureArgs {
  OutputPath last;       // the last of the pictures
  OutputPath folder;     // each as frame-00060.png
  OutputPath animation;  // all of them as an animated PNG
  OutputPath steps;      // the last, step by step (light_steps.hpp)
  uint32_t width_px = 1200, height_px = 900;
  uint32_t every = 1;           // frames from one picture to the next, counted from the last frame
  std::vector<double> times_s;  // of the frames to draw instead
  std::string light;            // of kNamedLights; empty: the default
  std::string renderer = "software";                // of RendererNames()
  std::vector<std::string> relief;                  // PictureMaps has it
  bool relief_rim = false;                          // likewise
  std::vector<float> relief_steps = {4.0f, 16.0f};  // ReliefMarch has them
  uint32_t relief_frames = 0;                       // of DrawFrames, in place of one without jitter
  float relief_wind_s = 0.0f;                       // m that tips are pushed for each m/s
  bool relief_shows_steps = false;
  bool lighting_buffer = false;  // PictureOptions has it

  bool Any() const {
    return !last.empty() || !folder.empty() || !animation.empty() || !steps.empty();
  }
};

class PictureShots {
 public:
  // `frames` are run in all; scenario and scene must outlive this. Throws Error for a time that no frame of them has,
  // and where the renderer cannot be had.
  PictureShots(const PictureArgs& args, Scenario& scenario, FurScene& scene, uint32_t frames,
               VertexOrder order);
  PictureShots(PictureShots&&) noexcept;
  ~PictureShots();

  uint32_t Count() const { return uint32_t(frames_.size()); }
  uint32_t Taken() const { return uint32_t(seconds_.size()); }
  // Draws the frame that the scene is in, if it is one of those. A picture that cannot be written keeps no other from
  // being drawn: see faults().
  void Take(uint32_t frame);
  // After the last frame: what is not one of the folder.
  void Finish();

  // "pictures": how many, and how long they took. None: nothing.
  void AddTo(ReportTree& tree) const;
  const std::vector<std::string>& written() const { return written_; }  // "picture p.png"
  const std::vector<std::string>& notes() const { return notes_; }
  const std::vector<std::string>& faults() const { return faults_; }

 private:
  OutputPath FrameFile(uint32_t frame) const;
  bool Wants(uint32_t frame) const;
  PictureScene Gather(uint32_t frame);
  void Write(std::string_view what, const OutputPath& path, std::span<const std::byte> png);

  PictureArgs args_;
  Scenario& scenario_;
  FurScene& scene_;
  VertexOrder order_;
  std::unique_ptr<PictureRenderer> renderer_;
  std::unique_ptr<PictureMaps> maps_;  // from the first picture on
  std::vector<uint32_t> frames_;       // rising
  std::vector<std::byte> last_;
  std::vector<uint8_t> steps_;
  std::vector<AnimationFrame> animation_;
  double open_seconds_ = 0.0, core_seconds_ = 0.0;
  double relief_steps_ = 0.0;  // of all pictures
  uint64_t relief_places_ = 0;
  std::vector<double> seconds_;  // that each took
  std::vector<std::string> written_, notes_, faults_;
};

}  // namespace pelt
