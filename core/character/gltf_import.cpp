// The order of an import; each step is a file of its own. Idea and promise: see gltf_import.hpp.
#include "core/character/gltf_import.hpp"

#include <cmath>
#include <vector>

#include "core/character/gltf_accessor.hpp"
#include "core/character/gltf_read.hpp"
#include "core/character/pose.hpp"
#include "core/error.hpp"
#include "core/file_bytes.hpp"
#include "core/float_environment.hpp"

namespace pelt {
namespace {

Character ImportDocument(const gltf::Document& document, const std::string& name) {
  Character character;
  character.name = name;
  character.files_read = document.files_read;
  character.images = document.images;
  character.notes = document.look_faults;
  for (const std::string& extension : document.extensions_unknown)
    character.notes.push_back("The file requires " + extension +
                              ", which is not supported; it was read without.");
  gltf::SkeletonImport skeleton = gltf::ReadSkeleton(document, &character.notes);
  character.mesh = gltf::ReadMesh(document, skeleton, &character.notes);
  character.clips = gltf::ReadClips(document, skeleton, &character.notes);
  character.skeleton = std::move(skeleton.skeleton);

  const RestGeometry rest = ComputeRestGeometry(character, 1.0f);
  for (size_t v = 0; v < rest.position.size(); ++v)
    for (int c = 0; c < 3; ++c)
      if (!(std::abs(rest.position[v][c]) < 1e15f))
        gltf::Fail(document, "rest pose",
                   "vertex " + std::to_string(v) + " lies beyond 1e15 or is not finite");
  return character;
}

}  // namespace

Character ImportGltf(std::span<const std::byte> bytes, const std::string& name) {
  const FloatEnvironment guard;
  return ImportDocument(gltf::ParseDocument(bytes, name, ""), name);
}

Character ImportGltfFile(const std::string& path) {
  const FloatEnvironment guard;
  const auto bytes = ReadWhole(path, 0xffffffffull);
  if (!bytes) throw Error(path + ": " + bytes.error());
  const std::string folder = FolderOf(path);
  return ImportDocument(gltf::ParseDocument(*bytes, path, folder.empty() ? "." : folder),
                        StemOf(path));
}

}  // namespace pelt
