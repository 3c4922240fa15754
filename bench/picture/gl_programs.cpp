#include "bench/picture/gl_programs.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "bench/view/gl_program.hpp"

namespace pelt {
namespace {

// Of GlPrograms::Other, in its order.
constexpr struct {
  const char *vertex, *fragment;
} kOthers[] = {{"body.vert", "body.frag"},     {"body_shadow.vert", "shadow.frag"},
               {"eye.vert", "eye.frag"},       {"lighting.vert", "lighting.frag"},
               {"whole.vert", "soften.frag"},  {"whole.vert", "resolve.frag"},
               {"shell.vert", "shell.frag"},   {"shell_shadow.vert", "shell_shadow.frag"},
               {"relief.vert", "relief.frag"}, {"fin.vert", "fin.frag"}};

std::string PassText(std::string_view file) { return ShaderText(fmt::format("passes/{}", file)); }

// Behind what its first lines name, and before the rest, comes the reader.
std::string StrandText(std::string_view file, std::string_view output) {
  const std::string whole = PassText(file);
  const std::string_view pass = OwnText(fmt::format("passes/{}", file));
  const size_t before = whole.size() - pass.size();
  return whole.substr(0, before) + PassText(fmt::format("readers/{}.glsl", output)) +
         whole.substr(before);
}

// Into `to`, unless the driver refuses: then what it says.
std::string Add(const GlApi& gl, std::vector<GlProgram>& to, const char* name,
                const std::string& vertex, const std::string& fragment) {
  Result<GlProgram> program = GlProgram::Make(gl, name, vertex, fragment);
  if (!program) return program.error();
  to.push_back(*std::move(program));
  return {};
}

constexpr size_t kStrandOutputs =
    size_t(std::ranges::count_if(kOutputs, [](const OutputRow& row) { return row.OfStrands(); }));

}  // namespace

std::string GlPrograms::AddStrands(const GlApi& gl, std::string_view defines) {
  const struct {
    std::vector<GlProgram>& to;
    const char *vertex, *fragment;
  } kPasses[] = {{strand_light, "strand_light.vert", "strand.frag"},
                 {strand_buffered, "strand_buffered.vert", "strand_buffered.frag"},
                 {strand_depth, "strand_depth.vert", "strand_depth.frag"},
                 {strand_shadow, "strand_shadow.vert", "shadow.frag"}};
  const std::string before(defines);
  for (const OutputRow& output : kOutputs) {
    if (!output.OfStrands()) continue;
    for (const auto& [to, vertex, fragment] : kPasses)
      if (std::string fault = Add(gl, to, vertex, before + StrandText(vertex, output.name),
                                  before + PassText(fragment));
          !fault.empty())
        return fault;
  }
  return {};
}

Result<GlPrograms> GlPrograms::Make(const GlApi& gl) {
  GlPrograms programs;
  std::string fault = programs.AddStrands(gl, "");
  for (const auto& other : kOthers)
    if (fault.empty())
      fault = Add(gl, programs.others, other.fragment, PassText(other.vertex),
                  PassText(other.fragment));
  if (!fault.empty()) return Failure{std::move(fault)};
  programs.SetUnits();
  return programs;
}

void GlPrograms::MakeCards(const GlApi& gl) {
  if (strand_light.size() > kStrandOutputs) return;
  if (const std::string fault = AddStrands(gl, "#define CARDS\n"); !fault.empty())
    throw Error("picture: the driver does not take the shaders of cards: " + fault);
  SetUnits();
}

void GlPrograms::SetUnits() const {
  ForEach([](const GlProgram& program) {
    program.Set("vertices", kVerticesUnit);
    program.Set("roots", kRootsUnit);
    program.Set("looks", kLooksUnit);
    program.Set("shadow_maps", kShadowMapsUnit);
    program.Set("characters", kCharactersUnit);
    program.Set("soft_maps", kSoftMapsUnit);
    program.Set("lighting", kLightingUnit);
    program.Set("surface", kSurfaceUnit);
    program.Set("source", kSourceUnit);
    program.Set("drawn", kSourceUnit);
    program.Set("relief_heights", kHeightsUnit);
    program.Set("strips", kStripsUnit);
    program.Set("covers", kCoversUnit);
    program.Set("growth", kGrowthUnit);
    program.BindBlock("Look", 0);
  });
}

void SetPaint(const GlProgram& program, const PaintLook& paint) {
  program.Set("paint_wet_darken", paint.wet_darken);
  program.Set("paint_mud", paint.mud);
  program.Set("paint_snow", paint.snow);
  program.Set("paint_dust", paint.dust);
}

}  // namespace pelt
