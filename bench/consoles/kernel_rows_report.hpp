// The measured kernels beside the ranges of their prices.
#pragma once

#include <span>
#include <string>

#include "bench/report/report_tree.hpp"
#include "platform_sim/kernel_rows.hpp"

namespace pelt {

void AddKernelRows(std::span<const KernelRow> rows, ReportTree& tree);
// Whether every measurement lies in the range of its price.
bool AllPass(std::span<const KernelRow> rows);
// "0.60 of the way from the best schedule to the order as written (a compiler's kernels: 0.28 to 0.92)"
std::string DescribePlace(double code_order);

}  // namespace pelt
