#include "core/character/gltf_look.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "core/exact_math.hpp"
#include "core/float_rules.hpp"
#include "core/format.hpp"
#include "core/printable.hpp"

namespace pelt::gltf {
namespace {

using Json = nlohmann::json;

// The member, or null where there is none or `from` is no object.
const Json& Member(const Json& from, const char* name) {
  static const Json kNone;
  const auto found = from.is_object() ? from.find(name) : from.end();
  return from.is_object() && found != from.end() ? *found : kNone;
}

const Json& Element(const Json& from, size_t index) {
  static const Json kNone;
  return from.is_array() && index < from.size() ? from[index] : kNone;
}
const Json& Element(const Json& from, const Json& index) {
  return Element(from, index.is_number_unsigned() ? size_t(index.get<uint64_t>()) : SIZE_MAX);
}

constexpr uint64_t kUvSets = 16;
constexpr double kFarOut = 1e6;  // of a texture transform: beyond, floats have no fractions left

class LookReader {
 public:
  LookReader(const Json& json, const ImageReader& read, Document& document)
      : json_(json), read_(read), document_(document) {}

  void Read() {
    for (size_t m = 0; m < document_.materials.size(); ++m)
      document_.looks.push_back(ReadMaterial(Element(Member(json_, "materials"), m), m));
  }

 private:
  MaterialLook ReadMaterial(const Json& material, size_t number) {
    const Json& metallic = Member(material, "pbrMetallicRoughness");
    const Json& factor = Member(metallic, "baseColorFactor");
    const Json& texture = Member(metallic, "baseColorTexture");
    MaterialLook look;
    look.unlit = Member(Member(material, "extensions"), "KHR_materials_unlit").is_object();
    if (factor.is_array() && factor.size() == 4 &&
        std::all_of(factor.begin(), factor.end(), [](const Json& v) { return v.is_number(); })) {
      look.stated = true;
      for (int c = 0; c < 3; ++c)
        look.base_colour[c] = std::clamp(factor[size_t(c)].get<float>(), 0.0f, 1.0f);
    }
    if (texture.is_object()) {
      const std::string fault = ReadTexture(texture, look);
      if (!fault.empty())
        document_.look_faults.push_back(
            Format("material {} '{}': its base colour's image was left out: {}.", number,
                   document_.materials[number], fault));
      look.stated |= look.image >= 0;
    }
    return look;
  }

  // Why it cannot be had, or nothing.
  std::string ReadTexture(const Json& texture, MaterialLook& look) {
    const Json& transform = Member(Member(texture, "extensions"), "KHR_texture_transform");
    const Json& other_set = Member(transform, "texCoord");
    const Json& set = other_set.is_null() ? Member(texture, "texCoord") : other_set;
    if (!set.is_null()) {
      if (!set.is_number_unsigned() || set.get<uint64_t>() >= kUvSets)
        return Format("its texCoord is none of 0 to {}", kUvSets - 1);
      look.uv_set = uint32_t(set.get<uint64_t>());
    }
    if (!ReadTransform(transform, look))
      return "its KHR_texture_transform is not made of finite numbers";
    const Json& index = Element(Member(json_, "textures"), Member(texture, "index"));
    const Json& source = Member(index, "source");
    const Json& image = Element(Member(json_, "images"), source);
    if (!image.is_object()) return "there is no such image";
    const auto [at, is_new] = images_.try_emplace(source.get<uint64_t>());
    if (is_new) at->second = ReadImage(image);
    look.image = at->second.number;
    return at->second.fault;
  }

  // Scaled, turned counter-clockwise as the image is seen, whose v points down, and moved.
  static bool ReadTransform(const Json& transform, MaterialLook& look) {
    const auto number = [](const Json& json, double fallback) {
      return json.is_null() ? fallback
             : json.is_number() && json.get<double>() < kFarOut && json.get<double>() > -kFarOut
                 ? json.get<double>()
                 : std::numeric_limits<double>::quiet_NaN();
    };
    const auto element = [&](const char* member, size_t i, double fallback) {
      const Json& pair = Member(transform, member);
      if (pair.is_null()) return fallback;
      return number(Element(pair, i), std::numeric_limits<double>::quiet_NaN());
    };
    const double turn = number(Member(transform, "rotation"), 0.0);
    const double c = exact::Cos(turn), s = exact::Sin(turn);
    const double across = element("scale", 0, 1.0), down = element("scale", 1, 1.0);
    look.image_u = glm::vec3(glm::dvec3(c * across, s * down, element("offset", 0, 0.0)));
    look.image_v = glm::vec3(glm::dvec3(-s * across, c * down, element("offset", 1, 0.0)));
    const glm::vec3 sum = look.image_u + look.image_v;
    return std::isfinite(sum.x) && std::isfinite(sum.y) && std::isfinite(sum.z);
  }

  struct ReadBefore {
    int32_t number = -1;  // among the document's images
    std::string fault;    // why there is none
  };
  ReadBefore ReadImage(const Json& image) {
    ReadBefore read;
    std::vector<std::byte> bytes;
    if (const Json& uri = Member(image, "uri"); uri.is_string())
      bytes = ReadUri(uri.get<std::string>(), read.fault);
    else
      bytes = ReadView(Member(image, "bufferView"), read.fault);
    if (!read.fault.empty()) return read;
    read.number = int32_t(document_.images.size());
    document_.images.push_back(std::move(bytes));
    return read;
  }

  std::vector<std::byte> ReadUri(const std::string& uri, std::string& fault) {
    const std::vector<unsigned char> bytes = read_(uri, fault);
    // What is within the text may be long.
    const std::string shown = uri.starts_with("data:") ? uri.substr(0, 32) : uri;
    if (!fault.empty()) fault = Format("'{}': {}", Printable(shown), fault);
    const auto* first = reinterpret_cast<const std::byte*>(bytes.data());
    return {first, first + bytes.size()};
  }

  std::vector<std::byte> ReadView(const Json& index, std::string& fault) {
    if (!index.is_number_unsigned() || index.get<uint64_t>() >= document_.views.size()) {
      fault = "its bufferView does not exist";
      return {};
    }
    const View& view = document_.views[size_t(index.get<uint64_t>())];
    const bool has_buffer = view.buffer >= 0 && size_t(view.buffer) < document_.buffers.size();
    const size_t size = has_buffer ? document_.buffers[size_t(view.buffer)].size() : 0;
    if (view.offset > size || view.length > size - view.offset) {
      fault = "it reaches past its buffer";
      return {};
    }
    if (!has_buffer) return {};
    const auto* first =
        reinterpret_cast<const std::byte*>(document_.buffers[size_t(view.buffer)].data());
    return {first + view.offset, first + view.offset + view.length};
  }

  const Json& json_;
  const ImageReader& read_;
  Document& document_;
  std::map<uint64_t, ReadBefore> images_;  // of the file; each is read once
};

}  // namespace

void ReadLook(std::string_view json, const ImageReader& read, Document& document) {
  const auto wanted = [](int depth, Json::parse_event_t event, Json& parsed) {
    return depth != 1 || event != Json::parse_event_t::key || parsed == "materials" ||
           parsed == "textures" || parsed == "images";
  };
  // What is no JSON was refused before; this only must not throw.
  const Json parsed = Json::parse(json.begin(), json.end(), wanted, false);
  LookReader(parsed, read, document).Read();
}

}  // namespace pelt::gltf
