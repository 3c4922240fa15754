// A scene's course in lock-step on every instruction set, executors in rotation, with what may stand between two
// frames and with other grooms from some frame on.
//
// The reference leaves out nothing but what changes the picture, and has no interludes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/scenarios/scenarios.hpp"
#include "bench/verify/frame_digests.hpp"
#include "bench/verify/lockstep.hpp"
#include "core/random.hpp"
#include "traces/digest.hpp"

namespace pelt {

// A scene and its course, drawn from a seed: setups within the bounds of the schema's rows, and inputs of every kind
// that a frame takes.
//
// A key that gets a row (layer_params.hpp, fur_setup.hpp) is drawn from then on. Most values are usual ones or about
// them, so that fur moves as fur does; some are at a bound or anywhere between.
//
// Invariant: the same seed gives the same bits on every machine (core/random.hpp, no libm).

struct RandomScene {
  Scenario scenario;
  LodSettings lod;
  SkipSettings skip;  // what changes the picture: culling, LOD
  std::string text;   // "3 layers, 412 strands, velocities"
};

RandomScene DrawScene(uint64_t seed);

// The layer's keys that are not what they are when unsaid, as a setup has them: what a finding is about.
std::string DescribeDrawn(const LayerParams& params);

// What may stand between two frames and changes no bit of any frame after it.

enum class Interlude : uint8_t {
  kRefused,   // a frame is refused
  kPause,     // time stands still, and the eye is elsewhere
  kReplaced,  // the grooms are replaced by the same ones
  kMoved,     // another scene goes on from the state
};
inline constexpr uint32_t kInterludes = 4;
std::string_view InterludeName(Interlude what);

// A scene that is run by a case, and may go over to another scene of that case.
struct CaseTurn {
  VerifyCase what;
  std::unique_ptr<CaseRun> run;
  std::string last;  // interlude, and ahead of which frame
};

// Ahead of frame `frame`. What does not happen as it should is returned.
std::optional<Finding> Interrupt(CaseTurn& turn, Interlude interlude, Scenario& scenario,
                                 const FrameSettings& settings, uint32_t frame,
                                 const VerifyOptions& options);

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
