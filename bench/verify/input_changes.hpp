// Every single number of a frame's input, and how to change it.
//
// The list is made from what a recording holds (traces/input_fields.hpp, the rows of the pose), not
// written down again, and a field that is added to FrameInput stops this from compiling until it is
// there.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/frame_input.hpp"
#include "jobs/scene.hpp"

namespace pelt {

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
// next to none, an eye that moves where no depth changes, strands that leave by whole groups of lanes. Left out are the switches that change the
// picture (culling, LOD) and the number of joints.
std::vector<InputChange> ListInputChanges(const FrameInput& input, const FurScene& scene);

}  // namespace pelt
