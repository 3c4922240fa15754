// What materials say of their look. Idea: see ReadLook in gltf_parse.hpp.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "core/character/gltf_parse.hpp"
#include "core/character/picture_kind.hpp"
#include "core/exact_math.hpp"
#include "core/float_rules.hpp"
#include "core/format.hpp"

namespace pelt::gltf {
namespace {

// The images that a glTF's textures name, in whichever way: each index, offset and length is checked, each image is
// read once, and what it is is seen from its bytes.
//
// Invariant: the images together have no more bytes than the file and those beside it.

class TextureReader {
 public:
  TextureReader(const Json& json, UriReader& files, Document& document)
      : json_(json), files_(files), document_(document) {}

  // The number of the image among the document's that a texture info ({"index": ...}) leads to: that of the texture
  // itself, or of an extension that is of a kind that is read after all. -1, and why, where there is none.
  int32_t FindImage(const Json& info, std::string& fault);
  // How its sampler has it go on beyond its edges.
  std::array<Wrap, 2> FindWrap(const Json& info) const;

 private:
  struct ReadBefore {
    int32_t number = -1;  // among the document's images
    std::string fault;    // why there is none
  };
  const Json& TextureOf(const Json& info) const;
  ReadBefore FindSource(const Json& source);
  ReadBefore ReadImage(const Json& image);
  std::vector<std::byte> ReadUri(const std::string& uri, std::string& fault);
  std::vector<std::byte> ReadView(const Json& index, std::string& fault);

  const Json& json_;
  UriReader& files_;
  Document& document_;
  std::map<uint64_t, ReadBefore> images_;  // by their number in the file
  uint64_t bytes_ = 0;                     // of those from buffers
};

constexpr size_t kUriShown = 64;  // what is within the text may be long

Wrap WrapOf(const Json& mode) {
  constexpr uint64_t kClampToEdge = 33071, kMirroredRepeat = 33648;
  if (mode == kClampToEdge) return Wrap::kClamp;
  return mode == kMirroredRepeat ? Wrap::kMirror : Wrap::kRepeat;
}

std::string WhyNotRead(std::span<const std::byte> bytes) {
  if (bytes.empty()) return "it is empty";
  if (IsReadPicture(bytes)) return {};
  const std::string_view kind = NamePicture(bytes);
  return Format("{}{}not of a type that is read (PNG, JPEG)", kind, kind.empty() ? "" : ", ");
}

const Json& TextureReader::TextureOf(const Json& info) const {
  return Element(Member(json_, "textures"), Member(info, "index"));
}

int32_t TextureReader::FindImage(const Json& info, std::string& fault) {
  const Json& texture = TextureOf(info);
  const Json& extensions = Member(texture, "extensions");
  const Json& source = Member(texture, "source");
  ReadBefore found;
  if (!source.is_null() || extensions.empty()) found = FindSource(source);
  for (auto at = extensions.begin(); extensions.is_object() && at != extensions.end(); ++at) {
    if (found.number >= 0) break;
    ReadBefore other = FindSource(Member(at.value(), "source"));
    if (!other.fault.empty())
      other.fault = Format("{}: {}", Printable(at.key().substr(0, kUriShown)), other.fault);
    if (other.number >= 0 || found.fault.empty()) found = std::move(other);
  }
  fault = found.fault;
  return found.number;
}

std::array<Wrap, 2> TextureReader::FindWrap(const Json& info) const {
  const Json& sampler = Element(Member(json_, "samplers"), Member(TextureOf(info), "sampler"));
  return {WrapOf(Member(sampler, "wrapS")), WrapOf(Member(sampler, "wrapT"))};
}

TextureReader::ReadBefore TextureReader::FindSource(const Json& source) {
  const Json& image = Element(Member(json_, "images"), source);
  if (!image.is_object()) return {-1, "there is no such image"};
  const auto [at, is_new] = images_.try_emplace(source.get<uint64_t>());
  if (is_new) at->second = ReadImage(image);
  return at->second;
}

TextureReader::ReadBefore TextureReader::ReadImage(const Json& image) {
  ReadBefore read;
  std::vector<std::byte> bytes;
  if (const Json& uri = Member(image, "uri"); uri.is_string()) {
    const std::string& text = uri.get_ref<const std::string&>();
    bytes = ReadUri(text, read.fault);
    if (read.fault.empty()) read.fault = WhyNotRead(bytes);
    if (!read.fault.empty())
      read.fault = Format("'{}{}': {}", Printable(text.substr(0, kUriShown)),
                          text.size() > kUriShown ? "..." : "", read.fault);
  } else {
    bytes = ReadView(Member(image, "bufferView"), read.fault);
    if (read.fault.empty()) read.fault = WhyNotRead(bytes);
  }
  if (!read.fault.empty()) return read;
  read.number = int32_t(document_.images.size());
  document_.images.push_back(std::move(bytes));
  return read;
}

std::vector<std::byte> TextureReader::ReadUri(const std::string& uri, std::string& fault) {
  std::vector<unsigned char> bytes = files_.Read(uri, fault);
  // Exporters of another system write its separators.
  if (!fault.empty() && !uri.starts_with("data:") && uri.find('\\') != uri.npos) {
    std::string path = uri, fault_of_path;
    std::ranges::replace(path, '\\', '/');
    bytes = files_.Read(path, fault_of_path);
    if (fault_of_path.empty()) fault.clear();
  }
  const auto* first = reinterpret_cast<const std::byte*>(bytes.data());
  return {first, first + bytes.size()};
}

std::vector<std::byte> TextureReader::ReadView(const Json& index, std::string& fault) {
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
  bytes_ += view.length;
  if (bytes_ > document_.file_bytes) {
    fault = "the file's images overlap";
    return {};
  }
  const auto* first =
      reinterpret_cast<const std::byte*>(document_.buffers[size_t(view.buffer)].data());
  return {first + view.offset, first + view.offset + view.length};
}

constexpr uint64_t kUvSets = 16;
constexpr double kFarOut = 1e6;  // of a texture transform: beyond, floats have no fractions left

constexpr float kDefaultCutoff = 0.5f;
// Below it a base colour is none: what is seen of such a material is what it emits.
constexpr float kBlack = 0.01f;

double NumberOr(const Json& json, double otherwise) {
  return json.is_number() ? json.get<double>() : otherwise;
}

// `size` numbers, 0 to 1; false for anything else.
bool ReadColour(const Json& from, int size, glm::vec4& colour) {
  if (!from.is_array() || int(from.size()) != size ||
      !std::all_of(from.begin(), from.end(), [](const Json& v) { return v.is_number(); }))
    return false;
  for (int c = 0; c < size; ++c) colour[c] = std::clamp(from[size_t(c)].get<float>(), 0.0f, 1.0f);
  return true;
}

class LookReader {
 public:
  LookReader(const Json& json, UriReader& files, Document& document)
      : json_(json), textures_(json, files, document), document_(document) {}

