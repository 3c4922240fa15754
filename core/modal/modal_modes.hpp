// The bending modes of a strand: the coordinates in which the linear part of its equation
// (modal_material.hpp) falls apart into single oscillators. Phi^T M Phi = 1, Phi^T K Phi = diag(omega^2).
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

}  // namespace pelt
