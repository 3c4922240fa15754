// Writes a built-in character as GLB, byte by byte: numbers are little-endian on every host, JSON
// numbers are the shortest that read back the same (std::to_chars), so the file's bytes are fixed.
// Source: glTF 2.0, 4 (GLB).
#include "core/character/builtin_character.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <string>

#include "core/character/builtin_shape.hpp"
#include "core/character/gltf_import.hpp"
#include "core/float_environment.hpp"
#include "core/float_rules.hpp"

namespace pelt {
namespace {

std::string Number(float value) {
  char text[32];
  const std::to_chars_result end = std::to_chars(text, text + sizeof text, value);
  return std::string(text, end.ptr);
}

// A list's text, without its brackets. Appended, not `(first ? "" : ",") + item`: that inserts in
// front of a temporary, which g++ 12 takes for overlapping memory at -O3.
void AddItem(const std::string& item, std::string& list) {
  if (!list.empty()) list += ',';
  list += item;
}

std::string Numbers(const float* values, int count) {
  std::string list;
  for (int i = 0; i < count; ++i) AddItem(Number(values[i]), list);
  return "[" + list + "]";
}

class GlbWriter {
 public:
  std::vector<std::byte> Write(const builtin::Shape& shape, const builtin::ShapeMesh& mesh,
                               const std::vector<builtin::ShapeClip>& clips) {
    const std::string nodes = WriteNodes(shape);
    const std::string meshes = WriteMesh(shape.name, mesh);
    const std::string skin = WriteSkin(shape);
    const std::string animations = WriteClips(clips);
    std::string materials;
    for (const char* name : shape.materials)
      AddItem(std::string("{\"name\":\"") + name + "\"}", materials);
    std::string json = "{\"asset\":{\"version\":\"2.0\",\"generator\":\"pelt\"},\"scene\":0,";
    json += "\"scenes\":[{\"nodes\":[0," + std::to_string(shape.joints.size()) + "]}],";
    json += "\"nodes\":[" + nodes + "],\"meshes\":[" + meshes + "],\"skins\":[" + skin + "],";
    json += "\"animations\":[" + animations + "],\"materials\":[" + materials + "],";
    json += "\"accessors\":[" + accessors_ + "],\"bufferViews\":[" + views_ + "],";
    json += "\"buffers\":[{\"byteLength\":" + std::to_string(binary_.size()) + "}]}";
    return Frame(json);
  }

 private:
  void PutU32(std::vector<std::byte>* to, uint32_t v) {
    for (int i = 0; i < 4; ++i) to->push_back(std::byte(v >> (8 * i) & 255));
  }

  void PutFloats(const float* values, size_t count) {
    for (size_t i = 0; i < count; ++i) {
      uint32_t bits;
      std::memcpy(&bits, values + i, 4);
      PutU32(&binary_, bits);
    }
  }

  // Describes what was put into the binary since `start`; returns the accessor's index.
  int AddAccessor(size_t start, size_t count, int component, const char* type,
                  const std::string& more = "") {
    while (binary_.size() % 4) binary_.push_back(std::byte(0));
    const std::string comma = accessor_count_ ? "," : "";
    views_ += comma + "{\"buffer\":0,\"byteOffset\":" + std::to_string(start) +
              ",\"byteLength\":" + std::to_string(binary_.size() - start) + "}";
    accessors_ += comma + "{\"bufferView\":" + std::to_string(accessor_count_) +
                  ",\"componentType\":" + std::to_string(component) +
                  ",\"count\":" + std::to_string(count) + ",\"type\":\"" + type + "\"" + more + "}";
    return accessor_count_++;
  }

  template <class T>
  int AddFloats(const std::vector<T>& values, const char* type, const std::string& more = "") {
    const size_t start = binary_.size();
    for (const T& v : values) PutFloats(&v[0], size_t(T::length()));
    return AddAccessor(start, values.size(), 5126, type, more);
  }

  std::string WriteNodes(const builtin::Shape& shape) {
    std::string out;
    for (int j = 0; j < int(shape.joints.size()); ++j) {
      const builtin::JointPlace& joint = shape.joints[size_t(j)];
      glm::dvec3 local = joint.position;
      if (joint.parent >= 0) local -= shape.joints[size_t(joint.parent)].position;
      const glm::vec3 translation(local);
      out += "{\"name\":\"" + std::string(joint.name) +
             "\",\"translation\":" + Numbers(&translation[0], 3);
      std::string children;
      for (int c = 0; c < int(shape.joints.size()); ++c)
        if (shape.joints[size_t(c)].parent == j) AddItem(std::to_string(c), children);
      if (!children.empty()) out += ",\"children\":[" + children + "]";
      out += "},";
    }
    return out + "{\"name\":\"" + shape.name + "\",\"mesh\":0,\"skin\":0}";
  }