  void Read() {
    for (size_t m = 0; m < document_.materials.size(); ++m)
      ReadMaterial(Element(Member(json_, "materials"), m), m);
  }

 private:
  void ReadMaterial(const Json& material, size_t number) {
    MaterialLook look;
    TextureTransform transform;
    const Json& extensions = Member(material, "extensions");
    look.unlit = Member(extensions, "KHR_materials_unlit").is_object();
    look.other_look = Member(Member(json_, "extensions"), "VRM").is_object();
    for (auto at = extensions.begin(); extensions.is_object() && at != extensions.end(); ++at)
      look.other_look |= !at.key().starts_with("KHR_");

    const Json& gloss = Member(extensions, "KHR_materials_pbrSpecularGlossiness");
    const Json& diffuse = Member(gloss, "diffuseFactor");
    const Json& diffuse_texture = Member(gloss, "diffuseTexture");
    const bool by_gloss = !diffuse.is_null() || !diffuse_texture.is_null();
    const Json& metallic = Member(material, "pbrMetallicRoughness");
    const Json& texture = by_gloss ? diffuse_texture : Member(metallic, "baseColorTexture");
    glm::vec4 colour(1.0f);
    look.stated = ReadColour(by_gloss ? diffuse : Member(metallic, "baseColorFactor"), 4, colour);
    look.base_colour = glm::vec3(colour);
    look.alpha = colour.a;
    if (texture.is_object())
      look.image = look.alpha_image = Lay(texture, "base colour's", number, look, transform);
    look.stated |= look.image >= 0;
    if (look.image >= 0 && !MayHaveAlpha(document_.images[size_t(look.image)]))
      look.alpha_image = -1;
    ReadAlpha(material, look);
    const bool emits = ReadEmission(material, number, look, transform);
    if (!texture.is_object() && !emits) LayByOther(material, look, transform);
    document_.looks.push_back(look);
    document_.transforms.push_back(transform);
  }

