// Where bytes go that are written to a path: what is there, and where its links lead.
//
// A regular file is replaced whole: its new bytes are written beside it and renamed onto it, so
// that a reader sees the old file or the new one. Everything else is written to as it stands.
// Renaming onto a device or a FIFO would take it away and leave a file in its place; renaming onto
// a link would leave the file that it leads to as it was.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace pelt {

struct OutputPlace {
  // A regular file or nothing yet: where it is, past all links. Else the path as it was given: what
  // /dev/stdout leads to has no path of its own.
  std::filesystem::path path;
  bool direct = false;  // opened and written to; else replaced whole
  bool is_there = false;
  bool is_pipe = false;
};

// Nothing, and the reason, when nothing can be written to `path` for what is there: a folder, a
// file or device that may not be written, a folder that is missing. Opens nothing.
std::optional<OutputPlace> FindOutputPlace(const std::string& path, std::string& reason);

// Whether two paths are one file under one or two names: links, hard links, "./", another folder.
// What is not there yet is compared by its folder and name.
bool IsSameFile(const std::string& a, const std::string& b);

// What a file that is neither regular nor absent is, for messages: "a folder"; empty for those two.
std::string_view DescribeFileType(std::filesystem::file_type type);

}  // namespace pelt
