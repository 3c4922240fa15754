#include "bench/viewer/page_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "bench/viewer/page_request.hpp"
#include "core/error.hpp"

namespace pelt {

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

std::vector<std::string> DigestTexts(std::span<const uint64_t> digests) {
  std::vector<std::string> texts;
  for (const uint64_t digest : digests) texts.push_back(fmt::format("{:016x}", digest));
  return texts;
}

namespace {

using Json = nlohmann::ordered_json;

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
  Json files = Json::object();
  for (const auto& [path, bytes] : content.files) files[path] = Base64(bytes);
  Json json = {
      {"request", WriteRequest(content.request)},
      {"files", files},
      {"native", {{"command", content.command}, {"digests", DigestTexts(content.digests)}}}};
  if (content.watched_from) json["watched_from"] = *content.watched_from;
  if (!content.consoles.empty()) json["consoles"] = Json::parse(content.consoles);
  if (!content.recording.empty()) json["recording"] = content.recording;
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
      {"@plain@", Base64(EmbeddedPlainModule())},
      {"@given@", GivenText(content)},
      {"@worker@", std::string(FileText("webgl.js")) + std::string(FileText("worker.js")) +
                       std::string(FileText("worker_groom.js"))},
      {"@script@",
       std::string(FileText("page.js")) + std::string(FileText("page_controls.js")) +
           std::string(FileText("page_watch.js")) + std::string(FileText("page_zip.js")) +
           std::string(FileText("page_groom.js")) + std::string(FileText("page_consoles.js"))}};
  std::string page(FileText("page.html"));
  for (const auto& [mark, text] : parts) page.replace(page.find(mark), mark.size(), text);
  return page;
}

DigestRun::DigestRun(Scenario scenario)
    : scenario_(std::move(scenario)), running_(scenario_, SceneOptions{}) {}

void DigestRun::Step() {
  SerialExecutor executor;
  running_.Begin(uint32_t(digests_.size()));
  executor.Run(running_.scene().CurrentFrame());
  run_.Add64(running_.scene().DigestFrame());
  digests_.push_back(run_.Value());
}

std::vector<uint64_t> RunDigests(const ScenarioRequest& request, uint32_t frames) {
  DigestRun run(LoadScenario(request));
  for (uint32_t f = 0; f < frames; ++f) run.Step();
  return run.digests();
}

}  // namespace pelt
