// Whole files in and out. This is the one place that opens a file to write it: what it does with
// links, devices, modes and full disks then holds for every output there is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.hpp"

namespace pelt {

// Largest file that is read: more than any groom or log that could be of use.
inline constexpr uint64_t kFileBytesLimit = uint64_t{8} << 30;

// All bytes of a file, or of a FIFO until its writer closes it. The reason of a failure does not
// name the file: "no such file", "a folder, not a file".
Result<std::vector<std::byte>> ReadWhole(const std::string& path, uint64_t bytes_limit);

// The same of what is open.
Result<std::vector<std::byte>> ReadToEnd(std::FILE* file, uint64_t bytes_limit);

// `what` is for messages: "digest log 'a.digests': no such file". More than the limit is not read
// and then refused: it is not read.
Result<std::vector<std::byte>> ReadFileBytes(std::string_view what, const std::string& path,
                                             uint64_t bytes_limit = kFileBytesLimit);

// A regular file is replaced whole (output_place.hpp) and keeps its mode and owner; a FIFO or a
// device is written to. When the new file cannot be renamed into place it is kept beside it, and
// named in the error.
Result<> WriteFileBytes(std::string_view what, const std::string& path,
                        std::span<const std::byte> bytes);

// Whether WriteFileBytes would come to writing: before work whose result goes there. Leaves
// everything as it was; of a FIFO or a device, which may not be opened for a try, it looks at the
// permissions.
Result<> TryOutput(std::string_view what, const std::string& path);

// Whether there is something at the path that ReadWhole may find to be a file.
bool IsThere(const std::string& path);
// Why the path is none of a regular file, "a folder, not a file"; empty: it is.
std::string WhyNoFile(const std::string& path);
// The folder that holds the path, empty where it names none; and a name relative to a folder, unless it is absolute.
std::string FolderOf(const std::string& path);
std::string InFolder(const std::string& folder, const std::string& name);
// The name without folder and ending.
std::string StemOf(const std::string& path);

// Of a program that has no files of its own, WebAssembly in a page (given_files.cpp): whoever runs it hands over their
// bytes, and the functions above find them by the same path. In place of what was given by this path before.
void GiveFile(const std::string& path, std::vector<std::byte> bytes);

inline std::string_view AsText(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
inline std::span<const std::byte> AsBytes(std::string_view text) {
  return {reinterpret_cast<const std::byte*>(text.data()), text.size()};
}

}  // namespace pelt
