// A scene and every file that its request leads to: what a page is given, and what changes in it while the user works
// on the setup, its maps or the model.
//
// A file is taken once it holds still for two looks: editors write in pieces and rename. What does not load is an error
// with its place, and the last scene that did stays. Not for several threads at once.
//
//   SceneWatch scene({.setup = "my_fur.toml"}, 120);
//   while (going_on) if (scene.Look()) Tell(scene.ChangesSince(shown));
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/viewer/page_text.hpp"

namespace pelt {

class SceneWatch {
 public:
  // Throws Error as LoadScenario does. `frames`: how many a run has that digests are taken of.
  SceneWatch(ScenarioRequest request, uint32_t frames);

  // Whether ChangesSince has more to report than before.
  bool Look();
  // Runs a frame for its digest; false: all are taken. The last of a scene that changed is reported as a change. Throws
  // Error where the first scene's frame is refused; one that changed has none from there on, and its page says why.
  bool StepDigest();

  const FileBytes& files() const { return files_; }
  // Why the files as they are now do not load; empty: they do.
  const std::string& error() const { return error_; }
  uint32_t version() const { return version_; }
  const std::vector<uint64_t>& digests() const { return digests_->digests(); }
  // What the last change was, for a line of text: paths.
  const std::vector<std::string>& changed() const { return changed_; }

  // PageContent::consoles of the pages from here on: of the files as they were.
  void TakeConsoles(std::string json) { consoles_ = std::move(json); }
  PageContent Content(std::string command) const;
  // JSON: what is other than at that version. page_watch.js reads it.
  std::string ChangesSince(uint32_t version) const;

 private:
  struct Stamp {
    bool is_there = false;
    uintmax_t size = 0;
    std::filesystem::file_time_type written = {};
    bool operator==(const Stamp&) const = default;
  };
  using Stamps = std::map<std::string, Stamp>;

  static Stamps StampsOf(const FileBytes& files);
  bool Take(const Stamps& now);
  bool TakeError(std::string error);
  void TakeFiles(FileBytes files);

  ScenarioRequest request_;
  uint32_t frames_;
  std::string consoles_;
  std::string run_;  // no other program's: versions of different ones cannot be compared
  FileBytes files_;
  std::map<std::string, uint32_t> changed_at_;  // version
  std::vector<std::string> changed_;
  Stamps taken_, seen_;
  std::string error_;
  uint32_t version_ = 0, digests_at_ = 0, looks_with_error_ = 0;
  bool refused_ = false;  // a frame of the run
  std::unique_ptr<DigestRun> digests_;
};

}  // namespace pelt
