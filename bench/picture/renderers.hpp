// What can draw a picture, by name.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "bench/picture/picture.hpp"
#include "core/error.hpp"

namespace pelt {

// The first is the default.
std::vector<std::string> RendererNames();

// Fails where what it needs is not here, and says what to install. A renderer belongs to the thread that opened it.
Result<std::unique_ptr<PictureRenderer>> OpenRenderer(std::string_view name);

}  // namespace pelt
