// A path that a command writes to. Only the command line makes one (AddOutputFile,
// command_options.hpp), and only one of these can be written: so every output has been tried, and checked
// against every input and every other output, before the work whose result goes there began.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/file_bytes.hpp"

namespace pelt {

class OutputPath {
 public:
  OutputPath() = default;  // nothing is written
  // For the option that declares it, and tests.
  static OutputPath Of(std::string path) {
    OutputPath output;
    output.path_ = std::move(path);
    return output;
  }
  // A file in this folder.
  OutputPath Inside(std::string_view name) const;

  bool empty() const { return path_.empty(); }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// Throw Error; `what` is for its text: "digest log". MakeFolder: and the folders above it.
void MakeFolder(const OutputPath& folder);
void CheckOutput(std::string_view what, const OutputPath& output);
void WriteOutput(std::string_view what, const OutputPath& output, std::span<const std::byte> bytes);
inline void WriteOutput(std::string_view what, const OutputPath& output, std::string_view text) {
  WriteOutput(what, output, AsBytes(text));
}

}  // namespace pelt
