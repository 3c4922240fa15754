// What a console's graphics processor has to do at least for the strands that a frame leaves to draw: counted from
// its Draws(), pixels from where its curves lie before the camera.
//
// The originals' 5 to 8 ms for all characters were the GPU's. This is a lower bound and no verdict.
#pragma once

#include <vector>

#include "bench/report/report_tree.hpp"
#include "core/view.hpp"
#include "jobs/scene.hpp"
#include "platform_sim/gpu/draw_bound.hpp"

namespace pelt {

// The shadow map's pass and the picture's, of the frame that ran last.
std::vector<DrawPass> FindDrawPasses(const FurScene& scene, const View& view,
                                     const ShaderNumbers& shaders = {});

// What a strand covers of the picture, px^2: of its pieces that lie whole within the view.
double CoveredPixels(const StrandCurve& curve, const View& view);

void AddGpuBound(const GpuParameters& gpu, const std::vector<DrawPass>& passes, ReportTree& tree);

}  // namespace pelt
