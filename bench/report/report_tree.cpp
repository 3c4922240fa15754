#include "bench/report/report_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/report/json_text.hpp"

namespace pelt {
namespace {

using JsonValue = nlohmann::ordered_json;

JsonValue TableJson(const ReportTable& table);

JsonValue ValueJson(const Value& value) {
  return std::visit(
      Overloaded{[](std::monostate) { return JsonValue(); },
                 [](const std::shared_ptr<const ReportTable>& rows) { return TableJson(*rows); },
                 [](const std::vector<Value>& list) {
                   JsonValue array = JsonValue::array();
                   for (const Value& one : list) array.push_back(ValueJson(one));
                   return array;
                 },
                 [](const auto& known) { return JsonValue(known); }},
      value.any());
}

// Texts may hold the name that a user gave a layer: bytes that are no UTF-8 are replaced, and all
// that could move a terminal's cursor is escaped.
std::string Printed(const JsonValue& value, int indent) {
  return value.dump(indent, ' ', true, JsonValue::error_handler_t::replace);
}

void SetAt(JsonValue& object, std::string_view path, JsonValue value) {
  JsonValue* at = &object;
  for (size_t dot; (dot = path.find('.')) != std::string_view::npos; path.remove_prefix(dot + 1))
    at = &(*at)[std::string(path.substr(0, dot))];
  (*at)[std::string(path)] = std::move(value);
}

JsonValue TableJson(const ReportTable& table) {
  JsonValue out = table.is_map ? JsonValue::object() : JsonValue::array();
  for (const ReportTable::Row& row : table.rows) {
    if (row.show == Show::kText) continue;
    if (table.is_map) {
      out[ValueJson(row.values[0]).get<std::string>()] = ValueJson(row.values[1]);
      continue;
    }
    JsonValue object = JsonValue::object();
    for (size_t c = 0; c < row.values.size(); ++c)
      if (table.columns[c].show != Show::kText && !row.values[c].IsNone())
        SetAt(object, table.columns[c].key, ValueJson(row.values[c]));
    out.push_back(std::move(object));
  }
  return out;
}

}  // namespace

bool Value::IsNone() const { return std::holds_alternative<std::monostate>(value_); }
Value::Value() = default;
Value::Value(bool value) : value_(value) {}
Value::Value(double value) : value_(value) {}
Value::Value(std::string value) : value_(std::move(value)) {}
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
Value Value::OfList(std::vector<Value> list) {
  Value made;
  made.value_ = std::move(list);
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
    if (field.quantity.show != Show::kText && !field.value.IsNone())
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
    if (list.key.empty())
      object = std::move(array);
    else
      SetAt(object, list.key, std::move(array));
  }
};

std::string ReportTree::Json() const { return Printed(JsonPrinter::Of(*this), 1) + '\n'; }
void ReportTree::Print(bool json) const { fmt::print("{}", json ? Json() : Text()); }

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
