// How a layer takes light: what its renderer needs besides the strands' colours. No kernel reads it; it goes from the
// setup's [layer.look] by way of the groom to LayerDraw::look. Its terms are those of bench/shading/shaders, which hold
// a light at the hairs' lobes, and are plain factors and exponents for any other shader.
#pragma once

#include <array>
#include <iterator>
#include <string_view>

#include "core/reflect.hpp"

namespace pelt {

struct LayerLook {
  std::array<float, 3> tint{1.0f, 1.0f, 1.0f};  // linear; multiplies both colours of every strand
  // Highlights: strength, sin^exponent, and the lean of the tangent to the root or to the tip. The first has the
  // light's colour, the second the hair's.
  float specular = 0.10f, specular_exponent = 90.0f, specular_shift = 0.1f;
  float second = 0.55f, second_exponent = 28.0f, second_shift = 0.1f;
  float specular_noise = 0.7f;  // how far noise along the strand breaks the second up
  float wrap = 0.4f;            // of light round the body
  float rim = 1.0f, rim_from = 0.8f;
  float backlight = 0.35f, backlight_exponent = 6.0f;
  float scatter = 0.6f, scatter_depth = 1.0f;
  // Linear; multiplies the colour where a strand texture has extra tint (core/groom/strand_texture.hpp).
  std::array<float, 3> strand_tint{0.6f, 0.45f, 0.35f};
  float shadow_alpha = 0.0f;  // strands that cover less of a place cast no shadow there
};

// A value of LayerLook: its key in [layer.look], bounds, both inclusive, and what it does.
struct LayerLookEntry {
  float LayerLook::*member;
  std::string_view key, in_file;
  double low, high;
  std::string_view text;
};

// All but the tints, in the order of the members.
inline constexpr LayerLookEntry kLayerLookEntries[] = {
    {&LayerLook::specular, "specular", "look_specular", 0, 10,
     "first highlight, in the light's colour"},
    {&LayerLook::specular_exponent, "specular_exponent", "look_specular_exponent", 1, 1000,
     "the higher, the narrower the first highlight"},
    {&LayerLook::specular_shift, "specular_shift", "look_specular_shift", -1, 1,
     "of the first highlight to the root"},
    {&LayerLook::second, "second", "look_second", 0, 10, "second highlight, in the hair's colour"},
    {&LayerLook::second_exponent, "second_exponent", "look_second_exponent", 1, 1000,
     "the higher, the narrower the second highlight"},
    {&LayerLook::second_shift, "second_shift", "look_second_shift", -1, 1,
     "of the second highlight to the tip"},
    {&LayerLook::specular_noise, "specular_noise", "look_specular_noise", 0, 1,
     "how far noise along the strand breaks the second highlight up"},
    {&LayerLook::wrap, "wrap", "look_wrap", 0, 1, "of light round the body"},
    {&LayerLook::rim, "rim", "look_rim", 0, 10, "share of the rim light that outlines get"},
    {&LayerLook::rim_from, "rim_from", "look_rim_from", 0, 1,
     "1: only where the rim light comes from; 0: all round"},
    {&LayerLook::backlight, "backlight", "look_backlight", 0, 10,
     "light that passes through hairs towards the eye"},
    {&LayerLook::backlight_exponent, "backlight_exponent", "look_backlight_exponent", 1, 100,
     "the higher, the nearer to the light it shows"},
    {&LayerLook::scatter, "scatter", "look_scatter", 0, 1, "share of light kept inside the coat"},
    {&LayerLook::scatter_depth, "scatter_depth", "look_scatter_depth", 0, 10,
     "how fast light inside the coat takes on its colour"},
    {&LayerLook::shadow_alpha, "shadow_alpha", "look_shadow_alpha", 0, 1,
     "strands that cover less of a shadow map's texel than this are cut from it; 0: none"},
};
inline constexpr double kMostTint = 4.0;  // above 1 it brightens
static_assert(std::size(kLayerLookEntries) + 2 == kMemberCount<LayerLook>,
              "a value without an entry is neither read nor stored nor checked");

}  // namespace pelt
