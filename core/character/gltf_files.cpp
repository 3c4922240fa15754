// The files of a glTF. Sources: glTF 2.0, 4.4 (GLB); RFC 2397 (data:), RFC 3986 (percent).
#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>

#include "core/character/gltf_parse.hpp"
#include "core/error.hpp"
#include "core/file_bytes.hpp"
#include "core/format.hpp"

namespace pelt::gltf {
namespace {

constexpr std::string_view kToGltf = "save it as glTF 2.0 (.glb), as Blender does";

struct Lookalike {
  std::string_view start, name;
};
// Texts are looked for without regard to case and behind leading blanks.
constexpr Lookalike kTexts[] = {
    {"version https://git-lfs", "a Git LFS pointer, not the file itself; fetch it (git lfs pull)"},
    {"<!doctype html", "an HTML page, not a model; the download went wrong"},
    {"<html", "an HTML page, not a model; the download went wrong"},
    {"; fbx", "an FBX file"},
    {"solid ", "an STL file"},
    {"ply\n", "a PLY file"},
    {"ply\r", "a PLY file"},
    {"#usda", "a USD file"},
    {"#vrml", "a VRML file"},
    {"xof 0", "a DirectX file"}};
constexpr Lookalike kBytes[] = {{"Kaydara FBX Binary", "an FBX file"},
                                {"PK\3\4", "a zip archive (or .usdz); unpack it"},
                                {"\x1f\x8b", "compressed with gzip; unpack it"},
                                {"\x28\xb5\x2f\xfd", "compressed with Zstandard; unpack it"},
                                {"7z\xbc\xaf", "a 7z archive; unpack it"},
                                {"Rar!", "a RAR archive; unpack it"},
                                {"BLENDER", "a Blender file"},
                                {"PXR-USDC", "a USD file"},
                                {"DRACO", "a Draco file"},
                                {"\x89PNG", "a PNG image"},
                                {"\xff\xd8\xff", "a JPEG image"},
                                {"GIF8", "a GIF image"},
                                {"\xabKTX", "a KTX image"},
                                {"%PDF", "a PDF document"},
                                {"\x7f"
                                 "ELF",
                                 "a program"},
                                {"\xff\xfe", "text in UTF-16; save it as UTF-8"},
                                {"\xfe\xff", "text in UTF-16; save it as UTF-8"}};

char Lower(char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; }
bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

std::string_view TextOf(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Behind a byte order mark and blanks.
std::string_view SkipToText(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  while (!text.empty() && IsBlank(text.front())) text.remove_prefix(1);
  return text;
}

bool StartsLike(std::string_view text, std::string_view start) {
  return text.size() >= start.size() && std::equal(start.begin(), start.end(), text.begin(),
                                                   [](char a, char b) { return a == Lower(b); });
}

// Lines of an OBJ begin with a keyword; one of the first is a vertex, or its library of materials.
bool IsObj(std::string_view text) {
  text = text.substr(0, 64 * 1024);
  for (size_t line = 0; line < 1000 && !text.empty(); ++line) {
    const size_t end = std::min(text.find('\n'), text.size() - 1);
    if (text.starts_with("v ") || text.starts_with("mtllib ")) return true;
    const bool other = text[0] == '#' || text[0] == '\r' || text[0] == '\n' ||
                       text.starts_with("o ") || text.starts_with("g ");
    if (!other) return false;
    text.remove_prefix(end + 1);
  }
  return false;
}

std::string NameXml(std::string_view text) {
  const std::string_view head = text.substr(0, 1024);
  if (head.find("<COLLADA") != head.npos) return "a COLLADA file";
  if (head.find("<html") != head.npos) return "an HTML page, not a model; the download went wrong";
  return "XML";
}

// What stands in for a file that was not fetched: "a Git LFS pointer, ..."; else nothing.
std::string NameStandIn(std::span<const std::byte> bytes) {
  for (const Lookalike& other : std::span(kTexts).first(3))
    if (StartsLike(SkipToText(TextOf(bytes)), other.start)) return std::string(other.name);
  return {};
}

std::string NameLookalike(std::span<const std::byte> file) {
  const std::string_view bytes = TextOf(file), text = SkipToText(bytes);
  if (bytes.empty()) return "empty";
  if (std::string stand_in = NameStandIn(file); !stand_in.empty()) return stand_in;
  for (const Lookalike& other : kBytes)
    if (bytes.starts_with(other.start)) return std::string(other.name);
  if (bytes.starts_with("RIFF") && bytes.substr(0, 12).ends_with("WEBP")) return "a WebP image";
  for (const Lookalike& other : kTexts)
    if (StartsLike(text, other.start)) return std::string(other.name);
  if (StartsLike(text, "<?xml") || StartsLike(text, "<collada")) return NameXml(text);
  if (IsObj(text)) return "an OBJ file, which has no skin";
  if (std::all_of(bytes.begin(), bytes.end(), [](char c) { return c == 0; }))
    return "nothing but zeros";
  return {};
}

uint32_t ReadU32(std::span<const std::byte> file, uint64_t at) {
  uint32_t v = 0;
  for (uint64_t i = 0; i < 4; ++i) v |= uint32_t(file[at + i]) << (8 * i);
  return v;
}

int HexDigit(char c) {
  const char low = Lower(c);
  if (c >= '0' && c <= '9') return c - '0';
  return low >= 'a' && low <= 'f' ? low - 'a' + 10 : -1;
}

// A % that no two digits follow stays.
std::string DecodePercent(std::string_view text) {
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    const int high = i + 2 < text.size() && text[i] == '%' ? HexDigit(text[i + 1]) : -1;
    const int low = high >= 0 ? HexDigit(text[i + 2]) : -1;
    out += low >= 0 ? char(16 * high + low) : text[i];
    if (low >= 0) i += 2;
  }
  return out;
}

constexpr std::array<int8_t, 256> MakeDigits() {
  std::array<int8_t, 256> value{};
  value.fill(-1);
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (size_t i = 0; i < kDigits.size(); ++i) value[uint8_t(kDigits[i])] = int8_t(i);
  value[uint8_t('-')] = 62;  // as URLs have them
  value[uint8_t('_')] = 63;
  return value;
}

// Blanks are skipped; ends at the first '='. False for what is no base64.
bool DecodeBase64(std::string_view text, std::vector<unsigned char>& out) {
  static constexpr std::array<int8_t, 256> kValue = MakeDigits();
  out.reserve(text.size() / 4 * 3 + 3);
  uint32_t group = 0, bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    if (IsBlank(c)) continue;
    const int value = kValue[uint8_t(c)];
    if (value < 0) return false;
    group = group << 6 | uint32_t(value);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    out.push_back(uint8_t(group >> bits));
  }
  return true;
}

std::vector<unsigned char> ReadData(std::string_view uri, std::string& fault) {
  std::vector<unsigned char> out;
  const size_t comma = uri.find(',');
  if (comma == uri.npos) {
    fault = "a data: URI without a comma";
    return out;
  }
  const std::string content = DecodePercent(uri.substr(comma + 1));
  std::string kind;
  for (const char c : uri.substr(0, comma)) kind += Lower(c);
  if (!kind.ends_with(";base64")) {
    out.assign(content.begin(), content.end());
  } else if (!DecodeBase64(content, out)) {
    fault = "not in base64, as it says";
    out.clear();
  }
  return out;
}

bool LeavesFolder(const std::string& path) {
  if (path.starts_with('/') || path.starts_with('\\')) return true;
  if (path.find(':') != path.npos || path.find('\0') != path.npos) return true;
  for (size_t at = 0; at <= path.size();) {
    const size_t end = std::min(path.find_first_of("/\\", at), path.size());
    if (path.substr(at, end - at) == "..") return true;
    at = end + 1;
  }
  return false;
}

}  // namespace

