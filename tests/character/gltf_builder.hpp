// Small glTF files for tests: a skinned quad whose every part can be replaced or broken.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "core/character/gltf_import.hpp"

namespace pelt::test {

inline constexpr int kI8 = 5120, kU8 = 5121, kI16 = 5122, kU16 = 5123, kU32 = 5125, kF32 = 5126;

// Two joints: node 0 "base" and its child node 1 "tip", one unit up; node 2 carries the mesh.
// Vertices 0 and 1 hang on the base, 2 and 3 on the tip.
struct GltfBuilder {
  std::vector<uint8_t> binary;
  std::string views, accessors;
  int view_count = 0, accessor_count = 0;

  std::string attributes;      // of the one primitive
  std::string primitive_more;  // ",\"indices\":..." and the like
  std::string meshes;          // replaces the mesh made of the two above
  std::string nodes = R"({"name":"base","children":[1]},{"name":"tip","translation":[0,1,0]},)"
                      R"({"name":"quad","mesh":0,"skin":0})";
  std::string skins;
  std::string animations, materials, more;  // `more`: further top-level members, with commas

  template <class T>
  int View(const std::vector<T>& data, size_t stride = 0) {
    while (binary.size() % 4) binary.push_back(0);
    const size_t start = binary.size(), bytes = data.size() * sizeof(T);
    binary.resize(start + bytes);
    if (bytes) std::memcpy(binary.data() + start, data.data(), bytes);
    views += std::string(view_count ? "," : "") +
             "{\"buffer\":0,\"byteOffset\":" + std::to_string(start) +
             ",\"byteLength\":" + std::to_string(bytes) +
             (stride ? ",\"byteStride\":" + std::to_string(stride) : "") + "}";
    return view_count++;
  }

  // `view` < 0: none. `more` begins with a comma.
  int Accessor(int view, int component, size_t count, const std::string& type,
               const std::string& more_members = "") {
    accessors += std::string(accessor_count ? ",{" : "{") +
                 (view >= 0 ? "\"bufferView\":" + std::to_string(view) + "," : "") +
                 "\"componentType\":" + std::to_string(component) +
                 ",\"count\":" + std::to_string(count) + ",\"type\":\"" + type + "\"" +
                 more_members + "}";
    return accessor_count++;
  }

  static size_t Numbers(const std::string& type) {
    return type == "SCALAR" ? 1 : type == "MAT4" ? 16 : size_t(type[3] - '0');
  }

  template <class T>
  int Add(int component, const std::string& type, const std::vector<T>& data,
          const std::string& more_members = "") {
    return Accessor(View(data), component, data.size() / Numbers(type), type, more_members);
  }
  int Floats(const std::string& type, const std::vector<float>& data) {
    return Add(kF32, type, data);
  }

  void Attribute(const std::string& name, int accessor) {
    attributes += (attributes.empty() ? "\"" : ",\"") + name + "\":" + std::to_string(accessor);
  }
  void Indices(int accessor) { primitive_more += ",\"indices\":" + std::to_string(accessor); }

  std::string Json(bool with_buffer = true, const std::string& uri = "") const {
    const std::string mesh = meshes.empty()
                                 ? "{\"name\":\"fox\",\"primitives\":[{\"attributes\":{" +
                                       attributes + "}" + primitive_more + "}]}"
                                 : meshes;
    std::string json =
        "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[" + nodes + "],\"meshes\":[" + mesh + "]";
    if (!skins.empty()) json += ",\"skins\":[" + skins + "]";
    if (!animations.empty()) json += ",\"animations\":[" + animations + "]";
    if (!materials.empty()) json += ",\"materials\":[" + materials + "]";
    json += ",\"accessors\":[" + accessors + "],\"bufferViews\":[" + views + "]";
    if (with_buffer)
      json += ",\"buffers\":[{\"byteLength\":" + std::to_string(binary.size()) +
              (uri.empty() ? "" : ",\"uri\":\"" + uri + "\"") + "}]";
    return json + more + "}";
  }

  std::vector<std::byte> Glb() const { return Frame(Json()); }

  std::vector<std::byte> Frame(std::string json) const {
    while (json.size() % 4) json += ' ';
    std::vector<uint8_t> body = binary;
    while (body.size() % 4) body.push_back(0);
    std::vector<std::byte> out;
    auto put = [&out](uint32_t v) {
      for (int i = 0; i < 4; ++i) out.push_back(std::byte(v >> (8 * i) & 255));
    };
    put(0x46546c67);
    put(2);
    put(uint32_t(28 + json.size() + body.size()));
    put(uint32_t(json.size()));
    put(0x4e4f534a);
    for (char c : json) out.push_back(std::byte(c));
    put(uint32_t(body.size()));
    put(0x004e4942);
    for (uint8_t b : body) out.push_back(std::byte(b));
    return out;
  }
};

inline const std::vector<float> kQuadPositions = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
inline const std::vector<uint16_t> kQuadIndices = {0, 1, 2, 0, 2, 3};
inline const std::vector<uint8_t> kQuadJoints = {0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
inline const std::vector<float> kQuadWeights = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};

// Which parts of the quad a test brings itself.
struct QuadParts {
  bool position = true, joints = true, weights = true, indices = true, skin = true;
};

inline GltfBuilder MakeQuad(const QuadParts& parts = {}) {
  GltfBuilder b;
  if (parts.position) b.Attribute("POSITION", b.Floats("VEC3", kQuadPositions));
  if (parts.joints) b.Attribute("JOINTS_0", b.Add(kU8, "VEC4", kQuadJoints));
  if (parts.weights) b.Attribute("WEIGHTS_0", b.Floats("VEC4", kQuadWeights));
  if (parts.indices) b.Indices(b.Add(kU16, "SCALAR", kQuadIndices));
  if (parts.skin) {
    const int bind = b.Floats("MAT4", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,
                                       1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1});
    b.skins =
        "{\"name\":\"rig\",\"joints\":[0,1],\"inverseBindMatrices\":" + std::to_string(bind) + "}";
  }
  return b;
}

inline Character Import(const GltfBuilder& builder) {
  return ImportGltf(builder.Glb(), "quad.glb");
}

// `last_two`: the digits 62 and 63, which are "-_" in a URL.
inline std::string Base64(const std::vector<uint8_t>& bytes, const char* last_two = "+/") {
  const std::string digits =
      std::string("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789") + last_two;
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k) group = group << 8 | (i + k < bytes.size() ? bytes[i + k] : 0);
    for (size_t k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

}  // namespace pelt::test