  // What is blended is there where more of it is seen than not.
  static void ReadAlpha(const Json& material, MaterialLook& look) {
    const Json& mode = Member(material, "alphaMode");
    if (mode == "BLEND") look.alpha_cutoff = kDefaultCutoff;
    if (mode == "MASK")
      look.alpha_cutoff = float(NumberOr(Member(material, "alphaCutoff"), double(kDefaultCutoff)));
    if (!(look.alpha_cutoff > 0.0f)) look.alpha_cutoff = 0.0f;
  }

  // Where the base colour is black or not said, what is emitted is the colour that is seen.
  bool ReadEmission(const Json& material, size_t number, MaterialLook& look,
                    TextureTransform& transform) {
    const glm::vec3& base = look.base_colour;
    if (look.stated && std::max({base.r, base.g, base.b}) > kBlack) return false;
    glm::vec4 colour(0.0f);
    if (!ReadColour(Member(material, "emissiveFactor"), 3, colour)) return false;
    if (!(std::max({colour.r, colour.g, colour.b}) > 0.0f)) return false;
    const Json& strength =
        Member(Member(Member(material, "extensions"), "KHR_materials_emissive_strength"),
               "emissiveStrength");
    for (int c = 0; c < 3; ++c)
      look.base_colour[c] =
          float(std::clamp(double(colour[c]) * NumberOr(strength, 1.0), 0.0, 1.0));
    look.stated = true;
    look.image = -1;
    const Json& texture = Member(material, "emissiveTexture");
    if (!texture.is_object()) return false;
    look.image = Lay(texture, "emissive", number, look, transform);
    return true;
  }

  // Of materials without an image of their colour maps lie as their other images do, which are not read.
  void LayByOther(const Json& material, MaterialLook& look, TextureTransform& transform) {
    for (const Json* texture :
         {&Member(material, "emissiveTexture"), &Member(material, "occlusionTexture"),
          &Member(material, "normalTexture"),
          &Member(Member(material, "pbrMetallicRoughness"), "metallicRoughnessTexture")}) {
      if (!texture->is_object()) continue;
      ReadLaying(*texture, look, transform);
      return;
    }
  }

  // The number of its image; -1, and a sentence, where there is none.
  int32_t Lay(const Json& texture, std::string_view whose, size_t material, MaterialLook& look,
              TextureTransform& transform) {
    std::string fault = ReadLaying(texture, look, transform);
    int32_t image = -1;
    if (fault.empty()) image = textures_.FindImage(texture, fault);
    if (!fault.empty())
      document_.look_faults.push_back(Format("material {} '{}': its {} image was left out: {}.",
                                             material, document_.materials[material], whose,
                                             fault));
    return image;
  }

  // Why it cannot be laid, or nothing.
  std::string ReadLaying(const Json& texture, MaterialLook& look, TextureTransform& transform) {
    const Json& moved = Member(Member(texture, "extensions"), "KHR_texture_transform");
    const Json& other_set = Member(moved, "texCoord");
    const Json& set = other_set.is_null() ? Member(texture, "texCoord") : other_set;
    look.wrap = textures_.FindWrap(texture);
    if (!set.is_null()) {
      if (!set.is_number_unsigned() || set.get<uint64_t>() >= kUvSets)
        return Format("its texCoord is none of 0 to {}", kUvSets - 1);
      look.uv_set = uint32_t(set.get<uint64_t>());
    }
    const TextureTransform read = ReadTransform(moved);
    const glm::vec3 sum = read.u + read.v;
    if (!std::isfinite(sum.x) || !std::isfinite(sum.y) || !std::isfinite(sum.z))
      return "its KHR_texture_transform is not made of finite numbers";
    transform = read;
    return {};
  }

  // Scaled, turned counter-clockwise as the image is seen, whose v points down, and moved.
  static TextureTransform ReadTransform(const Json& transform) {
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
    return {glm::vec3(glm::dvec3(c * across, s * down, element("offset", 0, 0.0))),
            glm::vec3(glm::dvec3(-s * across, c * down, element("offset", 1, 0.0)))};
  }

  const Json& json_;
  TextureReader textures_;
  Document& document_;
};

}  // namespace

void ReadLook(std::string_view json, UriReader& files, Document& document) {
  const auto wanted = [](int depth, Json::parse_event_t event, Json& parsed) {
    return depth != 1 || event != Json::parse_event_t::key || parsed == "materials" ||
           parsed == "textures" || parsed == "images" || parsed == "samplers" ||
           parsed == "extensions";
  };
  // What is no JSON was refused before; this only must not throw.
  const Json parsed = Json::parse(json.begin(), json.end(), wanted, false);
  LookReader(parsed, files, document).Read();
}

}  // namespace pelt::gltf
