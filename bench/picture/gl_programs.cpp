#include "bench/picture/gl_programs.hpp"

#include <fmt/format.h>

#include "bench/view/gl_program.hpp"

namespace pelt {
namespace {

// Of GlPrograms::Other, in its order.
constexpr struct {
  const char *vertex, *fragment;
} kOthers[] = {{"body.vert", "body.frag"},    {"body_shadow.vert", "shadow.frag"},
               {"eye.vert", "eye.frag"},      {"lighting.vert", "lighting.frag"},
               {"whole.vert", "soften.frag"}, {"whole.vert", "resolve.frag"},
               {"shell.vert", "shell.frag"},  {"relief.vert", "relief.frag"}};

std::string PassText(std::string_view file) { return ShaderText(fmt::format("passes/{}", file)); }

// Behind what its first lines name, and before the rest, comes the reader.
std::string StrandText(std::string_view file, std::string_view output) {
  const std::string whole = PassText(file);
  const std::string_view pass = OwnText(fmt::format("passes/{}", file));
  const size_t before = whole.size() - pass.size();
  return whole.substr(0, before) + PassText(fmt::format("readers/{}.glsl", output)) +
         whole.substr(before);
}

}  // namespace

Result<GlPrograms> GlPrograms::Make(const GlApi& gl) {
  GlPrograms programs;
  std::string fault;
  const auto add = [&](std::vector<GlProgram>& to, const char* name, const std::string& vertex,
                       const char* fragment) {
    Result<GlProgram> program = GlProgram::Make(gl, name, vertex, PassText(fragment));
    if (program)
      to.push_back(*std::move(program));
    else if (fault.empty())
      fault = program.error();
  };
  for (const OutputRow& output : kOutputs) {
    if (!output.OfStrands()) continue;
    const auto strand = [&](std::vector<GlProgram>& to, const char* vertex, const char* fragment) {
      add(to, vertex, StrandText(vertex, output.name), fragment);
    };
    strand(programs.strand_light, "strand_light.vert", "strand.frag");
    strand(programs.strand_buffered, "strand_buffered.vert", "strand_buffered.frag");
    strand(programs.strand_depth, "strand_depth.vert", "strand_depth.frag");
    strand(programs.strand_shadow, "strand_shadow.vert", "shadow.frag");
  }
  for (const auto& other : kOthers)
    add(programs.others, other.fragment, PassText(other.vertex), other.fragment);
  if (!fault.empty()) return Failure{std::move(fault)};
  programs.ForEach([](const GlProgram& program) {
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
    program.BindBlock("Look", 0);
  });
  return programs;
}

void SetPaint(const GlProgram& program, const PaintLook& paint) {
  program.Set("paint_wet_darken", paint.wet_darken);
  program.Set("paint_mud", paint.mud);
  program.Set("paint_snow", paint.snow);
  program.Set("paint_dust", paint.dust);
}

}  // namespace pelt
