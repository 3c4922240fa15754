// A strand texture out of a photograph with alpha: tufts or hairs beside each other, roots on top.
#pragma once

#include <string>

#include "core/groom/fur_setup.hpp"

namespace pelt {

// Cuts the picture into so many pieces of one width, a silhouette each. A piece's hairs are straightened, the middle of
// each row over the others', and drawn out from the first row that has alpha, the roots, to the last. What it covers
// is all that is taken (StrandChannels::kLook). Throws pelt::Error with `name` where strips is not 1 to 256 or a piece is
// empty.
StrandTexture CutStrips(const ControlMap& photo, uint32_t strips, const std::string& name);

}  // namespace pelt
