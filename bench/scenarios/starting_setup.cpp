// A fur setup to start from.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/scenarios/scenarios.hpp"
#include "core/character/pose.hpp"
#include "core/error.hpp"
#include "core/format.hpp"

namespace pelt {
namespace {

// Of the largest extent, as a fox's coat is.
constexpr double kLengthShare = 0.03;
// Cards, each of some hairs, as the originals had: a coat of 5,700 covers as 40,000 single hairs do.
constexpr double kWidthShare = 0.13;  // of the length
constexpr double kSpacingsALength = 2.75;
constexpr double kMostStrands = 8000.0;
// How far hair keeps away from eyes, so that none crosses one; of the length.
constexpr double kEyeMarginShare = 0.3;
// Parts of the surface below this are too small for a coat of their own.
constexpr double kLeastShare = 0.002;

struct CoatPlan {
  double length_m, density;
};

// Longer strands where there would be too many: fewer of them cover as well.
CoatPlan PlanCoat(double extent_m, double area_m2) {
  double length_m = kLengthShare * extent_m;
  const auto density = [&] { return std::pow(kSpacingsALength / length_m, 2.0); };
  if (density() * area_m2 > kMostStrands) length_m *= std::sqrt(density() * area_m2 / kMostStrands);
  return {length_m, density()};
}

// Two digits: a value that the user is to change looks like it.
std::string Round(double value) { return fmt::format("{:.2g}", value); }
std::string RoundWhole(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return fmt::format("{:.6g}", std::round(value / power) * power);
}

std::string Quoted(const std::string& name) {
  std::string quoted = "\"";
  for (const char c : name) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

// The materials that get a layer each; none: one layer grows on all that is not bare. A mask names
// materials, so each needs a name, of its own, that can be written.
std::vector<size_t> ChooseMaterials(const Mesh& mesh, const std::vector<MaterialShare>& shares) {
  double area = 0.0;
  for (const MaterialShare& share : shares) area += share.area_m2;
  std::vector<size_t> chosen;
  for (size_t m = 0; m < shares.size(); ++m) {
    if (mesh.looks[m].bare || shares[m].area_m2 < kLeastShare * area) continue;
    const std::string& name = mesh.materials[m];
    if (name.empty() || !IsPrintable(name)) return {};
    if (std::count(mesh.materials.begin(), mesh.materials.end(), name) > 1) return {};
    chosen.push_back(m);
  }
  return chosen.size() > 1 ? chosen : std::vector<size_t>{};
}

// ", away_from = ..." of a mask, if there are eyes that are bare.
std::string EyeMargin(const Mesh& mesh, double length_m) {
  std::string eyes;
  for (size_t m = 0; m < mesh.materials.size(); ++m) {
    std::string name = mesh.materials[m];
    if (!mesh.looks[m].bare || !IsPrintable(name)) continue;
    std::ranges::transform(name, name.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
    if (name.find("eye") == std::string::npos) continue;
    eyes += (eyes.empty() ? "" : ", ") + Quoted(mesh.materials[m]);
  }
  if (eyes.empty()) return "";
  return fmt::format("away_from = {{ materials = [{}], distance = {} }}", eyes,
                     Round(kEyeMarginShare * length_m));
}

std::string LayerText(const std::string& name, size_t seed, const std::string& mask) {
  return fmt::format("\n[[layer]]\nname = {}\nseed = {}\n{}", Quoted(name), seed, mask);
}

}  // namespace

std::vector<MaterialShare> MeasureMaterials(const Mesh& mesh, const RestGeometry& rest) {
  std::vector<MaterialShare> shares(mesh.materials.size());
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.triangles[t];
    const glm::vec3 ab = rest.position[b] - rest.position[a],
                    ac = rest.position[c] - rest.position[a];
    MaterialShare& share = shares[mesh.triangle_material[t]];
    ++share.triangles;
    share.area_m2 += 0.5 * double(glm::length(glm::cross(ab, ac)));
  }
  return shares;
}

std::string StartingSetup(const Character& character, const RestGeometry& rest, float unit_scale) {
  const Mesh& mesh = character.mesh;
  const std::vector<MaterialShare> shares = MeasureMaterials(mesh, rest);
  double area_m2 = 0.0;
  for (size_t m = 0; m < shares.size(); ++m)
    if (!mesh.looks[m].bare) area_m2 += shares[m].area_m2;
  const double extent_m = BoundPlaces(rest.position).LargestSide();
  if (!(area_m2 > 1e-12 * extent_m * extent_m))
    throw Error(fmt::format("{}: its surface has no area in the rest pose: nothing grows on it",
                            Printable(character.name)));
  const CoatPlan coat = PlanCoat(extent_m, area_m2);
  std::string text = fmt::format(
      "# A setup to start from for {}; pelt bake --keys explains every key.\n"
      "# Lengths and widths are in metres, densities in strands a square metre.\n\n"
      "unit_scale = {}  # metres a file unit\n",
      Printable(character.name), unit_scale);
  if (!character.clips.empty() && IsPrintable(character.clips.front().name) &&
      !character.clips.front().name.empty())
    text += fmt::format("clip = {}\n", Quoted(character.clips.front().name));
  text += fmt::format(
      "\n[defaults]\nlength = {{ value = {}, randomise = 0.25 }}\nwidth = {{ value = {}, randomise "
      "= 0.2 }}\n"
      "tip_width = 0.9\nfilm_strips = 8  # cards of 8 kinds: from 4 mm wide on each shows some "
      "hairs\n"
      "density = {}  # they stand 1/{} of their length apart\nelevation = {{ value = 35.0, "
      "randomise = "
      "0.3 }}\n"
      "frizz = 6.0\nchain = \"vertex\"\noutput = \"instances\"\n",
      Round(coat.length_m), Round(kWidthShare * coat.length_m), RoundWhole(coat.density),
      kSpacingsALength);
  const std::vector<size_t> chosen = ChooseMaterials(mesh, shares);
  const std::string margin = EyeMargin(mesh, coat.length_m);
  if (chosen.empty()) {
    text += LayerText(
        "coat", 1,
        "# Grows on all that is not bare; mask.joints, mask.range or a map say where instead.\n");
    if (!margin.empty()) text += fmt::format("mask = {{ {} }}\n", margin);
    return text;
  }
  for (size_t i = 0; i < chosen.size(); ++i) {
    const std::string& name = mesh.materials[chosen[i]];
    text += LayerText(name, i + 1,
                      fmt::format("mask = {{ materials = [{}]{}{} }}\n", Quoted(name),
                                  margin.empty() ? "" : ", ", margin));
  }
  return text;
}

}  // namespace pelt
