// Idea and invariant: see output_place.hpp.
#include "core/output_place.hpp"

#include <system_error>

#include "core/format.hpp"

#if !defined(_WIN32)
#include <unistd.h>
#endif

namespace pelt {
namespace {

namespace fs = std::filesystem;

constexpr int kMostLinks = 40;  // as Linux follows

bool MayWrite(const fs::path& path, std::error_code& code) {
#if defined(_WIN32)
  static_cast<void>(path);
  code.clear();
  return true;
#else
  if (access(path.c_str(), W_OK) == 0) return true;
  code = std::error_code(errno, std::generic_category());
  return false;
#endif
}

// Where the links at `path` lead, whose end is not there.
fs::path FollowLinks(fs::path path) {
  std::error_code code;
  for (int i = 0; i < kMostLinks && fs::is_symlink(fs::symlink_status(path, code)); ++i) {
    const fs::path to = fs::read_symlink(path, code);
    if (code) break;
    path = to.is_absolute() ? to : path.parent_path() / to;
  }
  return path;
}

fs::path FolderOf(const fs::path& path) {
  const fs::path folder = path.parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

std::string FindFolderFault(const fs::path& folder) {
  std::error_code code;
  const fs::file_status status = fs::status(folder, code);
  if (status.type() == fs::file_type::not_found)
    return Format("the folder '{}' is not there", folder.string());
  if (status.type() == fs::file_type::none) return code.message();
  if (!fs::is_directory(status)) return Format("'{}' is not a folder", folder.string());
  return {};
}

std::optional<OutputPlace> FindNewFile(const std::string& path, std::string& reason) {
  const fs::path end = FollowLinks(path);
  if (!end.has_filename()) reason = "there is no such folder";
  if (reason.empty()) reason = FindFolderFault(FolderOf(end));
  if (!reason.empty()) return std::nullopt;
  return OutputPlace{.path = end};
}

// The folder and name of what is not there, whichever way it is written.
bool WouldBeSameFile(const fs::path& a, const fs::path& b) {
  if (a.filename() != b.filename()) return false;
  std::error_code code;
  return fs::equivalent(FolderOf(a), FolderOf(b), code);
}

}  // namespace

std::string_view DescribeFileType(fs::file_type type) {
  switch (type) {
    case fs::file_type::directory:
      return "a folder";
    case fs::file_type::block:
    case fs::file_type::character:
      return "a device";
    case fs::file_type::fifo:
      return "a FIFO";
    case fs::file_type::socket:
      return "a socket";
    case fs::file_type::unknown:
      return "of an unknown kind";
    default:
      return {};
  }
}

std::optional<OutputPlace> FindOutputPlace(const std::string& path, std::string& reason) {
  reason.clear();
  std::error_code code;
  if (path.empty()) {
    reason = "the path is empty";
    return std::nullopt;
  }
  const fs::file_type type = fs::status(path, code).type();
  if (type == fs::file_type::not_found) return FindNewFile(path, reason);
  if (type == fs::file_type::none) {
    reason = code.message();
    return std::nullopt;
  }
  if (type == fs::file_type::directory || type == fs::file_type::socket) {
    reason = Format("{}, not a file", DescribeFileType(type));
    return std::nullopt;
  }
  if (!MayWrite(path, code)) {
    reason = Format("it may not be written: {}", code.message());
    return std::nullopt;
  }
  OutputPlace place{path, true, true, type == fs::file_type::fifo};
  if (type != fs::file_type::regular) return place;
  // An open file that has no name any more still has a path below /proc: written to as it stands.
  const fs::path real = fs::canonical(path, code);
  if (code || !fs::equivalent(real, path, code) || code) return place;
  return OutputPlace{.path = real, .is_there = true};
}

bool IsSameFile(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return false;
  std::error_code code;
  if (fs::exists(a, code) != fs::exists(b, code)) return false;
  if (!fs::exists(a, code)) return WouldBeSameFile(FollowLinks(a), FollowLinks(b));
  if (fs::equivalent(a, b, code) && !code) return true;
  // Not asked of devices and FIFOs by every library.
  const fs::path real_a = fs::canonical(a, code), real_b = fs::canonical(b, code);
  return !code && real_a == real_b;
}

}  // namespace pelt
