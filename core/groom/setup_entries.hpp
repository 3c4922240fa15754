// What an entry of a schema is made by: its field found by members, read by its type and shown in the key list. For the
// files that have entries (setup_schema.cpp, light_setup.cpp, host_costs.cpp, layer_plan.cpp) and no other.
#pragma once

#include <fmt/format.h>

#include "core/float_rules.hpp"
#include "core/format.hpp"
#include "core/groom/setup_schema.hpp"

namespace pelt::setup_entries {

inline constexpr std::string_view kChannelWords[] = {"r", "g", "b", "a"};
inline constexpr double kReachLimit = 1000.0;  // m, for places

// Follows members: Field<&LayerSetup::params, &LayerParams::weight>(layer) is layer.params.weight.
template <auto kMember, auto... kRest, class T>
auto& Field(T& object) {
  if constexpr (sizeof...(kRest) == 0) {
    return object.*kMember;
  } else {
    return Field<kRest...>(object.*kMember);
  }
}

inline std::string Show(const KeyInfo&, float value) { return Format("{}", value); }
inline std::string Show(const KeyInfo&, uint32_t value) { return Format("{}", value); }
inline std::string Show(const KeyInfo&, uint64_t value) { return Format("{}", value); }
inline std::string Show(const KeyInfo&, int value) {
  return Format("\"{}\"", kChannelWords[value]);
}
inline std::string Show(const KeyInfo&, bool value) { return value ? "true" : "false"; }
inline std::string Show(const KeyInfo&, char value) { return Format("\"{}\"", value); }
inline std::string Show(const KeyInfo&, const std::string& value) {
  return Format("\"{}\"", value);
}
inline std::string Show(const KeyInfo&, const Attribute& value) {
  return Format("{}", value.value);
}
inline std::string Show(const KeyInfo&, const std::array<float, 3>& value) {
  return Format("[{}, {}, {}]", value[0], value[1], value[2]);
}
inline std::string Show(const KeyInfo&, const glm::vec3& value) {
  return Format("[{}, {}, {}]", value.x, value.y, value.z);
}
inline std::string ShowColour(uint32_t value) {
  return Format("\"#{:02x}{:02x}{:02x}\"", value & 255, value >> 8 & 255, value >> 16 & 255);
}
inline std::string ShowColour(const std::array<float, 3>& value) { return Show({}, value); }
template <class Enum>
requires std::is_enum_v<Enum> std::string Show(const KeyInfo& info, Enum value) {
  return Format("\"{}\"", info.words[size_t(value)]);
}
inline std::string Show(const KeyInfo&, const MapChannel&) { return "none"; }
inline std::string Show(const KeyInfo&, const std::shared_ptr<const ControlMap>&) { return "none"; }
inline std::string Show(const KeyInfo&, const std::shared_ptr<const Character>&) { return "none"; }
inline std::string Show(const KeyInfo&, const Mask&) { return "everywhere"; }
inline std::string Show(const KeyInfo&, const LayerLook&) { return "as below"; }
inline std::string Show(const KeyInfo&, const LightsSetup::Sun&) { return "dark"; }
inline std::string Show(const KeyInfo&, const LightsSetup::Rim&) { return "dark"; }
template <class T>
std::string Show(const KeyInfo&, const std::optional<T>&) {
  return "none";
}
template <class T>
std::string Show(const KeyInfo&, const std::vector<T>&) {
  return "none";
}

inline const MapChannel* SurfaceMap(const MapChannel& value) { return &value; }
inline const MapChannel* SurfaceMap(const Attribute& value) { return &value.map; }
inline const MapChannel* SurfaceMap(const std::optional<FlowMapSetup>& value) {
  return value ? &value->picture : nullptr;
}
template <class T>
const MapChannel* SurfaceMap(const T&) {
  return nullptr;
}

template <class M>
struct OwnerOf;
template <class C, class F>
struct OwnerOf<F C::*> {
  using Type = C;
};

// An entry whose field is read by its type. A key starts from its own built-in value, so that a table
// which gives part of it never mixes with [defaults].
template <auto kFirst, auto... kRest>
auto MakeEntry(const KeyInfo& info) {
  using Object = typename OwnerOf<decltype(kFirst)>::Type;
  return KeyEntry<Object>{
      info,
      [](SetupReader& reader, const KeyInfo& key, const toml::node& node, Object& object) {
        const Object builtin{};
        auto fresh = Field<kFirst, kRest...>(builtin);
        reader.Read(key, node, fresh);
        Field<kFirst, kRest...>(object) = std::move(fresh);
      },
      [](const KeyInfo& key, const Object& object) {
        return Show(key, Field<kFirst, kRest...>(object));
      },
      [](const Object& object) { return SurfaceMap(Field<kFirst, kRest...>(object)); }};
}

using Text = std::string_view;

template <auto... kMembers>
auto Number(Text key, Text unit, double low, double high, Text doc) {
  return MakeEntry<kMembers...>({key, "number", unit, low, high, doc});
}
template <auto... kMembers>
auto Count(Text key, double low, double high, Text doc) {
  return MakeEntry<kMembers...>({key, "whole number", "", low, high, doc});
}
template <auto... kMembers>
auto Switch(Text key, Text doc) {
  return MakeEntry<kMembers...>({key, "true or false", "", 0, 1, doc});
}
template <auto... kMembers>
auto Map(Text key, Text doc) {
  return MakeEntry<kMembers...>({key, "map", "", 0, 1, doc});
}
// Texts, tables and lists; a list's bounds are those of its length.
template <auto... kMembers>
auto Plain(Text key, Text type, Text doc, double low = 0, double high = 256) {
  return MakeEntry<kMembers...>({key, type, "", low, high, doc});
}
template <class Entry>
Entry Required(Entry entry) {
  entry.info.required = true;
  return entry;
}
template <class Entry>
Entry AsOuter(Entry entry) {
  entry.info.outer_bounds = true;
  return entry;
}

template <auto kFirst, auto... kRest>
auto Colour(Text key, Text doc) {
  using Object = typename OwnerOf<decltype(kFirst)>::Type;
  return KeyEntry<Object>{
      {key, "colour", "", 0, 1, doc},
      [](SetupReader& reader, const KeyInfo& info, const toml::node& node, Object& object) {
        reader.ReadColour(info, node, Field<kFirst, kRest...>(object));
      },
      [](const KeyInfo&, const Object& object) {
        return ShowColour(Field<kFirst, kRest...>(object));
      }};
}

template <auto... kMembers>
auto ChannelOf(Text doc) {
  return MakeEntry<kMembers...>({"channel", "word", "", 0, 3, doc, kChannelWords});
}

}  // namespace pelt::setup_entries
