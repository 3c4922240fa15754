// The page of `pelt view` as one file: HTML, style, scripts, the module, and what it is to show.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/scenarios/scenarios.hpp"
#include "traces/digest.hpp"

namespace pelt {

struct PageFile {
  std::string_view name, text;
};
std::span<const PageFile> EmbeddedPageFiles();  // bench/viewer
// WebAssembly, gzip; empty where the program was built without PELT_WASM.
std::span<const std::byte> EmbeddedModule();
// The same without vectors, for browsers that have none.
std::span<const std::byte> EmbeddedPlainModule();

// What to do for a module where there is none; one sentence and its reason.
std::string WhyNoModule();

// By their paths.
using FileBytes = std::map<std::string, std::vector<std::byte>>;

struct PageContent {
  ScenarioRequest request;  // scene, character, setup, groom and lights alone
  FileBytes files = {};     // that the request leads to
  std::string
      command;  // that prints the digest of the first frames, "FRAMES" where their number stands
  std::vector<uint64_t> digests;  // of a run of the first frames, after each
  // Where the page asks for what changed, and from which version on: SceneWatch::ChangesSince.
  std::optional<uint32_t> watched_from = {};
  std::string recording = {};  // a recording among the files that is shown instead
  std::string consoles = {};   // JSON: frames as consoles would run them, an array; empty: none
};

// Throws Error where there is no module, and says what builds it.
std::string MakePage(const PageContent& content);

std::string Base64(std::span<const std::byte> bytes);
// As hexadecimal, which JSON's numbers have no room for.
std::vector<std::string> DigestTexts(std::span<const uint64_t> digests);

// A scene's run from its first frame on, one frame at a time.
class DigestRun {
 public:
  explicit DigestRun(Scenario scenario);
  // Throws Error where the frame is refused.
  void Step();
  // After each frame, as `pelt run` prints it for so many.
  const std::vector<uint64_t>& digests() const { return digests_; }

 private:
  Scenario scenario_;
  RunningScenario running_;
  Digest run_;
  std::vector<uint64_t> digests_;
};

// After each of the first frames, as `pelt run` prints it for so many.
std::vector<uint64_t> RunDigests(const ScenarioRequest& request, uint32_t frames);

}  // namespace pelt
