// The order of an import; each step is a file of its own. Idea and promise: see gltf_import.hpp.
#include "core/character/gltf_import.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/character/gltf_accessor.hpp"
#include "core/character/gltf_read.hpp"
#include "core/character/pose.hpp"
#include "core/error.hpp"
#include "core/file_bytes.hpp"
#include "core/float_environment.hpp"
#include "core/float_rules.hpp"
#include "core/format.hpp"

namespace pelt {
namespace {

// A terminal's few lines: names and paths of files may have any length.
constexpr size_t kLongestMessage = 300, kMostNotes = 64;

// Without its middle, where it is too long.
std::string Shorten(const std::string& text) {
  constexpr std::string_view kGap = " ... ";
  constexpr size_t kHead = kLongestMessage / 2, kTail = kLongestMessage - kHead - kGap.size();
  if (text.size() <= kLongestMessage) return text;
  const auto is_inside = [&](size_t at) { return (uint8_t(text[at]) & 0xc0) == 0x80; };
  size_t head = kHead, tail = text.size() - kTail;
  while (head > 0 && is_inside(head)) --head;
  while (tail < text.size() && is_inside(tail)) ++tail;
  return text.substr(0, head) + std::string(kGap) + text.substr(tail);
}

void ShortenNotes(std::vector<std::string>& notes) {
  const size_t more = notes.size() > kMostNotes ? notes.size() - kMostNotes + 1 : 0;
  if (more) {
    notes.resize(kMostNotes - 1);
    notes.push_back(Format("{} more of such notes.", more));
  }
  for (std::string& note : notes) note = Shorten(note);
}

// Throws unless the character's rest pose has a size and stays within finite bounds.
void CheckRestPose(const gltf::Document& document, const Character& character) {
  const RestGeometry rest = ComputeRestGeometry(character, 1.0f);
  glm::vec3 low = rest.position.front(), high = low;
  for (size_t v = 0; v < rest.position.size(); ++v) {
    for (int c = 0; c < 3; ++c)
      if (!(std::abs(rest.position[v][c]) < 1e15f))
        gltf::Fail(document, "rest pose",
                   "vertex " + std::to_string(v) + " lies beyond 1e15 or is not finite");
    low = glm::min(low, rest.position[v]);
    high = glm::max(high, rest.position[v]);
  }
  const glm::dvec3 size = glm::dvec3(high) - glm::dvec3(low);
  const double extent = std::max({size.x, size.y, size.z});
  if (!(extent > 1e-18))
    gltf::Fail(document, "rest pose",
               "has no size: its joints or what they hang on are scaled to 0; fur is groomed in "
               "the rest pose");
}

Character ImportDocument(const gltf::Document& document, const std::string& name) {
  Character character;
  character.name = name;
  character.files_read = document.files_read;
  character.images = document.images;
  character.notes = document.repairs;
  character.notes.insert(character.notes.end(), document.look_faults.begin(),
                         document.look_faults.end());
  for (const std::string& extension : document.extensions_unknown)
    character.notes.push_back("The file requires " + extension +
                              ", which is not supported; it was read without.");
  gltf::SkeletonImport skeleton = gltf::ReadSkeleton(document, &character.notes);
  character.mesh = gltf::ReadMesh(document, &skeleton, &character.notes);
  character.clips = gltf::ReadClips(document, skeleton, &character.notes);
  character.skeleton = std::move(skeleton.skeleton);
  CheckRestPose(document, character);
  if (const size_t turned = FitNormalsToRest(&character))
    character.notes.push_back(Format(
        "Joints stretch the skin unevenly in the rest pose; {} vertices have normals that fit it.",
        turned));
  ShortenNotes(character.notes);
  return character;
}

Character Import(std::span<const std::byte> bytes, const std::string& file,
                 const std::string& folder, const std::string& name) {
  try {
    return ImportDocument(gltf::ParseDocument(bytes, file, folder), name);
  } catch (const Error& e) {
    throw Error(Shorten(e.what()));
  }
}

}  // namespace

Character ImportGltf(std::span<const std::byte> bytes, const std::string& name) {
  const FloatEnvironment guard;
  return Import(bytes, name, "", name);
}

Character ImportGltfFile(const std::string& path) {
  const FloatEnvironment guard;
  const auto bytes = ReadWhole(path, 0xffffffffull);
  if (!bytes) throw Error(path + ": " + bytes.error());
  const std::string folder = FolderOf(path);
  return Import(*bytes, path, folder.empty() ? "." : folder, StemOf(path));
}

}  // namespace pelt
