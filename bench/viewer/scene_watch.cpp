#include "bench/viewer/scene_watch.hpp"

#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/file_bytes.hpp"

namespace pelt {
namespace {

namespace fs = std::filesystem;

// A setup that names a map that is not there yet leads to no file whose change could be seen: what does not load is
// tried again after so many looks.
constexpr uint32_t kLooksARetry = 5;

struct LoadedScene {
  Scenario scenario;
  FileBytes files;
};

LoadedScene LoadWithFiles(ScenarioRequest request) {
  LoadedScene loaded;
  const auto take = [&](const std::string& path) {
    if (!path.empty() && !IsBuiltInName(path))
      loaded.files[path] = ReadFileBytes("file", path).OrThrow();
  };
  const CheckFilesReadHook before = request.check_files_read;
  request.check_files_read = [&](const std::vector<std::string>& led_to) {
    if (before) before(led_to);
    for (const std::string& path : led_to) take(path);
  };
  loaded.scenario = LoadScenario(request);
  if (request.scene.empty())
    for (const std::string* path : {&request.character, &request.setup, &request.groom})
      take(*path);
  take(request.lights);
  return loaded;
}

bool AreOnDisk(const FileBytes& files) {
  for (const auto& [path, bytes] : files) {
    const Result<std::vector<std::byte>> now = ReadFileBytes("file", path);
    if (!now || *now != bytes) return false;
  }
  return true;
}

}  // namespace

SceneWatch::SceneWatch(ScenarioRequest request, uint32_t frames)
    : request_(std::move(request)),
      frames_(frames),
      run_(fmt::format("{:x}", std::chrono::system_clock::now().time_since_epoch().count())) {
  LoadedScene loaded = LoadWithFiles(request_);
  files_ = std::move(loaded.files);
  // What was written to since is other than its bytes, which the first looks compare.
  digests_ = std::make_unique<DigestRun>(std::move(loaded.scenario));
}

SceneWatch::Stamps SceneWatch::StampsOf(const FileBytes& files) {
  Stamps stamps;
  for (const auto& file : files) {
    std::error_code gone, unread;
    const uintmax_t size = fs::file_size(file.first, gone);
    const fs::file_time_type written = fs::last_write_time(file.first, unread);
    stamps[file.first] = gone || unread ? Stamp{} : Stamp{true, size, written};
  }
  return stamps;
}

bool SceneWatch::Look() {
  const Stamps now = StampsOf(files_);
  if (now == taken_) return !error_.empty() && ++looks_with_error_ % kLooksARetry == 0 && Take(now);
  if (now == seen_) return Take(now);
  seen_ = now;
  return false;
}

bool SceneWatch::Take(const Stamps& now) {
  if (error_.empty() && AreOnDisk(files_)) {
    taken_ = now;
    return false;
  }
  try {
    LoadedScene loaded = LoadWithFiles(request_);
    // Written to while it was read: what was read may be of both.
    if (StampsOf(files_) != now) return false;
    taken_ = now;
    TakeFiles(std::move(loaded.files));
    if (changed_.empty()) return true;
    digests_ = std::make_unique<DigestRun>(std::move(loaded.scenario));
    refused_ = false;
    return true;
  } catch (const std::exception& error) {
    taken_ = now;
    return TakeError(error.what());
  }
}

bool SceneWatch::TakeError(std::string error) {
  if (error == error_) return false;
  error_ = std::move(error);
  looks_with_error_ = 0;
  ++version_;
  return true;
}

void SceneWatch::TakeFiles(FileBytes files) {
  ++version_;
  error_.clear();
  changed_.clear();
  for (const auto& [path, bytes] : files) {
    const auto before = files_.find(path);
    if (before != files_.end() && before->second == bytes) continue;
    changed_at_[path] = version_;
    changed_.push_back(path);
  }
  if (!changed_.empty()) digests_at_ = version_;
  files_ = std::move(files);
}

bool SceneWatch::StepDigest() {
  if (refused_ || digests().size() >= frames_) return false;
  try {
    digests_->Step();
  } catch (const Error&) {
    if (version_ == 0) throw;
    refused_ = true;
    return false;
  }
  if (digests().size() == frames_ && version_ != 0) digests_at_ = ++version_;
  return true;
}

PageContent SceneWatch::Content(std::string command) const {
  return {request_, files_, std::move(command), digests(), std::nullopt, {}, consoles_};
}

std::string SceneWatch::ChangesSince(uint32_t version) const {
  using Json = nlohmann::ordered_json;
  Json json = {{"run", run_}, {"version", version_}, {"error", error_}};
  Json files = Json::object();
  for (const auto& [path, at] : changed_at_) {
    const auto file = files_.find(path);
    if (at <= version || file == files_.end()) continue;
    files[path] = Base64(file->second);
    if (path == request_.setup) json["setup"] = AsText(file->second);
  }
  if (!files.empty()) json["files"] = files;
  if (digests_at_ > version) json["digests"] = DigestTexts(digests());
  return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

}  // namespace pelt
