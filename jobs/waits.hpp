// Whose end an item of a pass waits for: derived from the ports of both sides.
//
// Two items must not run at once, and keep the order of their passes, where one of them writes a
// block that the other touches. Which blocks an item may touch follows from its ports: its own, one
// of a coarser unit that it is in, all in its layer or in the scene, or those that a list names. So
// two items can meet in a block only if they are in one unit, and the coarser of the two reaches is
// the unit; the wait is for all of the earlier pass in it.
#pragma once

#include "jobs/plan.hpp"

namespace pelt {

// Sets the waits of the plan's passes, from its stages alone. A wait that follows from others
// (another pass that is waited for has waited itself) is left out.
void DeriveWaits(Plan& plan, const SceneShape& shape);

}  // namespace pelt
