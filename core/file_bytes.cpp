// Idea and invariant: see file_bytes.hpp.
#include "core/file_bytes.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <system_error>

#include "core/format.hpp"
#include "core/output_place.hpp"

#if defined(_WIN32)
#include <process.h>
#else
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

namespace pelt {
namespace {

namespace fs = std::filesystem;

// A device may never end.
constexpr uint64_t kDeviceBytesLimit = 64u << 20;
// Most file systems' limit of one name.
constexpr size_t kNameBytesLimit = 255;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

std::string Reason(int error) { return std::error_code(error, std::generic_category()).message(); }

// ---- What the system has for it -----------------------------------------------------------------

#if defined(_WIN32)
int ProcessId() { return _getpid(); }
File OpenNew(const fs::path& path, const OutputPlace&) {
  return File(std::fopen(path.string().c_str(), "wb"));
}
File OpenDirect(const fs::path& path) { return File(std::fopen(path.string().c_str(), "wb")); }
void CopyOwnerAndMode(const OutputPlace&, std::FILE*) {}
#else
int ProcessId() { return getpid(); }

File Open(const fs::path& path, int flags, mode_t mode = 0) {
  const int descriptor = open(path.c_str(), flags | O_WRONLY | O_CLOEXEC | O_NOCTTY, mode);
  return File(descriptor < 0 ? nullptr : fdopen(descriptor, "wb"));
}

// Until what replaces a file has that file's mode, only its owner can read it.
File OpenNew(const fs::path& path, const OutputPlace& place) {
  return Open(path, O_CREAT | O_EXCL, place.is_there ? 0600 : 0666);
}
File OpenDirect(const fs::path& path) { return Open(path, O_TRUNC); }

// As far as they may be given: the owner is only root's to give.
void CopyOwnerAndMode(const OutputPlace& place, std::FILE* file) {
  struct stat old {};
  if (!place.is_there || stat(place.path.c_str(), &old) != 0) return;
  const int descriptor = fileno(file);
  const bool owned = fchown(descriptor, old.st_uid, old.st_gid) == 0 ||
                     fchown(descriptor, uid_t(-1), old.st_gid) == 0;
  // Another group must not get what this one was given.
  fchmod(descriptor, old.st_mode & (owned ? 0777 : 0707));
}
#endif

// ---- The partial file ---------------------------------------------------------------------------

// "NAME.PID.N.partial", NAME cut where that is too long, but not inside a character.
std::string PartialName(const std::string& name, const std::string& ending) {
  size_t kept = std::min(name.size(), kNameBytesLimit - ending.size());
  while (kept < name.size() && kept > 0 && (uint8_t(name[kept]) & 0xc0) == 0x80) --kept;
  return name.substr(0, kept) + ending;
}

struct Partial {
  File file;
  fs::path path;
};

// Beside the place, so that renaming does not copy. Without a file: errno has the reason.
Partial OpenPartial(const OutputPlace& place) {
  static std::atomic<uint32_t> count{0};
  std::string name = place.path.filename().string();
  Partial partial;
  for (int i = 0; i < 1000; ++i) {
    const std::string ending = Format(".{}.{}.partial", ProcessId(), count++);
    partial.path = place.path.parent_path() / PartialName(name, ending);
    partial.file = OpenNew(partial.path, place);
    if (!partial.file && errno == ENAMETOOLONG && !name.empty())
      name.clear();  // a shorter limit than most: the ending alone
    else if (partial.file || errno != EEXIST)
      break;
  }
  return partial;
}

bool WriteAndClose(File file, std::span<const std::byte> bytes) {
  errno = 0;
  const bool wrote = std::fwrite(bytes.data(), 1, bytes.size(), file.get()) == bytes.size() &&
                     std::fflush(file.get()) == 0;
  const int reason = errno;
  const bool closed = std::fclose(file.release()) == 0;
  if (!wrote) errno = reason;
  return wrote && closed;
}

std::string DescribeOpenFault(const OutputPlace& place, int error) {
  const fs::path folder = place.path.parent_path();
  return Format("nothing can be written to the folder '{}': {}",
                folder.empty() ? "." : folder.string(), Reason(error));
}

// Empty, or the reason.
std::string Replace(const OutputPlace& place, std::span<const std::byte> bytes) {
  Partial partial = OpenPartial(place);
  if (!partial.file) return DescribeOpenFault(place, errno);
  CopyOwnerAndMode(place, partial.file.get());
  std::error_code code;
  if (!WriteAndClose(std::move(partial.file), bytes)) {
    const std::string reason = Reason(errno);
    fs::remove(partial.path, code);
    return "cannot be written: " + reason;
  }
  fs::rename(partial.path, place.path, code);
  if (!code) return {};
  return Format("cannot be put in place: {}; it is whole in '{}'", code.message(),
                partial.path.string());
}

std::string WriteDirect(const OutputPlace& place, std::span<const std::byte> bytes) {
  File file = OpenDirect(place.path);
  if (!file) return "cannot be opened: " + Reason(errno);
  if (!WriteAndClose(std::move(file), bytes)) return "cannot be written: " + Reason(errno);
  return {};
}

std::string Named(std::string_view what, const std::string& path, std::string_view reason) {
  return Printable(Format("{} '{}': {}", what, path, reason));
}

// ---- Reading ------------------------------------------------------------------------------------

// The bytes of an open file of which `expected` are foreseen.
Result<std::vector<std::byte>> ReadOpen(std::FILE* file, uint64_t expected, uint64_t limit) {
  std::vector<std::byte> bytes(size_t(std::min(expected, limit)) + 1);
  size_t size = 0;
  while (const size_t got = std::fread(bytes.data() + size, 1, bytes.size() - size, file)) {
    size += got;
    if (size > limit) return Failure{Format("larger than {} bytes", limit)};
    if (size == bytes.size()) bytes.resize(std::max<size_t>(2 * size, 65536));
  }
  if (std::ferror(file)) return Failure{"cannot be read: " + Reason(errno)};
  bytes.resize(size);
  return bytes;
}

Result<> NamedUnlessEmpty(std::string_view what, const std::string& path,
                          const std::string& reason) {
  if (!reason.empty()) return Failure{Named(what, path, reason)};
  return Done{};
}

}  // namespace

Result<std::vector<std::byte>> ReadWhole(const std::string& path, uint64_t bytes_limit) {
  std::error_code code;
  const fs::file_type type = fs::status(path, code).type();
  if (type == fs::file_type::not_found)
    return Failure{fs::is_symlink(fs::symlink_status(path, code)) ? "a link to what is not there"
                                                                  : "no such file"};
  if (type == fs::file_type::none) return Failure{code.message()};
  if (type == fs::file_type::directory || type == fs::file_type::socket)
    return Failure{Format("{}, not a file", DescribeFileType(type))};
  uint64_t expected = 0;
  if (type == fs::file_type::regular) {
    expected = fs::file_size(path, code);
    if (!code && expected > bytes_limit)
      return Failure{Format("larger than {} bytes", bytes_limit)};
  } else if (type != fs::file_type::fifo) {
    bytes_limit = std::min(bytes_limit, kDeviceBytesLimit);
  }
  const File file(std::fopen(path.c_str(), "rb"));
  if (!file) return Failure{"cannot be opened: " + Reason(errno)};
  return ReadOpen(file.get(), expected, bytes_limit);
}

Result<std::vector<std::byte>> ReadToEnd(std::FILE* file, uint64_t bytes_limit) {
  return ReadOpen(file, 0, bytes_limit);
}

Result<std::vector<std::byte>> ReadFileBytes(std::string_view what, const std::string& path,
                                             uint64_t bytes_limit) {
  Result<std::vector<std::byte>> bytes = ReadWhole(path, bytes_limit);
  if (!bytes) return Failure{Named(what, path, bytes.error())};
  return bytes;
}

Result<> WriteFileBytes(std::string_view what, const std::string& path,
                        std::span<const std::byte> bytes) {
  std::string reason;
  if (const auto place = FindOutputPlace(path, reason))
    reason = place->direct ? WriteDirect(*place, bytes) : Replace(*place, bytes);
  return NamedUnlessEmpty(what, path, reason);
}

bool IsThere(const std::string& path) {
  std::error_code error;
  return fs::exists(path, error);
}

std::string WhyNoFile(const std::string& path) {
  std::error_code error;
  const fs::file_type type = fs::status(path, error).type();
  if (type == fs::file_type::regular) return {};
  const std::string_view found = DescribeFileType(type);
  return (found.empty() ? "nothing there" : std::string(found)) + ", not a file";
}

std::string FolderOf(const std::string& path) { return fs::path(path).parent_path().string(); }
std::string InFolder(const std::string& folder, const std::string& name) {
  return (fs::path(folder) / name).string();
}
std::string StemOf(const std::string& path) { return fs::path(path).stem().string(); }

Result<> TryOutput(std::string_view what, const std::string& path) {
  std::string reason;
  const auto place = FindOutputPlace(path, reason);
  if (place && !place->direct) {
    Partial partial = OpenPartial(*place);
    if (!partial.file) reason = DescribeOpenFault(*place, errno);
    std::error_code code;
    if (partial.file) fs::remove(partial.path, code);
  }
  return NamedUnlessEmpty(what, path, reason);
}

}  // namespace pelt
