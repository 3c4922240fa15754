// How exactly the modal solver steps, and which quality a modal layer needs for what is seen of it.
//
// The idea: in calm motion `fast` is some share of a strand's length off (kFastTypicalError), so its error on the
// screen follows from the longest strand's length and how near the eye comes to the layer. Where that is below what
// the caller allows, the other substeps of `fine` change next to nothing that is seen.
//
// What chooses is typical, and no bound: motion that is not calm is off by more. The bound is ErrorShare's.
//
// Layers whose author asked for `fast` or `best` have that at any distance.
//
// Invariant: a function of the view and the layer's box, both computed alike on every machine, with
// comparisons of squares: no root.
#pragma once

#include <cstdint>

#include "core/chunk.hpp"
#include "core/layer.hpp"
#include "core/view.hpp"

namespace pelt {

// Substeps are of a frame of 1/60 s. The figures of each stand in README.md.
enum class ModalQuality : uint8_t {
  kFast,  // one substep, two Newton steps
  kFine,  // three, four where the root's velocities are known
  kBest,  // three, three Newton steps in each, and the constraint force turns within the step
};

// RMS distance of `fast` from the converged motion at 60 frames per second, over the longest strand's length: about
// that of `monster`.
inline constexpr float kFastTypicalError = 0.006f;
// A layer keeps `fast` until its error is this many times what is allowed: a camera that sways at
// the bound does not change tables, which wake sleepers, every frame.
inline constexpr float kFastHysteresis = 1.1f;

// `last`: what the layer has. `box`: of the layer, m, in the view's space. `length_max`: of its
// strands, m. `allowed_px`: 0 or more; 0 keeps `asked`.
ModalQuality QualityOnScreen(ModalQuality asked, ModalQuality last, const View& view,
                             const BoundsBlock& box, float length_max, float allowed_px);

// Of `fast`, typical, at the nearest place of the box, px^2.
double FastErrorPx2(const View& view, const BoundsBlock& box, float length_max);

// 99 % of a scene's tips are at most so far off `best` at 8 times the frame rate, over their layer's longest strand: in
// every built-in scene that has one at another rate (`pelt accuracy --scene`, "within"). It is `eyepet` that needs it,
// whose feet stand on the ground; README.md has what others are off. Where chains at vertices are thinned (CountChains)
// it is of the tips that live, and wider: `tiny` needs it, whose patches are small.
constexpr float ErrorShare(ModalQuality quality, uint32_t chain_level = 0) {
  constexpr float kShares[] = {0.08f, 0.06f, 0.06f},
                  kThinned[kChainLevels] = {0, 0.04f, 0.10f, 0.12f};
  return kShares[uint32_t(quality)] + kThinned[chain_level];
}

// The most that a length in the box spans on the screen, px: at its nearest place. For reports and what is drawn,
// not for frames: has a root and a division.
float LengthOnScreenPx(const View& view, const BoundsBlock& box, float length);

struct ScreenQuality {
  ModalQuality quality;
  uint32_t chain_level;  // of chains at vertices (CountChains)
  float error_px;        // the bound, at the nearest place of the layer's box
};

}  // namespace pelt
