// How a value of each kind is read from TOML, and how a mistake is reported.
//
// Invariant: no value leaves this file unchecked: every number is finite and within its entry's
// bounds, every word is known, every list has a bounded length. The frame relies on it.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/character/gltf_import.hpp"
#include "core/error.hpp"
#include "core/file_bytes.hpp"
#include "core/float_rules.hpp"
#include "core/format.hpp"
#include "core/groom/nearest_word.hpp"
#include "core/groom/setup_schema.hpp"

namespace pelt {
namespace {

constexpr size_t kNameBytesLimit = 256;

std::string_view NameType(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "a list";
    case toml::node_type::string:
      return "a text";
    case toml::node_type::integer:
      return "a whole number";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "true or false";
    default:
      return "a date or time";
  }
}

}  // namespace

// ---- Messages -----------------------------------------------------------------------------------

void SetupReader::Fail(uint32_t line, std::string_view reason) const {
  throw Error(Printable(Format("{}:{}: {}{}", path_, line, owner_, reason)));
}

void SetupReader::FailKey(uint32_t line, std::string_view key, std::string_view reason) const {
  Fail(line, Format("key '{}{}': {}", prefix_, key, reason));
}

void SetupReader::FailType(const KeyInfo& info, const toml::node& node, std::string_view expected) {
  FailKey(LineOf(node), info.key, Format("expected {}, found {}", expected, NameType(node)));
}

// Nodes that TOML makes implicitly (a dotted key's tables) have no line of their own.
uint32_t SetupReader::LineOf(const toml::node& node) const {
  return std::max<uint32_t>(node.source().begin.line, 1);
}

std::vector<SetupReader::FoundKey> SetupReader::FindKeys(const toml::table& table,
                                                         std::span<const std::string_view> names) {
  struct Found {
    toml::source_position place;
    std::string_view key;
    const toml::node* node;
  };
  std::vector<Found> found;
  for (auto&& [key, node] : table) found.push_back({key.source().begin, key.str(), &node});
  std::sort(found.begin(), found.end(), [](const Found& a, const Found& b) {
    return a.place < b.place || (a.place == b.place && a.key < b.key);
  });
  std::vector<FoundKey> keys;
  for (const Found& f : found) {
    const auto name = std::find(names.begin(), names.end(), f.key);
    if (name == names.end()) {
      const std::string_view nearest = FindNearestWord(f.key, names);
      Fail(std::max<uint32_t>(f.place.line, 1),
           Format("unknown key '{}{}'; {}", prefix_, f.key,
                  nearest.empty() ? std::string("pelt bake --keys lists the known ones")
                                  : Format("did you mean '{}{}'?", prefix_, nearest)));
    }
    keys.push_back({size_t(name - names.begin()), f.node});
  }
  return keys;
}

// ---- Values -------------------------------------------------------------------------------------

const toml::table& SetupReader::ExpectTable(const KeyInfo& info, const toml::node& node) {
  if (!node.is_table()) FailType(info, node, "a table { ... }");
  return *node.as_table();
}

const toml::array& SetupReader::ExpectArray(const KeyInfo& info, const toml::node& node, double low,
                                            double high) {
  if (!node.is_array()) FailType(info, node, "a list [ ... ]");
  const toml::array& array = *node.as_array();
  if (double(array.size()) < low || double(array.size()) > high) {
    FailKey(LineOf(node), info.key,
            low == high ? Format("has {} entries; {} are needed", array.size(), low)
                        : Format("has {} entries; {} to {} are allowed", array.size(), low, high));
  }
  return array;
}

std::string_view SetupReader::ExpectString(const KeyInfo& info, const toml::node& node) {
  if (!node.is_string()) FailType(info, node, "a text in quotes");
  return node.as_string()->get();
}

double SetupReader::ReadNumber(const KeyInfo& info, const toml::node& node) {
  if (!node.is_number()) FailType(info, node, "a number");
  const double value =
      node.is_integer() ? double(node.as_integer()->get()) : node.as_floating_point()->get();
  if (!std::isfinite(value)) FailKey(LineOf(node), info.key, "is not a finite number");
  if (value < info.low || value > info.high) {
    FailKey(LineOf(node), info.key,
            Format("{} is out of bounds; allowed are {} to {}{}{}", value, info.low, info.high,
                   info.unit.empty() ? "" : " ", info.unit));
  }
  return value;
}

int64_t SetupReader::ReadWhole(const KeyInfo& info, const toml::node& node, int64_t low,
                               int64_t high) {
  if (!node.is_integer()) FailType(info, node, "a whole number");
  const int64_t value = node.as_integer()->get();
  if (value < low || value > high) {
    FailKey(LineOf(node), info.key,
            Format("{} is out of bounds; allowed are {} to {}", value, low, high));
  }
  return value;
}

