#include "bench/viewer/page_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "bench/viewer/data_views.hpp"
#include "core/error.hpp"
#include "core/exact_math.hpp"
#include "core/kernels/frame_table.hpp"

namespace pelt {
namespace {

WindSetup& WindOf(PageSettings& s) { return s.scenario.base.wind; }
const WindSetup& WindOf(const PageSettings& s) { return s.scenario.base.wind; }

double WindSpeed(const PageSettings& s) {
  const float* v = WindOf(s).velocity;
  return std::hypot(double(v[0]), double(v[2]));
}
// Towards where it blows: 0 is +z, 90 +x.
double WindTowards(const PageSettings& s) {
  const float* v = WindOf(s).velocity;
  const double angle = std::atan2(double(v[0]), double(v[2])) / exact::kRadiansPerDegree;
  return angle < 0.0 ? angle + 360.0 : angle;
}
void SetWind(PageSettings& s, double speed, double towards) {
  // A wind of no speed keeps its direction.
  speed = std::max(speed, 1e-6);
  WindOf(s).velocity[0] = float(speed * exact::Sin(towards * exact::kRadiansPerDegree));
  WindOf(s).velocity[2] = float(speed * exact::Cos(towards * exact::kRadiansPerDegree));
}

// An entry of a number that lies at `Place(settings)`.
template <auto kPlace>
PageEntry Entry(std::string_view key, std::string_view group, std::string_view unit, double low,
                double high, std::string_view text) {
  return {key,
          group,
          unit,
          low,
          high,
          text,
          [](const PageSettings& s) { return double(*kPlace(const_cast<PageSettings&>(s))); },
          [](PageSettings& s, double value) {
            auto* place = kPlace(s);
            *place = std::remove_reference_t<decltype(*place)>(value);
          }};
}
template <auto kPlace>
PageEntry Switch(std::string_view key, std::string_view group, std::string_view text) {
  PageEntry entry = Entry<kPlace>(key, group, "", 0, 1, text);
  entry.is_switch = true;
  return entry;
}
template <double PageLight::*kMember>
PageEntry Light(std::string_view key, std::string_view text) {
  return Entry<[](PageSettings& s) { return &(s.light.*kMember); }>(key, "light", "", 0, 3, text);
}
template <bool SkipSettings::*kMember>
PageEntry Skip(std::string_view key, std::string_view text) {
  return Switch<[](PageSettings& s) { return &(s.scenario.base.skip.*kMember); }>(
      key, "what is left out", text);
}

PageEntry ReliefEntry() {
  static constexpr std::string_view kWords[] = {"hair", "relief", "relief, jittered",
                                                "steps of relief"};
  PageEntry entry = Entry<[](PageSettings& s) { return &s.relief; }>(
      "relief", "relief", "", 0, double(std::size(kWords) - 1),
      "fur on the skin, with a setup and texture coordinates; jittered: by frame");
  entry.words = kWords;
  return entry;
}

PageEntry DataViewEntry() {
  PageEntry entry = Entry<[](PageSettings& s) { return &s.show; }>(
      "show", "stages", "", 0, double(DataViews().size() - 1), "what stages of the frame computed");
  entry.words = DataViewNames();
  return entry;
}

// Those that can run here.
const std::vector<Isa>& Isas() {
  static const std::vector<Isa> isas = [] {
    std::vector<Isa> found;
    std::ranges::copy_if(kAllIsas, std::back_inserter(found), FindKernels);
    return found;
  }();
  return isas;
}

PageEntry KernelsEntry() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> found;
    std::ranges::transform(Isas(), std::back_inserter(found), IsaName);
    return found;
  }();
  return {"kernels",
          "stages",
          "",
          0,
          double(Isas().size() - 1),
          "instruction set: the bits are the same",
          [](const PageSettings& s) {
            return double(std::ranges::find(Isas(), s.isa) - Isas().begin());
          },
          [](PageSettings& s, double value) { s.isa = Isas()[size_t(value)]; },
          false,
          names};
}

