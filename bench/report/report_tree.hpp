// What a command found, said once: named values with units, tables and sections. The text for
// people and the JSON for programs are both printed from it, so the one cannot know what the other
// does not.
//
// A key with dots is a path in JSON: "core_ms.median" is a member of the object "core_ms". A value
// that is left out (Value{}) is no member there, and an empty cell in text. Lines of text are at
// most kReportColumns wide: paragraphs wrap, and so does the last column of a table when it holds
// texts.
//
// Breaks if ignored: keys are what other people's programs read. Each has its line in
// bench/report/json_keys.txt, and a test checks what is printed by it.
#pragma once

#include <concepts>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace pelt {

inline constexpr size_t kReportColumns = 100;

struct ReportTable;

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

class Value {
 public:
  using Any = std::variant<std::monostate, bool, int64_t, uint64_t, double, std::string,
                           std::vector<Value>, std::shared_ptr<const ReportTable>>;

  Value();  // none
  Value(bool value);
  Value(double value);
  Value(std::signed_integral auto value) : Value(OfInteger(int64_t(value))) {}
  Value(std::unsigned_integral auto value) : Value(OfInteger(uint64_t(value))) {}
  Value(std::string value);
  Value(std::string_view value) : Value(std::string(value)) {}
  Value(const char* value) : Value(std::string(value)) {}
  template <class T>
  Value(const std::vector<T>& list) : Value(OfList({list.begin(), list.end()})) {}
  Value(ReportTable table);  // in JSON only
  // Not inline: g++ 12 takes what it inlines of a variant for uninitialised.
  Value(const Value& other);
  Value(Value&& other) noexcept;
  Value& operator=(const Value& other);
  Value& operator=(Value&& other) noexcept;
  ~Value();

  const Any& any() const { return value_; }
  bool IsNone() const;

 private:
  static Value OfInteger(int64_t value);
  static Value OfInteger(uint64_t value);
  static Value OfList(std::vector<Value> list);

  Any value_;
};

// 64-bit digests are texts: JSON readers take numbers for doubles.
std::string DigestText(uint64_t digest);

enum class Show : uint8_t { kBoth, kText, kJson };

// What a value is: of a single one and of a table's column alike.
struct Quantity {
  std::string key;
  std::string unit = {};     // in text
  int decimals = -1;         // in text; -1: as many as the value has; -3: three digits in all
  std::string heading = {};  // in text; empty: the key's last part, blanks for its underscores
  double scale = 1.0;        // in text: 100 shows a share in %
  Show show = Show::kBoth;
};

inline Quantity InJson(std::string key) { return {.key = std::move(key), .show = Show::kJson}; }
inline Quantity InText(std::string heading, std::string unit = {}, int decimals = -1) {
  return {{}, std::move(unit), decimals, std::move(heading), 1.0, Show::kText};
}

struct ReportTable {
  std::string key;
  std::vector<Quantity> columns;
  // In JSON an object from the first column's value to the second's, not an array of objects.
  bool is_map = false;
  struct Row {
    std::vector<Value> values;
    Show show;
  };
  std::deque<Row> rows = {};

  void Add(std::vector<Value> values, Show show = Show::kBoth) {
    rows.push_back({std::move(values), show});
  }
};

class ReportTree {
 public:
  ReportTree& Add(Quantity quantity, Value value);
  // For text only: what holds for what stands around it. Begins a line of its own, and ends one.
  ReportTree& Say(std::string text);
  ReportTree& EndLine() { return Say({}); }
  ReportTree& BlankLine() { return Say("\n"); }
  // References stay good while the report lives.
  ReportTable& AddTable(std::string key, std::vector<Quantity> columns);
  // An array of texts; in text a line "heading: text" for each.
  ReportTree& AddTexts(std::string key, std::vector<std::string> texts, std::string heading = {});
  // An object of its own; its heading stands in front of its first line of text.
  ReportTree& AddSection(std::string key, std::string heading = {});
  // One more object in the array of that key; without a key the array is all of the JSON.
  // BeginList() makes one that may stay empty.
  ReportTree& AddEntry(const std::string& key, std::string heading = {});
  void BeginList(const std::string& key);

  std::string Text() const;
  std::string Json() const;
  void Print(bool json) const;  // to standard output

 private:
  struct Field {
    Quantity quantity;
    Value value;
  };
  struct Note {
    std::string text;
  };
  struct Texts {
    std::string key, heading;
    std::vector<std::string> texts;
  };
  struct Section {
    std::string key, heading;
    std::unique_ptr<ReportTree> report;
  };
  struct List {
    std::string key;
    std::deque<Section> entries;
  };
  using Part = std::variant<Field, Note, Texts, ReportTable, Section, List>;
  class TextPrinter;
  class JsonPrinter;

  std::deque<Part> parts_;
};

}  // namespace pelt
