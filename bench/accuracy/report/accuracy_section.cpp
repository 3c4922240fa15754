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
    const bool has_format = file.is_object() && file.contains("format");
    const bool is_scene = has_format && file["format"] == kSceneAccuracyFormat;
    if (!is_scene && !(has_format && file["format"] == kAccuracyFormat))
      Fail(fmt::format("is not of the format '{}' or '{}'", kAccuracyFormat, kSceneAccuracyFormat));
    json_.BeginObject();
    for (const char* key : {"processor", "compiler", "build_type", "commit", "isa", "error_digest"})
      Text(file, key);
    Number(file, "rounds");
    Flag(file, "quick");
    if (is_scene)
      Scene(file);
    else
      Solvers(file);
    json_.EndObject();
  }

  [[noreturn]] void Fail(std::string_view reason) const {
    throw Error(
        fmt::format("{}: {}; expected what pelt accuracy, or pelt accuracy --scene, writes "
                    "with --json",
                    path_, reason));
  }

 private:
  const Json& Member(const Json& object, const char* key) const {
    if (!object.is_object() || !object.contains(key)) Fail(fmt::format("'{}' is missing", key));
    return object[key];
  }
  const Json& List(const Json& object, const char* key, size_t least = 1) const {
    const Json& list = Member(object, key);
    if (!list.is_array() || list.size() < least || list.size() > kMostEntries)
      Fail(fmt::format("'{}' is not a list of {} to {}", key, least, kMostEntries));
    return list;
  }
  void Text(const Json& object, const char* key) {
    const Json& text = Member(object, key);
    if (!text.is_string()) Fail(fmt::format("'{}' is not a text", key));
    json_.Add(key, text.get<std::string>());
  }
  void Texts(const Json& object, const char* key) {
    json_.BeginArray(key);
    for (const Json& text : List(object, key, 0)) {
      if (!text.is_string()) Fail(fmt::format("'{}' is not a list of texts", key));
      json_.Add("", text.get<std::string>());
    }
    json_.EndArray();
  }
  void Flag(const Json& object, const char* key) {
    const Json& flag = Member(object, key);
    if (!flag.is_boolean()) Fail(fmt::format("'{}' is neither true nor false", key));
    json_.Add(key, flag.get<bool>());
  }
  // null: not finite.
  double Value(const Json& value, const char* key) const {
    if (value.is_null()) return std::nan("");
    if (!value.is_number()) Fail(fmt::format("'{}' is not a number", key));
    return value.get<double>();
  }
  void NumberOrNull(const Json& object, const char* key) {
    json_.Add(key, Value(Member(object, key), key));
  }
  void Number(const Json& object, const char* key) {
    if (Member(object, key).is_null()) Fail(fmt::format("'{}' is not a number", key));
    NumberOrNull(object, key);
  }
  void Numbers(const Json& object, const char* key, size_t count) {
    const Json& list = List(object, key);
    if (list.size() != count) Fail(fmt::format("'{}' is not a list of {}", key, count));
    json_.BeginArray(key);
    for (const Json& value : list) json_.Add("", Value(value, key));
    json_.EndArray();
  }
  // An object of each entry, with what `row` writes of it.
  void Rows(const char* key, const Json& list, const auto& row) {
    json_.BeginArray(key);
    for (const Json& entry : list) {
      json_.BeginObject();
      row(entry);
      json_.EndObject();
    }
    json_.EndArray();
  }

  void Scene(const Json& file) {
    Text(file, "scene");
    for (const char* key : {"strands", "layers", "frames", "warm_up_frames", "still_frames",
                            "frames_per_second", "reference_self_error"})
      Number(file, key);
    Flag(file, "contact");
    Texts(file, "notes");
    Rows("rows", List(file, "rows"), [&](const Json& row) {
      for (const char* key : {"family", "label"}) Text(row, key);
      for (const char* key :
           {"frame_ns", "frame_of_pbd", "simulate_ns", "simulate_of_pbd", "live_share"})
        Number(row, key);
      for (const char* key : {"error", "off_m", "rod_error"}) NumberOrNull(row, key);
      for (const char* key :
           {"reference_material", "frame_pareto_optimal", "simulate_pareto_optimal"})
        Flag(row, key);
    });
  }

  void Rod(const Json& file) {
    Rows("model_error", List(file, "model_error"), [&](const Json& panel) {
      Text(panel, "motion");
      Number(panel, "cases");
      Rows("rows", List(panel, "rows"), [&](const Json& row) {
        for (const char* key : {"model", "moved", "family"}) Text(row, key);
        Flag(row, "pareto_optimal");
        Number(row, "ns");
        for (const char* key : {"pooled", "pooled_well_posed"}) NumberOrNull(row, key);
        Rows("presets", List(row, "presets"), [&](const Json& preset) {
          Text(preset, "preset");
          for (const char* key : {"median", "ninth_tenth"}) NumberOrNull(preset, key);
        });
      });
    });
  }

  void Shipped(const Json& file) {
    Rows("shipped", List(file, "shipped", 0), [&](const Json& panel) {
      for (const char* key : {"links", "motions", "strands"}) Number(panel, key);
      Rows("rows", List(panel, "rows"), [&](const Json& row) {
        for (const char* key : {"solver", "preset"}) Text(row, key);
        Flag(row, "velocities");
        Rows("scores", List(row, "scores"), [&](const Json& score) {
          for (const char* key : {"rate", "cases"}) Number(score, key);
          for (const char* key : {"rms", "median", "worst_case"}) NumberOrNull(score, key);
          Flag(score, "finite");
        });
      });
    });
  }

  void Solvers(const Json& file) {
    Number(file, "timed_strands");
    Text(file, "problems");
    Number(file, "seed");
    Rod(file);
    Shipped(file);
    Flag(file, "calibrated");
    const size_t rates = List(file, "rates").size();
    Numbers(file, "rates", rates);
    Rows("panels", List(file, "panels"), [&](const Json& panel) {
      Number(panel, "links");
      Text(panel, "preset");
      Numbers(panel, "input_errors", rates);
      Rows("rows", List(panel, "rows"), [&](const Json& row) {
        for (const char* key : {"family", "label"}) Text(row, key);
        for (const char* key : {"ns", "of_pbd"}) Number(row, key);
        const Json& scores = List(row, "scores");
        if (scores.size() != rates) Fail("'scores' has not one entry for each rate");
        Rows("scores", scores, [&](const Json& score) {
          for (const char* key : {"error", "stretch"}) NumberOrNull(score, key);
          for (const char* key : {"finite", "pareto_optimal"}) Flag(score, key);
        });
      });
    });
  }

  JsonText& json_;
  const std::string& path_;
};

}  // namespace

void AddAccuracySection(JsonText& json, std::string_view text, const std::string& path) {
  const Json file = Json::parse(text, nullptr, false);
  if (file.is_discarded()) SectionWriter(json, path).Fail("not JSON");
  SectionWriter(json, path).Write(file);
}

}  // namespace pelt
