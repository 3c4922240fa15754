// What the cross programs share: without exceptions, as WebAssembly has none, and with files by the
// standard library alone.
#pragma once

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "core/error.hpp"

// The value; without one the program ends with the reason.
template <class T>
T OrExit(pelt::Result<T> result) {
  if (result) return *std::move(result);
  std::fprintf(stderr, "%s\n", result.error().c_str());
  std::exit(1);
}

inline std::vector<std::byte> ReadBytes(const char* path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}
