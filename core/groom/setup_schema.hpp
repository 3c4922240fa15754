// The schema of the fur setup: one entry for each key, and everything else follows from the entry:
// reading, the message for a mistyped key, bounds, defaults, `pelt bake --keys`, and the check of
// layer parameters in a groom file.
//
// Invariant: a key exists if and only if it has an entry. An entry names its field by members, so the
// type of the field chooses how the value is read; a field that is read by hand elsewhere would be
// missing from all the others.
#pragma once

#include <array>
#include <cstdint>
#include <exception>
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/groom/fur_setup.hpp"

// toml++ 3.3 asserts what it has not checked ("[=" is enough), which stops a debug build and lets a
// release build run on into undefined behaviour. Its assertions are turned into an exception in
// both; the library's compiled form, which packages prefer, would keep its own.
namespace pelt {
struct TomlAssertion : std::exception {};
inline void ThrowTomlAssertion() { throw TomlAssertion(); }
}  // namespace pelt
#pragma push_macro("NDEBUG")
#undef NDEBUG
#undef TOML_HEADER_ONLY
#undef TOML_SHARED_LIB
#define TOML_HEADER_ONLY 1
#define TOML_ASSERT(condition) ((condition) ? void() : ::pelt::ThrowTomlAssertion())
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")

namespace pelt {

struct KeyInfo {
  std::string_view key;
  std::string_view type;  // for people: "number", "attribute", "table", ...
  std::string_view unit;
  double low = 0.0, high = 0.0;  // inclusive bounds of a number, or of a list's length
  std::string_view doc;
  std::span<const std::string_view> words = {};  // an enumeration's words, in value order
  bool required = false;
  bool outer_bounds = false;  // bounds and unit are those of the key that holds the table
};

class SetupReader;

template <class T>
struct KeyEntry {
  KeyInfo info;
  void (*read)(SetupReader&, const KeyInfo&, const toml::node&, T&);
  std::string (*show)(const KeyInfo&, const T&);  // the value, for the key list
  const MapChannel* (*map)(const T&) = nullptr;   // the value's map over the surface, if it has one
};

// The entries of each thing that is written as a TOML table.
template <class T>
std::span<const KeyEntry<T>> Schema();
template <>
std::span<const KeyEntry<FurSetup>> Schema();
template <>
std::span<const KeyEntry<LayerSetup>> Schema();
template <>
std::span<const KeyEntry<Attribute>> Schema();
template <>
std::span<const KeyEntry<MapChannel>> Schema();
template <>
std::span<const KeyEntry<Mask>> Schema();
template <>
std::span<const KeyEntry<Mask::JointWeight>> Schema();
template <>
std::span<const KeyEntry<Mask::Box>> Schema();
template <>
std::span<const KeyEntry<Mask::Range>> Schema();
template <>
std::span<const KeyEntry<Mask::AwayFrom>> Schema();
template <>
std::span<const KeyEntry<FlowMapSetup>> Schema();
template <>
std::span<const KeyEntry<CombVector>> Schema();
template <>
std::span<const KeyEntry<LayerLook>> Schema();
template <>
std::span<const KeyEntry<LightsSetup>> Schema();
template <>
std::span<const KeyEntry<LightsSetup::Light>> Schema();
template <>
std::span<const KeyEntry<LightsSetup::Sample>> Schema();
template <>
std::span<const KeyEntry<LightsSetup::Sun>> Schema();
template <>
std::span<const KeyEntry<LightsSetup::Rim>> Schema();

template <class T, class... Tables>
concept OneOf = (std::is_same_v<T, Tables> || ...);
template <class T>
concept SetupTable = OneOf<T, Mask, Mask::JointWeight, Mask::Box, Mask::Range, Mask::AwayFrom,
                           FlowMapSetup, CombVector, LayerLook, LightsSetup, LightsSetup::Light,
                           LightsSetup::Sample, LightsSetup::Sun, LightsSetup::Rim>;

// toml::parse that throws nothing but Error, with file and line.
toml::table ParseToml(std::string_view text, const std::string& path);

// Reads values and knows where it is, for messages.
class SetupReader {
 public:
  SetupReader(std::string path, std::string map_directory)
      : path_(std::move(path)), map_directory_(std::move(map_directory)) {}
  // Of the maps that were read, and of the chain_mesh.
  std::vector<std::string> FilesRead() const {
    std::vector<std::string> paths = mesh_files_;
    for (const auto& [path, map] : maps_) paths.push_back(path);
    return paths;
  }

  // Whose keys these are: "layer 'head': ", or empty.
  void SetOwner(std::string owner) { owner_ = std::move(owner); }

  [[noreturn]] void Fail(uint32_t line, std::string_view reason) const;
  [[noreturn]] void FailKey(uint32_t line, std::string_view key, std::string_view reason) const;

