// Reads a fur setup from TOML. What the keys are stands in setup_schema.cpp, how their values are
// read in setup_reader.cpp; here are the text, [defaults] and layers as wholes, what must hold
// between the keys of a layer, and how one of them is changed in the text.
#include "core/groom/fur_setup.hpp"

#include <algorithm>
#include <set>

#include "core/error.hpp"
#include "core/file_bytes.hpp"
#include "core/float_environment.hpp"
#include "core/format.hpp"
#include "core/groom/setup_schema.hpp"
#include "core/layer.hpp"

namespace pelt {
namespace {

constexpr size_t kSetupBytesLimit = 4u << 20;

// Fails at the key, in the layer or else in the defaults.
[[noreturn]] void FailLayer(const SetupReader& reader, const toml::table& layer,
                            const toml::table* defaults, std::string_view key,
                            std::string_view reason) {
  const toml::node* node = layer.get(key);
  if (!node && defaults) node = defaults->get(key);
  reader.FailKey(reader.LineOf(node ? *node : layer), key, reason);
}

void CheckLayer(const SetupReader& reader, const toml::table& table, const toml::table* defaults,
                LayerSetup& layer) {
  LayerParams& params = layer.params;
  const bool points_given = table.contains("points") || (defaults && defaults->contains("points"));
  if (!points_given) params.points = params.chain == ChainKind::kStrand ? 5 : 4;
  if (const auto bad = FindBadCombination(params)) {
    FailLayer(reader, table, defaults, bad->key, bad->reason);
  }
  if (const auto bad = FindBadTrait(layer))
    FailLayer(reader, table, defaults, bad->key, bad->reason);
  params.traits = HasTraits(layer);
  if (params.clump > 0.0f && layer.clump_controls == 0) {
    FailLayer(reader, table, defaults, "clump", "needs clump_controls above 0");
  }
  if (layer.direction_vector) {
    const glm::vec3 size = glm::abs(*layer.direction_vector);
    if (std::max({size.x, size.y, size.z}) < 1e-6f)
      FailLayer(reader, table, defaults, "direction_vector", "is zero");
  }
  if (layer.direction_vector && !layer.comb_joint.empty())
    FailLayer(reader, table, defaults, "direction_vector", "comb_joint says the direction");
  if (layer.flow_map && layer.flow_map->blue == FlowBlue::kLength && layer.length.map.map)
    FailLayer(reader, table, defaults, "length", "its map and flow_map's blue both say it");
  if (layer.segment_length > 0.0f &&
      (params.chain != ChainKind::kVertex || params.output == Output::kShells))
    FailLayer(reader, table, defaults, "segment_length",
              "of chains at mesh vertices alone: chain = \"vertex\", and no shells");
  const auto check_map = [&](const Attribute& attribute, std::string_view key) {
    if (attribute.range && attribute.value > attribute.range->y && !attribute.map.map) {
      FailLayer(reader, table, defaults, key, "its value lies above its range");
    }
  };
  check_map(layer.length, "length");
  check_map(layer.width, "width");
  if (!layer.strand_texture) return;
  if (const std::string bad = FindBadStrandTexture(StrandTextureOf(layer), params); !bad.empty())
    FailLayer(reader, table, defaults, "strand_texture", bad);
}

LayerSetup ReadLayer(SetupReader& reader, const toml::node& node, size_t index,
                     const LayerSetup& base, const toml::table* defaults) {
  reader.SetOwner(Format("layer {}: ", index + 1));
  if (!node.is_table()) reader.Fail(reader.LineOf(node), "write each layer as [[layer]]");
  const toml::table& table = *node.as_table();
  if (const auto name = table["name"].value<std::string>(); name && name->size() < 80) {
    reader.SetOwner(Format("layer '{}': ", *name));
  }
  LayerSetup layer = base;
  reader.ReadTable(KeyInfo{}, table, layer);
  CheckLayer(reader, table, defaults, layer);
  return layer;
}

}  // namespace

StrandTexture StrandTextureOf(const LayerSetup& layer) {
  const ControlMap& map = *layer.strand_texture;
  return {map.width, map.height, layer.film_strip_count, layer.strand_channels, map.rgba};
}

namespace {

// Some strand may have another value than all of the layer by default.
bool IsOwn(const LayerSetup& layer, const StrandAttribute& entry) {
  const Attribute& own = layer.*entry.member;
  return own.value != StrandTraits{}.*entry.trait || own.randomise != 0.0f || own.range ||
         own.map.map;
}

}  // namespace

bool HasTraits(const LayerSetup& layer) {
  return layer.params.traits || !layer.hardness_profile.empty() ||
         std::ranges::any_of(kStrandAttributes, [&](const StrandAttribute& entry) {
           return entry.trait && IsOwn(layer, entry);
         });
}

std::optional<BadKey> FindBadTrait(const LayerSetup& layer) {
  const LayerParams& params = layer.params;
  constexpr std::string_view kOneTable =
      "solver = \"modal\" bends a layer's strands by one table: set strength, give them a layer "
      "of their own, or use solver = \"pbd\" or \"verlet\"";
  const auto find = [&](std::string_view key, bool of_links) -> std::optional<BadKey> {
    if (params.output == Output::kShells) return BadKey{key, "shells have no chains of strands"};
    if (params.sag_free) return BadKey{key, "strands of a sag_free layer have no traits"};
    if (of_links && params.solver == Solver::kModal) return BadKey{key, kOneTable};
    return std::nullopt;
  };
  for (const StrandAttribute& entry : kStrandAttributes) {
    if (!entry.trait || !IsOwn(layer, entry)) continue;
    const bool of_links = entry.trait == &StrandTraits::stiffness ||
                          entry.trait == &StrandTraits::damping ||
                          entry.trait == &StrandTraits::angle_limit;
    if (const auto bad = find(entry.key, of_links)) return bad;
  }
  if (layer.hardness_profile.empty()) return std::nullopt;
  if (const auto bad = find("hardness_profile", true)) return bad;
  if (layer.hardness_profile.size() + 1 != params.points)
    return BadKey{"hardness_profile", params.points == 4
                                          ? "3 factors: chains of 4 points have 3 links"
                                          : "4 factors: chains of 5 points have 4 links"};
  return std::nullopt;
}

namespace {

// TOML has characters beyond ASCII in quotes and comments only, and toml++ 3.3 runs into undefined
// behaviour on some that stand elsewhere. The line of the first of those; 0 if there is none.
size_t FindStrayCharacter(std::string_view text) {
  constexpr std::string_view kOpenings[] = {"\"\"\"", "'''", "\"", "'", "#"};
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  size_t line = 1;
  std::string_view closing;  // of the string or comment around; one line ends it too, if 1 long
  for (size_t i = text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0; i < text.size();
       ++i) {
    const std::string_view rest = text.substr(i);
    if (rest[0] == '\n') {
      ++line;
      if (closing.size() == 1) closing = {};
    } else if (closing.empty()) {
      if (static_cast<unsigned char>(rest[0]) >= 0x80) return line;
      const auto* opening = std::find_if(std::begin(kOpenings), std::end(kOpenings),
                                         [&](std::string_view o) { return rest.starts_with(o); });
      if (opening == std::end(kOpenings)) continue;
      closing = *opening == "#" ? "\n" : *opening;
      i += opening->size() - 1;
    } else if (closing[0] == '"' && rest[0] == '\\' && rest.size() > 1 && rest[1] != '\n') {
      ++i;
    } else if (rest.starts_with(closing)) {
      const char quote = closing[0];
      i += closing.size() - 1;
      // A long string may hold up to two quotes right before those that close it.
      for (int more = 0; closing.size() == 3 && more < 2 && text.substr(i + 1).starts_with(quote);
           ++more)
        ++i;
      closing = {};
    }
  }
  return 0;
}

// The text's first `lines` lines trip the parser's own assertions.
bool TripsParser(std::string_view text, size_t lines) {
  size_t end = 0;
  for (size_t i = 0; i < lines && end != std::string_view::npos; ++i)
    end = text.find('\n', end + (i > 0));
  try {
    (void)toml::parse(text.substr(0, end));
  } catch (const TomlAssertion&) {
    return true;
  } catch (const toml::parse_error&) {
  }
  return false;
}

// The parser reads forwards, so a beginning of the text trips it if and only if the place is
// inside.
size_t FindTrippingLine(std::string_view text) {
  size_t low = 0, high = size_t(std::count(text.begin(), text.end(), '\n')) + 1;
  while (low + 1 < high) {
    const size_t middle = (low + high) / 2;
    (TripsParser(text, middle) ? high : low) = middle;
  }
  return high;
}

}  // namespace

toml::table ParseToml(std::string_view text, const std::string& path) {
  if (const size_t line = FindStrayCharacter(text))
    throw Error(
        Format("{}:{}: not valid TOML: a character beyond ASCII outside of quotes and comments",
               path, line));
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    throw Error(
        Printable(Format("{}:{}: not valid TOML: {}", path,
                         std::max<uint32_t>(error.source().begin.line, 1), error.description())));
  } catch (const TomlAssertion&) {
    throw Error(Format("{}:{}: not valid TOML: a key is missing or malformed", path,
                       FindTrippingLine(text)));
  }
}

