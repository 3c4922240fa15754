#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/command/commands.hpp"
#include "bench/report/report_tree.hpp"
#include "bench/scenarios/scenarios.hpp"
#include "core/character/pose.hpp"
#include "core/error.hpp"
#include "core/format.hpp"

namespace pelt {
namespace {

// Of the longer side: lines are thinner than what lies between them, and maps are read.
constexpr uint32_t kLeastSide = 1024, kMostSide = 4096;
constexpr uint8_t kColours[][3] = {{0, 255, 255}, {0, 255, 80},  {0, 120, 255},
                                   {0, 160, 0},   {0, 160, 160}, {0, 60, 200}};

UvTemplate MakeEmpty(const Mesh& mesh, const SurfaceColour& surface) {
  UvTemplate made{kLeastSide, kLeastSide, {}};
  uint64_t most = 0;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const ControlMap* image = surface.ImageOf(t);
    if (!image || uint64_t(image->width) * image->height <= most) continue;
    most = uint64_t(image->width) * image->height;
    made.width = image->width;
    made.height = image->height;
  }
  while (std::max(made.width, made.height) < kLeastSide) made.width *= 2, made.height *= 2;
  while (std::max(made.width, made.height) > kMostSide) {
    made.width = std::max(made.width / 2, 1u);
    made.height = std::max(made.height / 2, 1u);
  }
  made.rgb.assign(size_t(made.width) * made.height * 3, 0);
  return made;
}

// Where a place beyond the image's edges lies on it.
uint32_t PixelOf(double coordinate, uint32_t size, Wrap wrap) {
  double at = coordinate - std::floor(coordinate);
  if (wrap == Wrap::kMirror && std::fmod(std::floor(coordinate), 2.0) != 0.0) at = 1.0 - at;
  if (wrap == Wrap::kClamp) at = std::clamp(coordinate, 0.0, 1.0);
  return std::min(uint32_t(at * double(size)), size - 1);
}

void DrawLine(const glm::dvec2& from, const glm::dvec2& to, const std::array<Wrap, 2>& wrap,
              const uint8_t (&colour)[3], UvTemplate& made) {
  constexpr double kMostTurns = 8.0;  // round the image; what is longer is dotted
  const glm::dvec2 size(made.width, made.height), pixels = glm::abs(to - from) * size;
  const double most = kMostTurns * std::max(size.x, size.y);
  const auto steps = uint32_t(std::min(std::ceil(std::max(pixels.x, pixels.y)), most)) + 1;
  for (uint32_t i = 0; i <= steps; ++i) {
    const glm::dvec2 at = from + (to - from) * (double(i) / double(steps));
    const size_t pixel = size_t(PixelOf(at.y, made.height, wrap[1])) * made.width +
                         PixelOf(at.x, made.width, wrap[0]);
    std::copy_n(colour, 3, &made.rgb[3 * pixel]);
  }
}

}  // namespace

UvTemplate DrawUvTemplate(const Character& character, const SurfaceColour& surface) {
  const Mesh& mesh = character.mesh;
  if (mesh.uv.empty())
    throw Error(
        fmt::format("{}: no texture coordinates, by which a map would lie on it", character.name));
  UvTemplate made = MakeEmpty(mesh, surface);
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& corner = mesh.triangles[t];
    const auto& colour = kColours[mesh.triangle_material[t] % std::size(kColours)];
    for (size_t k = 0; k < 3; ++k)
      DrawLine(glm::dvec2(mesh.uv[corner[k]]), glm::dvec2(mesh.uv[corner[(k + 1) % 3]]),
               WrapOn(mesh, t), colour, made);
  }
  return made;
}

