// The one file that sees tinygltf. It turns the library's model into plain data and every way of
// failing into one Error.
//
// What breaks if ignored: tinygltf is not safe on hostile JSON by itself (see gltf_json_guard.hpp),
// it drops primitives it cannot parse and goes on, and it looks for missing buffers in the working
// directory. All three are caught here.
#include "core/character/gltf_document.hpp"

#include <algorithm>
#include <cstring>

#include "core/character/gltf_json_guard.hpp"
#include "core/character/gltf_look.hpp"
#include "core/error.hpp"
#include "core/file_bytes.hpp"
#include "core/format.hpp"
#include "core/printable.hpp"

// The distribution's library holds the implementation (define PELT_TINYGLTF_HEADER_ONLY where
// tinygltf is headers alone).
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#ifdef PELT_TINYGLTF_HEADER_ONLY
#define TINYGLTF_IMPLEMENTATION
#endif
#include <tiny_gltf.h>

namespace pelt::gltf {
namespace {

constexpr uint64_t kMaxExternalBytes = 1ull << 30;

// What the library may read: regular files below one folder, up to a total size.
struct BufferFolder {
  std::string folder;
  uint64_t bytes_left = kMaxExternalBytes;
  std::vector<std::string> read = {};
};

bool BufferFileExists(const std::string& path, void* user) {
  const BufferFolder& from = *static_cast<const BufferFolder*>(user);
  if (from.folder.empty() || path.compare(0, from.folder.size(), from.folder) != 0) return false;
  return IsThere(path);
}

bool ReadBufferFile(std::vector<unsigned char>* out, std::string* reason, const std::string& path,
                    void* user) {
  BufferFolder& from = *static_cast<BufferFolder*>(user);
  // Whoever made the file must not make us wait for a FIFO.
  *reason = WhyNoFile(path);
  if (!reason->empty()) return false;
  const auto bytes = ReadWhole(path, from.bytes_left);
  if (!bytes) {
    *reason = bytes.error();
    return false;
  }
  from.bytes_left -= bytes->size();
  from.read.push_back(path);
  const auto* data = reinterpret_cast<const unsigned char*>(bytes->data());
  out->assign(data, data + bytes->size());
  return true;
}

std::string SamePath(const std::string& path, void*) { return path; }

bool SkipImage(tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*,
               int, void*) {
  return true;
}

uint32_t ReadU32(const unsigned char* p) {
  return uint32_t(p[0]) | uint32_t(p[1]) << 8 | uint32_t(p[2]) << 16 | uint32_t(p[3]) << 24;
}

bool IsGlb(std::span<const unsigned char> file) {
  return file.size() >= 4 && std::memcmp(file.data(), "glTF", 4) == 0;
}

// The JSON text inside the file. Checks the GLB frame itself: its messages have byte offsets.
template <class Byte>  // unsigned char, const or not
std::span<Byte> FindJson(std::span<Byte> file, const std::string& name) {
  if (!IsGlb(file)) return file;
  auto fail = [&name](const std::string& what) { throw Error(name + ": " + what); };
  if (file.size() < 20)
    fail("truncated: a GLB starts with 20 bytes of header, the file has " +
         std::to_string(file.size()));
  const uint32_t version = ReadU32(&file[4]), length = ReadU32(&file[8]);
  const uint32_t json_length = ReadU32(&file[12]);
  if (version != 2) fail("byte 4: GLB version " + std::to_string(version) + ", only 2 is known");
  if (length > file.size())
    fail("truncated: the header says " + std::to_string(length) + " bytes, the file has " +
         std::to_string(file.size()));
  if (ReadU32(&file[16]) != 0x4e4f534a) fail("byte 16: the first chunk is not JSON");
  if (uint64_t(json_length) + 20 > length)
    fail("byte 12: the JSON chunk of " + std::to_string(json_length) +
         " bytes reaches past the end of the file");
  return file.subspan(20, json_length);
}

// Lines the library reports although the file is fine.
std::string DropHarmless(std::string errors) {
  static const std::string kNoInverseBind = "'inverseBindMatrices' property is missing in Skin.\n";
  for (size_t at; (at = errors.find(kNoInverseBind)) != std::string::npos;)
    errors.erase(at, kNoInverseBind.size());
  while (!errors.empty() && errors.back() == '\n') errors.pop_back();
  for (char& c : errors)
    if (c == '\n') c = ' ';
  return errors;
}

// Extensions without which the accessors mean something else.
constexpr std::string_view kUnreadable[] = {"KHR_draco_mesh_compression", "EXT_meshopt_compression",
                                            "KHR_meshopt_compression"};
// Of materials, lights and pictures, none of which is looked at; or read as plain glTF.
constexpr std::string_view kHarmless[] = {"KHR_materials_", "KHR_lights_", "KHR_texture_",
                                          "EXT_texture_", "KHR_mesh_quantization"};

// A file that needs an extension is refused in its name: what the library stumbles over, views and
// accessors without content, follows from it. Where the file could be read without, only `failed`.
void CheckExtensions(const tinygltf::Model& model, const std::string& name, bool failed) {
  const auto check = [&](const std::vector<std::string>& extensions, std::string_view member) {
    for (const std::string& extension : extensions)
      for (std::string_view unreadable : kUnreadable)
        if (extension == unreadable)
          throw Error(Format("{}: {}: {} is not supported; export without compression", name,
                             member, extension));
  };
  check(model.extensionsRequired, "extensionsRequired");
  if (failed) check(model.extensionsUsed, "extensionsUsed");
}

// The other extensions that the file says it cannot do without.
std::vector<std::string> ListUnknown(const tinygltf::Model& model) {
  std::vector<std::string> unknown;
  for (const std::string& extension : model.extensionsRequired)
    if (std::none_of(std::begin(kHarmless), std::end(kHarmless),
                     [&](std::string_view known) { return extension.starts_with(known); }))
      unknown.push_back(Printable(extension));
  return unknown;
}

tinygltf::Model ParseModel(std::span<unsigned char> file, const std::string& name,
                           BufferFolder& from) {
  const std::string& folder = from.folder;
  if (file.empty()) throw Error(name + ": the file is empty");
  if (file.size() > 0xffffffffull) throw Error(name + ": larger than 4 GiB");
  const std::span<unsigned char> json = FindJson(file, name);
  const std::string reason = GuardJson({reinterpret_cast<char*>(json.data()), json.size()});
  if (!reason.empty()) throw Error(name + ": " + reason);

  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(SkipImage, nullptr);
  loader.SetFsCallbacks({BufferFileExists, SamePath, ReadBufferFile, nullptr, &from});
  tinygltf::Model model;
  std::string errors, warnings;
  bool read = false;
  try {
    read = IsGlb(file) ? loader.LoadBinaryFromMemory(&model, &errors, &warnings, file.data(),
                                                     unsigned(file.size()), folder)
                       : loader.LoadASCIIFromString(&model, &errors, &warnings,
                                                    reinterpret_cast<const char*>(file.data()),
                                                    unsigned(file.size()), folder);
  } catch (const std::exception& e) {
    throw Error(name + ": not readable as glTF: " + Printable(e.what()));
  }
  errors = DropHarmless(errors);
  const bool failed = !read || !errors.empty();
  CheckExtensions(model, name, failed);
  if (failed) {
    std::string reason = errors.empty() ? std::string("no reason given") : Printable(errors);
    for (const std::string& extension : ListUnknown(model))
      reason += "; it requires " + extension + ", which is not supported";
    throw Error(name + ": not readable as glTF: " + reason);
  }
  if (model.asset.version.compare(0, 2, "2.") != 0)
    throw Error(name + ": asset.version is \"" + Printable(model.asset.version) +
                "\", only 2.x is known");
  return model;
}

Accessor Convert(const tinygltf::Accessor& from) {
  Accessor to;
  to.view = from.bufferView;
  to.offset = from.byteOffset;
  to.count = from.count;
  to.component = from.componentType;
  to.normalised = from.normalized;
  to.matrix = from.type == TINYGLTF_TYPE_MAT2 || from.type == TINYGLTF_TYPE_MAT3 ||
              from.type == TINYGLTF_TYPE_MAT4;
  to.components = tinygltf::GetNumComponentsInType(uint32_t(from.type));
  to.sparse.used = from.sparse.isSparse;
  if (to.sparse.used) {
    to.sparse.count = from.sparse.count;
    to.sparse.index_view = from.sparse.indices.bufferView;
    to.sparse.index_offset = from.sparse.indices.byteOffset;
    to.sparse.index_component = from.sparse.indices.componentType;
    to.sparse.value_view = from.sparse.values.bufferView;
    to.sparse.value_offset = from.sparse.values.byteOffset;
  }
  return to;
}

MeshDesc Convert(const tinygltf::Mesh& from) {
  MeshDesc to;
  to.name = Printable(from.name);
  for (const tinygltf::Primitive& p : from.primitives)
    to.primitives.push_back({p.attributes, p.indices, p.material, p.mode, !p.targets.empty()});
  return to;
}

Animation Convert(const tinygltf::Animation& from) {
  Animation to;
  to.name = Printable(from.name);
  for (const tinygltf::AnimationSampler& s : from.samplers)
    to.samplers.push_back({s.input, s.output, s.interpolation});
  for (const tinygltf::AnimationChannel& c : from.channels)
    to.channels.push_back({c.sampler, c.target_node, c.target_path});
  return to;
}

int HexDigit(char c) {
  const char low = char(c | 0x20);
  return c >= '0' && c <= '9' ? c - '0' : low >= 'a' && low <= 'f' ? low - 'a' + 10 : -1;
}

// A % that no two digits follow stays (RFC 3986, 2.1).
std::string DecodePercent(std::string_view text) {
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    const bool coded = i + 2 < text.size() && text[i] == '%' && HexDigit(text[i + 1]) >= 0 &&
                       HexDigit(text[i + 2]) >= 0;
    out += coded ? char(16 * HexDigit(text[i + 1]) + HexDigit(text[i + 2])) : text[i];
    i += coded ? 2 : 0;
  }
  return out;
}

// Of any media type, which the library is choosy about.
std::vector<unsigned char> DecodeData(const std::string& uri, std::string& fault) {
  static constexpr std::string_view kBase64 = ";base64,", kKnown = "data:text/plain;base64,";
  std::vector<unsigned char> bytes;
  std::string type;
  const size_t at = uri.find(kBase64);
  if (at > uri.find(',') ||
      !tinygltf::DecodeDataURI(
          &bytes, type,
          std::string(kKnown) + DecodePercent(std::string_view(uri).substr(at + kBase64.size())), 0,
          false))
    fault = "not in base64";
  return bytes;
}

// Of files beside the glTF file, under the rules of its buffers, and of what the text itself holds.
ImageReader MakeImageReader(BufferFolder& from) {
  return [&from](const std::string& uri, std::string& fault) -> std::vector<unsigned char> {
    if (uri.starts_with("data:")) return DecodeData(uri, fault);
    std::vector<unsigned char> bytes;
    // Some tools write a name as it is, with % in it.
    const std::string decoded = DecodePercent(uri);
    const std::string& name = IsThere(from.folder + "/" + uri) ? uri : decoded;
    if (from.folder.empty())
      fault = "no folder to look for it";
    else if (("/" + name + "/").find("/../") != std::string::npos || name.starts_with('/') ||
             name.find(':') != std::string::npos || name.find('\0') != std::string::npos)
      fault = "not below the file's folder";
    else
      ReadBufferFile(&bytes, &fault, from.folder + "/" + name, &from);
    return bytes;
  };
}

}  // namespace

