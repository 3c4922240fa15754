#include "bench/accuracy/report/accuracy_section.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "bench/accuracy/report/accuracy_report.hpp"
#include "core/error.hpp"

namespace pelt {
namespace {

using Json = nlohmann::json;

constexpr size_t kMostEntries = 256;  // of any list

class SectionWriter {
 public:
  SectionWriter(JsonText& json, const std::string& path) : json_(json), path_(path) {}

  void Write(const Json& file) {
    if (!file.is_object() || !file.contains("format") || file["format"] != kAccuracyFormat)
      Fail(fmt::format("is not of the format '{}'", kAccuracyFormat));
    json_.BeginObject();
    for (const char* key : {"processor", "compiler", "build_type", "commit", "isa", "error_digest"})
      Text(file, key);
    for (const char* key : {"rounds", "timed_strands"}) Number(file, key);
    for (const char* key : {"quick", "calibrated"}) json_.Add(key, Member(file, key) == true);
    const size_t rates = List(file, "rates").size();
    Numbers(file, "rates", rates);
    json_.BeginArray("panels");
    for (const Json& panel : List(file, "panels")) Panel(panel, rates);
    json_.EndArray();
    json_.EndObject();
  }

 private:
  [[noreturn]] void Fail(std::string_view reason) const {
    throw Error(fmt::format("{}: {}; expected what pelt accuracy --json writes", path_, reason));
  }

  const Json& Member(const Json& object, const char* key) const {
    if (!object.is_object() || !object.contains(key)) Fail(fmt::format("'{}' is missing", key));
    return object[key];
  }
  const Json& List(const Json& object, const char* key) const {
    const Json& list = Member(object, key);
    if (!list.is_array() || list.empty() || list.size() > kMostEntries)
      Fail(fmt::format("'{}' is not a list of 1 to {}", key, kMostEntries));
    return list;
  }
  void Text(const Json& object, const char* key) {
    const Json& text = Member(object, key);
    if (!text.is_string()) Fail(fmt::format("'{}' is not a text", key));
    json_.Add(key, text.get<std::string>());
  }
  // null: not finite.
  double Value(const Json& value, const char* key) const {
    if (value.is_null()) return std::nan("");
    if (!value.is_number()) Fail(fmt::format("'{}' is not a number", key));
    return value.get<double>();
  }
  void Number(const Json& object, const char* key) {
    json_.Add(key, Value(Member(object, key), key));
  }
  void Numbers(const Json& object, const char* key, size_t count) {
    const Json& list = List(object, key);
    if (list.size() != count) Fail(fmt::format("'{}' is not a list of {}", key, count));
    json_.BeginArray(key);
    for (const Json& value : list) json_.Add("", Value(value, key));
    json_.EndArray();
  }

  void Panel(const Json& panel, size_t rates) {
    json_.BeginObject();
    Number(panel, "links");
    Text(panel, "preset");
    Numbers(panel, "input_errors", rates);
    json_.BeginArray("rows");
    for (const Json& row : List(panel, "rows")) {
      json_.BeginObject();
      Text(row, "family");
      Text(row, "label");
      Number(row, "ns");
      Number(row, "of_pbd");
      const Json& scores = List(row, "scores");
      if (scores.size() != rates) Fail("'scores' has not one entry for each rate");
      json_.BeginArray("scores");
      for (const Json& score : scores) {
        json_.BeginObject();
        Number(score, "error");
        Number(score, "stretch");
        for (const char* key : {"finite", "pareto_optimal"})
          json_.Add(key, Member(score, key) == true);
        json_.EndObject();
      }
      json_.EndArray();
      json_.EndObject();
    }
    json_.EndArray();
    json_.EndObject();
  }

  JsonText& json_;
  const std::string& path_;
};

}  // namespace

void AddAccuracySection(JsonText& json, std::string_view text, const std::string& path) {
  const Json file = Json::parse(text, nullptr, false);
  if (file.is_discarded())
    throw Error(fmt::format("{}: not JSON; expected what pelt accuracy --json writes", path));
  SectionWriter(json, path).Write(file);
}

}  // namespace pelt
