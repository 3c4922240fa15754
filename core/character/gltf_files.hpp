// The files of a glTF: the parts of the one that was named, what it is if it is none, and the bytes
// that a URI leads to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pelt::gltf {

struct Parts {
  std::string_view json;
  std::span<const std::byte> binary;  // the GLB's chunk
  bool has_binary = false;
};

// Throws Error ("<name>: ...") for what is no glTF, in the name of what it is: people hand over
// pages of a failed download, pointers of Git LFS, and models of other formats.
Parts FindParts(std::span<const std::byte> file, const std::string& name);

// What stands in for a file that was not fetched: "a Git LFS pointer, ..."; else nothing.
std::string NameStandIn(std::span<const std::byte> bytes);

// Reads what a glTF's URIs lead to: `data:` of any media type, percent-encoded or in base64, and
// regular files below one folder, up to a total size. Whoever made the file must neither make us
// wait for a FIFO nor read what lies elsewhere.
class UriReader {
 public:
  // With an empty folder no file is read.
  explicit UriReader(std::string folder) : folder_(std::move(folder)) {}

  // Nothing, and why, where it cannot be had. File names may be percent-encoded.
  std::vector<unsigned char> Read(const std::string& uri, std::string& fault);

  const std::vector<std::string>& files_read() const { return files_read_; }

 private:
  std::vector<unsigned char> ReadFile(const std::string& path, std::string& fault);

  std::string folder_;
  uint64_t bytes_left_ = 1ull << 30;
  std::vector<std::string> files_read_;
};

}  // namespace pelt::gltf
