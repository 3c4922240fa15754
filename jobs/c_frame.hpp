// What a frame is in C, for jobs/c_interface.cpp.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/frame_input.hpp"
#include "core/frame_memory.hpp"
#include "jobs/pelt.h"

namespace pelt::c_frame {

template <size_t kN>
void Copy(const float (&from)[kN], float (&to)[kN]) {
  std::copy_n(from, kN, to);
}

// Null, or what the counts and pointers of the frame promise and do not hold. `weather`: where that of
// each character is put; other lists stay where they are.
const char* Translate(const PeltFrame& from, const SceneShape& shape, std::vector<Weather>& weather,
                      FrameInput& to);

}  // namespace pelt::c_frame
