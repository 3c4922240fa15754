// The images that a glTF's textures name, in whichever way: each index, offset and length is checked, each image is read
// once, and what it is is seen from its bytes.
//
// Invariant: the images together have no more bytes than the file and those beside it.
#pragma once

#include <map>
#include <string>

#include "core/character/gltf_json.hpp"
#include "core/character/gltf_look.hpp"

namespace pelt::gltf {

class TextureReader {
 public:
  TextureReader(const Json& json, const ImageReader& read, Document& document)
      : json_(json), read_(read), document_(document) {}

  // The number of the image among the document's that a texture info ({"index": ...}) leads to: that of the texture
  // itself, or of an extension that is of a kind that is read after all. -1, and why, where there is none.
  int32_t FindImage(const Json& info, std::string& fault);
  // How its sampler has it go on beyond its edges.
  std::array<Wrap, 2> FindWrap(const Json& info) const;

 private:
  struct ReadBefore {
    int32_t number = -1;  // among the document's images
    std::string fault;    // why there is none
  };
  const Json& TextureOf(const Json& info) const;
  ReadBefore FindSource(const Json& source);
  ReadBefore ReadImage(const Json& image);
  std::vector<std::byte> ReadUri(const std::string& uri, std::string& fault);
  std::vector<std::byte> ReadView(const Json& index, std::string& fault);

  const Json& json_;
  const ImageReader& read_;
  Document& document_;
  std::map<uint64_t, ReadBefore> images_;  // by their number in the file
  uint64_t bytes_ = 0;                     // of those from buffers
};

}  // namespace pelt::gltf
