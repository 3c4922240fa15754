// JSON out, in the order it is written: enough for --json, and nothing to read.
//
// Invariant: what comes out is valid as long as every Begin has its End; numbers that JSON cannot
// hold (not finite) become null.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

#include "traces/json_string.hpp"

namespace pelt {

class JsonText {
 public:
  // `key` is empty inside an array and for the outermost value.
  void BeginObject(std::string_view key = {}) { Open(key, '{'); }
  void EndObject() { Close('}'); }
  void BeginArray(std::string_view key = {}) { Open(key, '['); }
  void EndArray() { Close(']'); }

  void Add(std::string_view key, double value) {
    Key(key);
    text_ += std::isfinite(value) ? fmt::format("{}", value) : "null";
  }
  void Add(std::string_view key, std::integral auto value) {
    Key(key);
    if constexpr (std::same_as<decltype(value), bool>) {
      text_ += value ? "true" : "false";
    } else {
      text_ += fmt::format("{}", value);
    }
  }
  void Add(std::string_view key, std::string_view value) {
    Key(key);
    Quote(value);
  }
  void Add(std::string_view key, const char* value) { Add(key, std::string_view(value)); }
  void Add(std::string_view key, const std::string& value) { Add(key, std::string_view(value)); }
  // 64-bit digests are written as text: JSON readers take numbers for doubles.
  void AddDigest(std::string_view key, uint64_t value) { Add(key, fmt::format("{:016x}", value)); }

  const std::string& text() const { return text_; }

 private:
  void Open(std::string_view key, char bracket) {
    Key(key);
    text_ += bracket;
    first_ = true;
  }
  void Close(char bracket) {
    text_ += bracket;
    first_ = false;
  }
  void Key(std::string_view key) {
    if (!first_) text_ += ", ";
    first_ = false;
    if (key.empty()) return;
    Quote(key);
    text_ += ": ";
  }
  void Quote(std::string_view value) { AppendJsonString(text_, value); }

  std::string text_;
  bool first_ = true;
};

}  // namespace pelt
