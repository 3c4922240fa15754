#include "core/groom/setup_edit.hpp"

#include "core/error.hpp"
#include "core/format.hpp"
#include "core/groom/setup_schema.hpp"

namespace pelt {
namespace {

// Of a place that the parser reported, in lines and characters from 1.
size_t OffsetOf(std::string_view text, const toml::source_position& place) {
  size_t at = 0;
  for (toml::source_index line = 1; line < place.line; ++line) at = text.find('\n', at) + 1;
  for (toml::source_index column = 1; column < place.column; ++column) {
    ++at;
    while (at < text.size() && (uint8_t(text[at]) & 0xc0) == 0x80) ++at;
  }
  return at;
}

const toml::table* FindLayer(const toml::table& root, std::string_view name) {
  const toml::array* layers = root["layer"].as_array();
  if (!layers) return nullptr;
  for (const toml::node& node : *layers)
    if (const toml::table* layer = node.as_table();
        layer && (*layer)["name"].value_or(std::string_view()) == name)
      return layer;
  return nullptr;
}

}  // namespace

std::string ChangeLayerKey(std::string_view text, const std::string& path, std::string_view layer,
                           std::string_view key, std::string_view value) {
  const toml::table root = ParseToml(text, path);
  const toml::table* table = FindLayer(root, layer);
  if (!table) throw Error(Format("{}: no layer '{}'", path, layer));
  std::string changed(text);
  const toml::node* node = table->get(key);
  if (node && node->is_table()) node = node->as_table()->get("value");
  if (node) {
    const size_t begin = OffsetOf(text, node->source().begin),
                 end = OffsetOf(text, node->source().end);
    return changed.replace(begin, end - begin, value);
  }
  if (table->get(key))
    throw Error(Format("{}:{}: key '{}' is a table without a value", path,
                       table->get(key)->source().begin.line, key));
  const size_t name = OffsetOf(text, table->get("name")->source().end),
               line_end = changed.find('\n', name);
  const std::string line = Format("{} = {}", key, value);
  if (line_end == changed.npos) return changed + '\n' + line + '\n';
  return changed.insert(line_end + 1, line + '\n');
}

}  // namespace pelt
