#include "bench/consoles/gpu_bound.hpp"

#include <fmt/format.h>

#include <cmath>
#include <glm/glm.hpp>

namespace pelt {
namespace {

// Of one strand of an output.
struct StrandGeometry {
  double vertices, vertex_instructions, triangles;
};

// Strips and ribbons: two vertices at each end of a piece.
StrandGeometry Strip(uint32_t pieces, uint32_t instructions) {
  const double vertices = 2.0 * (pieces + 1);
  return {vertices, vertices * instructions, 2.0 * pieces};
}

// `curve_vertex`: instructions where the GPU deforms a cubic.
StrandGeometry GeometryOf(const LayerDraw& draw, uint32_t curve_vertex,
                          const ShaderNumbers& shaders) {
  if (draw.output == Output::kInstances) return Strip(draw.pieces, curve_vertex);
  return Strip(kRibbonPoints - 1, shaders.made_vertex);
}

void AddLayer(const LayerDraw& draw, const StrandGeometry& strand, DrawPass& pass) {
  const double strands = draw.strand_count;
  pass.vertices += strands * strand.vertices;
  pass.vertex_instructions += strands * strand.vertex_instructions;
  pass.triangles += strands * strand.triangles;
  pass.vertex_bytes += strands * draw.format().StrandBytes();
}

bool IsSeen(const glm::vec3& p, const View& view) {
  for (const auto& plane : view.planes)
    if (plane[0] * p.x + plane[1] * p.y + plane[2] * p.z + plane[3] < 0.0f) return false;
  return true;
}

// Across the view from its middle, px, in the world's directions: what lengths need.
glm::vec3 OnPicture(const glm::vec3& p, const View& view) {
  const glm::vec3 forward(view.forward[0], view.forward[1], view.forward[2]);
  const glm::vec3 from = p - glm::vec3(view.eye[0], view.eye[1], view.eye[2]);
  const float ahead = glm::dot(from, forward);
  return (from / ahead - forward) * view.pixels_per_unit_at_1m;
}

}  // namespace

double CoveredPixels(const StrandCurve& curve, const View& view) {
  double area = 0.0;
  const glm::vec3 forward(view.forward[0], view.forward[1], view.forward[2]);
  const glm::vec3 eye(view.eye[0], view.eye[1], view.eye[2]);
  const auto at = [&](uint32_t i) {
    return glm::vec3(curve.point[i][0], curve.point[i][1], curve.point[i][2]);
  };
  const auto width = [&](uint32_t i) {
    return curve.point[i][3] * view.pixels_per_unit_at_1m / glm::dot(at(i) - eye, forward);
  };
  for (uint32_t i = 0; i + 1 < kRibbonPoints; ++i) {
    if (!IsSeen(at(i), view) || !IsSeen(at(i + 1), view)) continue;
    area += 0.5 * double(width(i) + width(i + 1)) *
            double(glm::length(OnPicture(at(i + 1), view) - OnPicture(at(i), view)));
  }
  return area;
}

std::vector<DrawPass> FindDrawPasses(const FurScene& scene, const View& view,
                                     const ShaderNumbers& shaders) {
  DrawPass shadows{.name = "shadow map"}, picture{.name = "strands"};
  std::vector<StrandCurve> curves;
  for (const LayerDraw& draw : scene.Draws()) {
    if (!draw.format().OfStrands()) continue;
    AddLayer(draw, GeometryOf(draw, shaders.curve_shadow_vertex, shaders), shadows);
    AddLayer(draw, GeometryOf(draw, shaders.curve_vertex, shaders), picture);
    curves.resize(draw.live_strands);
    scene.CopyCurves(draw.layer, curves);
    std::vector<bool> is_drawn;
    for (const uint32_t strand : draw.order) {
      if (strand >= is_drawn.size()) is_drawn.resize(size_t(strand) + 1);
      is_drawn[strand] = true;
    }
    for (const StrandCurve& curve : curves)
      if (curve.strand < is_drawn.size() && is_drawn[curve.strand])
        picture.pixels += CoveredPixels(curve, view);
  }
  picture.pixel_instructions = picture.pixels * shaders.pixel;
  return {shadows, picture};
}

void AddGpuBound(const GpuParameters& gpu, const std::vector<DrawPass>& passes, ReportTree& tree) {
  tree.BlankLine();
  tree.Say(fmt::format(
      "{} at least, for the strands of the last frame: a lower bound, in no verdict", gpu.name));
  ReportTree& section = tree.AddSection("gpu");
  section.Add(InJson("name"), gpu.name);
  ReportTable& table = section.AddTable("passes", {{"pass"},
                                                   {"vertices"},
                                                   {"triangles"},
                                                   {"pixels", "", 0},
                                                   {"vertex_ms", "ms", 2, "vertex"},
                                                   {"pixel_ms", "ms", 2, "pixel"},
                                                   {"setup_ms", "ms", 2, "setup"},
                                                   {"blending_ms", "ms", 2, "blend"},
                                                   {"memory_ms", "ms", 2, "memory"},
                                                   {"at_least_ms", "ms", 2, "at least"},
                                                   {"binds"}});
  double all = 0.0;
  for (const DrawPass& pass : passes) {
    const DrawBound bound = BoundPass(gpu, pass);
    all += bound.at_least_ms;
    std::vector<Value> row = {pass.name, uint64_t(pass.vertices), uint64_t(pass.triangles),
                              pass.pixels};
    for (const double ms : bound.ms) row.push_back(ms);
    row.push_back(bound.at_least_ms);
    row.push_back(GpuUnitName(bound.binds));
    table.Add(std::move(row));
  }
  section.Add({"at_least_ms", "ms at least", 2, "in all"}, all);
}

}  // namespace pelt
