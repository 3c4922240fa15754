#include "bench/picture/shell_shadow.hpp"

#include <algorithm>

#include "bench/shading/shading.hpp"

namespace pelt {
namespace {

using Covers = std::array<float, 256>;

// Share of the texels that are drawn at this threshold, for each stencil.
Covers ShareAbove(const std::array<uint32_t, 256>& texels_of_length, float threshold) {
  float all = 0.0f;
  for (const uint32_t texels : texels_of_length) all += float(texels);
  Covers share;
  for (uint32_t stencil = 0; stencil < share.size(); ++stencil) {
    float drawn = 0.0f;
    for (uint32_t length = 0; length < texels_of_length.size(); ++length)
      drawn += float(texels_of_length[length]) *
               ShellCoverage(float(length) / 255.0f, float(stencil) / 255.0f, threshold);
    share[stencil] = drawn / std::max(all, 1.0f);
  }
  return share;
}

}  // namespace

std::vector<ShadowShell> FindShadowShells(std::span<const Shell> shells,
                                          const FurTexture& texture) {
  std::array<uint32_t, 256> texels_of_length{};
  for (const uint8_t length : texture.texels) ++texels_of_length[length];
  const size_t count = std::min(shells.size(), kShadowShells);
  std::vector<ShadowShell> found(count);
  Covers above{};  // what reaches the next one up
  for (size_t i = count; i-- > 0;) {
    const Shell& shell = shells[(i + 1) * shells.size() / count - 1];
    const Covers here = ShareAbove(texels_of_length, shell.threshold);
    found[i].height = shell.height;
    for (size_t s = 0; s < here.size(); ++s) found[i].covers[s] = (here[s] - above[s]) * shell.fade;
    above = here;
  }
  return found;
}

void AddShells(const LayerDraw& draw, const FurTexture& texture, ShadowMap& map) {
  if (draw.shells.shell.empty()) return;
  std::vector<uint32_t> indices(WriteShellIndices(draw.shells, {}));
  WriteShellIndices(draw.shells, indices);
  const std::span<const ShellVertex> vertices = draw.As<ShellVertex>();
  for (const ShadowShell& shell : FindShadowShells(draw.shells.shell, texture))
    for (size_t t = 0; t < indices.size(); t += 3) {
      glm::vec3 at[3], covered;
      for (int k = 0; k < 3; ++k) {
        const ShellVertex& vertex = vertices[indices[t + size_t(k)]];
        at[k] = ShellPosition(VecOf(vertex.position), VecOf(vertex.groom), VecOf(vertex.force),
                              shell.height);
        covered[k] = shell.covers[vertex.base_colour >> 24];
      }
      map.AddTriangle(at[0], at[1], at[2], covered);
    }
}

}  // namespace pelt
