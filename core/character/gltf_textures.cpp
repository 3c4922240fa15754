// Idea and invariant: see gltf_textures.hpp. Source: glTF 2.0, 3.8 (textures).
#include "core/character/gltf_textures.hpp"

#include <algorithm>

#include "core/character/picture_kind.hpp"
#include "core/format.hpp"
#include "core/printable.hpp"

namespace pelt::gltf {
namespace {

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

}  // namespace

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
  std::vector<unsigned char> bytes = read_(uri, fault);
  // Exporters of another system write its separators.
  if (!fault.empty() && !uri.starts_with("data:") && uri.find('\\') != uri.npos) {
    std::string path = uri, fault_of_path;
    std::ranges::replace(path, '\\', '/');
    bytes = read_(path, fault_of_path);
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

}  // namespace pelt::gltf
