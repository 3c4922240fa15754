#include "core/character/gltf_bare.hpp"

#include <algorithm>
#include <span>

namespace pelt::gltf {
namespace {

constexpr std::string_view kBareWords[] = {
    "eye",    "eyes",   "eyeball", "eyeballs", "pupil",    "pupils", "iris",
    "cornea", "sclera", "nose",    "nostril",  "nostrils", "mouth",  "tooth",
    "teeth",  "gum",    "gums",    "tongue",   "claw",     "claws",  "nail",
    "nails",  "hoof",   "hooves",  "hoofs",    "horn",     "horns",  "beak"};
// Behind "eye" these have fur.
constexpr std::string_view kFurryWords[] = {"brow", "brows", "lid", "lids"};

bool IsUpper(char c) { return c >= 'A' && c <= 'Z'; }
bool IsLower(char c) { return c >= 'a' && c <= 'z'; }

// Of ASCII letters, in lower case; a capital behind a small letter begins a word.
std::vector<std::string> WordsOf(std::string_view name) {
  std::vector<std::string> words;
  char before = ' ';
  for (const char c : name) {
    const bool is_letter = IsUpper(c) || IsLower(c), follows = IsUpper(before) || IsLower(before);
    if (is_letter && (!follows || (IsUpper(c) && IsLower(before)))) words.emplace_back();
    if (is_letter) words.back() += IsUpper(c) ? char(c - 'A' + 'a') : c;
    before = c;
  }
  return words;
}

bool IsOneOf(const std::string& word, std::span<const std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

template <class Is>
bool AreAll(const std::vector<MaterialLook>& looks, const Is& is) {
  return std::all_of(looks.begin(), looks.end(), is);
}

}  // namespace

bool IsBareName(std::string_view name) {
  const std::vector<std::string> words = WordsOf(name);
  for (size_t i = 0; i < words.size(); ++i) {
    const bool is_furry = i + 1 < words.size() && IsOneOf(words[i + 1], kFurryWords);
    if (IsOneOf(words[i], kBareWords) && !is_furry) return true;
  }
  return false;
}

void SettleBare(Mesh* mesh) {
  std::vector<MaterialLook>& looks = mesh->looks;
  if (!AreAll(looks, [](const MaterialLook& look) { return look.unlit; }))
    for (MaterialLook& look : looks) look.bare |= look.unlit;
  if (AreAll(looks, [](const MaterialLook& look) { return look.bare; }))
    for (MaterialLook& look : looks) look.bare = false;
}

}  // namespace pelt::gltf
