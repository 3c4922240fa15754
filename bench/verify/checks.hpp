// The sections of a verification besides the matrix of cases. Each adds its results to the report;
// all run the scene that is verified, with everything beside it where that is affordable
// (verified_scene.hpp), with best kernels.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/verify/lockstep.hpp"
#include "bench/verify/verify.hpp"
#include "core/frame_input.hpp"
#include "core/view.hpp"

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

// Over a second of the scene's course, with interludes.
void CheckWholeCourse(Scenario& scenario, const VerifyOptions& options, VerifyReport& report);

// ---- What they share ----------------------------------------------------------------------------

// Most chains lie still, bit for bit, this many frames after everything around them does.
inline constexpr uint32_t kSettleFrames = 240;

// Runs both again, frame by frame together, until they part.
Mismatch Locate(CaseRun expected, CaseRun found, uint32_t frame, bool bookkeeping = false);

// Runs the case's plan between closed pages up to `frame`: the first access that no port declares.
std::optional<Finding> FindUndeclared(Scenario& scenario, const VerifyCase& what,
                                      const VerifyOptions& options, uint32_t frame);

// ---- Waking: what is changed --------------------------------------------------------------------

// Every single number of a frame's input, and how to change it: what the check of waking goes through.
//
// The list is made from what a recording holds (traces/input_fields.hpp, the rows of the pose), not
// written down again, and a field that is added to FrameInput stops input_changes.cpp from compiling until it is
// there.

enum class Amount : uint8_t {
  kOneUlp,
  kMuch,
  kLess,        // instead, where that is refused
  kLittle,      // or even that
  kBelowFloat,  // of a double: rounded to a float it has not changed
};
std::string_view AmountName(Amount amount);  // "one ulp", "a lot"

struct InputChange {
  std::string name;  // "sphere 0[3]"
  enum class Part : uint8_t { kFrame, kLod, kSkip, kPose, kLights } part = Part::kFrame;
  enum class Type : uint8_t { kFloat, kDouble, kWhole, kOneWay } type = Type::kFloat;
  // Changes the input before the frame begins; poses lie in the scene.
  std::function<void(FrameInput&, FurScene&, Amount)> apply;
  // The input of the frames around it, from a few before it on; empty: the course's input.
  std::function<void(FrameInput&)> around = {};
};

// For inputs like `input` in a scene like `scene`. Of the pose, every row with one of the joints
// that move hair, characters and joints in rotation, and every such joint at least once, and once
// as it turns and does nothing else. Besides single numbers: spheres and capsules that come and go,
// one over an edge of each layer's box, lights that leave, origins that move, wind that grows from
// next to none, force volumes that come, grow and are carried, an eye that moves where no depth changes, strands that
// leave by whole groups of lanes, layers that are switched off or matter less, strands that are cut off or written.
// Left out are the switches that change the picture (culling, LOD) and the number of joints.
std::vector<InputChange> ListInputChanges(const FrameInput& input, const FurScene& scene);

// ---- Culling: what is seen ----------------------------------------------------------------------

// Whether a point is in view of a camera, worked out for the check of culling alone.
//
// Projects the point and looks where it lands, in double; the frame tests boxes against planes. The
// two share no code and no formula, so that one mistake cannot be made in both.
class ViewTest {
 public:
  explicit ViewTest(const Camera& camera);
  // In view, and by more than any rounding from its border.
  bool IsClearlyInside(const float (&point)[3]) const;

 private:
  double eye_[3], right_[3], up_[3], forward_[3];
  double half_width_, half_height_;  // of the picture, one metre ahead
  double near_m_, far_m_;
};

}  // namespace pelt
