// What a glTF's materials say of their look: colour, as a factor and an image, by whichever model they say it; where they
// are cut out; and how images are laid. Each index, offset and length is checked.
//
// Invariant: nothing here refuses a file. What is wrong becomes a sentence in look_faults, and the material goes without.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/character/gltf_document.hpp"

namespace pelt::gltf {

// The bytes of a file beside the glTF file, or of a data: URI; none, and why, where they cannot be read.
using ImageReader =
    std::function<std::vector<unsigned char>(const std::string& uri, std::string& fault)>;

// Fills looks, transforms and images. `json` is JSON; the document has its buffers, views and materials.
void ReadLook(std::string_view json, const ImageReader& read, Document& document);

}  // namespace pelt::gltf
