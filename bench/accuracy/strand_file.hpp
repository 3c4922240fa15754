// A strand as a text: what `pelt accuracy --strand` simulates.
//
//     length = 0.05          # m, needed
//     links = 3              # parts that are seen; or 4, 8
//     frequency_hz = 4.0     # of the first bending mode: a rod; or stiffness = [..], N m per joint, of a chain
//     rod = "calibrated"     # or "uniform": a chain of equal masses and joints; with frequency_hz
//     damping_ratio = 0.05   # of the first mode, by bending alone
//     drag = 4.0             # 1/s, towards the wind
//     gravity = [0, -9.81, 0]
//     root = [0.1, 0, 0]     # m, in the body's frame
//     rest = [[0, 1, 0], [0.2, 0.98, 0], [0.4, 0.9, 0.1]]   # link directions, body's frame
//     start = "rest"         # or "equilibrium", or link directions in the world
//     mass = [..]            # kg a point, with stiffness; in equal shares of 1 kg otherwise
//
// A rod is what a layer makes a strand of, and what moves exactly is the rod itself. A chain's exact motion is the
// chain's: of 8 links no solver runs it.
//
// Invariant: 3, 4 or 8 links of equal length, everything finite and within bounds, directions of length
// 1. Whatever is not is an Error with file, line, key and reason.
#pragma once

#include <string>
#include <string_view>

#include "bench/accuracy/chain_problem.hpp"

namespace pelt::accuracy {

struct StrandFile {
  ChainMaterial material;  // as links
  bool rod = false;        // a rod that bends; else the chain itself
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