  void Read(const KeyInfo&, const toml::node&, float&);
  void Read(const KeyInfo&, const toml::node&, uint32_t&);
  void Read(const KeyInfo&, const toml::node&, uint64_t&);
  void Read(const KeyInfo&, const toml::node&, bool&);
  void Read(const KeyInfo&, const toml::node&, std::string&);
  void Read(const KeyInfo&, const toml::node&, std::vector<std::string>&);
  void Read(const KeyInfo&, const toml::node&, std::vector<uint32_t>&);  // colours
  void Read(const KeyInfo&, const toml::node&, std::vector<float>&);     // of each link
  void Read(const KeyInfo&, const toml::node&, glm::vec2&);              // low, high
  void Read(const KeyInfo&, const toml::node&, glm::vec3&);
  void Read(const KeyInfo&, const toml::node&, std::array<float, 3>&);
  void Read(const KeyInfo&, const toml::node&, char&);  // a word of one letter
  void Read(const KeyInfo&, const toml::node&, int&);   // a word's place
  void Read(const KeyInfo&, const toml::node&, Attribute&);
  void Read(const KeyInfo&, const toml::node&, MapChannel&);
  void Read(const KeyInfo&, const toml::node&, std::shared_ptr<const ControlMap>&);
  void Read(const KeyInfo&, const toml::node&, std::shared_ptr<const Character>&);
  void ReadColour(const KeyInfo&, const toml::node&, uint32_t&);  // "#rrggbb" to 0xffBBGGRR
  void ReadColour(const KeyInfo&, const toml::node&,
                  std::array<float, 3>&);  // "#rrggbb" to bytes / 255
  void ReadDensity(const KeyInfo&, const toml::node&, LayerSetup&);

  template <class Enum>
  requires std::is_enum_v<Enum>
  void Read(const KeyInfo& info, const toml::node& node, Enum& value) {
    value = Enum(ReadWord(info, node));
  }
  template <class T>
  void Read(const KeyInfo& info, const toml::node& node, std::optional<T>& value) {
    T fresh{};
    Read(info, node, fresh);
    value = fresh;
  }
  template <SetupTable T>
  void Read(const KeyInfo& info, const toml::node& node, T& value) {
    ReadTable(info, ExpectTable(info, node), value);
    Check(info, node, value);
  }
  template <SetupTable T>
  void Read(const KeyInfo& info, const toml::node& node, std::vector<T>& values) {
    const toml::array& array = ExpectArray(info, node, info.low, info.high);
    for (size_t i = 0; i < array.size(); ++i) {
      const std::string name = std::string(info.key) + "[" + std::to_string(i) + "]";
      KeyInfo element = info;
      element.key = name;
      Read(element, array[i], values.emplace_back());
    }
  }

  // Reads every key of the table by its entry, in file order. `outer` is the key that holds it. A
  // partial table may lack keys that are needed.
  template <class T>
  void ReadTable(const KeyInfo& outer, const toml::table& table, T& value, bool partial = false) {
    const std::string kept = prefix_;
    if (!outer.key.empty()) prefix_ += std::string(outer.key) + ".";
    const auto entries = Schema<T>();
    std::vector<std::string_view> names;
    for (const auto& entry : entries) names.push_back(entry.info.key);
    for (const FoundKey& found : FindKeys(table, names)) {
      const KeyEntry<T>& entry = entries[found.entry];
      if (!entry.read) continue;
      KeyInfo info = entry.info;
      if (info.outer_bounds) {
        info.low = outer.low;
        info.high = outer.high;
        info.unit = outer.unit;
      }
      entry.read(*this, info, *found.node, value);
    }
    for (const auto& entry : entries) {
      if (!partial && entry.info.required && !table.contains(entry.info.key)) {
        FailKey(LineOf(table), entry.info.key, "is needed here and missing");
      }
    }
    prefix_ = kept;
  }

  uint32_t LineOf(const toml::node& node) const;

 private:
  struct FoundKey {
    size_t entry;  // of the schema
    const toml::node* node;
  };
  // The table's keys in file order; fails on the first that is not among `names`.
  std::vector<FoundKey> FindKeys(const toml::table&, std::span<const std::string_view> names);
  const toml::table& ExpectTable(const KeyInfo&, const toml::node&);
  const toml::array& ExpectArray(const KeyInfo&, const toml::node&, double low, double high);
  std::string_view ExpectString(const KeyInfo&, const toml::node&);
  [[noreturn]] void FailType(const KeyInfo&, const toml::node&, std::string_view expected);
  double ReadNumber(const KeyInfo&, const toml::node&);
  int64_t ReadWhole(const KeyInfo&, const toml::node&, int64_t low, int64_t high);
  size_t ReadWord(const KeyInfo&, const toml::node&);
  uint32_t ReadHexColour(const KeyInfo&, const toml::node&);
  // What holds between the keys of one table.
  void Check(const KeyInfo&, const toml::node&, const Mask&) {}
  void Check(const KeyInfo&, const toml::node&, const Mask::Box&) {}
  void Check(const KeyInfo&, const toml::node&, const Mask::AwayFrom&) {}
  void Check(const KeyInfo&, const toml::node&, const Mask::JointWeight&);
  void Check(const KeyInfo&, const toml::node&, const Mask::Range&);
  void Check(const KeyInfo&, const toml::node&, const FlowMapSetup&);
  void Check(const KeyInfo&, const toml::node&, const CombVector&);
  void Check(const KeyInfo&, const toml::node&, const LayerLook&) {}
  void Check(const KeyInfo&, const toml::node&, const LightsSetup&) {}
  void Check(const KeyInfo&, const toml::node&, const LightsSetup::Light&) {}
  void Check(const KeyInfo&, const toml::node&, const LightsSetup::Sample&);
  void Check(const KeyInfo&, const toml::node&, const LightsSetup::Sun&);
  void Check(const KeyInfo&, const toml::node&, const LightsSetup::Rim&);
  void CheckDirection(const KeyInfo&, const toml::node&, std::string_view key, const glm::vec3&);

  std::string path_, map_directory_, owner_, prefix_;
  std::map<std::string, std::shared_ptr<const ControlMap>> maps_;
  std::vector<std::string> mesh_files_;
};

}  // namespace pelt
