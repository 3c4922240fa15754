// What can be set on the page while it runs, besides the keys of layers: one entry for each, and the page makes its
// controls from the entries.
#pragma once

#include <span>
#include <string_view>

#include "bench/picture/picture_scene.hpp"
#include "bench/scenarios/scenarios.hpp"
#include "core/isa.hpp"

namespace pelt {

// How the picture is lit, as shares of what the scene and its setup say.
struct PageLight {
  double sun = 1.0, sky = 1.0, rim = 1.0;
  double highlight = 1.0, second_highlight = 1.0, noise = 1.0, scatter = 1.0, backlight = 1.0;
  double shadow = 1.0, shadow_reach = 1.0, depth = 1.0;
};

struct PageSettings {
  Scenario& scenario;
  PageLight light = {};
  bool render_fur = true;
  uint32_t relief = 0;       // in place of hair; 1: as it is; 2: jittered by frame; 3: its steps
  uint32_t show = 0;         // of DataViews()
  bool hold_view = false;    // cull, sort and LOD for where the camera was
  bool in_between = true;    // pictures between two frames
  Isa isa = BestIsa();       // whose kernels run
  double slow_motion = 1.0;  // of the page's clock: no frame's bits see it
  double sphere_radius = 0.0;
  double brush_radius = 0.06, brush_amount = 0.2;
};

struct PageEntry {
  std::string_view key, group, unit;
  double low, high;
  std::string_view text;
  double (*get)(const PageSettings&);
  void (*set)(PageSettings&, double);
  bool is_switch = false;
  std::span<const std::string_view> words =
      {};  // what the numbers from `low` on are called; none: numbers
};

std::span<const PageEntry> PageEntries();
// The entry of a key. Throws Error where there is none, or the value is out of its bounds.
const PageEntry& PageEntryFor(std::string_view key, double value);
// Whether it only changes how frames are shown, and nothing of the frames' input.
bool IsOfShowing(const PageEntry& entry);

// Whether a display shows more pictures than there are frames of this length, and those in between are wanted.
bool IsShownBetween(double dt_s, const PageSettings& settings);

// Whether it changes nothing but what ApplyLight does.
bool IsOfLight(const PageEntry& entry);

// Changes what a picture is lit by.
void ApplyLight(const PageSettings& settings, PictureScene& shown);
// Leaves its fur out, where that is wanted.
void ApplyRenderFur(const PageSettings& settings, PictureScene& shown);

}  // namespace pelt
