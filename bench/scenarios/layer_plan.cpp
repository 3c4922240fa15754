#include "bench/scenarios/layer_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "bench/scenarios/scenarios.hpp"
#include "core/error.hpp"
#include "core/file_bytes.hpp"
#include "core/groom/nearest_word.hpp"
#include "core/groom/setup_entries.hpp"

namespace pelt {
namespace {

constexpr uint64_t kPlanBytesLimit = 16u << 20;

// A word of a layer's parameter, as in a setup.
template <auto kMember, class Enum>
KeyEntry<LayerChoice> Word(Enum LayerParams::*param) {
  const auto& entry = LayerParamEntryOf(param);
  return setup_entries::MakeEntry<&LayerChoice::choice, kMember>(
      {entry.key, "word", "", entry.low, entry.high, entry.text, entry.words});
}

template <auto kMember>
KeyEntry<LayerChoice> Share(std::string_view key, double low, std::string_view doc) {
  return setup_entries::MakeEntry<&LayerChoice::choice, kMember>({key, "number", "", low, 1, doc});
}

// What held a sag-free layer up.
void DropRestDown(Groom& groom, size_t layer) {
  const ChainKind chain = groom.layers[layer].params.chain;
  const bool on_vertices = chain == ChainKind::kVertex;
  const auto count = [&](size_t l) {
    return on_vertices ? groom.layers[l].patch_count : groom.layers[l].chunk_count;
  };
  size_t first = 0;
  for (size_t l = 0; l < layer; ++l)
    if (groom.layers[l].params.sag_free && groom.layers[l].params.chain == chain) first += count(l);
  std::vector<DownBlock>& downs = on_vertices ? groom.vertex_down : groom.strand_down;
  const auto begin = downs.begin() + ptrdiff_t(first);
  downs.erase(begin, begin + count(layer));
}

// The first of each chunk's strands, which are spread over all of it; control strands among them.
void KeepStrands(Groom& groom, GroomLayer& layer, float share) {
  layer.strand_count = 0;
  layer.length_max = 0.0f;
  for (uint32_t c = 0; c < layer.chunk_count; ++c) {
    StrandBlock& block = groom.strands[layer.first_chunk + c];
    const auto kept = uint32_t(std::ceil(double(share) * block.strand_count));
    block.strand_count = std::min(std::max(kept, block.control_count), block.strand_count);
    layer.strand_count += block.strand_count;
    for (uint32_t s = 0; s < block.strand_count; ++s)
      layer.length_max = std::max(layer.length_max, block.length[s]);
  }
}

template <class Enum>
std::string WordOf(Enum LayerParams::*param, Enum value) {
  const auto& entry = LayerParamEntryOf(param);
  return fmt::format("{} = \"{}\"\n", entry.key, entry.words[size_t(value)]);
}

}  // namespace

template <>
std::span<const KeyEntry<LayerChoice>> Schema() {
  using C = LayerChoice;
  using S = SimulationChoice;
  static const KeyEntry<C> kEntries[] = {
      setup_entries::Required(
          setup_entries::Count<&C::character>("character", 0, 1e6, "of the scene, from 0")),
      setup_entries::Required(setup_entries::Plain<&C::name>("name", "text", "of its layer")),
      Word<&S::solver>(&LayerParams::solver),
      Word<&S::quality>(&LayerParams::quality),
      Word<&S::curl_follows>(&LayerParams::curl_follows),
      Share<&S::chain_share>("chain_share", 0.125, "of its chains at mesh vertices"),
      Share<&S::strand_share>("strand_share", 0.01, "of its strands"),
  };
  return kEntries;
}

std::vector<LayerChoice> ReadLayerPlan(const std::string& path) {
  const std::vector<std::byte> bytes = ReadFileBytes("layer plan", path, kPlanBytesLimit).OrThrow();
  const toml::table root = ParseToml(AsText(bytes), path);
  SetupReader reader(path, "");
  for (const auto& [key, node] : root)
    if (key != "layer")
      reader.Fail(std::max<uint32_t>(key.source().begin.line, 1),
                  fmt::format("unknown key '{}'; a plan has [[layer]] alone", key.str()));
  const toml::array* layers = root["layer"].as_array();
  if (!layers) throw Error(fmt::format("{}: a plan has [[layer]] tables, this has none", path));
  std::vector<LayerChoice> plan;
  std::set<std::pair<uint32_t, std::string>> seen;
  for (const toml::node& node : *layers) {
    if (!node.is_table()) reader.Fail(reader.LineOf(node), "a plan's layers are [[layer]] tables");
    LayerChoice& layer = plan.emplace_back();
    layer.line = reader.LineOf(node);
    reader.ReadTable({}, *node.as_table(), layer);
    const SimulationChoice& choice = layer.choice;
    if (choice.solver.value_or(Solver::kModal) != Solver::kModal &&
        (choice.quality || choice.curl_follows))
      reader.Fail(layer.line, "quality and curl_follows are of solver = \"modal\"");
    if (!seen.emplace(layer.character, layer.name).second)
      reader.Fail(layer.line, fmt::format("layer '{}' of character {} is there twice", layer.name,
                                          layer.character));
  }
  return plan;
}

void ApplyLayerPlan(std::span<const LayerChoice> plan, const std::string& path,
                    Scenario& scenario) {
  for (const LayerChoice& layer : plan) {
    const auto fail = [&](const std::string& reason) {
      throw Error(fmt::format("{}:{}: {}", path, layer.line, reason));
    };
    if (layer.character >= scenario.actors.size())
      fail(fmt::format("no character {}; the scene has {}, from 0", layer.character,
                       scenario.actors.size()));
    Groom& groom = scenario.grooms[scenario.actors[layer.character].groom];
    const auto found = std::ranges::find(groom.layers, layer.name, &GroomLayer::name);
    if (found == groom.layers.end()) {
      std::vector<std::string_view> names;
      for (const GroomLayer& known : groom.layers) names.push_back(known.name);
      fail(fmt::format("character {} has no layer '{}'{}", layer.character, layer.name,
                       DidYouMean(layer.name, names)));
    }
    const auto bad = ChangeSimulation(groom, size_t(found - groom.layers.begin()), layer.choice);
    if (bad) fail(fmt::format("layer '{}': key '{}': {}", layer.name, bad->key, bad->reason));
  }
}

std::string LayerPlanText(std::span<const LayerChoice> plan) {
  std::string text;
  for (const LayerChoice& layer : plan) {
    // As TOML wants it, which has the name in quotes.
    text += fmt::format("\n[[layer]]\ncharacter = {}\nname = ", layer.character);
    std::ostringstream name;
    name << toml::value<std::string>(layer.name);
    text += name.str() + '\n';
    const SimulationChoice& choice = layer.choice;
    if (choice.solver) text += WordOf(&LayerParams::solver, *choice.solver);
    if (choice.quality) text += WordOf(&LayerParams::quality, *choice.quality);
    if (choice.curl_follows) text += WordOf(&LayerParams::curl_follows, *choice.curl_follows);
    if (choice.chain_share) text += fmt::format("chain_share = {}\n", *choice.chain_share);
    if (choice.strand_share) text += fmt::format("strand_share = {}\n", *choice.strand_share);
  }
  return text;
}

std::optional<BadKey> ChangeSimulation(Groom& groom, size_t l, const SimulationChoice& choice) {
  LayerParams params = groom.layers[l].params;
  params.solver = choice.solver.value_or(params.solver);
  params.quality = choice.quality.value_or(params.quality);
  params.curl_follows = choice.curl_follows.value_or(params.curl_follows);
  params.chain_share = choice.chain_share.value_or(params.chain_share);
  params.sag_free = params.sag_free && params.solver == Solver::kModal;
  if (const auto bad = FindBadCombination(params)) return bad;
  if (groom.layers[l].params.sag_free && !params.sag_free) DropRestDown(groom, l);
  groom.layers[l].params = params;
  if (choice.strand_share) KeepStrands(groom, groom.layers[l], *choice.strand_share);
  return std::nullopt;
}

}  // namespace pelt