namespace {

toml::table ParseSetup(std::string_view text, const std::string& path) {
  if (text.size() > kSetupBytesLimit) {
    throw Error(
        Format("{}: {} bytes; a fur setup has at most {}", path, text.size(), kSetupBytesLimit));
  }
  return ParseToml(text, path);
}

// All but [defaults] and the layers.
FurSetup ReadTop(SetupReader& reader, const toml::table& root) {
  FurSetup setup;
  reader.ReadTable(KeyInfo{}, root, setup);
  return setup;
}

std::vector<std::byte> ReadSetupBytes(const std::string& path) {
  auto bytes = ReadWhole(path, kSetupBytesLimit);
  if (!bytes) throw Error(Format("{}: {}", path, bytes.error()));
  return *std::move(bytes);
}

}  // namespace

FurSetup ReadFurSetup(std::string_view text, const std::string& path,
                      const std::string& map_directory) {
  const FloatEnvironment guard;
  const toml::table root = ParseSetup(text, path);
  SetupReader reader(path, map_directory);
  FurSetup setup = ReadTop(reader, root);
  setup.path = path;
  setup.text = text;

  LayerSetup base;
  const toml::table* defaults = nullptr;
  if (const toml::node* node = root.get("defaults")) {
    reader.SetOwner("defaults: ");
    if (!node->is_table()) reader.Fail(reader.LineOf(*node), "write it as [defaults]");
    defaults = node->as_table();
    if (const toml::node* name = defaults->get("name")) {
      reader.FailKey(reader.LineOf(*name), "name", "belongs to one layer; it has no default");
    }
    reader.ReadTable(KeyInfo{}, *defaults, base, true);
  }
  reader.SetOwner("");
  const toml::node* layers = root.get("layer");
  if (!layers || !layers->is_array() || layers->as_array()->empty()) {
    reader.Fail(layers ? reader.LineOf(*layers) : 1, "a fur setup needs at least one [[layer]]");
  }
  if (layers->as_array()->size() > kLayersPerScene) {
    reader.Fail(reader.LineOf(*layers), Format("more than {} layers", kLayersPerScene));
  }
  std::set<std::string> names;
  for (size_t i = 0; i < layers->as_array()->size(); ++i) {
    const toml::node& node = (*layers->as_array())[i];
    setup.layers.push_back(ReadLayer(reader, node, i, base, defaults));
    if (!names.insert(setup.layers.back().name).second) {
      reader.FailKey(reader.LineOf(*node.as_table()->get("name")), "name",
                     "another layer has this name");
    }
  }
  setup.files_read = reader.FilesRead();
  const auto has_chains = [](const LayerSetup& layer) {
    return layer.params.chain == ChainKind::kVertex && layer.params.output != Output::kShells;
  };
  if (setup.chain_mesh && !std::ranges::any_of(setup.layers, has_chains)) {
    reader.SetOwner("");
    reader.FailKey(reader.LineOf(*root.get("chain_mesh")), "chain_mesh",
                   "no layer has chains at mesh vertices: chain = \"vertex\", and no shells");
  }
  return setup;
}

