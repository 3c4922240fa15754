// JSON to plain data, and nothing else: an index, a number or a name is checked where it is used.
// A library that reads glTF also refuses a file for faults in parts that no code of ours uses, so it is
// read here, with nlohmann's JSON.
//
// What breaks if ignored: `extras` and unknown members can be most of a file; they are dropped while
// it is parsed. The parser holds its stack on the heap, so that nesting cannot overflow ours.
#include "core/character/gltf_document.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/character/gltf_parse.hpp"
#include "core/error.hpp"
#include "core/float_rules.hpp"
#include "core/format.hpp"

namespace pelt::gltf {
namespace {

constexpr std::string_view kMembers[] = {
    "accessors",          "animations", "asset",  "bufferViews", "buffers",
    "extensionsRequired", "materials",  "meshes", "nodes",       "scene",
    "extensionsUsed",     "scenes",     "skins"};

// Extensions without which the accessors mean something else. They are named with the command that
// undoes them, not decoded: no codec of theirs is packaged where Pelt is built, one of our own would
// have nothing here to be compared with, and a file has to be undone only once.
constexpr std::string_view kCompressions[] = {"KHR_draco_mesh_compression",
                                              "EXT_meshopt_compression", "KHR_meshopt_compression"};
// Of materials, lights and pictures, none of which is looked at; or read.
constexpr std::string_view kHarmless[] = {
    "KHR_materials_", "KHR_lights_",          "KHR_texture_",          "EXT_texture_",
    "MSFT_texture_",  "EXT_lights_",          "KHR_mesh_quantization", "KHR_node_visibility",
    "MSFT_lod",       "KHR_animation_pointer"};

int ToIndex(const Json& value) {
  if (!value.is_number()) return kBroken;
  const double number = value.get<double>();
  const bool fits = number >= 0.0 && number < 2147483647.0 && number == std::floor(number);
  return fits ? int(number) : kBroken;
}

// -1 where there is none.
int IndexOf(const Json& from, const char* member) {
  const Json& value = Member(from, member);
  return value.is_null() ? -1 : ToIndex(value);
}

// Larger than anything where it is no size.
uint64_t SizeOf(const Json& from, const char* member) {
  const Json& value = Member(from, member);
  if (value.is_null()) return 0;
  if (value.is_number_unsigned()) return value.get<uint64_t>();
  const int index = ToIndex(value);
  return index == kBroken ? std::numeric_limits<uint64_t>::max() : uint64_t(index);
}

bool FlagOf(const Json& from, const char* member, bool otherwise) {
  const Json& value = Member(from, member);
  return value.is_boolean() ? value.get<bool>() : otherwise;
}

std::string RawTextOf(const Json& from, const char* member) {
  const Json& value = Member(from, member);
  return value.is_string() ? value.get<std::string>() : std::string();
}
std::string TextOf(const Json& from, const char* member) {
  return Printable(RawTextOf(from, member));
}

std::vector<int> IndicesOf(const Json& from, const char* member) {
  std::vector<int> out;
  if (const Json& array = Member(from, member); array.is_array())
    for (const Json& value : array) out.push_back(ToIndex(value));
  return out;
}

std::vector<double> NumbersOf(const Json& from, const char* member) {
  std::vector<double> out;
  if (const Json& array = Member(from, member); array.is_array())
    for (const Json& value : array)
      out.push_back(value.is_number() ? value.get<double>()
                                      : std::numeric_limits<double>::quiet_NaN());
  return out;
}

std::vector<std::string> TextsOf(const Json& from, const char* member) {
  std::vector<std::string> out;
  if (const Json& array = Member(from, member); array.is_array())
    for (const Json& value : array)
      if (value.is_string()) out.push_back(value.get<std::string>());
  return out;
}

const Json& ExtensionOf(const Json& from, const char* name) {
  return Member(Member(from, "extensions"), name);
}
bool IsCompressed(const Json& from) {
  return std::any_of(
      std::begin(kCompressions), std::end(kCompressions),
      [&](std::string_view name) { return ExtensionOf(from, name.data()).is_object(); });
}

View ToView(const Json& from) {
  return {IndexOf(from, "buffer"), SizeOf(from, "byteOffset"), SizeOf(from, "byteLength"),
          SizeOf(from, "byteStride"), IsCompressed(from)};
}

int64_t CountOf(const Json& from, const char* member) {
  const Json& value = Member(from, member);
  return value.is_null() ? 0 : int64_t(ToIndex(value));
}

Accessor ToAccessor(const Json& from) {
  constexpr std::pair<std::string_view, int> kTypes[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}};
  Accessor to;
  to.view = IndexOf(from, "bufferView");
  to.offset = SizeOf(from, "byteOffset");
  to.count = SizeOf(from, "count");
  to.component = IndexOf(from, "componentType");
  to.normalised = FlagOf(from, "normalized", false);
  const std::string type = RawTextOf(from, "type");
  to.matrix = type.starts_with("MAT");
  for (const auto& [name, components] : kTypes)
    if (type == name) to.components = components;
  const Json& sparse = Member(from, "sparse");
  to.sparse.used = sparse.is_object();
  if (!to.sparse.used) return to;
  const Json &indices = Member(sparse, "indices"), &values = Member(sparse, "values");
  to.sparse.count = CountOf(sparse, "count");
  to.sparse.index_view = IndexOf(indices, "bufferView");
  to.sparse.index_offset = CountOf(indices, "byteOffset");
  to.sparse.index_component = IndexOf(indices, "componentType");
  to.sparse.value_view = IndexOf(values, "bufferView");
  to.sparse.value_offset = CountOf(values, "byteOffset");
  return to;
}

template <class T, class Convert>
void ReadEach(const Json& from, const char* member, std::vector<T>& to, const Convert& convert) {
  const Json& array = Member(from, member);
  if (!array.is_array()) return;
  for (const Json& element : array) to.push_back(convert(element));
}

Primitive ToPrimitive(const Json& from) {
  Primitive to;
  if (const Json& attributes = Member(from, "attributes"); attributes.is_object())
    for (const auto& [name, accessor] : attributes.items()) to.attributes[name] = ToIndex(accessor);
  to.indices = IndexOf(from, "indices");
  to.material = IndexOf(from, "material");
  if (const int mode = IndexOf(from, "mode"); mode != -1) to.mode = mode;
  const Json& targets = Member(from, "targets");
  to.morphs = targets.is_array() && !targets.empty();
  to.compressed = IsCompressed(from);
  return to;
}

MeshDesc ToMesh(const Json& from) {
  MeshDesc to;
  to.name = TextOf(from, "name");
  ReadEach(from, "primitives", to.primitives, ToPrimitive);
  return to;
}

Node ToNode(const Json& from) {
  Node to;
  to.name = TextOf(from, "name");
  to.children = IndicesOf(from, "children");
  to.mesh = IndexOf(from, "mesh");
  to.skin = IndexOf(from, "skin");
  to.matrix = NumbersOf(from, "matrix");
  to.translation = NumbersOf(from, "translation");
  to.rotation = NumbersOf(from, "rotation");
  to.scale = NumbersOf(from, "scale");
  to.coarser = IndicesOf(ExtensionOf(from, "MSFT_lod"), "ids");
  to.hidden = !FlagOf(ExtensionOf(from, "KHR_node_visibility"), "visible", true);
  return to;
}

Animation ToAnimation(const Json& from) {
  Animation to;
  to.name = TextOf(from, "name");
  ReadEach(from, "samplers", to.samplers, [](const Json& s) {
    return Sampler{IndexOf(s, "input"), IndexOf(s, "output"), TextOf(s, "interpolation")};
  });
  ReadEach(from, "channels", to.channels, [](const Json& c) {
    const Json& target = Member(c, "target");
    return ChannelDesc{IndexOf(c, "sampler"), IndexOf(target, "node"), TextOf(target, "path")};
  });
  return to;
}

// Bytes that are no UTF-8, of names in older code pages, become question marks.
std::string RepairText(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const size_t bytes = FirstCharacter(text).bytes;
    out += bytes ? text.substr(0, bytes) : "?";
    text.remove_prefix(std::max<size_t>(bytes, 1));
  }
  return out;
}

