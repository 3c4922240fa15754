#include "traces/file_bytes.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "core/format.hpp"

namespace pelt {

std::optional<std::vector<std::byte>> TryReadFileBytes(std::string_view what,
                                                       const std::string& path,
                                                       std::string& error) {
  const auto fail = [&](const std::string& reason) {
    error = Format("{} '{}': {}", what, path, reason);
    return std::nullopt;
  };
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code)) return fail("no such file");
  const uintmax_t size = std::filesystem::file_size(path, code);
  if (code || size > kLogFileBytesLimit)
    return fail(Format("larger than {} bytes", kLogFileBytesLimit));
  std::vector<std::byte> bytes(size);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(size));
  if (!file) return fail("cannot be read");
  return bytes;
}

bool TryWriteFileBytes(std::string_view what, const std::string& path,
                       std::span<const std::byte> bytes, std::string& error) {
  const std::string partial = Format("{}.{}.partial", path, getpid());
  std::error_code code;
  const auto fail = [&](const std::string& reason) {
    error = Format("{} '{}': {}", what, path, reason);
    std::filesystem::remove(partial, code);
    return false;
  };
  {
    std::ofstream file(partial, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    file.close();
    if (!file) return fail("cannot be written there; is the folder there, writable and not full?");
  }
  std::filesystem::rename(partial, path, code);
  if (code) return fail("cannot be put in place: " + code.message());
  return true;
}

}  // namespace pelt
