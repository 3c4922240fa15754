// The renderer's programs, from bench/view/shaders/passes, and the texture units that they share.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "bench/picture/gl_objects.hpp"
#include "bench/view/paint_shading.hpp"
#include "core/outputs.hpp"

namespace pelt {

// What lies where as long as something is drawn.
enum GlUnit : GLint {
  kVerticesUnit,
  kRootsUnit,
  kLooksUnit,
  kShadowMapsUnit,
  kCharactersUnit,
  kSoftMapsUnit,
  kLightingUnit,
  kSurfaceUnit,
  kSourceUnit,
  kHeightsUnit,
  kStripsUnit,
  kCoversUnit,
  kGrowthUnit,
  kMakingUnit  // where textures are made
};

struct GlPrograms {
  // For each output of strands, in kOutputs' order; once MakeCards was called, as many again for layers with cards.
  std::vector<GlProgram> strand_light, strand_buffered, strand_depth, strand_shadow;
  std::vector<GlProgram> others;

  enum Other {
    kBody,
    kBodyShadow,
    kEye,
    kLighting,
    kSoften,
    kResolve,
    kShell,
    kShellShadow,
    kRelief,
    kFin
  };
  const GlProgram& operator[](Other other) const { return others[other]; }

  static Result<GlPrograms> Make(const GlApi& gl);
  // Unless it was called before. Throws Error with the driver's words.
  void MakeCards(const GlApi& gl);
  // Calls set(program), in use, for each.
  template <class Set>
  void ForEach(const Set& set) const {
    for (const auto* list :
         {&strand_light, &strand_buffered, &strand_depth, &strand_shadow, &others})
      for (const GlProgram& program : *list) {
        program.Use();
        set(program);
      }
  }

 private:
  // Words of the driver, if it refuses; `defines` come before each text.
  std::string AddStrands(const GlApi& gl, std::string_view defines);
  void SetUnits() const;
};

// What passes/painted.glsl is told; of a program in use.
void SetPaint(const GlProgram& program, const PaintLook& paint);

}  // namespace pelt
