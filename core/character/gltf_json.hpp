// Looking things up in a glTF's JSON, none of which need be there or be what it should be.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>

namespace pelt::gltf {

using Json = nlohmann::json;

// The member, or null where there is none or `from` is no object.
inline const Json& Member(const Json& from, const char* name) {
  static const Json kNone;
  const auto found = from.is_object() ? from.find(name) : from.end();
  return from.is_object() && found != from.end() ? *found : kNone;
}

inline const Json& Element(const Json& from, size_t index) {
  static const Json kNone;
  return from.is_array() && index < from.size() ? from[index] : kNone;
}
inline const Json& Element(const Json& from, const Json& index) {
  return Element(from, index.is_number_unsigned() ? size_t(index.get<uint64_t>()) : SIZE_MAX);
}

}  // namespace pelt::gltf