size_t SetupReader::ReadWord(const KeyInfo& info, const toml::node& node) {
  const std::string_view text = ExpectString(info, node);
  const auto word = std::find(info.words.begin(), info.words.end(), text);
  if (word == info.words.end()) {
    FailKey(LineOf(node), info.key,
            Format("'{}' is not one of {}{}", text.substr(0, 64), fmt::join(info.words, ", "),
                   DidYouMean(text, info.words)));
  }
  return size_t(word - info.words.begin());
}

uint32_t SetupReader::ReadHexColour(const KeyInfo& info, const toml::node& node) {
  const std::string_view text = ExpectString(info, node);
  uint32_t value = 0;
  bool good = text.size() == 7 && text[0] == '#';
  for (size_t i = 1; good && i < text.size(); ++i) {
    const char c = text[i];
    const bool digit = c >= '0' && c <= '9', lower = c >= 'a' && c <= 'f',
               upper = c >= 'A' && c <= 'F';
    good = digit || lower || upper;
    value = value * 16 + uint32_t(digit ? c - '0' : lower ? c - 'a' + 10 : c - 'A' + 10);
  }
  if (!good) {
    FailKey(LineOf(node), info.key,
            Format("'{}' is not a colour; write \"#rrggbb\"", text.substr(0, 64)));
  }
  return value;
}

void SetupReader::Read(const KeyInfo& info, const toml::node& node, float& value) {
  value = float(ReadNumber(info, node));
}
void SetupReader::Read(const KeyInfo& info, const toml::node& node, uint32_t& value) {
  value = uint32_t(ReadWhole(info, node, int64_t(info.low), int64_t(info.high)));
}
void SetupReader::Read(const KeyInfo& info, const toml::node& node, uint64_t& value) {
  value = uint64_t(ReadWhole(info, node, 0, INT64_MAX));
}
void SetupReader::Read(const KeyInfo& info, const toml::node& node, bool& value) {
  if (!node.is_boolean()) FailType(info, node, "true or false");
  value = node.as_boolean()->get();
}
void SetupReader::Read(const KeyInfo& info, const toml::node& node, std::string& value) {
  const std::string_view text = ExpectString(info, node);
  if (text.empty()) FailKey(LineOf(node), info.key, "is empty");
  if (text.size() > kNameBytesLimit) {
    FailKey(LineOf(node), info.key, Format("is longer than {} bytes", kNameBytesLimit));
  }
  if (!IsPrintable(text)) {
    FailKey(LineOf(node), info.key, "holds a control character");
  }
  value = text;
}
void SetupReader::Read(const KeyInfo& info, const toml::node& node,
                       std::vector<std::string>& values) {
  for (const toml::node& element : ExpectArray(info, node, info.low, info.high)) {
    Read(info, element, values.emplace_back());
  }
}
void SetupReader::Read(const KeyInfo& info, const toml::node& node, std::vector<uint32_t>& values) {
  for (const toml::node& element : ExpectArray(info, node, info.low, info.high)) {
    ReadColour(info, element, values.emplace_back());
  }
}
void SetupReader::Read(const KeyInfo& info, const toml::node& node, std::vector<float>& values) {
  for (const toml::node& element : ExpectArray(info, node, 1, kTraitLinks))
    values.push_back(float(ReadNumber(info, element)));
}
void SetupReader::Read(const KeyInfo& info, const toml::node& node, glm::vec2& value) {
  const toml::array& array = ExpectArray(info, node, 2, 2);
  value = {float(ReadNumber(info, array[0])), float(ReadNumber(info, array[1]))};
  if (value.x > value.y) FailKey(LineOf(node), info.key, "its low end is above its high end");
}
void SetupReader::Read(const KeyInfo& info, const toml::node& node, glm::vec3& value) {
  const toml::array& array = ExpectArray(info, node, 3, 3);
  for (int i = 0; i < 3; ++i) value[i] = float(ReadNumber(info, array[size_t(i)]));
}
void SetupReader::Read(const KeyInfo& info, const toml::node& node, std::array<float, 3>& value) {
  const toml::array& array = ExpectArray(info, node, 3, 3);
  for (size_t i = 0; i < 3; ++i) value[i] = float(ReadNumber(info, array[i]));
}
void SetupReader::Read(const KeyInfo& info, const toml::node& node, char& value) {
  value = info.words[ReadWord(info, node)][0];
}
void SetupReader::Read(const KeyInfo& info, const toml::node& node, int& value) {
  value = int(ReadWord(info, node));
}