Parts FindParts(std::span<const std::byte> file, const std::string& name) {
  const auto fail = [&name](const std::string& what) { throw Error(name + ": " + what); };
  if (file.size() > 0xffffffffull) fail("larger than 4 GiB");
  if (!TextOf(file).starts_with("glTF")) {
    const std::string other = NameLookalike(file);
    const bool says_how = other.find(';') != other.npos;
    if (other == "empty") fail("the file is empty");
    if (!other.empty())
      fail(says_how ? Format("no glTF but {}", other)
                    : Format("no glTF but {}; {}", other, kToGltf));
    return {TextOf(file), {}, false};
  }
  if (file.size() < 20)
    fail(Format("truncated: a GLB starts with 20 bytes of header, the file has {}", file.size()));
  const uint32_t version = ReadU32(file, 4), json_bytes = ReadU32(file, 12);
  if (version != 2) fail(Format("byte 4: GLB version {}, only 2 is known", version));
  if (ReadU32(file, 16) != 0x4e4f534a) fail("byte 16: the first chunk is not JSON");
  // The length that the header says is not looked at: whether the chunks are there is what counts.
  uint64_t at = 20 + uint64_t(json_bytes);
  if (at > file.size())
    fail(
        Format("truncated: byte 12: the JSON chunk of {} bytes reaches past the end of the file, "
               "which has {}",
               json_bytes, file.size()));
  Parts parts{TextOf(file.subspan(20, json_bytes)), {}, false};
  while (at + 8 <= file.size() && !parts.has_binary) {
    const uint64_t bytes = ReadU32(file, at);
    const bool is_binary = ReadU32(file, at + 4) == 0x004e4942;
    if (is_binary && bytes > file.size() - at - 8)
      fail(Format("truncated: the binary chunk at byte {} has {} bytes, the file ends after {}", at,
                  bytes, file.size() - at - 8));
    if (is_binary) parts = {parts.json, file.subspan(at + 8, bytes), true};
    at += 8 + (bytes + 3) / 4 * 4;
  }
  return parts;
}

std::vector<unsigned char> UriReader::Read(const std::string& uri, std::string& fault) {
  if (StartsLike(uri, "data:")) return ReadData(uri, fault);
  if (folder_.empty()) {
    fault = "no folder to look for it";
    return {};
  }
  // Some tools write a name as it is, with % in it.
  const std::string decoded = DecodePercent(uri);
  const std::string& name = IsThere(folder_ + "/" + uri) ? uri : decoded;
  if (LeavesFolder(name)) {
    fault = "not below the file's folder";
    return {};
  }
  return ReadFile(folder_ + "/" + name, fault);
}

std::vector<unsigned char> UriReader::ReadFile(const std::string& path, std::string& fault) {
  fault = WhyNoFile(path);
  if (!fault.empty()) return {};
  const auto bytes = ReadWhole(path, bytes_left_);
  if (!bytes) {
    fault = bytes.error();
    return {};
  }
  bytes_left_ -= bytes->size();
  files_read_.push_back(path);
  fault = NameStandIn(*bytes);
  const auto* data = reinterpret_cast<const unsigned char*>(bytes->data());
  return {data, data + bytes->size()};
}

}  // namespace pelt::gltf
