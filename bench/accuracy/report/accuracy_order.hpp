// What `pelt accuracy --order` found, as a report tree.
#pragma once

#include <string_view>

#include "bench/accuracy/order_precision.hpp"
#include "bench/report/machine.hpp"
#include "bench/report/report_tree.hpp"

namespace pelt {

inline constexpr std::string_view kOrderAccuracyFormat = "pelt order accuracy 1";

ReportTree MakeOrderTree(const accuracy::OrderPrecision& precision, const Machine& machine);

}  // namespace pelt
