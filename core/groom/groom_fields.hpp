// What the groom file holds of each struct: one list of fields for writing, reading, measuring and
// locating. Blocks are held as their rows list them and layer parameters as their entries do; with a
// new one kGroomVersion goes up.
//
// An archive is called with each field's name and the field. Arrays of any rank go element by
// element, last index fastest. Padding is not listed and so never reaches a file.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/block_rows.hpp"
#include "core/groom/groom.hpp"

namespace pelt::groom_file {

// Held as a length and so many bytes.
template <class T>
constexpr bool kIsBytes = std::is_same_v<T, std::string> || std::is_same_v<T, std::vector<uint8_t>>;

// Either constness of T.
template <class A, class T>
concept Like = std::is_same_v<std::remove_const_t<A>, T>;

template <class B>
requires(kListedMembers<std::remove_const_t<B>> > 0) void ListFields(auto&& archive, B& block) {
  ForEachMember<std::remove_const_t<B>>(
      [&](const auto& member) { archive(member.name, block.*member.member); });
}

// Whether files of that version have a layer's parameter.
constexpr bool HasParam(uint32_t version, std::string_view key) {
  for (const std::string_view added :
       {"dirt_clump", "shell_spacing", "sort_place", "shadow_share", "traits"})
    if (key == added) return version > 9;
  return version > 8 || key != "chain_share";
}

void ListFields(auto&& archive, Like<LayerLook> auto& look) {
  archive("look_tint_red", look.tint[0]);
  archive("look_tint_green", look.tint[1]);
  archive("look_tint_blue", look.tint[2]);
  for (const LayerLookEntry& entry : kLayerLookEntries) archive(entry.in_file, look.*entry.member);
  archive("look_strand_tint_red", look.strand_tint[0]);
  archive("look_strand_tint_green", look.strand_tint[1]);
  archive("look_strand_tint_blue", look.strand_tint[2]);
}

// An archive of an older file says so: version().
void ListFields(auto&& archive, Like<LayerParams> auto& params) {
  ForEachLayerParam([&](const auto& entry) {
    auto& value = params.*entry.member;
    if constexpr (requires { archive.version(); })
      if (!HasParam(archive.version(), entry.key)) return;
    if constexpr (requires { value.size(); }) {
      for (size_t i = 0; i < value.size(); ++i) archive(entry.in_file[i], value[i]);
    } else {
      archive(entry.key, value);
    }
  });
  if constexpr (requires { archive.version(); })
    if (archive.version() < 10) return;
  ListFields(archive, params.look);
}

void ListFields(auto&& archive, Like<StrandTexture> auto& texture) {
  archive("strand_texture_width", texture.width);
  archive("strand_texture_height", texture.height);
  archive("strand_texture_strips", texture.strips);
  archive("strand_texture_channels", texture.channels);
  archive("strand_texture_rgba", texture.rgba);
}

void ListFields(auto&& archive, Like<GroomLayer> auto& l) {
  archive("name", l.name);
  ListFields(archive, l.params);
  archive("first_patch", l.first_patch);
  archive("patch_count", l.patch_count);
  archive("first_chunk", l.first_chunk);
  archive("chunk_count", l.chunk_count);
  archive("strand_count", l.strand_count);
  archive("length_max", l.length_max);
  if constexpr (requires { archive.version(); })
    if (archive.version() < 10) return;
  if constexpr (std::is_const_v<std::remove_reference_t<decltype(l)>>) {
    static const StrandTexture kNone{};
    ListFields(archive, l.strand_texture ? *l.strand_texture : kNone);
  } else {
    StrandTexture texture;
    ListFields(archive, texture);
    if (texture != StrandTexture{})
      l.strand_texture = std::make_shared<const StrandTexture>(std::move(texture));
  }
}

// The one item of section "general".
struct General {
  float unit_scale = 1.0f;
  uint32_t joint_count = 0;
};
void ListFields(auto&& archive, Like<General> auto& g) {
  archive("unit_scale", g.unit_scale);
  archive("joint_count", g.joint_count);
}
void ListFields(auto&& archive, Like<std::string> auto& s) { archive("text", s); }

// The unsigned number whose little-endian bytes stand for a T.
template <class T>
using UnsignedOf =
    std::conditional_t<sizeof(T) == 1, uint8_t,
                       std::conditional_t<sizeof(T) == 2, uint16_t,
                                          std::conditional_t<sizeof(T) == 4, uint32_t, uint64_t>>>;

// Numbers to little-endian bytes and back. The path of a big-endian host is right on any host, so a
// test holds the two against each other.
template <std::endian kHost = std::endian::native, class T>
void StoreNumbers(std::byte* to, const T* from, size_t count) {
  if constexpr (kHost == std::endian::little) {
    std::memcpy(to, from, count * sizeof(T));
  } else {
    for (size_t i = 0; i < count; ++i) {
      UnsignedOf<T> bits;
      std::memcpy(&bits, from + i, sizeof(T));
      for (size_t b = 0; b < sizeof(T); ++b) *to++ = std::byte(bits >> 8 * b & 255);
    }
  }
}
template <std::endian kHost = std::endian::native, class T>
void LoadNumbers(T* to, const std::byte* from, size_t count) {
  if constexpr (kHost == std::endian::little) {
    std::memcpy(to, from, count * sizeof(T));
  } else {
    for (size_t i = 0; i < count; ++i) {
      UnsignedOf<T> bits = 0;
      for (size_t b = 0; b < sizeof(T); ++b)
        bits = UnsignedOf<T>(bits | UnsignedOf<T>(*from++) << 8 * b);
      std::memcpy(to + i, &bits, sizeof(T));
    }
  }
}

// Bytes of one number in the file.
template <class T>
constexpr uint64_t ElementBytes() {
  return std::is_same_v<T, bool> ? 1 : sizeof(T);
}

// Bytes of an item in the file; texts count as their length prefix alone.
struct ByteCounter {
  uint32_t file_version = ~0u;
  uint64_t bytes = 0;
  uint32_t version() const { return file_version; }
  template <class T>
  void operator()(std::string_view, const T&) {
    using Element = std::remove_all_extents_t<T>;
    if constexpr (kIsBytes<Element>) {
      bytes += 4;
    } else {
      bytes += sizeof(T) / sizeof(Element) * ElementBytes<Element>();
    }
  }
};

// Where in an item's bytes a field lies, and which it is; `bytes` ends as the item's size, texts
// included.
struct FieldLocator {
  const void* wanted = nullptr;
  uint64_t bytes = 0;
  uint64_t found_at = 0;
  std::string_view name = {};
  uint64_t element = 0;
  template <class T>
  void operator()(std::string_view field, const T& value) {
    using Element = std::remove_all_extents_t<T>;
    const auto* first = reinterpret_cast<const char*>(&value);
    const auto* at = static_cast<const char*>(wanted);
    if (at >= first && at < first + sizeof(T)) {
      element = uint64_t(at - first) / sizeof(Element);
      found_at = bytes + element * ElementBytes<Element>();
      name = field;
    }
    if constexpr (kIsBytes<Element>) {
      bytes += 4 + value.size();
    } else {
      bytes += sizeof(T) / sizeof(Element) * ElementBytes<Element>();
    }
  }
};

// In a file of that version; if not given, of this program's.
template <class T>
uint64_t CountItemBytes(const T& item, uint32_t version = ~0u) {
  ByteCounter counter{version};
  ListFields(counter, item);
  return counter.bytes;
}

// Bytes of this item in the file, its texts included.
template <class T>
uint64_t MeasureItem(const T& item) {
  FieldLocator measure{};
  ListFields(measure, item);
  return measure.bytes;
}

// Sections in file order.
inline constexpr std::string_view kSectionNames[] = {
    "general",     "skeleton",   "joint_names",   "layers",       "layer_joints",
    "mesh",        "strands",    "vertex_rest",   "strand_rest4", "strand_rest5",
    "strand_uv",   "shell_skin", "fin_edges",     "vertex_down",  "strand_rest9",
    "strand_down", "halo",       "vertex_traits", "strand_traits"};
inline constexpr uint32_t kSectionCount = 19;
// In files of that version, whose sections are the first of these.
constexpr uint32_t CountSections(uint32_t version) { return version > 9 ? kSectionCount : 17; }
inline constexpr uint64_t kSectionNameBytes = 16;
inline constexpr uint64_t kHeaderBytes = 48;
inline constexpr uint64_t kSectionEntryBytes = kSectionNameBytes + 8 + 8 + 4 + 4;

// Calls visit(section name, vector of items) for each section, in file order. General and skeleton
// are one item each and are handled by the caller.
void ListSections(auto&& visit, Like<Groom> auto& groom) {
  visit(kSectionNames[2], groom.joint_names);
  visit(kSectionNames[3], groom.layers);
  visit(kSectionNames[4], groom.layer_joints);
  visit(kSectionNames[5], groom.mesh);
  visit(kSectionNames[6], groom.strands);
  visit(kSectionNames[7], groom.vertex_rest);
  visit(kSectionNames[8], groom.strand_rest4);
  visit(kSectionNames[9], groom.strand_rest5);
  visit(kSectionNames[10], groom.strand_uv);
  visit(kSectionNames[11], groom.shell_skin);
  visit(kSectionNames[12], groom.fin_edges);
  visit(kSectionNames[13], groom.vertex_down);
  visit(kSectionNames[14], groom.strand_rest9);
  visit(kSectionNames[15], groom.strand_down);
  visit(kSectionNames[16], groom.halo);
  visit(kSectionNames[17], groom.vertex_traits);
  visit(kSectionNames[18], groom.strand_traits);
}

}  // namespace pelt::groom_file
