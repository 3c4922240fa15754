// Files of one name in two projects: each include means its own.
#include "core/error.hpp"
#include "pelt/core/error.hpp"
#include "pelt/core/groom/groom_file.hpp"

int main() {
  const auto groom = pelt::ReadGroom({}, "nothing");
  return !groom && !groom.error().empty() && outside::kErrorCode == 7 ? 0 : 1;
}
