// A scene's course in lock-step on every instruction set, executors taking turns, with what may stand between two
// frames and with other grooms from some frame on.
//
// The reference leaves out nothing but what changes the picture, and has no interludes.
#pragma once

#include <vector>

#include "bench/verify/frame_digests.hpp"
#include "bench/verify/interludes.hpp"
#include "core/random.hpp"
#include "traces/digest.hpp"

namespace pelt {

class CourseCheck {
 public:
  // Of `settings` culling and LOD count. The scenario must outlive this.
  CourseCheck(Scenario& scenario, const FrameSettings& settings, uint64_t seed,
              const VerifyOptions& options);

  // Once: runs the frames, and adds what is found to `result`.
  void Run(uint32_t frames, CheckResult& result);
  uint64_t digest() const { return digest_.Value(); }  // of the reference

 private:
  void AddTurns(uint64_t seed);
  // False when it parts from the reference there, and is not run on.
  bool RunTurn(CaseTurn& turn, uint32_t frame, CaseRun& reference, const StreamDigests& expected,
               CheckResult& result);
  std::string KeysOf(const Mismatch& mismatch) const;

  Random random_;
  Scenario &scenario_, *grooms_;  // the latter has the grooms of now
  Scenario tuned_;
  const VerifyOptions& options_;
  FrameSettings never_, skips_;
  VertexOrder order_;
  std::vector<CaseTurn> turns_;
  Digest digest_;
};

}  // namespace pelt
