#include "bench/report/report_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/report/json_text.hpp"

namespace pelt {
namespace {

using JsonValue = nlohmann::ordered_json;

constexpr size_t kLeastWrappedWidth = 24;

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

std::string NumberText(double value, const Quantity& quantity) {
  if (!std::isfinite(value)) return "none";
  value *= quantity.scale;
  return quantity.decimals < 0 ? fmt::format("{:.6g}", value)
                               : fmt::format("{:.{}f}", value, quantity.decimals);
}

std::string ValueText(const Value& value, const Quantity& quantity) {
  const auto whole = [&](auto number) {
    return quantity.scale == 1.0 && quantity.decimals < 0 ? fmt::format("{}", number)
                                                          : NumberText(double(number), quantity);
  };
  return std::visit(
      Overloaded{[](std::monostate) { return std::string(); },
                 [](bool is) { return std::string(is ? "yes" : "no"); },
                 [&](int64_t number) { return whole(number); },
                 [&](uint64_t number) { return whole(number); },
                 [&](double number) { return NumberText(number, quantity); },
                 [](const std::string& text) { return text; },
                 [](const std::vector<std::string>& list) {
                   return fmt::format("{}", fmt::join(list, ", "));
                 },
                 [](const std::shared_ptr<const ReportTable>&) { return std::string(); }},
      value.any());
}

JsonValue TableJson(const ReportTable& table);

JsonValue ValueJson(const Value& value) {
  return std::visit(
      Overloaded{[](std::monostate) { return JsonValue(); },
                 [](const std::shared_ptr<const ReportTable>& rows) { return TableJson(*rows); },
                 [](const auto& known) { return JsonValue(known); }},
      value.any());
}

std::string HeadingOf(const Quantity& quantity) {
  if (!quantity.heading.empty()) return quantity.heading;
  std::string heading = quantity.key.substr(quantity.key.rfind('.') + 1);
  std::replace(heading.begin(), heading.end(), '_', ' ');
  return heading;
}

// Lines of at most `width`; words are not cut, what comes before the first blank of a line is kept.
std::vector<std::string> Wrap(std::string_view text, size_t width) {
  std::vector<std::string> lines;
  while (text.size() > width) {
    size_t end = text.rfind(' ', width);
    if (end == std::string_view::npos || end == 0) end = text.find(' ', width);
    if (end == std::string_view::npos) break;
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  lines.emplace_back(text);
  return lines;
}

// Texts may hold what somebody named a layer: bytes that are no UTF-8 are replaced, and whatever
// could move a terminal's cursor is escaped.
std::string Printed(const JsonValue& value, int indent) {
  return value.dump(indent, ' ', true, JsonValue::error_handler_t::replace);
}

void SetAt(JsonValue& object, std::string_view path, JsonValue value) {
  JsonValue* at = &object;
  for (size_t dot; (dot = path.find('.')) != std::string_view::npos; path.remove_prefix(dot + 1))
    at = &(*at)[std::string(path.substr(0, dot))];
  (*at)[std::string(path)] = std::move(value);
}

bool HasValue(const Value& value) { return !std::holds_alternative<std::monostate>(value.any()); }
bool IsText(const Value& value) {
  return std::holds_alternative<std::string>(value.any()) ||
         std::holds_alternative<std::vector<std::string>>(value.any());
}

JsonValue TableJson(const ReportTable& table) {
  JsonValue out = table.is_map ? JsonValue::object() : JsonValue::array();
  for (const ReportTable::Row& row : table.rows) {
    if (row.show == Show::kText) continue;
    if (table.is_map) {
      out[ValueText(row.values[0], {})] = ValueJson(row.values[1]);
      continue;
    }
    JsonValue object = JsonValue::object();
    for (size_t c = 0; c < row.values.size(); ++c)
      if (table.columns[c].show != Show::kText && HasValue(row.values[c]))
        SetAt(object, table.columns[c].key, ValueJson(row.values[c]));
    out.push_back(std::move(object));
  }
  return out;
}

// The cells of a table, laid out.
class TableText {
 public:
  explicit TableText(const ReportTable& table) {
    for (size_t c = 0; c < table.columns.size(); ++c)
      if (table.columns[c].show != Show::kJson) AddColumn(table, c);
    for (const Column& column : columns_) has_units_ = has_units_ || !column.unit.empty();
    while (Width() > kReportColumns)
      if (!NarrowWidest()) break;
  }

  std::string Text() const {
    std::vector<std::string> cells;
    for (const Column& column : columns_) cells.push_back(column.heading);
    std::string out = Line(cells);
    if (has_units_) {
      for (size_t c = 0; c < columns_.size(); ++c) cells[c] = columns_[c].unit;
      out += Line(cells);
    }
    for (size_t r = 0; r < rows_; ++r) {
      for (size_t c = 0; c < columns_.size(); ++c) cells[c] = columns_[c].cells[r];
      out += Line(cells);
    }
    return out;
  }

 private:
  static constexpr size_t kGap = 2;
  struct Column {
    std::string heading, unit;
    std::vector<std::string> cells = {};
    size_t width = 0;
    bool left = false;
  };

  void AddColumn(const ReportTable& table, size_t c) {
    const Quantity& quantity = table.columns[c];
    Column column{HeadingOf(quantity), quantity.unit};
    column.width = std::max(column.heading.size(), column.unit.size());
    for (const ReportTable::Row& row : table.rows) {
      if (row.show == Show::kJson) continue;
      const Value value = c < row.values.size() ? row.values[c] : Value{};
      column.left = column.left || IsText(value);
      column.cells.push_back(ValueText(value, quantity));
      column.width = std::max(column.width, column.cells.back().size());
    }
    rows_ = column.cells.size();
    columns_.push_back(std::move(column));
  }

  size_t Width() const {
    size_t width = 0;
    for (const Column& column : columns_) width += column.width + (width ? kGap : 0);
    return width;
  }

  // Of the columns of texts; false when none may be narrower.
  bool NarrowWidest() {
    Column* widest = nullptr;
    for (Column& column : columns_)
      if (column.left && (!widest || column.width >= widest->width)) widest = &column;
    if (!widest || widest->width <= kLeastWrappedWidth) return false;
    --widest->width;
    return true;
  }

  // Texts that are wider than their column go on in the lines below.
  std::string Line(const std::vector<std::string>& cells) const {
    std::vector<std::vector<std::string>> parts;
    size_t lines = 1;
    for (size_t c = 0; c < cells.size(); ++c) {
      parts.push_back(Wrap(cells[c], columns_[c].width));
      lines = std::max(lines, parts.back().size());
    }
    std::string out;
    for (size_t l = 0; l < lines; ++l) {
      std::string line;
      for (size_t c = 0; c < cells.size(); ++c) {
        const std::string part = l < parts[c].size() ? parts[c][l] : "";
        if (c) line.append(kGap, ' ');
        line += columns_[c].left ? fmt::format("{:<{}}", part, columns_[c].width)
                                 : fmt::format("{:>{}}", part, columns_[c].width);
      }
      out += Ended(line);
    }
    return out;
  }

  static std::string Ended(std::string line) {
    line.erase(line.find_last_not_of(' ') + 1);
    return line + '\n';
  }

  std::vector<Column> columns_;
  size_t rows_ = 0;
  bool has_units_ = false;
};

}  // namespace

Value::Value() = default;
Value::Value(bool value) : value_(value) {}
Value::Value(double value) : value_(value) {}
Value::Value(std::string value) : value_(std::move(value)) {}
Value::Value(std::vector<std::string> list) : value_(std::move(list)) {}
Value::Value(ReportTable table) : value_(std::make_shared<const ReportTable>(std::move(table))) {}
Value::Value(const Value& other) = default;
Value::Value(Value&& other) noexcept = default;
Value& Value::operator=(const Value& other) = default;
Value& Value::operator=(Value&& other) noexcept = default;
Value::~Value() = default;
Value Value::OfInteger(int64_t value) {
  Value made;
  made.value_ = value;
  return made;
}
Value Value::OfInteger(uint64_t value) {
  Value made;
  made.value_ = value;
  return made;
}

std::string DigestText(uint64_t digest) { return fmt::format("{:016x}", digest); }

ReportTree& ReportTree::Add(Quantity quantity, Value value) {
  parts_.push_back(Field{std::move(quantity), std::move(value)});
  return *this;
}
ReportTree& ReportTree::Say(std::string text) {
  parts_.push_back(Note{std::move(text)});
  return *this;
}
ReportTable& ReportTree::AddTable(std::string key, std::vector<Quantity> columns) {
  parts_.push_back(ReportTable{std::move(key), std::move(columns)});
  return std::get<ReportTable>(parts_.back());
}
ReportTree& ReportTree::AddTexts(std::string key, std::vector<std::string> texts,
                                 std::string heading) {
  parts_.push_back(Texts{std::move(key), std::move(heading), std::move(texts)});
  return *this;
}
ReportTree& ReportTree::AddSection(std::string key, std::string heading) {
  parts_.push_back(Section{std::move(key), std::move(heading), std::make_unique<ReportTree>()});
  return *std::get<Section>(parts_.back()).report;
}
void ReportTree::BeginList(const std::string& key) { parts_.push_back(List{key, {}}); }
ReportTree& ReportTree::AddEntry(const std::string& key, std::string heading) {
  const auto is_list = [&](const Part& part) {
    const List* list = std::get_if<List>(&part);
    return list && list->key == key;
  };
  auto at = std::find_if(parts_.begin(), parts_.end(), is_list);
  if (at == parts_.end()) {
    BeginList(key);
    at = parts_.end() - 1;
  }
  auto& entries = std::get<List>(*at).entries;
  entries.push_back({{}, std::move(heading), std::make_unique<ReportTree>()});
  return *entries.back().report;
}

// Values that follow each other stand in one paragraph; a blank line parts tables from what is
// around them.
class ReportTree::TextPrinter {
 public:
  void Print(const ReportTree& report, const std::string& heading) {
    line_ = heading;
    for (const Part& part : report.parts_)
      std::visit([&](const auto& known) { Print(known); }, part);
    EndLine();
  }
  std::string Take() {
    if (!out_.empty() && out_.front() == '\n') out_.erase(0, 1);
    return std::move(out_);
  }

