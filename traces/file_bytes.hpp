// Whole files in and out, for logs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.hpp"

namespace pelt {

// Largest file that is read: more than any log that could be of use.
inline constexpr uint64_t kLogFileBytesLimit = uint64_t{8} << 30;

// `what` is for messages: "digest log 'a.digests': no such file".
std::optional<std::vector<std::byte>> TryReadFileBytes(std::string_view what,
                                                       const std::string& path, std::string& error);

// Written beside the target first and renamed onto it, so that a reader never sees half a file.
bool TryWriteFileBytes(std::string_view what, const std::string& path,
                       std::span<const std::byte> bytes, std::string& error);

#if defined(__cpp_exceptions)
// The same, throwing Error.
inline std::vector<std::byte> ReadFileBytes(std::string_view what, const std::string& path) {
  return ValueOrThrow([&](std::string& error) { return TryReadFileBytes(what, path, error); });
}
inline void WriteFileBytes(std::string_view what, const std::string& path,
                           std::span<const std::byte> bytes) {
  std::string error;
  if (!TryWriteFileBytes(what, path, bytes, error)) throw Error(error);
}
#endif

inline std::string_view AsText(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
inline std::span<const std::byte> AsBytes(std::string_view text) {
  return {reinterpret_cast<const std::byte*>(text.data()), text.size()};
}

}  // namespace pelt