bool IsUtf8(std::string_view text) {
  while (!text.empty()) {
    const size_t bytes = FirstCharacter(text).bytes;
    if (bytes == 0) return false;
    text.remove_prefix(bytes);
  }
  return true;
}

Json ParseText(std::string_view text, const std::string& name) {
  const auto wanted = [](int depth, Json::parse_event_t event, Json& parsed) {
    if (event != Json::parse_event_t::key) return true;
    if (depth > 1) return parsed != "extras";
    return std::find(std::begin(kMembers), std::end(kMembers), parsed) != std::end(kMembers);
  };
  try {
    return Json::parse(text.begin(), text.end(), wanted);
  } catch (const std::exception& e) {
    throw Error(name + ": not readable as glTF: " + Printable(e.what()));
  }
}

void CheckVersion(const Json& json, const std::string& name) {
  const Json& asset = Member(json, "asset");
  if (!asset.is_object()) throw Error(name + ": not readable as glTF: JSON without `asset`");
  const std::string version = TextOf(asset, "version");
  if (version != "2" && !version.starts_with("2."))
    throw Error(Format("{}: asset.version is \"{}\", only 2.x is known; export as glTF 2.0", name,
                       version));
}

// Whether something of the document has its bytes in an extension alone.
bool LacksPlainBytes(const Document& document) {
  const auto is_empty_view = [&](const View& view) {
    const bool known = view.buffer >= 0 && size_t(view.buffer) < document.buffers.size();
    return view.compressed && known && !document.buffer_faults[size_t(view.buffer)].empty();
  };
  const auto is_empty = [&](int accessor) {
    const bool known = accessor >= 0 && size_t(accessor) < document.accessors.size();
    return known && document.accessors[size_t(accessor)].view < 0 &&
           !document.accessors[size_t(accessor)].sparse.used;
  };
  const auto is_empty_primitive = [&](const Primitive& primitive) {
    return primitive.compressed &&
           (is_empty(primitive.indices) ||
            std::any_of(primitive.attributes.begin(), primitive.attributes.end(),
                        [&](const auto& attribute) { return is_empty(attribute.second); }));
  };
  return std::any_of(document.views.begin(), document.views.end(), is_empty_view) ||
         std::any_of(document.meshes.begin(), document.meshes.end(), [&](const MeshDesc& mesh) {
           return std::any_of(mesh.primitives.begin(), mesh.primitives.end(), is_empty_primitive);
         });
}

