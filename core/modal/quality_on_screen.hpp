// Which quality a modal layer needs for what is seen of it.
//
// The idea: `fast` is a known share of a strand's length off (kFastError), so its error on the screen
// is bounded by the longest strand's length and how near the eye comes to the layer. Where that is
// below what the caller allows, the other substeps of `fine` change nothing that is seen.
//
// Layers whose author asked for `fast` or `best` have that at any distance.
//
// Invariant: a function of the view and the layer's box, both computed alike on every machine, with
// comparisons of squares: no root, no division.
#pragma once

#include "core/chunk.hpp"
#include "core/modal/modal_quality.hpp"
#include "core/view.hpp"

namespace pelt {

// RMS distance of `fast` from the converged motion at 60 frames per second, over a strand's length: that of
// `monster` (0.31 mm; `pelt accuracy --scene monster`), here taken of the layer's longest strand. Other coats were not
// measured one by one, and what contact gets wrong comes besides, in every quality alike (`eyepet`: 2.83 mm in fast, 2.80
// in the default).
inline constexpr float kFastError = 0.006f;
// A layer keeps `fast` until its error is this many times what is allowed: a camera that sways at
// the bound does not change tables, which wake sleepers, every frame.
inline constexpr float kFastHysteresis = 1.1f;

// `last`: what the layer has. `box`: of the layer, m, in the view's space. `length_max`: of its
// strands, m. `allowed_px`: 0 or more; 0 keeps `asked`.
ModalQuality QualityOnScreen(ModalQuality asked, ModalQuality last, const View& view,
                             const BoundsBlock& box, float length_max, float allowed_px);

}  // namespace pelt
