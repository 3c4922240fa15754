// The report page's data, which has no text beside it (report_page.cpp, the consoles' frames, the
// accuracy section), put together in the order it is written; nlohmann-json holds and prints it.
// What a command prints is a ReportTree (report_tree.hpp).
//
// Invariant: what comes out is valid as long as every Begin has its End; numbers that JSON cannot
// hold (not finite) become null, and what is no printable ASCII is escaped.
#pragma once

#include <concepts>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "bench/report/report_tree.hpp"

namespace pelt {

class JsonText {
 public:
  JsonText();
  ~JsonText();

  // `key` is empty inside an array and for the outermost value.
  void BeginObject(std::string_view key = {});
  void EndObject() { Close(); }
  void BeginArray(std::string_view key = {});
  void EndArray() { Close(); }

  void Add(std::string_view key, const Value& value);
  // 64-bit digests are written as text: JSON readers take numbers for doubles.
  void AddDigest(std::string_view key, uint64_t value) { Add(key, DigestText(value)); }

  std::string text() const;     // a member a line
  std::string Compact() const;  // one line

 private:
  void Close();

  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace pelt
