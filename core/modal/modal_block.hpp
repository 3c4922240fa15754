// The blocks of the modal solver: one table a layer and frame, one state block a chunk.
//
// Lengths are in links (a lane's own segment length), so that one table serves every lane. Q and Z
// below are modal coordinates of D and dD/dt, where D_i is link i's direction and D_1 carries the
// root's place too: Q = Phi^T M (d + e1 X), X the root's place in links, measured from where it is
// at the end of the frame (floats stay small however far the character is from the origin).
//
// Bytes a strand: 244 with 3 links, 308 with 4, 564 with 8 (state; 275, 347 and 635 with the rows'
// padding), besides the 36, 48 or 96 of its points.
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/chunk.hpp"
#include "core/modal/modal_material.hpp"

namespace pelt {

// What the root did in a frame that was too long to be stepped is kept as of one this long.
inline constexpr float kCarriedFrame_s = 1.0f / 60.0f;
inline constexpr uint32_t kModalSubsteps = 6;  // at most; as many as keep them short enough
inline constexpr uint32_t kModalSamples = 4;  // root poses that the frame's motion is drawn through
// Floats between two rows of the state. Rows of a power of two bytes would fall on a handful of
// cache sets, and a step reads and writes some ninety of them: the odd line costs 1/8 more memory
// and saves 15 % of the time.
inline constexpr uint32_t kModalRow = kStrandsPerChunk + 16;

// One substep's weights. Root poses enter as the pull of the newest one, T = omega^2 Phi^T M r, and
// T's backward differences (with the root's place). Where velocities are known, what stands for the
// second and third difference is made from those (modal_table.hpp).
template <uint32_t kMost>
struct ModalSubstepOf {
  float bend_q[kModalSamples - 1][kMost];  // of T's differences in Q at the end: [dT ..][mode]
  float bend_z[kModalSamples - 1][kMost];
  float wind_q[kMost], wind_z[kMost];    // of its change since last frame
  float root_place[kModalSamples - 1];   // X at the end, of the root's differences; 0 at the last
  float root_speed[kModalSamples - 1];   // dX/dt at the end, 1/s
  float start_place[kModalSamples - 1];  // as root_place, at the start
};

// To a whole block alignment.
template <uint32_t kMost>
struct ModalTablePad {};
template <>
struct ModalTablePad<8> {
  uint32_t zero[4];
};

// Constant over the frame; lanes differ only in their length. Matrices are [row][column]. For at
// most kMost links: chains of 3 and 4 share a table, and those of 8 have one of their own, as it is
// more than twice as large.
template <uint32_t kMost>
struct alignas(kBlockAlignment) ModalTableOf {
  using Substep = ModalSubstepOf<kMost>;

  uint32_t links;
  uint32_t substeps;  // 1 to kModalSubsteps; 0: the frame is too long, strands are carried
  // Not 0: three Newton steps, and the constraint force turns with its link within the step.
  uint32_t use_slope;
  uint32_t parent_curl;  // not 0: the curl follows its parent link (modal_curl.hpp)
  float joint[kMost];    // read only then: the stiffness of the joint above each link, 1/s^2; in
                         // place of the root's: 1 / |r_j - r_p|^2 of the most that is followed
  float rest_of_bend[kMost][kMost];  // r of T: K^-1 M Phi; 0 where a joint is loose
  float y_of_y[kMost], y_of_v[kMost], v_of_y[kMost], v_of_v[kMost];
  float y_of_force[kMost], v_of_force[kMost];  // of a force constant over the substep
  Substep substep[kModalSubsteps];
  float shape[kMost][kMost];     // Phi: [link][mode]
  float image[kMost][kMost];     // Phi^T M: [mode][link]
  float bend[kMost][kMost];      // omega^2 Phi^T M: [mode][link]
  float response[kMost][kMost];  // B / 2
  float slope[kMost][kMost];     // B1 / h: of a force's change over the substep
  float impulse[kMost];          // q0 / 2
  float impulse_slope[kMost];    // q1 / h
  float inverse_mass[kMost], inverse_mass_off[kMost];
  // The fallback: implicit Euler over the whole frame.
  float euler[kMost][kMost];  // M (1/H^2 + c/H) + K (1 + beta/H)
  float euler_inverse[kMost][kMost];
  float mass[kMost][kMost];
  float mass_shape[kMost][kMost];  // M Phi: [link][mode]
  float stiffness[kMost][kMost];
  float euler_place;                        // 1/H^2 + c/H
  float euler_speed;                        // 1/H
  float euler_bend;                         // beta/H
  float frame_s;                            // H
  float quiet_s;                            // a lane that was this long without motion is at rest
  float root_end_speed[kModalSamples - 1];  // dX/dt at the frame's end
  uint32_t looks;                           // ahead, before the first Newton step, and the share
  float look_share;                         // of the last pull they see (modal_step.hpp)
  [[no_unique_address]] ModalTablePad<kMost> pad;
};
using ModalTableBlock = ModalTableOf<4>;
using LongModalTableBlock = ModalTableOf<8>;
static_assert(sizeof(ModalTableBlock) == 480 * 4);  // no hidden bytes
static_assert(sizeof(LongModalTableBlock) == 1248 * 4);

// Of chains of so many links.
template <uint32_t kLinks>
using ModalTable = std::conditional_t<(kLinks > 4), LongModalTableBlock, ModalTableBlock>;
template <uint32_t kLinks>
using ModalSubstep = typename ModalTable<kLinks>::Substep;

template <uint32_t kPoints>
struct alignas(kBlockAlignment) ModalStateBlock {
  static constexpr uint32_t kLinks = kPoints - 1;
  float direction[kLinks][3][kModalRow];  // unit, world axes
  float velocity[kLinks][3][kModalRow];   // Z, by mode, links/s
  float multiplier[kLinks][kModalRow];    // of the lengths: the next step's first guess
  float bend[kLinks][3][kModalRow];       // T of the last frame
  float bend_step[kLinks][3][kModalRow];  // its first and second backward difference, with the
  float bend_turn[kLinks][3][kModalRow];  // root's place
  float root_step[3][kModalRow];          // the same of the root's place alone, links
  float root_turn[3][kModalRow];
  float wind[3][kModalRow];    // last frame's acceleration, m/s^2
  float normal[3][kModalRow];  // last frame's, of the skin at the root
  float quiet_s[kModalRow];    // since it last moved; below 0: struck (modal_strike.hpp)
  float pad[16];               // to a whole block alignment
};
static_assert(sizeof(ModalStateBlock<4>) == 61 * 4 * kModalRow + 64);
static_assert(sizeof(ModalStateBlock<5>) == 77 * 4 * kModalRow + 64);
static_assert(sizeof(ModalStateBlock<9>) == 141 * 4 * kModalRow + 64);

}  // namespace pelt
