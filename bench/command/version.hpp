// `pelt --version`: what a report of a fault needs to say.
#pragma once

#include <string>

namespace pelt {

std::string DescribeVersion();

}  // namespace pelt