 private:
  void EndLine() {
    if (line_.empty()) return;
    for (const std::string& line : Wrap(line_, kReportColumns)) out_ += line + '\n';
    line_.clear();
  }
  void BlankLine() {
    EndLine();
    if (!out_.empty() && !out_.ends_with("\n\n")) out_ += '\n';
  }
  void Print(const Field& field) {
    const Quantity& quantity = field.quantity;
    if (quantity.show == Show::kJson || !HasValue(field.value)) return;
    if (!line_.empty()) line_ += line_.ends_with(':') ? " " : ", ";
    line_ += HeadingOf(quantity) + ' ' + ValueText(field.value, quantity);
    if (!quantity.unit.empty()) line_ += ' ' + quantity.unit;
  }
  void Print(const Note& note) {
    EndLine();
    if (note.text == "\n") return BlankLine();
    line_ = note.text;
    EndLine();
  }
  void Print(const Texts& texts) {
    EndLine();
    for (const std::string& text : texts.texts) {
      line_ = texts.heading.empty() ? text : texts.heading + ": " + text;
      EndLine();
    }
  }
  void Print(const ReportTable& table) {
    EndLine();
    const auto in_text = [](const auto& part) { return part.show != Show::kJson; };
    if (std::ranges::none_of(table.rows, in_text) || std::ranges::none_of(table.columns, in_text))
      return;
    BlankLine();
    out_ += TableText(table).Text();
  }
  void Print(const Section& section) {
    EndLine();
    Print(*section.report, section.heading.empty() ? "" : section.heading + ":");
  }
  void Print(const List& list) {
    for (const Section& entry : list.entries) Print(entry);
  }

