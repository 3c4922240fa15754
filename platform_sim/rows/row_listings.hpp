// The listings of the measured rows, made from what consoles.md says was run. Nothing here knows
// what was measured.
#pragma once

#include <cstdint>
#include <string>

namespace pelt {

// ---- SPU listings, their loop labelled "loop" ------------------------------------------------

std::string SinglePrecisionFma();  // C1
std::string IntegerMultiplyAdd();  // C2
std::string NewtonSteps();         // C5
std::string DoublePrecisionFma();  // C7
std::string UnhintedBranch();      // C9
// C13: no listing of the row's kernel is published; this is a schedule of our own for the same
// work.
std::string MatrixMultiply();
inline constexpr uint32_t kMatrixMultiplyFmas = 2 * 64 * 32;  // of a turn
std::string PublishedListing();                               // C23

// ---- PPE and Xenon listings ------------------------------------------------------------------

std::string PointerChase();       // P1, P3: a load a turn, its address the last one's result
std::string VectorStream();       // P5: 128 bytes a turn
std::string VectorFmaChains();    // P7
std::string MixedVectorKernel();  // X6
std::string LoadHitStore();       // X5

}  // namespace pelt
