// What is described in the same way for all that the page shows.
#pragma once

#include <nlohmann/json.hpp>

#include "bench/scenarios/scenarios.hpp"
#include "bench/viewer/page_settings.hpp"
#include "bench/viewer/page_view.hpp"
#include "jobs/frame_recording.hpp"

namespace pelt {

using PageJson = nlohmann::ordered_json;

PageJson DescribeEntry(const PageEntry& entry, const PageSettings& settings);
PageJson DescribeOrbit(const PageCamera& camera);
PageJson DescribeViews();  // DataViews()
// Of each joint its name and the colour that the views give it, "#rrggbb".
PageJson DescribeJoints(std::span<const std::string> names);
PageJson DescribePasses(const FurScene& scene);
// Times and items of each stage, of the last frame that was profiled.
PageJson DescribeStages(const FurScene& scene, const FrameRecording& times);
// Of each setup, its layers by name: what all stages of that frame took for them, ns.
PageJson DescribeLayerCosts(const Scenario& scenario, const FurScene& scene,
                            const FrameRecording& times);

}  // namespace pelt
