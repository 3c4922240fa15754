// The measured kernels beside the ranges of their prices, as text and as JSON.
#pragma once

#include <span>
#include <string>

#include "bench/report/json_text.hpp"
#include "platform_sim/kernel_rows.hpp"

namespace pelt {

std::string DescribeKernelRows(std::span<const KernelRow> rows);  // ends with a newline
void AddKernelRows(JsonText& json, std::span<const KernelRow> rows);
// Whether every measurement lies in the range of its price.
bool AllPass(std::span<const KernelRow> rows);
// "0.42 of the way from the best schedule to the order as written (measured kernels: 0.10 to 0.90)"
std::string DescribePlace(double code_order);

}  // namespace pelt
