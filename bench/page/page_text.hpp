// The page of `pelt view` as one file: HTML, style, scripts, the module, and what it is to show.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/scenarios/scenarios.hpp"

namespace pelt {

struct PageFile {
  std::string_view name, text;
};
std::span<const PageFile> EmbeddedPageFiles();  // bench/page
// WebAssembly, gzip; empty where the program was built without PELT_WASM.
std::span<const std::byte> EmbeddedModule();

// What to do for a module where there is none; one sentence and its reason.
std::string WhyNoModule();

struct PageContent {
  ScenarioRequest request;  // scene, character, setup, groom and lights alone
  std::map<std::string, std::vector<std::byte>> files =
      {};  // by the paths that the request leads to
  std::string
      command;  // that prints the digest of the first frames, "FRAMES" where their number stands
  std::vector<uint64_t> digests;  // of a run of the first frames, after each
};

// Throws Error where there is no module, and says what builds it.
std::string MakePage(const PageContent& content);

// After each of the first frames, as `pelt run` prints it for so many.
std::vector<uint64_t> RunDigests(const ScenarioRequest& request, uint32_t frames);

}  // namespace pelt
