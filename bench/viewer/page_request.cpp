#include "bench/viewer/page_request.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/format.hpp"
#include "core/groom/setup_schema.hpp"

namespace pelt {
namespace {

struct TextEntry {
  std::string_view key;
  std::string ScenarioRequest::*member;
};
constexpr TextEntry kTexts[] = {
    {"scene", &ScenarioRequest::scene}, {"character", &ScenarioRequest::character},
    {"setup", &ScenarioRequest::setup}, {"groom", &ScenarioRequest::groom},
    {"clip", &ScenarioRequest::clip},   {"lights", &ScenarioRequest::lights}};

// Calls visit(member, entry) for those that are a layer's words.
void ForEachWord(ScenarioRequest& request, const auto& visit) {
  visit(request.solver, LayerParamEntryOf(&LayerParams::solver));
  visit(request.quality, LayerParamEntryOf(&LayerParams::quality));
}

}  // namespace

std::vector<std::pair<std::string_view, std::string>> RequestOptions(
    const ScenarioRequest& request) {
  std::vector<std::pair<std::string_view, std::string>> options;
  for (const TextEntry& entry : kTexts) {
    const bool of_scene = entry.key == "character" && !request.scene.empty();
    if (!(request.*entry.member).empty() && !of_scene)
      options.emplace_back(entry.key, request.*entry.member);
  }
  if (request.seed) options.emplace_back("seed", std::to_string(request.seed));
  if (request.once) options.emplace_back("once", "");
  ScenarioRequest copy = request;
  ForEachWord(copy, [&](const auto& value, const auto& entry) {
    if (value) options.emplace_back(entry.key, entry.words[size_t(*value)]);
  });
  return options;
}

std::string WriteRequest(const ScenarioRequest& request) {
  std::string text;
  for (const auto& [key, value] : RequestOptions(request))
    // JSON writes texts as TOML has them.
    text += Format("{} = {}\n", key, nlohmann::json(value).dump());
  return text;
}

ScenarioRequest ReadRequest(std::string_view text) {
  const toml::table table = ParseToml(text, "request");
  ScenarioRequest request;
  for (const auto& entry : table) {
    const std::string_view key = entry.first.str();
    const std::string value = entry.second.value_or(std::string());
    const toml::array* texts = key == "setup_texts" ? entry.second.as_array() : nullptr;
    bool known = texts || key == "seed" || key == "once";
    request.once |= key == "once";
    for (size_t i = 0; texts && i < texts->size(); ++i)
      request.setup_texts.push_back((*texts)[i].value_or(std::string()));
    if (key == "seed") std::from_chars(value.data(), value.data() + value.size(), request.seed);
    for (const TextEntry& entry : kTexts)
      if (entry.key == key) {
        request.*entry.member = value;
        known = true;
      }
    ForEachWord(request, [&](auto& chosen, const auto& entry) {
      const auto word = std::find(entry.words.begin(), entry.words.end(), value);
      if (entry.key != key || word == entry.words.end()) return;
      using Word = typename std::remove_reference_t<decltype(chosen)>::value_type;
      chosen = Word(word - entry.words.begin());
      known = true;
    });
    if (!known) throw Error(Format("request: '{}' of '{}' is not known", value, key));
  }
  return request;
}

}  // namespace pelt
