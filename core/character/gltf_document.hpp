// A glTF file as plain data, before anything in it is believed: indices may point anywhere and
// counts may lie. What is not what it should be is -2, empty or too large here, and no fault
// until it is used: all code that reads a document goes through the checks of gltf_accessor.hpp and
// gltf_read.hpp. So what is broken and of no use refuses no character.
//
// Invariant: a document's memory is bounded by a constant times the bytes of the file and of the
// buffer files it names.
// Source: Khronos glTF 2.0 specification, sections 3 and 4 (GLB).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/character/character.hpp"

namespace pelt::gltf {

enum class Component : int {
  kI8 = 5120,
  kU8 = 5121,
  kI16 = 5122,
  kU16 = 5123,
  kU32 = 5125,
  kF32 = 5126,
};

struct View {
  int buffer = -1;
  uint64_t offset = 0, length = 0;
  uint64_t stride = 0;      // 0: packed
  bool compressed = false;  // by meshopt: its bytes stand in the extension
};

struct Sparse {
  bool used = false;
  int64_t count = 0;
  int index_view = -1, value_view = -1;
  int64_t index_offset = 0, value_offset = 0;
  int index_component = 0;
};

struct Accessor {
  int view = -1;  // -1: zeros
  uint64_t offset = 0, count = 0;
  int component = 0;    // Component, or a number that is none
  int components = 0;   // 1, 2, 3, 4, 9 or 16 numbers an element
  bool matrix = false;  // MAT2, MAT3, MAT4
  bool normalised = false;
  Sparse sparse;
};

// An index that is there and none.
inline constexpr int kBroken = -2;

inline constexpr int kTriangles = 4, kTriangleStrip = 5, kTriangleFan = 6;

struct Primitive {
  std::map<std::string, int> attributes;
  int indices = -1, material = -1, mode = kTriangles;
  bool morphs = false;
  bool compressed = false;  // by Draco: its accessors may have no bytes
};

struct MeshDesc {
  std::string name;
  std::vector<Primitive> primitives;
};

struct Node {
  std::string name;
  std::vector<int> children;
  int mesh = -1, skin = -1;
  std::vector<double> matrix, translation, rotation, scale;  // empty where not given
  std::vector<int> coarser;  // nodes that stand in for this one far away (MSFT_lod)
  bool hidden = false;       // with all below it (KHR_node_visibility)
};

struct Scene {
  std::string name;
  std::vector<int> roots;
};

struct Skin {
  std::string name;
  std::vector<int> joints;
  int inverse_bind = -1;
};

struct Sampler {
  int input = -1, output = -1;
  std::string interpolation;
};

struct ChannelDesc {
  int sampler = -1, node = -1;
  std::string path;
};

struct Animation {
  std::string name;
  std::vector<Sampler> samplers;
  std::vector<ChannelDesc> channels;
};

// The place in a material's images is this much of (u, v, 1), for its u and its v
// (KHR_texture_transform).
struct TextureTransform {
  glm::vec3 u{1.0f, 0.0f, 0.0f}, v{0.0f, 1.0f, 0.0f};
  bool operator==(const TextureTransform&) const = default;
};

struct Document {
  std::string name;         // of the file, for messages
  uint64_t file_bytes = 0;  // of the file and its buffers
  std::vector<std::vector<unsigned char>> buffers;
  std::vector<std::string> buffer_faults;  // of the buffers; why one has no bytes
  std::vector<View> views;
  std::vector<Accessor> accessors;
  std::vector<MeshDesc> meshes;
  std::vector<Node> nodes;
  std::vector<Scene> scenes;
  int scene = -1;  // the active one; -1: none is named
  std::vector<Skin> skins;
  std::vector<Animation> animations;
  std::vector<std::string> materials;
  std::vector<MaterialLook> looks;           // of the materials
  std::vector<TextureTransform> transforms;  // likewise
  std::vector<std::vector<std::byte>> images;
  std::vector<std::string> repairs;             // notes on what was put right to read it at all
  std::vector<std::string> look_faults;         // what of the look could not be read
  std::vector<std::string> extensions_unknown;  // that the file requires
  std::vector<std::string> files_read;          // the buffers that are files of their own
};

// Parses .glb or .gltf bytes. Buffers in other files are looked up below `folder`; with an empty
// folder none is found. Of images only those are looked at that are a material's base colour, and
// what is wrong with these is no error; cameras and extras are never looked at. Throws Error
// ("<name>: ...") for anything that is not glTF 2.0, and for what cannot be read without an
// extension that is not read.
Document ParseDocument(std::span<const std::byte> bytes, const std::string& name,
                       const std::string& folder);

}  // namespace pelt::gltf
