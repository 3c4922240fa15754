// How set-up reports bad input: one text that names the place (file, line or byte offset, key), the
// reason and what to do. Only set-up fails; a frame cannot.
//
//   Result<Groom> groom = ReadGroomFile(path);
//   if (!groom) return Show(groom.error());          // an engine
//   Groom groom = ReadGroomFile(path).OrThrow();     // a tool, with exceptions
//
// core, traces, jobs and platform_sim build and work with exceptions and RTTI switched off: OrThrow
// is there where the including file is compiled with exceptions. The offline side (glTF, fur setup,
// bake) only throws.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace pelt {

#if defined(__cpp_exceptions)
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};
#endif

// Why there is no value.
struct Failure {
  std::string text;
};

// Of a call that makes nothing but may fail.
struct Done {};

// A value, or the reason why there is none.
template <class T = Done>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}
  Result(Failure failure) : error_(std::move(failure.text)) {}

  explicit operator bool() const { return value_.has_value(); }
  T& operator*() & { return *value_; }
  const T& operator*() const& { return *value_; }
  T&& operator*() && { return *std::move(value_); }
  T* operator->() { return &*value_; }
  const T* operator->() const { return &*value_; }
  // Empty when there is a value.
  const std::string& error() const { return error_; }

#if defined(__cpp_exceptions)
  T OrThrow() && {
    if (!value_) throw Error(error_);
    return *std::move(value_);
  }
#endif

 private:
  std::optional<T> value_;
  std::string error_;
};

}  // namespace pelt
