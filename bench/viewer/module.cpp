// What the page's module exports: a Viewer and the renderer behind plain functions. The caller is
// bench/viewer/worker.js.
//
// Texts go in as UTF-8 in memory that Allocate gave, and come out as a pointer to TextSize() bytes, good until the
// next call. What a call throws is said on standard error, and ends the module (wasm/throw.cpp).
#include <cstdlib>
#include <cstring>

#include "bench/picture/gl_renderer.hpp"
#include "bench/viewer/groom_tools.hpp"
#include "bench/viewer/page_request.hpp"
#include "bench/viewer/replay_viewer.hpp"
#include "bench/viewer/viewer.hpp"
#include "core/file_bytes.hpp"

#define PELT_EXPORT(name) extern "C" __attribute__((export_name(#name))) auto name

namespace pelt {
namespace {

struct Page {
  // One of them.
  std::unique_ptr<Viewer> viewer;
  std::unique_ptr<ReplayViewer> replay;
  std::optional<GroomTools> tools;  // of the viewer
  std::optional<GlRenderer> renderer;
  std::string text;
  float place[3] = {};
};
Page& ThePage() {
  static Page page;
  return page;
}

PageView& Shown() {
  Page& page = ThePage();
  if (page.replay) return *page.replay;
  return *page.viewer;
}
// Of a scenario, which can be changed.
Viewer& ShownScene() {
  if (ThePage().replay) throw Error("a recording can be looked at, not changed");
  return *ThePage().viewer;
}

GroomTools& Tools() {
  ShownScene();
  return *ThePage().tools;
}

std::string_view Text(const char* bytes, size_t size) { return {bytes, size}; }

const char* Tell(std::string text) {
  ThePage().text = std::move(text);
  return ThePage().text.c_str();
}

}  // namespace

PELT_EXPORT(Allocate)(size_t bytes)->void* { return std::malloc(bytes); }
PELT_EXPORT(Free)(void* block)->void { std::free(block); }
PELT_EXPORT(TextSize)()->size_t { return ThePage().text.size(); }

PELT_EXPORT(GiveFile)
(const char* path, size_t path_size, const std::byte* bytes, size_t size)->void {
  pelt::GiveFile(std::string(Text(path, path_size)), {bytes, bytes + size});
}

PELT_EXPORT(Open)(const char* request, size_t size)->void {
  ThePage().tools.reset();
  ThePage().viewer = std::make_unique<Viewer>(ReadRequest(Text(request, size)));
  ThePage().tools.emplace(*ThePage().viewer);
}

// In place of what was shown. Null; or why it cannot be replayed, and then what was shown is shown on.
PELT_EXPORT(OpenRecording)
(const char* name, size_t name_size, const std::byte* bytes, size_t size)->const char* {
  auto opened = ReplayViewer::Open({bytes, size}, std::string(Text(name, name_size)));
  if (!opened) return Tell(opened.error());
  ThePage().replay = *std::move(opened);
  ThePage().tools.reset();
  ThePage().viewer.reset();
  return nullptr;
}

// Null, or why there is no picture. In place of the one before, whose objects went with their context or go with it.
PELT_EXPORT(OpenRenderer)()->const char* {
  ThePage().renderer.reset();
  Result<GlRenderer> opened = GlRenderer::Open();
  if (!opened) return Tell(opened.error());
  ThePage().renderer.emplace(*std::move(opened));
  return nullptr;
}

PELT_EXPORT(Describe)()->const char* { return Tell(Shown().Describe()); }
PELT_EXPORT(LastFrame)()->const char* { return Tell(Shown().LastFrame()); }
// How many there are; and each, of which one that is a groom's file has none.
PELT_EXPORT(SetupCount)()->size_t { return ThePage().replay ? 0 : ShownScene().setup_count(); }
PELT_EXPORT(SetupText)(size_t setup)->const char* { return Tell(ShownScene().setup_text(setup)); }

// Null, or why the frame was refused.
PELT_EXPORT(Step)()->const char* {
  const char* refused = Shown().Step();
  return refused ? Tell(refused) : nullptr;
}
PELT_EXPORT(HasInBetween)()->int { return Shown().HasInBetween(); }
PELT_EXPORT(TakeDigests)(uint32_t frames)->void { ShownScene().TakeDigests(frames); }
PELT_EXPORT(Restart)()->void { Shown().Restart(); }
PELT_EXPORT(AtEnd)()->int { return Shown().AtEnd(); }

// As it is at `share` of the way from the frame before, where there is something in between.
PELT_EXPORT(Draw)(uint32_t width_px, uint32_t height_px, uint32_t samples, float share)->void {
  Page& page = ThePage();
  Shown().SetViewport(width_px, height_px);
  Shown().Look();
  page.renderer->Show(Shown().Picture(share),
                      {.width_px = width_px, .height_px = height_px, .samples = samples});
}

PELT_EXPORT(Set)(const char* key, size_t size, double value)->void {
  Shown().Set(Text(key, size), value);
}
PELT_EXPORT(ChangeKey)
(size_t setup, const char* layer, size_t layer_size, const char* key, size_t key_size,
 const char* value, size_t value_size)
    ->void {
  ShownScene().ChangeKey(setup, Text(layer, layer_size), Text(key, key_size),
                         Text(value, value_size));
}
PELT_EXPORT(ReplaceSetup)(size_t setup, const char* text, size_t size)->void {
  ShownScene().ReplaceSetup(setup, std::string(Text(text, size)));
}

PELT_EXPORT(SetCamera)
(double x, double y, double z, double yaw_rad, double elevation_rad, double distance_m)->void {
  Shown().SetCamera(PageCamera{{float(x), float(y), float(z)}, yaw_rad, elevation_rad, distance_m});
}
PELT_EXPORT(TakeScenesCamera)()->void { Shown().SetCamera(std::nullopt); }

// Three floats: where the characters are under this place of the picture; null: nowhere.
PELT_EXPORT(Pick)(double x, double y)->const float* {
  Page& page = ThePage();
  const auto place = ShownScene().Pick(ShownScene().RayAt(x, y));
  if (!place) return nullptr;
  std::memcpy(page.place, &(*place)[0], sizeof(page.place));
  return page.place;
}
PELT_EXPORT(Paint)(uint32_t channel, float x, float y, float z)->void {
  ShownScene().Paint(channel, {x, y, z});
}
PELT_EXPORT(MoveSphere)(float x, float y, float z)->void { ShownScene().MoveSphere({x, y, z}); }

// What groom_tools.hpp says of each.
PELT_EXPORT(DescribeCombs)(size_t setup, const char* layer, size_t layer_size)->const char* {
  return Tell(Tools().DescribeCombs(setup, Text(layer, layer_size)));
}
PELT_EXPORT(MoveComb)
(size_t setup, const char* vector, size_t size, uint32_t part, double x, double y, double lift)
    ->const char* {
  return Tell(Tools().MoveComb(setup, Text(vector, size), GroomTools::CombPart(part), x, y, lift));
}
PELT_EXPORT(BeginMap)
(size_t setup, const char* layer, size_t layer_size, const char* key, size_t key_size,
 uint32_t side, double empty)
    ->const char* {
  return Tell(Tools().BeginMap(setup, Text(layer, layer_size), Text(key, key_size), side, empty));
}
PELT_EXPORT(PaintMap)
(double from_x, double from_y, double to_x, double to_y, double radius, double hardness,
 double value)
    ->double {
  return Tools().PaintMap({from_x, from_y}, {to_x, to_y}, radius, hardness, value);
}
// TextSize() bytes.
PELT_EXPORT(MapPng)()->const char* { return Tell(Tools().MapPng()); }
PELT_EXPORT(TakeMap)
(size_t setup, const char* layer, size_t layer_size, const char* key, size_t key_size,
 const char* name, size_t name_size)
    ->void {
  Tools().TakeMap(setup, Text(layer, layer_size), Text(key, key_size), Text(name, name_size));
}
PELT_EXPORT(PathOf)(size_t setup, const char* name, size_t size)->const char* {
  return Tell(Tools().PathOf(setup, Text(name, size)));
}
PELT_EXPORT(DescribeFiles)(size_t setup)->const char* { return Tell(Tools().DescribeFiles(setup)); }

}  // namespace pelt
