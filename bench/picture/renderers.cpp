#include "bench/picture/renderers.hpp"

#include <algorithm>

#include "bench/picture/gl_renderer.hpp"

namespace pelt {
namespace {

using Opened = Result<std::unique_ptr<PictureRenderer>>;

Opened OpenSoftware() { return Opened(std::make_unique<SoftwareRenderer>()); }

Opened OpenGl() {
  Result<GlRenderer> renderer = GlRenderer::Open();
  if (!renderer) return Failure{renderer.error()};
  return Opened(std::make_unique<GlRenderer>(*std::move(renderer)));
}

constexpr struct {
  std::string_view name;
  Opened (*make)();
} kRenderers[] = {{"software", OpenSoftware}, {"gl", OpenGl}};

}  // namespace

std::vector<std::string> RendererNames() {
  std::vector<std::string> names;
  for (const auto& row : kRenderers) names.emplace_back(row.name);
  return names;
}

Opened OpenRenderer(std::string_view name) {
  const auto* row = std::ranges::find(kRenderers, name, [](const auto& r) { return r.name; });
  if (row == std::end(kRenderers)) return Failure{"there is no renderer " + std::string(name)};
  return row->make();
}

}  // namespace pelt
