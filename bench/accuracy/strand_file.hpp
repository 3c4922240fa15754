// A strand as a text: what `pelt accuracy --strand` simulates.
//
//     length = 0.05          # m, needed
//     links = 3              # or 4; 8 for the exact motion alone
//     frequency_hz = 4.0     # of the first bending mode; or stiffness = [..], N m per joint
//     rod = "calibrated"     # or "uniform": equal masses and joints; with frequency_hz
//     damping_ratio = 0.05   # of the first mode, by bending alone
//     drag = 4.0             # 1/s, towards the wind
//     gravity = [0, -9.81, 0]
//     root = [0.1, 0, 0]     # m, in the body's frame
//     rest = [[0, 1, 0], [0.2, 0.98, 0], [0.4, 0.9, 0.1]]   # link directions, body's frame
//     start = "rest"         # or "equilibrium", or link directions in the world
//     mass = [..]            # kg a point, with stiffness; in equal shares of 1 kg otherwise
//
// Invariant: a StrandFile is a chain that every solver can be asked to run (of 8 links none): 3, 4 or 8 links of equal length, everything finite and within bounds, directions of length
// 1. Whatever is not is an Error with file, line, key and reason.
#pragma once

#include <string>
#include <string_view>

#include "bench/accuracy/chain_problem.hpp"

namespace pelt::accuracy {

struct StrandFile {
  ChainMaterial material;
  Strand strand;
  enum class Start { kRest, kEquilibrium, kGiven } start = Start::kRest;
  std::array<Double3, kMaxLinks> given{};  // with kGiven, world

  // Link directions, world, for a body that begins with `pose`.
  std::array<Double3, kMaxLinks> StartIn(const BodyPose& pose) const;
};

// `path` is for messages.
StrandFile ParseStrand(std::string_view text, const std::string& path);
StrandFile ReadStrandFile(const std::string& path);

}  // namespace pelt::accuracy
