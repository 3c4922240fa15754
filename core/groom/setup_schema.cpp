// The keys of a fur setup, without those of its lights (light_setup.cpp), and the list of all for people.
//
// Bounds are there to catch slips (millimetres for metres, a missing decimal point) and to keep
// hostile files from asking for absurd amounts of work; they are far outside what looks good.
#include "core/groom/setup_schema.hpp"

#include "core/float_rules.hpp"
#include "core/groom/setup_entries.hpp"
#include "core/layer.hpp"

namespace pelt {
namespace {

using setup_entries::AsOuter;
using setup_entries::ChannelOf;
using setup_entries::Colour;
using setup_entries::Count;
using setup_entries::kReachLimit;
using setup_entries::MakeEntry;
using setup_entries::Map;
using setup_entries::Number;
using setup_entries::Plain;
using setup_entries::Required;
using setup_entries::Show;
using setup_entries::SurfaceMap;
using setup_entries::Switch;
using setup_entries::Text;

constexpr std::string_view kAxisWords[] = {"x", "y", "z"};
constexpr std::string_view kStrandChannelWords[] = {"look", "weather"};
constexpr std::string_view kBlueWords[] = {"up", "length", "unused"};
constexpr double kMapLimit = 100.0;
constexpr double kStrandLimit = 8388608.0;  // a strand's index in its layer has 24 bits

using L = LayerSetup;
constexpr auto kParams = &LayerSetup::params;

template <class T>
constexpr Text ParamType() {
  return std::is_same_v<T, bool>       ? "true or false"
         : std::is_enum_v<T>           ? "word"
         : std::is_same_v<T, uint32_t> ? "whole number"
                                       : "number";
}

// The key of a layer parameter, made from its entry.
template <size_t kPlace>
KeyEntry<L> ParamKey() {
  constexpr const auto& kEntry = std::get<kPlace>(kLayerParamEntries);
  using T = MemberType<kEntry.member>;
  if constexpr (std::is_class_v<T>)
    return Colour<kParams, kEntry.member>(kEntry.key, kEntry.text);
  else
    return MakeEntry<kParams, kEntry.member>({kEntry.key, ParamType<T>(), kEntry.unit, kEntry.low,
                                              kEntry.high, kEntry.text, kEntry.words});
}

// The key of an attribute, made from its entry.
template <size_t kPlace>
KeyEntry<L> AttributeKey() {
  constexpr const StrandAttribute& kEntry = kStrandAttributes[kPlace];
  return MakeEntry<kEntry.member>(
      {kEntry.key, "attribute", kEntry.unit, kEntry.low, kEntry.high, kEntry.text});
}

// A group's keys: its attributes, those of the layer itself, its parameters.
void AddKeys(std::vector<KeyEntry<L>>& keys, KeyGroup group,
             std::initializer_list<KeyEntry<L>> own) {
  const auto add = [&](KeyGroup of, const KeyEntry<L>& key) {
    if (of == group) keys.push_back(key);
  };
  [&]<size_t... kPlace>(std::index_sequence<kPlace...>) {
    (add(kStrandAttributes[kPlace].group, AttributeKey<kPlace>()), ...);
  }
  (std::make_index_sequence<kStrandAttributes.size()>());
  keys.insert(keys.end(), own);
  [&]<size_t... kPlace>(std::index_sequence<kPlace...>) {
    (add(std::get<kPlace>(kLayerParamEntries).group, ParamKey<kPlace>()), ...);
  }
  (std::make_index_sequence<
      std::tuple_size_v<std::remove_cvref_t<decltype(kLayerParamEntries)>>>());
}

KeyEntry<L> DensityEntry() {
  KeyInfo info{"density", "attribute", "1/m^2",
               0,         1.0e7,       "strands per square metre; randomise: by triangle"};
  return {info,
          [](SetupReader& reader, const KeyInfo& key, const toml::node& node, L& layer) {
            reader.ReadDensity(key, node, layer);
          },
          [](const KeyInfo& key, const L& layer) { return Show(key, layer.density); },
          [](const L& layer) { return SurfaceMap(layer.density_map); }};
}

}  // namespace

template <>
std::span<const KeyEntry<FurSetup>> Schema() {
  static const KeyEntry<FurSetup> kEntries[] = {
      Number<&FurSetup::unit_scale>("unit_scale", "m", 1e-6, 1e6,
                                    "metres a unit of the character file; else from its size"),
      Number<&FurSetup::crease_angle>(
          "crease_angle", "degrees", 0, 180,
          "edges of the mesh up to this sharp are round to the fur, which else parts at facets"),
      Plain<&FurSetup::clip>("clip", "text", "the animation to play; else the file's first"),
      Plain<&FurSetup::clip_smoothing>(
          "clip_smoothing", "true or false",
          "motion sampled in more than 10 linear keys a second goes smoothly through them"),
      Plain<&FurSetup::chain_mesh>("chain_mesh", "path",
                                   "coarser glTF of the same character: chains stand at its "
                                   "vertices' nearest (chain_share)"),
      Plain<&FurSetup::lights>("lights", "table", "what light there is, for lit layers"),
      {{"defaults", "table", "", 0, 0, "layer keys that hold for every layer that lacks them"},
       nullptr,
       [](const KeyInfo&, const FurSetup&) { return std::string("none"); }},
      {{"layer", "tables", "", 1, double(kLayersPerScene), "[[layer]]: a region of fur"},
       nullptr,
       [](const KeyInfo&, const FurSetup&) { return std::string("none"); }},
  };
  return kEntries;
}

template <>
std::span<const KeyEntry<LayerSetup>> Schema() {
  static const std::vector<KeyEntry<L>> kKeys = [] {
    std::vector<KeyEntry<L>> keys;
    // What the layer is.
    AddKeys(keys, KeyGroup::kLayer,
            {
                Required(Plain<&L::name>("name", "text", "shown in reports; unique")),
                Plain<&L::seed>("seed", "whole number", "chooses every random value of the layer",
                                0, 0),
            });
    // Where it grows, and how much.
    AddKeys(keys, KeyGroup::kGrowth,
            {
                DensityEntry(),
                Count<&L::max_strands>("max_strands", 0, kStrandLimit,
                                       "most strands; 0: density decides"),
                Plain<&L::mask>("mask", "mask", "where the layer grows"),
            });
    // What a strand looks like.
    AddKeys(keys, KeyGroup::kLook,
            {
                Plain<&L::comb>("comb", "tables", "comb vectors", 0, 4096),
                Number<&L::comb_normal_weight>("comb_normal_weight", "", 0, 1,
                                               "how much a differing normal weakens a comb vector"),
                Plain<&L::comb_joint>("comb_joint", "text",
                                      "outside every comb vector's reach: along this joint"),
                Plain<&L::direction_vector>(
                    "direction_vector", "[x, y, z]",
                    "likewise: along tangent, bitangent and normal; any length but 0", -kReachLimit,
                    kReachLimit),
                Plain<&L::flow_map>("flow_map", "table",
                                    "likewise, painted over the surface; before the others"),
                Plain<&L::direction_range>(
                    "direction_range", "[x, y, z]",
                    "added to the direction, which is unit, times a random number in [-1, 1] each",
                    0, 10),
                Plain<&L::curl_profile>("curl_profile", "[a, b, c]",
                                        "curl at a share t of the strand: times a + b t + c t^2",
                                        -kMapLimit, kMapLimit),
                Colour<&L::base_colour>("base_colour",
                                        "at the root; if not said, the mesh's own, darker"),
                Colour<&L::tip_colour>("tip_colour",
                                       "at the tip; if not said, the mesh's own at the root"),
                Map<&L::colour_map>("colour_map", "its r, g and b multiply both colours"),
                Map<&L::base_colour_map>("base_colour_map", "likewise, of the colour at the root"),
                Map<&L::tip_colour_map>("tip_colour_map", "likewise, of the colour at the tip"),
                Count<&L::film_strip_count>("film_strips", 1, 256,
                                            "silhouettes of strands; picked at random"),
                Map<&L::type_map>("type_map",
                                  "picks each strand's of film_strips: 0 the first, 1 the last"),
                Plain<&L::strand_texture>("strand_texture", "path",
                                          "PNG: film_strips silhouettes side by side, root on top"),
                MakeEntry<&L::strand_channels>(
                    {"strand_channels", "word", "", 0, 0,
                     "r extra tint, g specular, b shadow, a alpha; or alpha dry, wet, dirty",
                     kStrandChannelWords}),
                Plain<kParams, &LayerParams::look>("look", "table", "how the layer takes light"),
            });
    // How it moves.
    AddKeys(keys, KeyGroup::kMotion,
            {
                Number<&L::segment_length>("segment_length", "m", 0, 3,
                                           "vertex: of its chains; 0: a third of their strands"),
                Count<&L::clump_controls>("clump_controls", 0, 64,
                                          "control strands per chunk, rounded up to 16"),
                Plain<&L::hardness_profile>("hardness_profile", "[root, .., tip]",
                                            "pbd, verlet: factor on the hardness of each link's "
                                            "joint, one for each of its points - 1 links",
                                            0, 10),
            });
    // What water and dirt do to it.
    AddKeys(keys, KeyGroup::kWeather, {});
    return keys;
  }();
  return kKeys;
}

template <>
std::span<const KeyEntry<Attribute>> Schema() {
  using A = Attribute;
  static const KeyEntry<A> kEntries[] = {
      AsOuter(Number<&A::value>("value", "", 0, 0, "where the map is 1")),
      Number<&A::randomise>("randomise", "", 0, 1, "times (1 + randomise * u), u in [-1, 1]"),
      AsOuter(Plain<&A::range>("range", "[low, high]", "the result is kept inside")),
      Plain<&A::map, &MapChannel::map>("map", "path", "PNG that scales the value; needs UVs"),
      ChannelOf<&A::map, &MapChannel::channel>("of the map"),
      Number<&A::map, &MapChannel::low>("low", "", -kMapLimit, kMapLimit,
                                        "factor where the map is 0"),
      Number<&A::map, &MapChannel::high>("high", "", -kMapLimit, kMapLimit,
                                         "factor where the map is 1 (255)"),
  };
  return kEntries;
}

template <>
std::span<const KeyEntry<MapChannel>> Schema() {
  static const KeyEntry<MapChannel> kEntries[] = {
      Required(Plain<&MapChannel::map>("map", "path", "PNG, from the setup's folder")),
      ChannelOf<&MapChannel::channel>("of the map"),
      Number<&MapChannel::low>("low", "", -kMapLimit, kMapLimit, "what its 0 stands for"),
      Number<&MapChannel::high>("high", "", -kMapLimit, kMapLimit, "what its 1 (255) stands for"),
  };
  return kEntries;
}

template <>
std::span<const KeyEntry<Mask>> Schema() {
  static const KeyEntry<Mask> kEntries[] = {
      Plain<&Mask::materials>("materials", "texts",
                              "grow on these alone; else on all but eyes, claws, clothes..."),
      Plain<&Mask::joints>("joints", "tables", "grow where joints move the skin; largest counts"),
      Plain<&Mask::box>("box", "table", "a map projected through the rest pose's bounding box"),
      Plain<&Mask::range>("range", "table", "grow inside a part of the bounding box"),
      Plain<&Mask::away_from>("away_from", "table", "bald about other materials: eyes, a nose"),
      Map<&Mask::uv>("uv", "stencil: scales the density; needs UVs"),
      Map<&Mask::bald>("bald", "1 is bald; needs UVs"),
      Plain<&Mask::colours>("colours", "colours",
                            "bald where the character's image, or else its surface, has them", 1,
                            64),
      Number<&Mask::colour_tolerance>(
          "colour_tolerance", "", 0, 1,
          "of mask.colours: most that r, g and b may each differ, of their range"),
  };
  return kEntries;
}

template <>
std::span<const KeyEntry<Mask::JointWeight>> Schema() {
  using J = Mask::JointWeight;
  static const KeyEntry<J> kEntries[] = {
      Required(Plain<&J::joint>("joint", "text", "name of a joint")),
      Switch<&J::subtree>("subtree", "its descendants count too"),
      Number<&J::low>("low", "", 0, 1, "weight at which fur begins"),
      Number<&J::high>("high", "", 0, 1, "weight from which fur is full"),
  };
  return kEntries;
}

template <>
std::span<const KeyEntry<Mask::Box>> Schema() {
  using B = Mask::Box;
  static const KeyEntry<B> kEntries[] = {
      MakeEntry<&B::axis>({"axis", "word", "", 0, 0, "to project along", kAxisWords}),
      Required(Plain<&B::map, &MapChannel::map>("map", "path", "PNG, from the setup's folder")),
      ChannelOf<&B::map, &MapChannel::channel>("of the map"),
  };
  return kEntries;
}

template <>
std::span<const KeyEntry<Mask::Range>> Schema() {
  using R = Mask::Range;
  static const KeyEntry<R> kEntries[] = {
      Plain<&R::low>("low", "[x, y, z]", "corner, as a share of the box", 0, 1),
      Plain<&R::high>("high", "[x, y, z]", "other corner", 0, 1),
  };
  return kEntries;
}

template <>
std::span<const KeyEntry<Mask::AwayFrom>> Schema() {
  using A = Mask::AwayFrom;
  static const KeyEntry<A> kEntries[] = {
      Required(Plain<&A::materials>("materials", "texts", "that it keeps away from", 1, 64)),
      Number<&A::distance>("distance", "m", 0, kReachLimit,
                           "of the rest pose, to the nearest of them"),
  };
  return kEntries;
}

template <>
std::span<const KeyEntry<FlowMapSetup>> Schema() {
  using F = FlowMapSetup;
  static const KeyEntry<F> kEntries[] = {
      Required(Plain<&F::picture, &MapChannel::map>(
          "map", "path", "PNG: red and green are the way along u and v, 128 is 0")),
      MakeEntry<&F::blue>({"blue", "word", "", 0, 0,
                           "the way up the normal, or the length over longest", kBlueWords}),
      Number<&F::longest>("longest", "m", 0, 10, "length where blue = \"length\" is 255"),
  };
  return kEntries;
}

template <>
std::span<const KeyEntry<CombVector>> Schema() {
  using C = CombVector;
  static const KeyEntry<C> kEntries[] = {
      Required(
          Plain<&C::position>("position", "[x, y, z]", "m, rest pose", -kReachLimit, kReachLimit)),
      Required(Plain<&C::direction>("direction", "[x, y, z]", "rest pose; any length but 0",
                                    -kReachLimit, kReachLimit)),
      Number<&C::reach>("reach", "m", 1e-4, kReachLimit, "how far it acts"),
  };
  return kEntries;
}

template <>
std::span<const KeyEntry<LayerLook>> Schema() {
  static const std::vector<KeyEntry<LayerLook>> kKeys = [] {
    std::vector<KeyEntry<LayerLook>> keys{
        Plain<&LayerLook::tint>("tint", "[r, g, b]", "linear; multiplies both colours", 0,
                                kMostTint),
        Plain<&LayerLook::strand_tint>("strand_tint", "[r, g, b]",
                                       "likewise, where a strand_texture has extra tint", 0,
                                       kMostTint)};
    [&]<size_t... kPlace>(std::index_sequence<kPlace...>) {
      (keys.push_back(Number<kLayerLookEntries[kPlace].member>(
           kLayerLookEntries[kPlace].key, "", kLayerLookEntries[kPlace].low,
           kLayerLookEntries[kPlace].high, kLayerLookEntries[kPlace].text)),
       ...);
    }
    (std::make_index_sequence<std::size(kLayerLookEntries)>());
    return keys;
  }();
  return kKeys;
}

namespace {

template <class T>
std::string FindMapKey(const T& object, const std::string& prefix = {}) {
  for (const auto& entry : Schema<T>()) {
    const MapChannel* map = entry.map ? entry.map(object) : nullptr;
    if (map && map->map) return prefix + std::string(entry.info.key);
  }
  return {};
}

}  // namespace

// Not a box's map, which is projected.
std::string FindSurfaceMap(const LayerSetup& layer) {
  const std::string key = FindMapKey(layer);
  return key.empty() ? FindMapKey(layer.mask, "mask.") : key;
}

// ---- The list for people ------------------------------------------------------------------------

namespace {

std::string DescribeType(const KeyInfo& info) {
  if (!info.words.empty()) return Format("{}", fmt::join(info.words, " | "));
  std::string text(info.type);
  if (!info.unit.empty()) text += Format(", {}", info.unit);
  if ((info.type == "number" || info.type == "whole number" || info.type == "attribute") &&
      info.low < info.high) {
    text += Format(", {} to {}", info.low, info.high);
  }
  return text;
}

template <class T>
void Describe(std::string& out, std::string_view heading) {
  out += Format("\n{}\n", heading);
  const T builtin{};
  for (const auto& entry : Schema<T>()) {
    const std::string value =
        entry.info.required ? "needed" : "default " + entry.show(entry.info, builtin);
    out += Format("  {:<24} {:<34} {:<22} {}\n", entry.info.key, DescribeType(entry.info), value,
                  entry.info.doc);
  }
}

}  // namespace

std::string DescribeSetupKeys() {
  std::string out =
      "Keys of a fur setup (TOML). Lengths are metres, angles degrees, colours \"#rrggbb\".\n"
      "An attribute is a number, or a table of the keys listed for it; a map is the path of a "
      "PNG,\n"
      "or a table. Maps are found from the setup's folder.\n";
  Describe<FurSetup>(out, "At the top of the file");
  Describe<LayerSetup>(out, "In [[layer]] and [defaults]");
  Describe<Attribute>(out, "In an attribute, as length = { value = 0.03, randomise = 0.2 }");
  Describe<MapChannel>(out, "In a map, as bald = { map = \"maps/bald.png\", channel = \"g\" }");
  Describe<Mask>(out, "In mask (what is given is multiplied)");
  Describe<Mask::JointWeight>(out, "In mask.joints = [{ ... }]");
  Describe<Mask::Box>(out, "In mask.box");
  Describe<Mask::Range>(out, "In mask.range");
  Describe<Mask::AwayFrom>(out, "In mask.away_from");
  Describe<FlowMapSetup>(out, "In flow_map = { ... }, as pelt bake --flow-map prints it");
  Describe<CombVector>(out, "In comb = [{ ... }]");
  Describe<LayerLook>(out, "In look, as [layer.look]");
  Describe<LightsSetup>(out, "In [lights]");
  Describe<LightsSetup::Light>(out, "In lights.light = [{ ... }], or [[lights.light]]");
  Describe<LightsSetup::Sample>(out, "In lights.sample");
  Describe<LightsSetup::Sun>(out, "In lights.sun");
  Describe<LightsSetup::Rim>(out, "In lights.rim");
  return out;
}

}  // namespace pelt
