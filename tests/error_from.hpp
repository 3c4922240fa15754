#pragma once

#include <string>

#include "core/error.hpp"

namespace pelt::test {

// What the error that a call throws says, or "".
template <class Call>
std::string ErrorFrom(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace pelt::test
