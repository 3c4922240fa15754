// The sections of a verification besides the matrix of cases. Each adds its results to the report;
// all run the scene that is verified, with everything beside it where that is affordable
// (verified_scene.hpp), with best kernels.
#pragma once

#include <optional>

#include "bench/verify/lockstep.hpp"
#include "bench/verify/verify.hpp"

namespace pelt {

// Each skip switched off: the same digests, as the scene runs and as it comes to rest.
void VerifySkips(Scenario& scenario, const VerifyOptions& options, VerifyReport& report);

// All below, in their order.
void RunChecks(Scenario& scenario, const VerifyOptions& options, VerifyReport& report);

// A scene at rest, most of it asleep; then one input changes, by a bit and by a lot. With
// everything: what comes, goes or turns, no single numbers.
void CheckWaking(Scenario& scenario, const VerifyOptions& options, VerifyReport& report);
void CheckWakingOfAll(Scenario& scenario, const VerifyOptions& options, VerifyReport& report);
// Layers that leave the view and return, judged by where their strands' points are.
void CheckCulling(Scenario& scenario, const VerifyOptions& options, VerifyReport& report);
// Every stage between closed pages, on a scene at rest with nothing skipped.
void CheckAccessAtRest(Scenario& scenario, const VerifyOptions& options, VerifyReport& report);
// Back to an earlier frame by a snapshot, at random places, under every executor.
void CheckRollback(Scenario& scenario, const VerifyOptions& options, VerifyReport& report);
// Every value that the frame leaves behind is in the digests.
void CheckDigests(Scenario& scenario, const VerifyOptions& options, VerifyReport& report);

// Over a second of the scene's course, with interludes (course_check.hpp).
void CheckWholeCourse(Scenario& scenario, const VerifyOptions& options, VerifyReport& report);

// ---- What they share ----------------------------------------------------------------------------

// Most chains lie still, bit for bit, this many frames after everything around them does.
inline constexpr uint32_t kSettleFrames = 240;

// Runs both again, frame by frame together, until they part.
Mismatch Locate(CaseRun expected, CaseRun found, uint32_t frame, bool bookkeeping = false);

// Runs the case's plan between closed pages up to `frame`: the first access that no port declares.
std::optional<Finding> FindUndeclared(Scenario& scenario, const VerifyCase& what,
                                      const VerifyOptions& options, uint32_t frame);

}  // namespace pelt
