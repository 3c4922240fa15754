// Fills a layer's ModalTable for one frame: everything about a modal step that does not depend
// on the strand.
//
// The root's motion is the polynomial through its last four poses, at the times they had: frames
// need not be equally long. In backward differences S, S - S1, S - 2 S1 + S2, ... its value and
// derivatives at any time are weights that depend on the four times alone, and the modes' answers
// to them are weights too.
//
// Where the root's velocity is known at both ends of the frame, its motion is the cubic that has
// both (Hermite's). With D = S - S1, e and s the frame's length times dS/dt at its end and start, and
// u from -1 to 0,
//
//     S(u) = S + D u + D2 u (u + 1) / 2 + D3 u^2 (u + 1),   D2 = 2 (e - D),   D3 = e + s - 2 D,
//
// so D2 and D3 take the places of the second and third difference, and nothing but their weights is
// another. D2 is the second difference of the quadratic that has S, S1 and e: frames that know
// velocities and frames that do not can follow each other.
//
// Cost: some 5 microseconds per layer and frame (dt varies), nothing per
// strand.
//
// Invariant: double precision and exact arithmetic throughout (core/exact_math.hpp), rounded to
// float once, at the end.
#pragma once

#include "core/modal/modal_block.hpp"
#include "core/modal/modal_material.hpp"
#include "core/modal/modal_quality.hpp"

namespace pelt {

// The bending modes of a strand: the coordinates in which the linear part of its equation
// (modal_material.hpp) falls apart into single oscillators. Phi^T M Phi = 1, Phi^T K Phi = diag(omega^2).
//
// Invariant: plus, minus, times, divide and square root alone, a fixed order of rotations: the same
// bits everywhere. Modes are in ascending order of frequency and the largest component of each is
// positive. What breaks if ignored: tables, and with them every digest, depend on the machine.
//
// Source: Jacobi's rotations on L^-1 K L^-T, M = L L^T.

struct ModalModes {
  using Matrix = ModalMaterial::Matrix;

  uint32_t nodes;
  Matrix inverse_mass;
  Matrix shape;              // Phi: [node][mode]
  Matrix image;              // Phi^T M: [mode][node]
  double omega2[kMaxNodes];  // 1/s^2, >= 0
  double pull[kMaxNodes];    // Phi^T b: of each mode
  double root[kMaxNodes];    // M^-1 b: how the root's place enters each vector
};

ModalModes FindModes(const ModalMaterial& material);

// ModalQuality at 60 frames per second: kFast takes one substep, kFine three, kBest three with
// three Newton steps and a constraint force that turns with its tangent. Substeps are kept short (1/48 s
// for kFast, 1/150 s for the others), so a frame of 1/30 s takes two or five; kFine's to 1/200 s where
// the root's velocities are known.
// What each gets wrong, and costs: README.md, `pelt accuracy`.

// The last frames' lengths, s: this one's first. All > 0.
struct FrameTimes {
  double dt_s[kModalSamples - 1];
  bool velocities = false;  // of the root are known in this frame; then only its own length counts
};

// A frame longer than this is not stepped: strands are carried (kernels/modal_frame.hpp).
inline constexpr double kLongestModalFrame_s = 0.075;  // kModalSubsteps of the longest there are
// The frame that it then counts as where later ones look back.
inline constexpr double FrameInHistory(double dt_s) {
  return dt_s > kLongestModalFrame_s ? double(kCarriedFrame_s) : dt_s;
}
// The times of a frame of dt_s that follows one with `last`. Whether velocities are known is as it
// was.
FrameTimes NextTimes(const FrameTimes& last, double dt_s);

// What depends on the material alone; made once.
struct ModalLayer {
  ModalMaterial material;
  ModalModes modes;
};
ModalLayer MakeModalLayer(const ModalMaterial& material);

// How far a steady force at the tip moves it in a substep of such a frame, lengths left aside, over
// how far in one of 1/120 s. 0 without substeps.
double PushRatio(const ModalLayer& layer, ModalQuality quality, const FrameTimes& times);

void FillModalTable(const ModalLayer& layer, ModalQuality quality, const FrameTimes& times,
                    ModalTableBlock* table);

}  // namespace pelt
