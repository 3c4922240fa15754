// core/file_bytes.hpp where there is no file system: WebAssembly.
#include <map>

#include "core/file_bytes.hpp"
#include "core/format.hpp"

namespace pelt {
namespace {

constexpr std::string_view kNoPlace = "there are no files here to write to";

std::map<std::string, std::vector<std::byte>>& Files() {
  static std::map<std::string, std::vector<std::byte>> files;
  return files;
}

// Of a path without its folders.
size_t NameAt(const std::string& path) {
  const size_t slash = path.rfind('/');
  return slash == path.npos ? 0 : slash + 1;
}

Failure Named(std::string_view what, const std::string& path, std::string_view reason) {
  return Failure{Printable(Format("{} '{}': {}", what, path, reason))};
}

}  // namespace

void GiveFile(const std::string& path, std::vector<std::byte> bytes) {
  Files()[path] = std::move(bytes);
}

Result<std::vector<std::byte>> ReadWhole(const std::string& path, uint64_t bytes_limit) {
  const auto found = Files().find(path);
  if (found == Files().end()) return Failure{"no such file was given"};
  if (found->second.size() > bytes_limit)
    return Failure{Format("{} bytes, more than {}", found->second.size(), bytes_limit)};
  return found->second;
}

Result<std::vector<std::byte>> ReadToEnd(std::FILE*, uint64_t) {
  return Failure{"there are no open files here"};
}

Result<std::vector<std::byte>> ReadFileBytes(std::string_view what, const std::string& path,
                                             uint64_t bytes_limit) {
  auto bytes = ReadWhole(path, bytes_limit);
  if (!bytes) return Named(what, path, bytes.error());
  return bytes;
}

Result<> WriteFileBytes(std::string_view what, const std::string& path,
                        std::span<const std::byte>) {
  return Named(what, path, kNoPlace);
}

Result<> TryOutput(std::string_view what, const std::string& path) {
  return Named(what, path, kNoPlace);
}

bool IsThere(const std::string& path) { return Files().contains(path); }

std::string WhyNoFile(const std::string& path) {
  return IsThere(path) ? std::string() : "nothing there, not a file";
}

std::string FolderOf(const std::string& path) {
  const size_t name = NameAt(path);
  return path.substr(0, name > 1 ? name - 1 : name);
}

std::string InFolder(const std::string& folder, const std::string& name) {
  return folder.empty() || name.starts_with('/') ? name : folder + '/' + name;
}

std::string StemOf(const std::string& path) {
  const std::string name = path.substr(NameAt(path));
  const size_t dot = name.rfind('.');
  return dot == name.npos || dot == 0 ? name : name.substr(0, dot);
}

}  // namespace pelt
