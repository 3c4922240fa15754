#include "jobs/verify/finding.hpp"

namespace pelt {

std::string_view FindingName(FindingKind kind) {
  constexpr std::string_view kNames[] = {"",
                                         "value",
                                         "order-dependent",
                                         "race",
                                         "undeclared-read",
                                         "undeclared-write",
                                         "reads-out",
                                         "hidden-state",
                                         "float-environment",
                                         "skip-changes-bits",
                                         "sleeper-not-woken",
                                         "wrongly-culled",
                                         "kept-over-rollback",
                                         "digest-incomplete",
                                         "workers",
                                         "executor"};
  return kNames[size_t(kind)];
}

}  // namespace pelt
