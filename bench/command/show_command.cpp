#include <fmt/format.h>

#include <algorithm>

#include "bench/command/commands.hpp"
#include "bench/picture/png.hpp"
#include "bench/picture/uv_template.hpp"
#include "bench/report/report_tree.hpp"
#include "bench/scenarios/starting_setup.hpp"
#include "core/character/pose.hpp"
#include "core/printable.hpp"

namespace pelt {
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
    WriteOutput("UV template", args.uv_template, EncodePng(made.rgb, made.width, made.height, 3));
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
