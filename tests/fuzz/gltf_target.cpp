// glTF in: import, and what a character is used for at once.
#include "core/character/gltf_import.hpp"
#include "core/character/pose.hpp"
#include "core/error.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace pelt::fuzz {

void ReadHostile(std::span<const std::byte> input) {
  try {
    const Character character = ImportGltf(input, "fuzz");
    DefaultUnitScale(character);
    const Clip* clip = character.clips.empty() ? nullptr : &character.clips[0];
    MakePose(character.skeleton, clip, 0.37, true, glm::mat4(1.0f));
  } catch (const Error&) {
  }
}

}  // namespace pelt::fuzz