Document ParseDocument(std::span<const std::byte> bytes, const std::string& name,
                       const std::string& folder) {
  const unsigned char* first = reinterpret_cast<const unsigned char*>(bytes.data());
  std::vector<unsigned char> file(first, first + bytes.size());  // the guard masks in place
  BufferFolder from{folder};
  tinygltf::Model model = ParseModel(file, name, from);

  Document to;
  to.name = name;
  to.file_bytes = bytes.size();
  for (tinygltf::Buffer& b : model.buffers) {
    to.file_bytes += b.data.size();
    to.buffers.push_back(std::move(b.data));
  }
  for (const tinygltf::BufferView& v : model.bufferViews)
    to.views.push_back({v.buffer, v.byteOffset, v.byteLength, v.byteStride});
  for (const tinygltf::Accessor& a : model.accessors) to.accessors.push_back(Convert(a));
  for (const tinygltf::Mesh& m : model.meshes) to.meshes.push_back(Convert(m));
  for (const tinygltf::Node& n : model.nodes)
    to.nodes.push_back({Printable(n.name), n.children, n.mesh, n.skin, n.matrix, n.translation,
                        n.rotation, n.scale});
  for (const tinygltf::Skin& s : model.skins)
    to.skins.push_back({Printable(s.name), s.joints, s.inverseBindMatrices});
  for (const tinygltf::Animation& a : model.animations) to.animations.push_back(Convert(a));
  for (const tinygltf::Material& m : model.materials) to.materials.push_back(Printable(m.name));
  to.extensions_unknown = ListUnknown(model);
  const std::span<const unsigned char> json =
      FindJson(std::span<const unsigned char>(first, bytes.size()), name);
  ReadLook({reinterpret_cast<const char*>(json.data()), json.size()}, MakeImageReader(from), to);
  to.files_read = std::move(from.read);
  return to;
}

}  // namespace pelt::gltf
