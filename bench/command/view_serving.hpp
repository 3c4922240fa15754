// `pelt view --open` and `--watch`: the page at an address of this machine, until a signal ends it.
#pragma once

#include <string>

#include "bench/command/commands.hpp"
#include "bench/page/scene_watch.hpp"

namespace pelt {

// Returns the exit code. `command`: as PageContent's.
int ServePage(const ViewArgs& args, const std::string& command, SceneWatch& scene);

}  // namespace pelt
