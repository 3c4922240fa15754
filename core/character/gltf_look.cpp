#include "core/character/gltf_look.hpp"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

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

const Json& Element(const Json& from, const Json& index) {
  static const Json kNone;
  const bool fits =
      from.is_array() && index.is_number_unsigned() && index.get<uint64_t>() < from.size();
  return fits ? from[size_t(index.get<uint64_t>())] : kNone;
}

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
    if (factor.is_array() && factor.size() == 4 &&
        std::all_of(factor.begin(), factor.end(), [](const Json& v) { return v.is_number(); })) {
      look.stated = true;
      for (int c = 0; c < 3; ++c)
        look.base_colour[c] = std::clamp(factor[size_t(c)].get<float>(), 0.0f, 1.0f);
    }
    if (texture.is_object()) {
      look.image =
          FindImage(texture, Format("material {} '{}'", number, document_.materials[number]));
      look.stated |= look.image >= 0;
    }
    return look;
  }

  // Its number among the document's images; -1 and a sentence where it cannot be had.
  int32_t FindImage(const Json& texture, const std::string& material) {
    const Json& index = Element(Member(json_, "textures"), Member(texture, "index"));
    const Json& source = Member(index, "source");
    const Json& image = Element(Member(json_, "images"), source);
    std::string fault;
    int32_t number = -1;
    if (const Json& set = Member(texture, "texCoord"); set.is_number() && set != 0)
      fault = "it uses other texture coordinates than the first";
    else if (!image.is_object())
      fault = "there is no such image";
    else
      number = ReadImage(source.get<uint64_t>(), image, fault);
    if (!fault.empty())
      document_.look_faults.push_back(
          Format("{}: its base colour's image was left out: {}.", material, fault));
    return number;
  }

  int32_t ReadImage(uint64_t source, const Json& image, std::string& fault) {
    const auto known = number_.find(source);
    if (known != number_.end()) return known->second;
    std::vector<std::byte> bytes;
    if (const Json& uri = Member(image, "uri"); uri.is_string())
      bytes = ReadUri(uri.get<std::string>(), fault);
    else
      bytes = ReadView(Member(image, "bufferView"), fault);
    if (!fault.empty()) return -1;
    const int32_t number = int32_t(document_.images.size());
    document_.images.push_back(std::move(bytes));
    number_.emplace(source, number);
    return number;
  }

  std::vector<std::byte> ReadUri(const std::string& uri, std::string& fault) {
    if (uri.starts_with("data:")) {
      fault = "images within the text are not read";
      return {};
    }
    const std::vector<unsigned char> bytes = read_(uri, fault);
    if (!fault.empty()) fault = Format("'{}': {}", Printable(uri), fault);
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
  std::map<uint64_t, int32_t> number_;  // of the file's images among the document's
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
