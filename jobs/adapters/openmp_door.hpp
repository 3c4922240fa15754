// The door on OpenMP tasks. Compile what includes this with -fopenmp (without it, everything runs
// on the caller).
//
//   DoorExecutor executor(OpenMpDoor());
//   RunInOpenMpTeam([&] { executor.Run(frame); });
//
// Tasks run on the threads of the team that the caller is in: outside a parallel region the team is
// one thread, and OpenMP runs every task where it is created. OpenMP has no way to wait for one
// task, so finish waits for all that the caller created: more than asked, never less.
#pragma once

#include <cstdint>

#include "jobs/engine_door.hpp"

#if defined(_OPENMP)
#include <omp.h>
#endif

namespace pelt {

inline EngineDoor OpenMpDoor() {
  const auto enqueue = [](PeltTask task, void* context, void*, const char*) -> void* {
#if defined(_OPENMP)
#pragma omp task firstprivate(task, context)
    task(context);
    return context;
#else
    task(context);
    return nullptr;
#endif
  };
  const auto finish = [](void*, void*) {
#if defined(_OPENMP)
#pragma omp taskwait
#endif
  };
#if defined(_OPENMP)
  return {enqueue, finish, nullptr, uint32_t(omp_get_max_threads())};
#else
  return {enqueue, finish, nullptr, 1};
#endif
}

// Runs body on the caller, with a team of threads that take its tasks meanwhile.
template <class Body>
void RunInOpenMpTeam(const Body& body) {
#if defined(_OPENMP)
#pragma omp parallel
#pragma omp single
#endif
  body();
}

}  // namespace pelt
