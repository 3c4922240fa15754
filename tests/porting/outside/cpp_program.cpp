// An engine in C++: runs a frame and draws it from Draws(), with vertices sorted by Pelt and again
// through an index buffer. Prints the picture and the digest of the README's example.
//
//   cpp_program GROOM
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <vector>

#include "draw_frame.h"
#include "pelt/core/bind_pose.hpp"
#include "pelt/core/groom/groom_file.hpp"
#include "pelt/core/ribbon_indices.hpp"
#include "pelt/jobs/scene.hpp"

namespace {

void DrawLayer(const pelt::LayerDraw& draw, pelt::VertexOrder order, Canvas& canvas) {
  const auto* vertices = reinterpret_cast<const unsigned char*>(draw.vertices.data());
  const bool sorted = order == pelt::VertexOrder::kSorted;
  if (draw.output == pelt::Output::kInstances) {
    for (uint32_t place = 0; place < draw.strand_count; ++place) {
      const size_t at = sorted ? place : draw.order[place];
      DrawInstances(&canvas, vertices + at * draw.format().vertex_bytes, 1);
    }
  } else if (draw.output == pelt::Output::kRibbons) {
    std::vector<uint32_t> indices(draw.strand_count * size_t(pelt::kRibbonIndicesPerHair));
    if (sorted)
      pelt::WriteRibbonIndices(indices);
    else
      pelt::WriteSortedRibbonIndices(draw.order, 0, indices);
    DrawRibbons(&canvas, vertices, indices.data(), indices.size());
  } else if (draw.output == pelt::Output::kShells) {
    std::vector<uint32_t> indices(pelt::WriteShellIndices(draw.shells, {}));
    pelt::WriteShellIndices(draw.shells, indices);
    for (const pelt::Shell& shell : draw.shells.shell)
      DrawShell(&canvas, vertices, indices.data(), indices.size(), shell.height);
    std::vector<pelt::Fin> fins(pelt::WriteFins(draw.shells, {}));
    pelt::WriteFins(draw.shells, fins);
    for (const pelt::Fin& fin : fins) DrawFin(&canvas, vertices, fin.from, fin.to);
  }
}

bool DrawFrame(const pelt::Groom& groom, pelt::VertexOrder order, Canvas& canvas,
               uint64_t& digest) {
  const pelt::Groom* grooms[] = {&groom};
  pelt::SceneOptions options;
  options.vertex_order = order;
  const auto made = pelt::FurScene::Create(grooms, options);
  if (!made) return std::fprintf(stderr, "%s\n", made.error().c_str()), false;
  pelt::FurScene& scene = **made;
  pelt::FillBindPose(groom, scene.Pose(0));
  if (scene.BeginFrame({}) || pelt::SerialExecutor().Run(scene.CurrentFrame())) return false;
  float low[3] = {1e9f, 1e9f, 1e9f}, high[3] = {-1e9f, -1e9f, -1e9f};
  for (const pelt::LayerDraw& draw : scene.Draws())
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], draw.low[axis]);
      high[axis] = std::max(high[axis], draw.high[axis]);
    }
  LookAt(&canvas, low, high);
  for (const pelt::LayerDraw& draw : scene.Draws()) DrawLayer(draw, order, canvas);
  digest = scene.DigestFrame();
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const auto groom = pelt::ReadGroomFile(argv[1]);
  if (!groom) return 2;
  static Canvas sorted, indexed;
  uint64_t digest = 0, other = 0;
  if (!DrawFrame(*groom, pelt::VertexOrder::kIndexBuffer, indexed, other) ||
      !DrawFrame(*groom, pelt::VertexOrder::kSorted, sorted, digest))
    return 1;
  if (std::memcmp(&sorted, &indexed, sizeof sorted) != 0)
    return std::fprintf(stderr, "the two vertex orders draw two pictures\n"), 1;
  const bool seen = ShowCanvas(&sorted) > 50;
  std::printf("%016llx\n", static_cast<unsigned long long>(digest));
  return seen ? 0 : 1;
}
