// The text of a report tree: paragraphs and tables, no line wider than kReportColumns but for words
// that are.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/report/report_tree.hpp"

namespace pelt {
namespace {

constexpr size_t kLeastWrappedWidth = 24;

std::string NumberText(double value, const Quantity& quantity) {
  if (!std::isfinite(value)) return "none";
  value *= quantity.scale;
  if (quantity.decimals >= 0) return fmt::format("{:.{}f}", value, quantity.decimals);
  return fmt::format("{:.{}g}", value, quantity.decimals == -1 ? 6 : -quantity.decimals);
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
                 [&](const std::vector<Value>& list) {
                   std::vector<std::string> texts;
                   for (const Value& one : list) texts.push_back(ValueText(one, quantity));
                   return fmt::format("{}", fmt::join(texts, ", "));
                 },
                 [](const std::shared_ptr<const ReportTable>&) { return std::string(); }},
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

bool IsText(const Value& value) {
  return std::holds_alternative<std::string>(value.any()) ||
         std::holds_alternative<std::vector<Value>>(value.any());
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
    if (quantity.show == Show::kJson || field.value.IsNone()) return;
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

std::string ReportTree::Text() const {
  TextPrinter printer;
  printer.Print(*this, {});
  return printer.Take();
}

}  // namespace pelt