void SetupReader::Read(const KeyInfo& info, const toml::node& node, Attribute& value) {
  if (node.is_number()) return Read(info, node, value.value);
  if (!node.is_table()) FailType(info, node, "a number or a table { value = ... }");
  const toml::table& table = *node.as_table();
  ReadTable(info, table, value);
  for (const char* of_map : {"channel", "low", "high"})
    if (table.contains(of_map) && !table.contains("map"))
      FailKey(LineOf(*table.get(of_map)), std::string(info.key) + "." + of_map, "has no map");
}

void SetupReader::Read(const KeyInfo& info, const toml::node& node, MapChannel& value) {
  if (node.is_string()) return Read(info, node, value.map);
  if (!node.is_table()) FailType(info, node, "a path or a table { map = ... }");
  ReadTable(info, *node.as_table(), value);
}

void SetupReader::Read(const KeyInfo& info, const toml::node& node,
                       std::shared_ptr<const ControlMap>& value) {
  std::string name;
  Read(info, node, name);
  const std::string path = InFolder(map_directory_, name);
  auto& kept = maps_[path];
  if (!kept) {
    try {
      kept = std::make_shared<const ControlMap>(ReadControlMapFile(path));
    } catch (const Error& error) {
      FailKey(LineOf(node), info.key, error.what());
    }
  }
  value = kept;
}

void SetupReader::Read(const KeyInfo& info, const toml::node& node,
                       std::shared_ptr<const Character>& value) {
  std::string name;
  Read(info, node, name);
  const std::string path = InFolder(map_directory_, name);
  try {
    value = std::make_shared<const Character>(ImportGltfFile(path));
  } catch (const Error& error) {
    FailKey(LineOf(node), info.key, error.what());
  }
  mesh_files_ = value->files_read;
  mesh_files_.push_back(path);
}

void SetupReader::ReadColour(const KeyInfo& info, const toml::node& node, uint32_t& value) {
  const uint32_t rgb = ReadHexColour(info, node);
  value = 0xff000000u | (rgb & 255) << 16 | (rgb & 0xff00) | rgb >> 16;
}
void SetupReader::ReadColour(const KeyInfo& info, const toml::node& node,
                             std::array<float, 3>& value) {
  const uint32_t rgb = ReadHexColour(info, node);
  value = {float(rgb >> 16) / 255.0f, float(rgb >> 8 & 255) / 255.0f, float(rgb & 255) / 255.0f};
}

void SetupReader::ReadDensity(const KeyInfo& info, const toml::node& node, LayerSetup& layer) {
  Attribute density{LayerSetup{}.density};
  Read(info, node, density);
  layer.density = density.value;
  layer.density_map = density.map;
  layer.density_randomise = density.randomise;
  layer.density_range = density.range;
}

// ---- What holds between keys --------------------------------------------------------------------

void SetupReader::Check(const KeyInfo& info, const toml::node& node,
                        const Mask::JointWeight& value) {
  if (!(value.low < value.high)) FailKey(LineOf(node), info.key, "low must be below high");
}
void SetupReader::Check(const KeyInfo& info, const toml::node& node, const Mask::Range& value) {
  for (int i = 0; i < 3; ++i) {
    if (!(value.low[i] < value.high[i])) {
      FailKey(LineOf(node), info.key, Format("low {} must be below high {}", "xyz"[i], "xyz"[i]));
    }
  }
}
void SetupReader::CheckDirection(const KeyInfo& info, const toml::node& node, std::string_view key,
                                 const glm::vec3& direction) {
  const glm::vec3 d = glm::abs(direction);
  if (std::max({d.x, d.y, d.z}) < 1e-6f) FailKey(LineOf(node), info.key, Format("{} is zero", key));
}
void SetupReader::Check(const KeyInfo& info, const toml::node& node, const FlowMapSetup& value) {
  if ((value.blue == FlowBlue::kLength) != (value.longest > 0.0f))
    FailKey(LineOf(node), info.key, "blue = \"length\" and longest go together");
}
void SetupReader::Check(const KeyInfo& info, const toml::node& node, const CombVector& value) {
  CheckDirection(info, node, "direction", value.direction);
}
void SetupReader::Check(const KeyInfo& info, const toml::node& node,
                        const LightsSetup::Sample& value) {
  CheckDirection(info, node, "up", value.up);
}
void SetupReader::Check(const KeyInfo& info, const toml::node& node,
                        const LightsSetup::Sun& value) {
  CheckDirection(info, node, "direction", value.direction);
}
void SetupReader::Check(const KeyInfo& info, const toml::node& node,
                        const LightsSetup::Rim& value) {
  CheckDirection(info, node, "direction", value.direction);
}

}  // namespace pelt
