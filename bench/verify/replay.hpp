// Runs an input log again, and checks that the bits are those recorded.
//
// Needs the core, the groom reader, jobs and traces, and the executor that it is given: nothing
// here sees oneTBB, glTF or the command line, so that the same file replays in a program for
// another machine (tests/) or inside an engine.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/groom/groom.hpp"
#include "jobs/scene.hpp"
#include "traces/digest.hpp"
#include "traces/digest_log.hpp"
#include "traces/input_log.hpp"

namespace pelt {

// A log with its grooms read and the scene that runs it. The log must outlive it.
class ReplayScene {
 public:
  // Of `options` the vertex order is the log's; all others are free to choose. `name` is for
  // messages. Fails when the log was recorded with another chunk capacity, a groom cannot be read or
  // the scene cannot be made.
  static Result<ReplayScene> Open(const InputLog& log, const std::string& name,
                                  SceneOptions options);

  FurScene& scene() { return *scene_; }
  const FurScene& scene() const { return *scene_; }
  const SceneOptions& options() const { return options_; }
  // Fills the poses and begins a frame. Null, or the reason the frame must not run.
  const char* Begin(uint32_t frame);

 private:
  ReplayScene(const InputLog& log, SceneOptions options) : log_(log), options_(options) {}

  const InputLog& log_;
  SceneOptions options_;
  std::vector<Groom> grooms_;
  std::unique_ptr<FurScene> scene_;
};

struct ReplayMismatch {
  uint32_t frame = 0;
  uint64_t recorded = 0, found = 0;
  std::string refused;  // why the frame could not run; empty: it ran and gave another digest
};

struct ReplayResult {
  uint32_t frames = 0;  // that ran
  std::optional<ReplayMismatch> first;
  uint32_t mismatches = 0;
  std::string refused_pose;  // the first pose that was not used, and in which frame
  std::string note;          // the first of FurScene::NextNote
  uint64_t digest = 0;       // of all frames, folded as `pelt run` does
  bool Same() const { return !first; }
};

// A replay frame by frame: what came of those that ran. Log and scene must outlive it.
class ReplayCourse {
 public:
  ReplayCourse(const InputLog& log, ReplayScene& replay) : log_(log), replay_(replay) {}

  // Whether frames are left, none of which was refused.
  bool HasNext() const { return !refused_ && result_.frames < log_.FrameCount(); }
  // False when the frame was refused, of which there must be one left.
  bool RunNext(Executor& executor);
  const ReplayResult& result() const { return result_; }
  uint64_t found() const { return found_; }  // digest of the last frame that ran

 private:
  const InputLog& log_;
  ReplayScene& replay_;
  ReplayResult result_;
  Digest fold_;
  uint64_t found_ = 0;
  bool refused_ = false;
};

// Runs every frame of the log; stops at one that is refused. `after_frame` may be empty.
ReplayResult Replay(const InputLog& log, ReplayScene& replay, Executor& executor,
                    const std::function<void(uint32_t frame)>& after_frame = {});

// One line: the verdict.
std::string DescribeReplay(const ReplayResult& result);

}  // namespace pelt
