// What the page's module exports: a Viewer and the renderer behind plain functions. The caller is bench/page/worker.js.
//
// Texts go in as UTF-8 in memory that Allocate gave, and come out as a pointer whose size TextSize tells, good until the
// next call. What a call throws is said on standard error, and ends the module (wasm/throw.cpp).
#include <cstdlib>
#include <cstring>

#include "bench/page/page_request.hpp"
#include "bench/page/viewer.hpp"
#include "bench/picture/gl_renderer.hpp"
#include "core/given_files.hpp"

#define PELT_EXPORT(name) extern "C" __attribute__((export_name(#name))) auto name

namespace pelt {
namespace {

struct Page {
  std::unique_ptr<Viewer> viewer;
  std::optional<GlRenderer> renderer;
  std::string text;
  float place[3] = {};
};
Page& ThePage() {
  static Page page;
  return page;
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
  ThePage().viewer = std::make_unique<Viewer>(ReadRequest(Text(request, size)));
}

// Null, or why there is no picture.
PELT_EXPORT(OpenRenderer)()->const char* {
  Result<GlRenderer> opened = GlRenderer::Open();
  if (!opened) return Tell(opened.error());
  ThePage().renderer.emplace(*std::move(opened));
  return nullptr;
}

PELT_EXPORT(Describe)()->const char* { return Tell(ThePage().viewer->Describe()); }
PELT_EXPORT(LastFrame)()->const char* { return Tell(ThePage().viewer->LastFrame()); }
PELT_EXPORT(SetupText)()->const char* { return Tell(ThePage().viewer->setup_text()); }

// Null, or why the frame was refused.
PELT_EXPORT(Step)()->const char* {
  const char* refused = ThePage().viewer->Step();
  return refused ? Tell(refused) : nullptr;
}
PELT_EXPORT(HasInBetween)()->int { return ThePage().viewer->HasInBetween(); }
PELT_EXPORT(TakeDigests)(uint32_t frames)->void { ThePage().viewer->TakeDigests(frames); }
PELT_EXPORT(Restart)()->void { ThePage().viewer->Restart(); }

// As it is at `share` of the way from the frame before, where there is something in between.
PELT_EXPORT(Draw)(uint32_t width_px, uint32_t height_px, uint32_t samples, float share)->void {
  Page& page = ThePage();
  page.viewer->SetViewport(width_px, height_px);
  page.renderer->Show(page.viewer->Gather(share),
                      {.width_px = width_px, .height_px = height_px, .samples = samples});
}

PELT_EXPORT(Set)(const char* key, size_t size, double value)->void {
  ThePage().viewer->Set(Text(key, size), value);
}
PELT_EXPORT(ChangeKey)
(const char* layer, size_t layer_size, const char* key, size_t key_size, const char* value,
 size_t value_size)
    ->void {
  ThePage().viewer->ChangeKey(Text(layer, layer_size), Text(key, key_size),
                              Text(value, value_size));
}
PELT_EXPORT(ReplaceSetup)(const char* text, size_t size)->void {
  ThePage().viewer->ReplaceSetup(std::string(Text(text, size)));
}

PELT_EXPORT(SetCamera)
(double x, double y, double z, double yaw_rad, double elevation_rad, double distance_m)->void {
  ThePage().viewer->SetCamera(
      PageCamera{{float(x), float(y), float(z)}, yaw_rad, elevation_rad, distance_m});
}
PELT_EXPORT(TakeScenesCamera)()->void { ThePage().viewer->SetCamera(std::nullopt); }

// Three floats: where the characters are under this place of the picture; null: nowhere.
PELT_EXPORT(Pick)(double x, double y)->const float* {
  Page& page = ThePage();
  const auto place = page.viewer->Pick(page.viewer->RayAt(x, y));
  if (!place) return nullptr;
  std::memcpy(page.place, &(*place)[0], sizeof(page.place));
  return page.place;
}
PELT_EXPORT(Paint)(uint32_t channel, float x, float y, float z)->void {
  ThePage().viewer->Paint(channel, {x, y, z});
}
PELT_EXPORT(MoveSphere)(float x, float y, float z)->void {
  ThePage().viewer->MoveSphere({x, y, z});
}

}  // namespace pelt