namespace {

void AddSize(const Character& character, const RestGeometry& rest, float unit_scale,
             ReportTree& tree) {
  const glm::vec3 size = BoundPlaces(rest.position).Size();
  tree.Add({"unit_scale", "m", -1, "a unit is"}, double(unit_scale));
  tree.Add({"size_m", "m", 3, "size x, y, z"}, std::vector<double>{size.x, size.y, size.z})
      .EndLine();
  const Mesh& mesh = character.mesh;
  tree.Add({"vertices"}, mesh.position.size()).Add({"triangles"}, mesh.triangles.size());
  // A built-in character's are in no file.
  tree.Add({"uv_sets", "", -1, "sets of texture coordinates"},
           std::max(mesh.uv_sets, mesh.uv.empty() ? 0u : 1u));
  tree.Add({"has_vertex_colours", "", -1, "vertex colours"}, !mesh.corner_colour.empty());
  tree.Add({"images"}, character.images.size());
}

std::string ColourText(const glm::vec3& colour) {
  return fmt::format("{:.2f} {:.2f} {:.2f}", colour.r, colour.g, colour.b);
}

void AddMaterials(const Mesh& mesh, const RestGeometry& rest, ReportTree& tree) {
  ReportTable& table = tree.AddTable("materials", {{"material"},
                                                   {"triangles"},
                                                   {"area_m2", "m2", 4, "area"},
                                                   {"bare"},
                                                   {"unlit"},
                                                   {"base_colour", "linear"},
                                                   {"image"},
                                                   {"uv_set"}});
  const std::vector<MaterialShare> shares = MeasureMaterials(mesh, rest);
  for (size_t m = 0; m < shares.size(); ++m) {
    const MaterialLook& look = mesh.looks[m];
    table.Add({Printable(mesh.materials[m]), shares[m].triangles, shares[m].area_m2, look.bare,
               look.unlit, look.stated ? Value(ColourText(look.base_colour)) : Value(),
               look.image >= 0 ? Value(look.image) : Value(),
               look.image >= 0 ? Value(look.uv_set) : Value()});
  }
}

// Vertices that follow a joint more than any other.
void AddJoints(const Character& character, ReportTree& tree) {
  const Skeleton& skeleton = character.skeleton;
  std::vector<uint32_t> vertices(skeleton.name.size());
  for (const std::array<uint8_t, 4>& joints : character.mesh.joints) ++vertices[joints[0]];
  ReportTable& table = tree.AddTable("joints", {{"joint"}, {"vertices"}, {"parent"}});
  for (size_t j = 0; j < skeleton.name.size(); ++j)
    table.Add({Printable(skeleton.name[j]), vertices[j],
               skeleton.parent[j] < 0
                   ? Value()
                   : Value(Printable(skeleton.name[size_t(skeleton.parent[j])]))});
}

void AddClips(const Character& character, ReportTree& tree) {
  if (character.clips.empty()) tree.Say("no clip: it stands in its rest pose");
  ReportTable table{.key = "clips",
                    .columns = {{"clip"}, {"duration_s", "s", 2, "takes"}, {"tracks"}}};
  for (const Clip& clip : character.clips)
    table.Add({Printable(clip.name), double(clip.duration_s), clip.tracks.size()});
  if (character.clips.empty())
    tree.Add(InJson("clips"), std::move(table));
  else
    tree.AddTable(table.key, table.columns).rows = std::move(table.rows);
}

}  // namespace

ExitCode ShowCharacter(const ShowCharacterArgs& args) {
  if (!args.uv_template.empty()) RequirePictures();
  const Character character = LoadCharacter(args.character);
  if (args.check_files_read) args.check_files_read(character.files_read);
  std::vector<std::string> notes = character.notes;
  const float unit_scale = ChooseUnitScale({}, character, notes);
  const RestGeometry rest = ComputeRestGeometry(character, unit_scale);
  const SurfaceColour surface(character);
  notes.insert(notes.end(), surface.faults().begin(), surface.faults().end());
  const std::string setup = StartingSetup(character, rest, unit_scale);
  ReportTree tree;
  tree.Add({"character"}, Printable(character.name)).EndLine();
  AddSize(character, rest, unit_scale, tree);
  tree.AddTexts("notes", notes, "note");
  AddMaterials(character.mesh, rest, tree);
  AddJoints(character, tree);
  AddClips(character, tree);
  tree.Add(InJson("setup"), setup);
  if (!args.out.empty()) WriteOutput("setup", args.out, setup);
  if (!args.uv_template.empty()) {
    const UvTemplate made = DrawUvTemplate(character, surface);
    WritePng("UV template", args.uv_template, made.rgb, made.width, made.height, 3);
  }
  fmt::print("{}", args.json ? tree.Json() : tree.Text());
  if (args.json) return kDone;
  if (args.out.empty())
    fmt::print("\nA setup to start from (--out writes it):\n\n{}", setup);
  else
    fmt::print("\nsetup {}\n", args.out.path());
  if (!args.uv_template.empty()) fmt::print("\nUV template {}\n", args.uv_template.path());
  return kDone;
}

}  // namespace pelt
