#include "bench/page/page_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "bench/page/page_request.hpp"
#include "core/error.hpp"
#include "traces/digest.hpp"

namespace pelt {
namespace {

using Json = nlohmann::ordered_json;

std::string Base64(std::span<const std::byte> bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t at = 0; at < bytes.size(); at += 3) {
    const size_t left = std::min<size_t>(bytes.size() - at, 3);
    uint32_t word = 0;
    for (size_t i = 0; i < 3; ++i) word = word << 8 | (i < left ? uint32_t(bytes[at + i]) : 0u);
    for (size_t i = 0; i < 4; ++i) text += i <= left ? kDigits[word >> (18 - 6 * i) & 63] : '=';
  }
  return text;
}

std::string_view FileText(std::string_view name) {
  for (const PageFile& file : EmbeddedPageFiles())
    if (file.name == name) return file.text;
  throw Error(fmt::format("the page has no part '{}'", name));
}

// JSON inside a script element: it must not end there.
std::string InScript(std::string json) {
  for (size_t at = 0; (at = json.find('<', at)) != json.npos;) json.replace(at, 1, "\\u003c");
  return json;
}

std::string GivenText(const PageContent& content) {
  Json files = Json::object(), digests = Json::array();
  for (const auto& [path, bytes] : content.files) files[path] = Base64(bytes);
  for (const uint64_t digest : content.digests) digests.push_back(fmt::format("{:016x}", digest));
  const Json json = {{"request", WriteRequest(content.request)},
                     {"files", files},
                     {"native", {{"command", content.command}, {"digests", digests}}}};
  return InScript(json.dump(-1, ' ', true, Json::error_handler_t::replace));
}

}  // namespace

std::string WhyNoModule() {
  return "this program was built without the page's module: `bash bench/run.sh view` installs what "
         "that needs "
         "(Debian: clang lld-14 wasi-libc libc++-16-dev-wasm32 libclang-rt-14-dev-wasm32), builds "
         "with -DPELT_WASM=ON "
         "and writes the page";
}

std::string MakePage(const PageContent& content) {
  if (EmbeddedModule().empty()) throw Error(WhyNoModule());
  const std::pair<std::string_view, std::string> parts[] = {
      {"@style@", std::string(FileText("page.css"))},
      {"@module@", Base64(EmbeddedModule())},
      {"@given@", GivenText(content)},
      {"@worker@", std::string(FileText("webgl.js")) + std::string(FileText("worker.js"))},
      {"@script@", std::string(FileText("page.js"))}};
  std::string page(FileText("page.html"));
  for (const auto& [mark, text] : parts) page.replace(page.find(mark), mark.size(), text);
  return page;
}

std::vector<uint64_t> RunDigests(const ScenarioRequest& request, uint32_t frames) {
  Scenario scenario = LoadScenario(request);
  RunningScenario running(scenario, SceneOptions{});
  SerialExecutor executor;
  Digest run;
  std::vector<uint64_t> digests;
  for (uint32_t f = 0; f < frames; ++f) {
    running.Begin(f);
    executor.Run(running.scene().CurrentFrame());
    run.Add64(running.scene().DigestFrame());
    digests.push_back(run.Value());
  }
  return digests;
}

}  // namespace pelt
