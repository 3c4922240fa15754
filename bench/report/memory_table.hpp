// What every range of a scene's block takes.
#pragma once

#include "bench/report/report_tree.hpp"
#include "jobs/scene.hpp"

namespace pelt {

// "memory": an object from a range's name to its bytes; and the sums.
void AddMemory(const SceneLayout& layout, ReportTree& report);

}  // namespace pelt
