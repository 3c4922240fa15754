// What ParseDocument (gltf_document.hpp) is made of: the files of a glTF, looking things up in its JSON, and what its
// materials say of their look.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/character/gltf_document.hpp"

namespace pelt::gltf {

// ---- Files --------------------------------------------------------------------------------------

struct Parts {
  std::string_view json;
  std::span<const std::byte> binary;  // the GLB's chunk
  bool has_binary = false;
};

// Of the file that was named. Throws Error ("<name>: ...") for what is no glTF, in the name of what
// it is: people hand over pages of a failed download, pointers of Git LFS, and models of other
// formats.
Parts FindParts(std::span<const std::byte> file, const std::string& name);

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

// ---- JSON: none of what is looked up need be there or be what it should be ----------------------

using Json = nlohmann::json;

// The member, or null where there is none or `from` is no object.
inline const Json& Member(const Json& from, const char* name) {
  static const Json kNone;
  const auto found = from.is_object() ? from.find(name) : from.end();
  return from.is_object() && found != from.end() ? *found : kNone;
}

inline const Json& Element(const Json& from, size_t index) {
  static const Json kNone;
  return from.is_array() && index < from.size() ? from[index] : kNone;
}
inline const Json& Element(const Json& from, const Json& index) {
  return Element(from, index.is_number_unsigned() ? size_t(index.get<uint64_t>()) : SIZE_MAX);
}

// ---- Look ---------------------------------------------------------------------------------------

// Fills looks, transforms and images with what materials say of their look: colour, as a factor and an image, by
// whichever model they say it; where they are cut out; and how images are laid. Each index, offset and length is
// checked. `json` is JSON; `files` are those beside the glTF file; the document has its buffers, views and materials.
//
// Invariant: nothing here refuses a file. What is wrong becomes a sentence in look_faults, and the material goes
// without.
void ReadLook(std::string_view json, UriReader& files, Document& document);

}  // namespace pelt::gltf