std::string ReadSetupText(const std::string& path) {
  return std::string(AsText(ReadSetupBytes(path)));
}

FurSetup ReadFurSetupFile(const std::string& path) {
  return ReadFurSetup(ReadSetupText(path), path, FolderOf(path));
}

LightsSetup ReadLights(std::string_view text, const std::string& path) {
  const FloatEnvironment guard;
  const toml::table root = ParseSetup(text, path);
  SetupReader reader(path, "");
  const FurSetup setup = ReadTop(reader, root);
  if (!setup.lights) reader.Fail(1, "there is no [lights] in it");
  return *setup.lights;
}

LightsSetup ReadLightsFile(const std::string& path) {
  return ReadLights(AsText(ReadSetupBytes(path)), path);
}

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

std::string_view SourceOf(std::string_view text, const toml::node& node) {
  const size_t begin = OffsetOf(text, node.source().begin);
  return text.substr(begin, OffsetOf(text, node.source().end) - begin);
}

// `part` is of the text.
std::string Replace(std::string_view text, std::string_view part, std::string_view by) {
  return std::string(text).replace(size_t(part.data() - text.data()), part.size(), by);
}

// Behind the line that holds a place of the text.
std::string InsertLine(std::string_view text, size_t at, std::string_view line) {
  const size_t end = text.find('\n', at);
  if (end == text.npos) return Format("{}\n{}\n", text, line);
  return Format("{}{}\n{}", text.substr(0, end + 1), line, text.substr(end + 1));
}

