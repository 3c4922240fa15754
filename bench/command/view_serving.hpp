// `pelt view --open` and `--watch`: the page at an address of this machine, until a signal ends it.
#pragma once

#include <functional>

#include "bench/command/commands.hpp"
#include "bench/page/scene_watch.hpp"

namespace pelt {

// `content`: of the page that is asked for next. `watched`: with what changes in it; or null.
ExitCode ServePage(uint16_t port, const std::function<PageContent()>& content, SceneWatch* watched);

}  // namespace pelt
