// Which parts of a character are bare.
#include <algorithm>
#include <cmath>

#include "core/character/gltf_mesh.hpp"
#include "core/float_rules.hpp"

namespace pelt::gltf {
namespace {

// Without those that stand for markings and whole coats as well: coat, suit, mask, cape, mittens.
constexpr std::string_view kBareWords[] = {
    // Of the body.
    "eye", "eyes", "eyeball", "eyeballs", "pupil", "pupils", "iris", "irises", "cornea", "corneas",
    "sclera", "tearline", "caruncle", "nose", "nostril", "nostrils", "mouth", "lip", "lips",
    "tooth", "teeth", "fang", "fangs", "tusk", "tusks", "gum", "gums", "tongue", "claw", "claws",
    "talon", "talons", "nail", "nails", "toenail", "toenails", "fingernail", "fingernails", "hoof",
    "hooves", "hoofs", "horn", "horns", "antler", "antlers", "beak", "pawpad", "pawpads", "whisker",
    "whiskers", "lash", "lashes", "eyelash", "eyelashes",
    // Worn.
    "shirt", "shirts", "tshirt", "blouse", "sweater", "pullover", "hoodie", "jacket", "vest",
    "waistcoat", "trousers", "trouser", "pants", "jeans", "shorts", "leggings", "skirt", "dress",
    "overalls", "dungarees", "underwear", "apron", "robe", "cloak", "cloth", "clothes", "clothing",
    "garment", "garments", "outfit", "uniform", "armor", "armour", "shoe", "shoes", "boot", "boots",
    "sneaker", "sneakers", "sandal", "sandals", "slipper", "slippers", "shoelace", "shoelaces",
    "sock", "socks", "glove", "gloves", "hat", "hats", "cap", "helmet", "scarf", "bandana", "tie",
    "bowtie", "necktie", "glasses", "sunglasses", "spectacles", "goggles", "monocle", "lens",
    "lenses", "belt", "belts", "buckle", "buckles", "strap", "straps", "button", "buttons", "zip",
    "zipper", "collar", "harness", "saddle", "bridle", "stirrup", "stirrups", "necklace",
    "bracelet", "earring", "earrings", "backpack"};
// Behind such a word these have fur: eyebrows, whisker pads, the bridge of a nose.
constexpr std::string_view kFurryWords[] = {"brow",   "brows", "lid",  "lids",   "pad",    "pads",
                                            "bridge", "fur",   "hair", "socket", "sockets"};

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

// Eyes and mouths are painted and unlit; but what most of the surface is, is its style, or a fallback.
bool IsUnlitTelling(const Mesh& mesh) {
  constexpr double kMostUnlit = 0.25;  // of the surface
  double unlit = 0.0, all = 0.0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    const glm::dvec3 a(mesh.position[v[0]]), b(mesh.position[v[1]]), c(mesh.position[v[2]]);
    const glm::dvec3 cross = glm::cross(b - a, c - a);
    const double area = std::sqrt(glm::dot(cross, cross));
    all += area;
    if (mesh.looks[mesh.triangle_material[t]].unlit) unlit += area;
  }
  return unlit <= kMostUnlit * all;
}

}  // namespace

bool IsBareName(std::string_view name) {
  const std::vector<std::string> words = WordsOf(name);
  for (size_t i = 0; i < words.size(); ++i) {
    const std::string next = i + 1 < words.size() ? words[i + 1] : "";
    if (IsOneOf(words[i], kBareWords) && !IsOneOf(next, kFurryWords)) return true;
    if (IsOneOf(words[i] + next, kBareWords)) return true;  // paw pads, T-shirts
  }
  return false;
}

void SettleBare(Mesh* mesh) {
  std::vector<MaterialLook>& looks = mesh->looks;
  if (IsUnlitTelling(*mesh))
    for (MaterialLook& look : looks) look.bare |= look.unlit && !look.other_look;
  for (MaterialLook& look : looks) look.bare |= look.IsTransparent();
  if (AreAll(looks, [](const MaterialLook& look) { return look.bare; }))
    for (MaterialLook& look : looks) look.bare = false;
}

}  // namespace pelt::gltf