std::string InsertBelowName(std::string_view text, const toml::table& layer,
                            std::string_view line) {
  return InsertLine(text, OffsetOf(text, layer.get("name")->source().end), line);
}

// An inline table's source with one more key.
std::string InsertKey(std::string source, const toml::table& table, std::string_view entry) {
  return source.insert(1, table.empty() ? Format(" {} ", entry) : Format(" {},", entry));
}

const toml::table& ExpectLayer(const toml::table& root, const std::string& path,
                               std::string_view layer) {
  const toml::table* table = FindLayer(root, layer);
  if (!table) throw Error(Format("{}: no layer '{}'", path, layer));
  return *table;
}

// Of what has headers or dots in its keys the source is in parts.
void ExpectInline(std::string_view text, const std::string& path, std::string_view key,
                  const toml::node& node) {
  const toml::table* table = node.as_table();
  if ((table && !table->is_inline()) ||
      (node.is_array_of_tables() && SourceOf(text, node).starts_with("[[")))
    throw Error(Format("{}:{}: key '{}' is written in parts; write it as one {} to change it here",
                       path, std::max<uint32_t>(node.source().begin.line, 1), key,
                       table ? "table { ... }" : "list [ ... ]"));
}

bool IsAttribute(std::string_view key) {
  return std::ranges::any_of(Schema<LayerSetup>(), [&](const KeyEntry<LayerSetup>& entry) {
    return entry.info.key == key && entry.info.type == "attribute";
  });
}

}  // namespace

std::string ChangeLayerKey(std::string_view text, const std::string& path, std::string_view layer,
                           std::string_view key, std::string_view value) {
  const toml::table root = ParseToml(text, path);
  const toml::table& table = ExpectLayer(root, path, layer);
  const toml::node* node = table.get(key);
  if (!node) return InsertBelowName(text, table, Format("{} = {}", key, value));
  const toml::table* inside = node->as_table();
  if (const toml::node* own = inside ? inside->get("value") : node; own && !own->is_array())
    return Replace(text, SourceOf(text, *own), value);
  ExpectInline(text, path, key, *node);
  const std::string_view source = SourceOf(text, *node);
  if (!inside) return Replace(text, source, value);
  if (!IsAttribute(key))
    throw Error(
        Format("{}:{}: key '{}' is a table without a value", path, node->source().begin.line, key));
  return Replace(text, source,
                 InsertKey(std::string(source), *inside, Format("value = {}", value)));
}

std::string ChangeLayerMap(std::string_view text, const std::string& path, std::string_view layer,
                           std::string_view key, std::string_view map) {
  const toml::table root = ParseToml(text, path);
  const toml::table& table = ExpectLayer(root, path, layer);
  const size_t dot = key.find('.');
  const std::string_view outer = key.substr(0, dot);
  const toml::node* own = table.get(outer);
  // A table of the layer's own is in the place of all that [defaults] says of the key.
  const toml::node* said = own ? own : root["defaults"][outer].node();
  const toml::table* inside = said ? said->as_table() : nullptr;
  if (said) ExpectInline(text, path, outer, *said);
  const std::string_view inner = dot == key.npos ? "map" : key.substr(dot + 1);
  const std::string name = Format("\"{}\"", map), entry = Format("{} = {}", inner, name);
  std::string value(said ? SourceOf(text, *said) : "");
  const toml::node* old = inside ? inside->get(inner) : nullptr;
  if (old && old->is_table()) old = old->as_table()->get("map");
  if (old) {
    const size_t begin = OffsetOf(text, said->source().begin);
    const std::string_view source = SourceOf(text, *old);
    value.replace(size_t(source.data() - text.data()) - begin, source.size(), name);
  } else if (inside) {
    value = InsertKey(std::move(value), *inside, entry);
  } else if (said && said->is_number()) {
    value = Format("{{ value = {}, {} }}", value, entry);
  } else {
    value = dot != key.npos || IsAttribute(key) ? Format("{{ {} }}", entry) : name;
  }
  return own ? Replace(text, SourceOf(text, *own), value)
             : InsertBelowName(text, table, Format("{} = {}", outer, value));
}

}  // namespace pelt