  std::string WriteMesh(const std::string& name, const builtin::ShapeMesh& mesh) {
    glm::vec3 low = mesh.position[0], high = low;
    for (const glm::vec3& p : mesh.position) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
    const int position =
        AddFloats(mesh.position, "VEC3",
                  ",\"min\":" + Numbers(&low[0], 3) + ",\"max\":" + Numbers(&high[0], 3));
    const int normal = AddFloats(mesh.normal, "VEC3");
    const int tangent = AddFloats(mesh.tangent, "VEC4");
    const int uv = AddFloats(mesh.uv, "VEC2");
    const int weights = AddFloats(mesh.weights, "VEC4");
    const size_t start = binary_.size();
    for (const auto& four : mesh.joints)
      for (uint8_t joint : four) binary_.push_back(std::byte(joint));
    const int joints = AddAccessor(start, mesh.joints.size(), 5121, "VEC4");
    const std::string attributes =
        "\"attributes\":{\"POSITION\":" + std::to_string(position) +
        ",\"NORMAL\":" + std::to_string(normal) + ",\"TANGENT\":" + std::to_string(tangent) +
        ",\"TEXCOORD_0\":" + std::to_string(uv) + ",\"JOINTS_0\":" + std::to_string(joints) +
        ",\"WEIGHTS_0\":" + std::to_string(weights) + "}";
    std::string primitives;
    for (size_t m = 0; m < mesh.triangles.size(); ++m) {
      if (mesh.triangles[m].empty()) continue;
      const size_t first = binary_.size();
      for (const auto& t : mesh.triangles[m])
        for (uint32_t corner : t) PutU32(&binary_, corner);
      const int indices = AddAccessor(first, 3 * mesh.triangles[m].size(), 5125, "SCALAR");
      AddItem("{" + attributes + ",\"indices\":" + std::to_string(indices) +
                  ",\"material\":" + std::to_string(m) + "}",
              primitives);
    }
    return "{\"name\":\"" + name + "\",\"primitives\":[" + primitives + "]}";
  }

  std::string WriteSkin(const builtin::Shape& shape) {
    const size_t start = binary_.size();
    std::string joints;
    for (size_t j = 0; j < shape.joints.size(); ++j) {
      glm::mat4 inverse(1.0f);
      inverse[3] = glm::vec4(glm::vec3(-shape.joints[j].position), 1.0f);
      for (int c = 0; c < 4; ++c) PutFloats(&inverse[c][0], 4);
      AddItem(std::to_string(j), joints);
    }
    const int inverse_bind = AddAccessor(start, shape.joints.size(), 5126, "MAT4");
    return "{\"joints\":[" + joints +
           "],\"skeleton\":0,\"inverseBindMatrices\":" + std::to_string(inverse_bind) + "}";
  }

  std::string WriteClips(const std::vector<builtin::ShapeClip>& clips) {
    std::string out;
    for (const builtin::ShapeClip& clip : clips) {
      const size_t start = binary_.size();
      PutFloats(clip.time_s.data(), clip.time_s.size());
      const int input = AddAccessor(start, clip.time_s.size(), 5126, "SCALAR",
                                    ",\"min\":" + Numbers(&clip.time_s.front(), 1) +
                                        ",\"max\":" + Numbers(&clip.time_s.back(), 1));
      std::string samplers, channels;
      for (size_t t = 0; t < clip.tracks.size(); ++t) {
        const builtin::ShapeTrack& track = clip.tracks[t];
        const size_t first = binary_.size();
        for (const glm::vec4& v : track.values) PutFloats(&v[0], track.rotation ? 4 : 3);
        const int output =
            AddAccessor(first, track.values.size(), 5126, track.rotation ? "VEC4" : "VEC3");
        AddItem("{\"input\":" + std::to_string(input) + ",\"output\":" + std::to_string(output) +
                    ",\"interpolation\":\"CUBICSPLINE\"}",
                samplers);
        AddItem("{\"sampler\":" + std::to_string(t) +
                    ",\"target\":{\"node\":" + std::to_string(track.joint) + ",\"path\":\"" +
                    (track.rotation ? "rotation" : "translation") + "\"}}",
                channels);
      }
      AddItem(std::string("{\"name\":\"") + clip.name + "\",\"samplers\":[" + samplers +
                  "],\"channels\":[" + channels + "]}",
              out);
    }
    return out;
  }

  std::vector<std::byte> Frame(std::string json) {
    while (json.size() % 4) json += ' ';
    std::vector<std::byte> out;
    out.reserve(28 + json.size() + binary_.size());
    PutU32(&out, 0x46546c67);  // "glTF"
    PutU32(&out, 2);
    PutU32(&out, uint32_t(28 + json.size() + binary_.size()));
    PutU32(&out, uint32_t(json.size()));
    PutU32(&out, 0x4e4f534a);  // "JSON"
    for (char c : json) out.push_back(std::byte(c));
    PutU32(&out, uint32_t(binary_.size()));
    PutU32(&out, 0x004e4942);  // "BIN"
    out.insert(out.end(), binary_.begin(), binary_.end());
    return out;
  }

  std::vector<std::byte> binary_;
  std::string views_, accessors_;
  int accessor_count_ = 0;
};

}  // namespace

std::vector<std::byte> MakeBuiltinCharacterGlb(const BuiltinCharacterOptions& options) {
  const FloatEnvironment guard;
  const bool scorpion = options.body == BuiltinBody::kScorpion;
  const builtin::Shape shape =
      scorpion ? builtin::DesignScorpion() : builtin::DesignMonster(options);
  const builtin::ShapeMesh mesh = builtin::MeshShape(shape, options);
  return GlbWriter().Write(
      shape, mesh,
      builtin::MakeClips(shape, scorpion ? builtin::ScorpionClips() : builtin::MonsterClips()));
}

Character MakeBuiltinCharacter(const BuiltinCharacterOptions& options) {
  return ImportGltf(MakeBuiltinCharacterGlb(options),
                    options.body == BuiltinBody::kScorpion ? "scorpion" : "builtin");
}

}  // namespace pelt