  std::string out_, line_;
};

class ReportTree::JsonPrinter {
 public:
  static JsonValue Of(const ReportTree& report) {
    JsonValue object = JsonValue::object();
    for (const Part& part : report.parts_)
      std::visit([&](const auto& known) { Add(object, known); }, part);
    return object;
  }

 private:
  static void Add(JsonValue& object, const Field& field) {
    if (field.quantity.show != Show::kText && HasValue(field.value))
      SetAt(object, field.quantity.key, ValueJson(field.value));
  }
  static void Add(JsonValue&, const Note&) {}
  static void Add(JsonValue& object, const Texts& texts) {
    if (!texts.key.empty()) SetAt(object, texts.key, JsonValue(texts.texts));
  }
  static void Add(JsonValue& object, const ReportTable& table) {
    if (!table.key.empty()) SetAt(object, table.key, TableJson(table));
  }
  static void Add(JsonValue& object, const Section& section) {
    if (!section.key.empty()) SetAt(object, section.key, Of(*section.report));
  }
  static void Add(JsonValue& object, const List& list) {
    JsonValue array = JsonValue::array();
    for (const Section& entry : list.entries) array.push_back(Of(*entry.report));
    SetAt(object, list.key, std::move(array));
  }
};

std::string ReportTree::Text() const {
  TextPrinter printer;
  printer.Print(*this, {});
  return printer.Take();
}

std::string ReportTree::Json() const { return Printed(JsonPrinter::Of(*this), 1) + '\n'; }

// The values that are open, the innermost last; one stays where it is until it is closed.
struct JsonText::Tree {
  JsonValue root;
  std::vector<JsonValue*> open = {};

  JsonValue& Place(std::string_view key) {
    if (open.empty()) return root;
    if (open.back()->is_array()) return open.back()->emplace_back();
    return (*open.back())[std::string(key)];
  }
};

JsonText::JsonText() : tree_(std::make_unique<Tree>()) {}
JsonText::~JsonText() = default;

void JsonText::BeginObject(std::string_view key) {
  tree_->open.push_back(&(tree_->Place(key) = JsonValue::object()));
}
void JsonText::BeginArray(std::string_view key) {
  tree_->open.push_back(&(tree_->Place(key) = JsonValue::array()));
}
void JsonText::Close() { tree_->open.pop_back(); }
void JsonText::Add(std::string_view key, const Value& value) {
  tree_->Place(key) = ValueJson(value);
}
std::string JsonText::text() const { return Printed(tree_->root, 1); }
std::string JsonText::Compact() const { return Printed(tree_->root, -1); }

}  // namespace pelt
