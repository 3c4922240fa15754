// The blocks of the modal solver: one table per layer and frame, one state block per chunk.
//
// Lengths are in parts of the strand (a lane's own segment length), so that one table serves every lane. Q and
// Z below are modal coordinates of D and dD/dt, where D_i is the tangent at node i, and the root's place X is
// in it: Q = Phi^T M (d + e X), e = M^-1 b, X in parts, measured from where the root is at the end of the frame
// (floats stay small however far the character is from the origin).
//
// Bytes per strand: 244 with 3 nodes, 308 with 4 (state; 275 and 347 with the rows' padding), besides the 36, 48
// or 96 of its points.
#pragma once

#include <cstdint>

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
struct ModalSubstep {
  float bend_q[kModalSamples - 1][kMaxNodes];  // of T's differences in Q at the end: [dT ..][mode]
  float bend_z[kModalSamples - 1][kMaxNodes];
  float wind_q[kMaxNodes], wind_z[kMaxNodes];  // of its change since last frame
  float root_place[kModalSamples - 1];    // X at the end, of the root's differences; 0 at the last
  float root_speed[kModalSamples - 1];    // dX/dt at the end, 1/s
  float middle_place[kModalSamples - 1];  // as root_place, in the middle
};

// Constant over the frame; lanes differ only in their length. Matrices are [row][column].
struct alignas(kBlockAlignment) ModalTableBlock {
  using Row = float[kMaxNodes];
  using Matrix = float[kMaxNodes][kMaxNodes];

  uint32_t nodes;
  uint32_t substeps;  // 1 to kModalSubsteps; 0: the frame is too long, strands are carried
  // Not 0: three Newton steps, and the constraint force turns with its vector within the step.
  uint32_t use_slope;
  uint32_t parent_curl;  // not 0: the curl turns with the strand (modal_curl.hpp)
  Row y_of_y, y_of_v, v_of_y, v_of_v;
  Row y_of_force, v_of_force;  // of a force constant over the substep
  ModalSubstep substep[kModalSubsteps];
  Matrix shape;         // Phi: [node][mode]
  Matrix image;         // Phi^T M: [mode][node]
  Matrix bend;          // omega^2 Phi^T M: [mode][node]
  Matrix rest_of_bend;  // r of T: K^-1 M Phi; 0 without stiffness
  Matrix response;      // B / 2
  Matrix slope;         // B1 / h: of a force's change over the substep
  Row impulse;          // q0 / 2
  Row impulse_slope;    // q1 / h
  Matrix inverse_mass;
  Row pull, pull_mode;  // b, Phi^T b
  Row bend_root;        // omega^2 Phi^T b: of the root's place in T
  Row root;             // e
  // How the strand lies (modal_material.hpp).
  float place[kMaxPlaces][kMaxNodes];
  float rest[kMaxNodes][kMaxPlaces];
  // The curl that turns with the strand: D, W, K D^-1 and the nodes' weights.
  Matrix curl_bend, curl_turn, curl_pull;
  Row curl_weight;
  // The fallback: implicit Euler over the whole frame.
  Matrix euler;  // M (1/H^2 + c/H) + K (1 + beta/H)
  Matrix euler_inverse;
  Matrix mass;
  Matrix mass_shape;  // M Phi: [node][mode]
  Matrix stiffness;
  float euler_place;                        // 1/H^2 + c/H
  float euler_speed;                        // 1/H
  float euler_bend;                         // beta/H
  float frame_s;                            // H
  float half_step_s;                        // h / 2
  float quiet_s;                            // a lane that was this long without motion is at rest
  float root_end_speed[kModalSamples - 1];  // dX/dt at the frame's end
  uint32_t looks;                           // ahead, before the first Newton step, and the share
  float look_share;                         // of the last pull they see (modal_step.hpp)
  float pad[23];                            // to a whole block alignment
};
static_assert(sizeof(ModalTableBlock) == 640 * 4);  // no hidden bytes

template <uint32_t kNodes>
struct alignas(kBlockAlignment) ModalStateBlock {
  float direction[kNodes][3][kModalRow];  // unit, world axes
  float velocity[kNodes][3][kModalRow];   // Z, by mode, 1/s
  float multiplier[kNodes][kModalRow];    // of the lengths: the next step's first guess
  float bend[kNodes][3][kModalRow];       // T of the last frame
  float bend_step[kNodes][3][kModalRow];  // its first and second backward difference, with the
  float bend_turn[kNodes][3][kModalRow];  // root's place
  float root_step[3][kModalRow];          // the same of the root's place alone, parts
  float root_turn[3][kModalRow];
  float wind[3][kModalRow];    // last frame's acceleration, m/s^2
  float normal[3][kModalRow];  // last frame's, of the skin at the root
  float quiet_s[kModalRow];    // since it last moved; below 0: struck (modal_strike.hpp)
  float pad[16];               // to a whole block alignment
};
static_assert(sizeof(ModalStateBlock<3>) == 61 * 4 * kModalRow + 64);
static_assert(sizeof(ModalStateBlock<4>) == 77 * 4 * kModalRow + 64);

}  // namespace pelt
