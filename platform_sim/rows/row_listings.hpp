// The listings of the measured rows, made from what consoles.md says was run. Nothing here knows
// what was measured.
#pragma once

#include <cstdint>
#include <string>

namespace pelt {

// ---- SPU listings, their loop labelled "loop" ------------------------------------------------

std::string SinglePrecisionFma();       // C1
std::string IntegerMultiplyAdd();       // C2
std::string Shuffles();                 // C3
std::string FmaBesideShuffles();        // C4
std::string NewtonSteps();              // C5
std::string NewtonStepsWithEvenNops();  // C6: behind each "and" a nop of its own pipe
std::string DoublePrecisionFma();       // C7
std::string UnhintedBranch();           // C9
std::string HintedBranch();             // C10
// C13: no listing of the row's kernel is published; this is a schedule of our own for the same
// work.
std::string MatrixMultiply();
inline constexpr uint32_t kMatrixMultiplyFmas = 2 * 64 * 32;  // per iteration
std::string PublishedListing();                               // C23

// ---- PPE and Xenon listings ------------------------------------------------------------------

std::string
PointerChase();  // P1, P3: eight loads per iteration, the address of each the last one's result
inline constexpr uint32_t kChasesPerIteration = 8;
std::string IndexChase();              // P2, P4: what is loaded is an index, one per iteration
std::string VectorStream();            // P5: 128 bytes per iteration
std::string PrefetchedVectorStream();  // P6: the same, with a dcbt for the line four further on
inline constexpr uint32_t kLinesAhead = 4;
std::string VectorFmaChains();   // P7: six chains, eight rounds
std::string ScalarFmaChains();   // P8: eight chains, eight rounds
std::string IntegerAddChains();  // P9
inline constexpr uint32_t kEightChains = 8 * 8;
std::string MixedVectorKernel();  // X6
std::string LoadHitStore();       // X5

}  // namespace pelt