const PageEntry kEntries[] = {
    {"frame_rate", "time", "1/s", 15, 240, "simulated frames a second",
     [](const PageSettings& s) { return std::round(1.0 / s.scenario.dt_s); },
     [](PageSettings& s, double value) { s.scenario.dt_s = 1.0 / value; }},
    Entry<[](PageSettings& s) { return &s.slow_motion; }>("slow_motion", "time", "", 0.05, 1,
                                                          "of real time"),
    Entry<[](PageSettings& s) { return &s.scenario.clip_rate; }>(
        "animation_speed", "time", "", 0, 3, "of the animation; the strands keep their own time"),
    Switch<[](PageSettings& s) { return &s.in_between; }>(
        "in_between", "time",
        "draw what lies between two frames, one frame late, where the display is faster"),
    {"wind_speed", "wind", "m/s", 0, 20, "mean", WindSpeed,
     [](PageSettings& s, double value) { SetWind(s, value, WindTowards(s)); }},
    {"wind_direction", "wind", "degrees", 0, 360, "towards: 0 is +z, 90 is +x", WindTowards,
     [](PageSettings& s, double value) { SetWind(s, WindSpeed(s), value); }},
    Entry<[](PageSettings& s) { return &WindOf(s).gust_strength; }>("gust_strength", "wind", "", 0,
                                                                    1, "of the mean"),
    Entry<[](PageSettings& s) { return &WindOf(s).gust_period_s; }>("gust_period", "wind", "s", 0.2,
                                                                    20, "of the slowest gusts"),
    Entry<[](PageSettings& s) { return &WindOf(s).turbulence; }>("turbulence", "wind", "m/s", 0, 10,
                                                                 "eddies"),
    Entry<[](PageSettings& s) { return &WindOf(s).turbulence_scale_m; }>(
        "turbulence_scale", "wind", "m", 0.05, 5, "size of an eddy"),
    Switch<[](PageSettings& s) { return &WindOf(s).kind; }>(
        "published_wind", "wind", "as Furry Scorpion had it: sines along x and z, swung by noise"),
    Entry<[](PageSettings& s) { return &s.scenario.base.gravity[1]; }>("gravity", "world", "m/s2",
                                                                       -30, 10, "upwards"),
    Switch<[](PageSettings& s) { return &s.scenario.base.use_ground; }>(
        "ground", "world", "strands do not go below it"),
    Entry<[](PageSettings& s) { return &s.scenario.weather_course.wetness; }>(
        "wetness", "world", "", 0, 1, "of every character"),
    Entry<[](PageSettings& s) { return &s.scenario.weather_course.dirt; }>("dirt", "world", "", 0,
                                                                           1, "of every character"),
    Entry<[](PageSettings& s) { return &s.sphere_radius; }>(
        "sphere_radius", "world", "m", 0, 0.5,
        "of the ball that is dragged through the fur; 0: none"),
    Entry<[](PageSettings& s) { return &s.brush_radius; }>("brush_radius", "paint", "m", 0.005, 0.5,
                                                           "of the brush"),
    Entry<[](PageSettings& s) { return &s.brush_amount; }>(
        "brush_amount", "paint", "", -1, 1, "that a frame of painting adds; below 0: takes away"),
    Switch<[](PageSettings& s) { return &s.render_fur; }>("render_fur", "light",
                                                          "draw strands and shells"),
    Light<&PageLight::sun>("sun", "the sun's light"),
    Light<&PageLight::sky>("sky", "light from all around"),
    Light<&PageLight::rim>("rim", "light from behind"),
    Light<&PageLight::highlight>("highlight", "first highlight, the light's colour"),
    Light<&PageLight::second_highlight>("second_highlight", "second highlight, the hair's colour"),
    Light<&PageLight::noise>("highlight_noise", "along the strand"),
    Light<&PageLight::scatter>("scatter", "light that hairs pass on to hairs"),
    Light<&PageLight::backlight>("backlight", "light that passes through"),
    {"shadow", "light", "", 0, 1, "how dark what lies in shadow is",
     [](const PageSettings& s) { return s.light.shadow; },
     [](PageSettings& s, double value) { s.light.shadow = value; }},
    Light<&PageLight::shadow_reach>("shadow_falloff", "how fast light dies away inside a coat"),
    Light<&PageLight::depth>("depth", "light left at the skin"),
    ReliefEntry(),
    DataViewEntry(),
    KernelsEntry(),
    Switch<[](PageSettings& s) { return &s.hold_view; }>(
        "hold_view", "stages",
        "cull, sort and choose detail for where the camera was: turn it and look"),
    Skip<&SkipSettings::sleep>("sleep", "chunks at rest"),
    Skip<&SkipSettings::unmoved>("unmoved", "skinning what did not move"),
    Skip<&SkipSettings::sort>("sort", "sorting what is in order"),
    Skip<&SkipSettings::cull>("cull", "layers outside the view"),
    Skip<&SkipSettings::wind>("wind", "gusts where no wind blows"),
    Skip<&SkipSettings::light>("light", "light that did not change"),
    Skip<&SkipSettings::lod>("lod", "strands of what is small in the view"),
    Entry<[](PageSettings& s) { return &s.scenario.base.lod.full_detail_px; }>(
        "full_detail", "what is left out", "px", 16, 2000,
        "size from which a layer has all its strands"),
    Entry<[](PageSettings& s) { return &s.scenario.base.lod.min_fraction; }>(
        "min_fraction", "what is left out", "", 0.001, 1, "of the strands, the least"),
    Entry<[](PageSettings& s) { return &s.scenario.base.lod.strand_budget; }>(
        "strand_budget", "what is left out", "", 0, 200000, "strands in all, with lod; 0: any"),
    Entry<[](PageSettings& s) { return &s.scenario.base.lod.fast_quality_px; }>(
        "fast_quality", "what is left out", "px", 0, 10,
        "error on the screen up to which strands are simulated in fast quality"),
};

}  // namespace

