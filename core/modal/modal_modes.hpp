// The bending modes of a chain of links: the coordinates in which its linear part falls apart into
// single oscillators.
//
// M_ij = mass beyond the later of links i and j, K tridiagonal (modal_material.hpp). Phi has
// Phi^T M Phi = 1 and Phi^T K Phi = diag(omega^2).
//
// Invariant: plus, minus, times, divide and square root alone, a fixed order of rotations: the same
// bits everywhere. Modes are in ascending order of frequency and the largest component of each is
// positive. What breaks if ignored: tables, and with them every digest, depend on the machine.
//
// Source: Jacobi's rotations on L^-1 K L^-T, M = L L^T.
#pragma once

#include "core/modal/modal_material.hpp"

namespace pelt {

struct ModalModes {
  uint32_t links;
  double mass[kMaxLinks][kMaxLinks];
  double stiffness[kMaxLinks][kMaxLinks];
  double inverse_mass_diagonal[kMaxLinks];  // M^-1 is tridiagonal
  double inverse_mass_off[kMaxLinks];       // of (i, i + 1)
  double shape[kMaxLinks][kMaxLinks];       // Phi: [link][mode]
  double image[kMaxLinks][kMaxLinks];       // Phi^T M: [mode][link]
  double omega2[kMaxLinks];                 // 1/s^2, >= 0
};

ModalModes FindModes(const ModalMaterial& material);

}  // namespace pelt
