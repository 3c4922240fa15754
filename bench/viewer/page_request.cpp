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

struct TextRow {
  std::string_view key;
  std::string ScenarioRequest::*member;
};
constexpr TextRow kTexts[] = {
    {"scene", &ScenarioRequest::scene}, {"character", &ScenarioRequest::character},
    {"setup", &ScenarioRequest::setup}, {"groom", &ScenarioRequest::groom},
    {"clip", &ScenarioRequest::clip},   {"lights", &ScenarioRequest::lights}};

// Calls visit(member, row) for those that are a layer's words.
void ForEachWord(ScenarioRequest& request, const auto& visit) {
  visit(request.solver, LayerParamRowOf(&LayerParams::solver));
  visit(request.quality, LayerParamRowOf(&LayerParams::quality));
}

}  // namespace

std::vector<std::pair<std::string_view, std::string>> RequestOptions(
    const ScenarioRequest& request) {
  std::vector<std::pair<std::string_view, std::string>> options;
  for (const TextRow& row : kTexts) {
    const bool of_scene = row.key == "character" && !request.scene.empty();
    if (!(request.*row.member).empty() && !of_scene)
      options.emplace_back(row.key, request.*row.member);
  }
  if (request.seed) options.emplace_back("seed", std::to_string(request.seed));
  if (request.once) options.emplace_back("once", "");
  ScenarioRequest copy = request;
  ForEachWord(copy, [&](const auto& value, const auto& row) {
    if (value) options.emplace_back(row.key, row.words[size_t(*value)]);
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
    for (const TextRow& row : kTexts)
      if (row.key == key) {
        request.*row.member = value;
        known = true;
      }
    ForEachWord(request, [&](auto& chosen, const auto& row) {
      const auto word = std::find(row.words.begin(), row.words.end(), value);
      if (row.key != key || word == row.words.end()) return;
      using Word = typename std::remove_reference_t<decltype(chosen)>::value_type;
      chosen = Word(word - row.words.begin());
      known = true;
    });
    if (!known) throw Error(Format("request: '{}' of '{}' is not known", value, key));
  }
  return request;
}

}  // namespace pelt
