// How far strands are off the rod that they stand for, as the first tables of `pelt accuracy`.
#pragma once

#include "bench/accuracy/model_error.hpp"
#include "bench/report/report_tree.hpp"

namespace pelt {

// Adds the array `model_error`: an entry a family of motions.
void AddRodTables(const accuracy::ModelErrorTable& table,
                  const accuracy::ModelErrorOptions& options, ReportTree& tree);

}  // namespace pelt
