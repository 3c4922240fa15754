#include "core/format.hpp"

#include <fmt/format.h>

#include <iterator>

namespace pelt {

void AppendText(fmt::string_view format, fmt::format_args args, std::string& out) {
  fmt::vformat_to(std::back_inserter(out), format, args);
}

}  // namespace pelt