std::span<const PageEntry> PageEntries() { return kEntries; }

const PageEntry& PageEntryFor(std::string_view key, double value) {
  const auto entry = std::ranges::find(PageEntries(), key, &PageEntry::key);
  if (entry == PageEntries().end()) throw Error(fmt::format("no setting '{}'", key));
  if (!(value >= entry->low && value <= entry->high))
    throw Error(
        fmt::format("'{}' {} is not within {} and {}", key, value, entry->low, entry->high));
  return *entry;
}

bool IsOfShowing(const PageEntry& entry) {
  return IsOfLight(entry) || entry.key == "render_fur" || entry.key == "slow_motion" ||
         entry.key == "in_between" || entry.key == "show";
}

bool IsShownBetween(double dt_s, const PageSettings& settings) {
  constexpr double kDisplayed_s = 1.0 / 55.0;
  return settings.in_between && dt_s > kDisplayed_s * settings.slow_motion;
}

bool IsOfLight(const PageEntry& entry) {
  return entry.group == "light" && entry.key != "render_fur";
}

void ApplyLight(const PageSettings& settings, PictureScene& shown) {
  const PageLight& light = settings.light;
  shown.ForEachLook([&](PictureLook& look) {
    look.light.sun *= float(light.sun);
    look.light.rim *= float(light.rim);
    for (glm::vec3& coefficient : look.light.sky) coefficient *= float(light.sky);
    look.hair.primary *= float(light.highlight);
    look.hair.secondary *= float(light.second_highlight);
    look.hair.noise *= float(light.noise);
    look.hair.scatter *= float(light.scatter);
    look.hair.backlight *= float(light.backlight);
    look.shadow.strength *= float(light.shadow);
    look.shadow.falloff *= float(light.shadow_reach);
    look.depth_floor = std::min(look.depth_floor * float(light.depth), 1.0f);
  });
}

void ApplyRenderFur(const PageSettings& settings, PictureScene& shown) {
  if (settings.render_fur) return;
  for (std::vector<Hair>& hairs : shown.layers) hairs.clear();
  for (LayerDraw& draw : shown.draws) draw.strand_count = 0;
}

}  // namespace pelt
