// How set-up reports bad input: one text that names the place (file, line or byte offset, key), the
// reason and what to do. Only set-up fails; a frame cannot.
//
// What an engine calls (groom file, plan, scene) comes in two forms:
//
//   std::optional<Groom> TryReadGroom(bytes, name, error);   // nothing, and the text in `error`
//   Groom ReadGroom(bytes, name);                            // throws Error of the same text
//
// The first is the real one and needs neither exceptions nor RTTI: core, traces, jobs and
// platform_sim build and work with both switched off. The second is a shorthand, there where the
// including file is compiled with exceptions. The offline side (glTF, fur setup, bake) only throws.
#pragma once

#if defined(__cpp_exceptions)

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace pelt {

struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// What `try_form(error)` returns in its optional or pointer; throws Error of its text when there is
// nothing. The shorthands are made with it.
template <class TryForm>
auto ValueOrThrow(TryForm try_form) {
  std::string error;
  auto result = try_form(error);
  if (!result) throw Error(error);
  return *std::move(result);
}

}  // namespace pelt

#endif
