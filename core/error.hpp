// How set-up reports bad input: one exception whose text names the place (file, line or byte
// offset, key), the reason and what to do. Only set-up throws; a frame cannot fail.
#pragma once

#include <stdexcept>
#include <string>

namespace pelt {

struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace pelt