// A file that is compressed has the plain bytes too, or says that it requires the extension; some
// forget to say it.
void CheckCompression(const Json& json, const Document& document) {
  for (const char* member : {"extensionsRequired", "extensionsUsed"}) {
    const bool required = std::string_view(member) == "extensionsRequired";
    for (const std::string& extension : TextsOf(json, member))
      if (std::find(std::begin(kCompressions), std::end(kCompressions), extension) !=
              std::end(kCompressions) &&
          (required || LacksPlainBytes(document)))
        throw Error(Format("{}: {}: {} is not read; undo it: gltf-transform cp in.glb out.glb",
                           document.name, member, extension));
  }
}

// The other extensions that the file says it cannot do without.
std::vector<std::string> ListUnknown(const Json& json) {
  std::vector<std::string> unknown;
  for (const std::string& extension : TextsOf(json, "extensionsRequired"))
    if (std::none_of(std::begin(kHarmless), std::end(kHarmless),
                     [&](std::string_view known) { return extension.starts_with(known); }))
      unknown.push_back(Printable(extension));
  return unknown;
}

void ReadBuffers(const Json& json, const Parts& parts, UriReader& reader, Document& to) {
  const Json& buffers = Member(json, "buffers");
  for (size_t b = 0; buffers.is_array() && b < buffers.size(); ++b) {
    const std::string uri = RawTextOf(buffers[b], "uri");
    std::string fault;
    std::vector<unsigned char> bytes;
    if (!uri.empty()) {
      bytes = reader.Read(uri, fault);
      if (!fault.empty()) fault = Format("'{}': {}", Printable(uri), fault);
    } else if (b == 0 && parts.has_binary) {
      const auto* first = reinterpret_cast<const unsigned char*>(parts.binary.data());
      bytes.assign(first, first + parts.binary.size());
    } else {
      fault = "it has no uri and is not the binary chunk";
    }
    to.file_bytes += bytes.size();
    to.buffers.push_back(std::move(bytes));
    to.buffer_faults.push_back(std::move(fault));
  }
}

}  // namespace

Document ParseDocument(std::span<const std::byte> bytes, const std::string& name,
                       const std::string& folder) {
  Document to;
  to.name = name;
  to.file_bytes = bytes.size();
  const Parts parts = FindParts(bytes, name);
  std::string_view text = parts.json;
  std::string repaired;
  if (!IsUtf8(text)) {
    repaired = RepairText(text);
    text = repaired;
    to.repairs.push_back("The file's text is not all UTF-8; what is not became '?'.");
  }
  const Json json = ParseText(text, name);
  CheckVersion(json, name);
  UriReader reader(folder);
  ReadBuffers(json, parts, reader, to);
  ReadEach(json, "bufferViews", to.views, ToView);
  ReadEach(json, "accessors", to.accessors, ToAccessor);
  ReadEach(json, "meshes", to.meshes, ToMesh);
  ReadEach(json, "nodes", to.nodes, ToNode);
  ReadEach(json, "scenes", to.scenes, [](const Json& scene) {
    return Scene{TextOf(scene, "name"), IndicesOf(scene, "nodes")};
  });
  to.scene = IndexOf(json, "scene");
  ReadEach(json, "skins", to.skins, [](const Json& skin) {
    return Skin{TextOf(skin, "name"), IndicesOf(skin, "joints"),
                IndexOf(skin, "inverseBindMatrices")};
  });
  ReadEach(json, "animations", to.animations, ToAnimation);
  ReadEach(json, "materials", to.materials,
           [](const Json& material) { return TextOf(material, "name"); });
  CheckCompression(json, to);
  to.extensions_unknown = ListUnknown(json);
  ReadLook(text, reader, to);
  to.files_read = reader.files_read();
  return to;
}

}  // namespace pelt::gltf
