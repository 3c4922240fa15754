// The fur setup: each key lands in its field. Every key of the schema has its entry here; one without
// fails.
#include "core/groom/fur_setup.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <set>
#include <sstream>

#include "core/groom/setup_schema.hpp"
#include "tests/groom/setup_folder.hpp"
#include "tests/source_folder.hpp"

namespace pelt::test {
namespace {

using FurSetupTest = SetupFolder;

struct KeyCase {
  std::string key, value;
  std::function<bool(const LayerSetup&)> landed;
};

bool Near(float a, float b) { return std::fabs(a - b) <= 1e-6f * std::max(1.0f, std::fabs(b)); }

std::vector<KeyCase> ListKeyCases() {
  using L = const LayerSetup&;
  return {
      {"name", "'head'", [](L l) { return l.name == "head"; }},
      {"seed", "123456789012", [](L l) { return l.seed == 123456789012u; }},
      {"enabled", "false", [](L l) { return !l.params.enabled; }},
      {"solver", "'verlet'\nchain = 'strand'",
       [](L l) { return l.params.solver == Solver::kVerlet; }},
      {"chain", "'strand'",
       [](L l) { return l.params.chain == ChainKind::kStrand && l.params.points == 5; }},
      {"points", "5\nchain = 'strand'", [](L l) { return l.params.points == 5; }},
      {"points", "9\nchain = 'strand'", [](L l) { return l.params.points == 9; }},
      {"output", "'ribbons'", [](L l) { return l.params.output == Output::kRibbons; }},
      {"output", "'lines'", [](L l) { return l.params.output == Output::kLines; }},
      {"output", "'shells'", [](L l) { return l.params.output == Output::kShells; }},
      {"shells", "8", [](L l) { return l.params.shells == 8; }},
      {"cone_kind", "'published'", [](L l) { return l.params.cone_kind == ConeKind::kPublished; }},
      {"fur_texture_size", "64", [](L l) { return l.params.fur_texture_size == 64; }},
      {"fur_seed", "77", [](L l) { return l.params.fur_seed == 77; }},
      {"fins", "true\noutput = 'shells'", [](L l) { return l.params.fins; }},
      {"density",
       "{ value = 5e4, randomise = 0.25, range = [1e4, 9e4], map = 'maps/m.png', channel = 'b', "
       "high = 2 }",
       [](L l) {
         return l.density == 5e4f && l.density_randomise == 0.25f &&
                *l.density_range == glm::vec2(1e4f, 9e4f) && l.density_map.map &&
                l.density_map.channel == 2 && l.density_map.low == 0.0f &&
                l.density_map.high == 2.0f;
       }},
      {"max_strands", "777", [](L l) { return l.max_strands == 777; }},
      {"mask", "{ materials = ['a', 'b'] }",
       [](L l) {
         return l.mask.materials == std::vector<std::string>{"a", "b"};
       }},
      {"length", "0.07", [](L l) { return Near(l.length.value, 0.07f); }},
      {"comb", "[{ position = [1, 2, 3], direction = [0, -1, 0.5], reach = 0.25 }]",
       [](L l) {
         return l.comb.size() == 1 && l.comb[0].position == glm::vec3(1, 2, 3) &&
                l.comb[0].direction == glm::vec3(0, -1, 0.5f) && l.comb[0].reach == 0.25f;
       }},
      {"comb_normal_weight", "0.75", [](L l) { return l.comb_normal_weight == 0.75f; }},
      {"comb_joint", "'Neck'", [](L l) { return l.comb_joint == "Neck"; }},
      {"direction_vector", "[0, 0.5, -1]",
       [](L l) { return l.direction_vector == glm::vec3(0.0f, 0.5f, -1.0f); }},
      {"direction_range", "[0.25, 2, 0]",
       [](L l) { return l.direction_range == glm::vec3(0.25f, 2.0f, 0.0f); }},
      {"flow_map", "{ map = 'maps/m.png', blue = 'length', longest = 0.5 }",
       [](L l) {
         return l.flow_map && l.flow_map->picture.map && l.flow_map->blue == FlowBlue::kLength &&
                l.flow_map->longest == 0.5f && FindSurfaceMap(l) == "flow_map";
       }},
      {"curl_profile", "[0, -1, 2]",
       [](L l) { return l.curl_profile == glm::vec3(0.0f, -1.0f, 2.0f); }},
      {"segment_length", "0.25", [](L l) { return l.segment_length == 0.25f; }},
      {"base_colour", "'#123456'", [](L l) { return l.base_colour == 0xff563412u; }},
      {"tip_colour", "'#aBcDeF'", [](L l) { return l.tip_colour == 0xffefcdabu; }},
      {"colour_variation", "0.3", [](L l) { return Near(l.colour_variation.value, 0.3f); }},
      {"colour_map", "'maps/m.png'",
       [](L l) { return l.colour_map.map && l.colour_map.channel == 0; }},
      {"base_colour_map", "{ map = 'maps/m.png', low = 0.5 }",
       [](L l) { return l.base_colour_map.map && l.base_colour_map.low == 0.5f; }},
      {"tip_colour_map", "'maps/m.png'", [](L l) { return l.tip_colour_map.map != nullptr; }},
      {"film_strips", "7", [](L l) { return l.film_strip_count == 7; }},
      {"type_map", "{ map = 'maps/m.png', channel = 'g' }",
       [](L l) { return l.type_map.map && l.type_map.channel == 1; }},
      {"strand_texture", "'maps/m.png'",
       [](L l) { return l.strand_texture && l.strand_texture->rgba[4] == 200; }},
      {"strand_channels", "'weather'",
       [](L l) { return l.strand_channels == StrandChannels::kWeather; }},
      {"quality", "'best'", [](L l) { return l.params.quality == ModalQuality::kBest; }},
      {"curl_follows", "'root'", [](L l) { return l.params.curl_follows == CurlFollows::kRoot; }},
      {"sag_free", "true", [](L l) { return l.params.sag_free; }},
      {"traits", "true", [](L l) { return l.params.traits; }},
      {"hardness_profile", "[1, 0.5, 10]\nsolver = 'pbd'",
       [](L l) {
         return l.hardness_profile == std::vector<float>{1.0f, 0.5f, 10.0f} && l.params.traits;
       }},
      {"iterations", "9", [](L l) { return l.params.iterations == 9; }},
      {"clump_controls", "32", [](L l) { return l.clump_controls == 32; }},
      {"backface_cull", "false", [](L l) { return !l.params.backface_cull; }},
      {"lit", "true", [](L l) { return l.params.lit; }},
      {"painted", "true\nlit = true", [](L l) { return l.params.painted && l.params.lit; }},
      {"dirt_colour", "'#ff0033'",
       [](L l) {
         return l.params.dirt_colour[0] == 1.0f && l.params.dirt_colour[1] == 0.0f &&
                Near(l.params.dirt_colour[2], 0.2f);
       }},
      {"look", "{ rim = 2, tint = [1, 1, 0.5] }",
       [](const LayerSetup& l) {
         return l.params.look.rim == 2.0f && l.params.look.tint[2] == 0.5f;
       }},
  };
}

TEST_F(FurSetupTest, EveryKeyLandsInItsField) {
  std::set<std::string> tried;
  for (const KeyCase& c : ListKeyCases()) {
    tried.insert(c.key);
    const std::string name = c.key == "name" ? "" : "name = 'x'\n";
    const std::string line = c.key + " = " + c.value + "\n";
    EXPECT_FALSE(c.landed(LayerSetup{})) << c.key << ": the value tried is the built-in one";
    EXPECT_TRUE(c.landed(Read("[[layer]]\n" + name + line).layers.at(0))) << c.key;
    if (c.key == "name") continue;
    EXPECT_TRUE(c.landed(Read("[defaults]\n" + line + "[[layer]]\nname = 'x'\n").layers.at(0)))
        << c.key << " from [defaults]";
  }
  for (const auto& entry : Schema<LayerSetup>()) {
    // Numbers and attributes that have an entry are tried below, each against all others.
    if (entry.info.type == "number" || entry.info.type == "attribute") continue;
    EXPECT_EQ(tried.count(std::string(entry.info.key)), 1u)
        << entry.info.key << " is not tried above";
  }
}

TEST_F(FurSetupTest, EveryNumberOfALayerLandsInItsMemberAlone) {
  const LayerParams builtin;
  uint32_t tried = 0;
  ForEachLayerParam([&]<class T>(const LayerParamEntry<T>& entry) {
    if constexpr (std::is_same_v<T, float>) {
      const double value = (entry.low + 4.0 * entry.high) / 5.0;
      const LayerParams read =
          Read("[[layer]]\nname = 'x'\n" + std::string(entry.key) + " = " + std::to_string(value))
              .layers.at(0)
              .params;
      EXPECT_EQ(read.*entry.member, float(value)) << entry.key;
      ForEachLayerParam([&](const auto& other) {
        EXPECT_EQ(read.*other.member == builtin.*other.member, other.key != entry.key)
            << entry.key << ", " << other.key;
      });
      ++tried;
    }
  });
  EXPECT_GT(tried, 20u);
}

TEST_F(FurSetupTest, EveryValueOfALookLandsInItsMemberAlone) {
  const auto read = [&](const std::string& line) {
    return Read("[[layer]]\nname = 'x'\n[layer.look]\n" + line).layers.at(0).params.look;
  };
  EXPECT_EQ(read("tint = [0.5, 1, 2]").tint, (std::array<float, 3>{0.5f, 1.0f, 2.0f}));
  EXPECT_EQ(read("strand_tint = [0, 1, 2]").strand_tint, (std::array<float, 3>{0.0f, 1.0f, 2.0f}));
  for (const LayerLookEntry& entry : kLayerLookEntries) {
    const double value = (entry.low + 3.0 * entry.high) / 4.0;
    const LayerLook look = read(std::string(entry.key) + " = " + std::to_string(value));
    EXPECT_EQ(look.*entry.member, float(value)) << entry.key;
    for (const LayerLookEntry& other : kLayerLookEntries)
      EXPECT_EQ(look.*other.member == LayerLook{}.*other.member, other.key != entry.key)
          << entry.key << ", " << other.key;
  }
}

TEST_F(FurSetupTest, EveryAttributeTakesItsTable) {
  size_t tried = 0;
  for (const auto& entry : Schema<LayerSetup>()) {
    if (entry.info.type != "attribute" || entry.info.key == "density") continue;
    const std::string key(entry.info.key);
    std::ostringstream half;
    half << (entry.info.low + entry.info.high) / 2;
    const auto setup =
        Read("[[layer]]\nname = 'x'\nsolver = 'pbd'\n" + key + " = { value = " + half.str() +
             ", randomise = 0.5, " + "range = [" + half.str() + ", " + half.str() +
             "], map = 'maps/m.png', channel = 'g', low = 0.25, high = 3 }");
    const LayerSetup& l = setup.layers[0];
    for (const StrandAttribute& attribute : kStrandAttributes) {
      const Attribute& a = l.*attribute.member;
      const bool changed = a.randomise == 0.5f && a.range && a.map.map && a.map.channel == 1 &&
                           a.map.low == 0.25f && a.map.high == 3.0f;
      EXPECT_EQ(changed, attribute.key == key) << key << ", " << attribute.key;
    }
    ++tried;
  }
  EXPECT_EQ(tried, kStrandAttributes.size());
}

TEST_F(FurSetupTest, MaskHoldsEverything) {
  const auto setup = Read(R"(
[[layer]]
name = "x"
[layer.mask]
colours = ["#102030", "#ffffff"]
colour_tolerance = 0.25
materials = ["skin"]
joints = [{ joint = "Head", subtree = false, low = 0.25, high = 0.5 }, { joint = "Tail" }]
box = { axis = "z", map = "maps/m.png", channel = "a" }
range = { low = [0.1, 0.2, 0.3], high = [0.4, 0.5, 0.6] }
away_from = { materials = ["eye"], distance = 0.25 }
uv = { map = "maps/m.png", channel = "g" }
bald = "maps/m.png"
)");
  const Mask& mask = setup.layers[0].mask;
  EXPECT_EQ(mask.colours, (std::vector<uint32_t>{0xff302010u, 0xffffffffu}));
  EXPECT_EQ(mask.colour_tolerance, 0.25f);
  ASSERT_EQ(mask.joints.size(), 2u);
  EXPECT_EQ(mask.joints[0].joint, "Head");
  EXPECT_FALSE(mask.joints[0].subtree);
  EXPECT_EQ(mask.joints[0].low, 0.25f);
  EXPECT_EQ(mask.joints[0].high, 0.5f);
  EXPECT_TRUE(mask.joints[1].subtree);
  ASSERT_TRUE(mask.box && mask.range);
  EXPECT_EQ(mask.box->axis, 'z');
  EXPECT_EQ(mask.box->map.channel, 3);
  EXPECT_EQ(mask.range->low, glm::vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(mask.range->high, glm::vec3(0.4f, 0.5f, 0.6f));
  ASSERT_TRUE(mask.away_from);
  EXPECT_EQ(mask.away_from->materials, std::vector<std::string>{"eye"});
  EXPECT_EQ(mask.away_from->distance, 0.25f);
  EXPECT_EQ(mask.uv.channel, 1);
  ASSERT_TRUE(mask.bald.map);
  EXPECT_EQ(mask.bald.map, mask.uv.map) << "one file is read once";
  EXPECT_EQ(mask.bald.map->rgba[4], 200);
}

TEST_F(FurSetupTest, TopOfTheFile) {
  const auto setup =
      Read("unit_scale = 0.01\nclip = 'Walk'\n[[layer]]\nname='a'\n[[layer]]\nname='b'");
  EXPECT_EQ(setup.path, "fur.toml");
  EXPECT_EQ(*setup.unit_scale, 0.01f);
  EXPECT_EQ(setup.clip, "Walk");
  ASSERT_EQ(setup.layers.size(), 2u);
  EXPECT_FALSE(Read("[[layer]]\nname='a'").unit_scale);
}

TEST_F(FurSetupTest, AChainMeshIsReadWithTheSetup) {
  const std::string path = SourceFolder() + "/tests/fuzz/corpus/gltf/builtin.glb";
  const std::string line = "chain_mesh = '" + path + "'\n[[layer]]\nname = 'a'\n";
  const FurSetup setup = Read(line);
  ASSERT_TRUE(setup.chain_mesh);
  EXPECT_GT(setup.chain_mesh->mesh.position.size(), 100u);
  EXPECT_EQ(setup.files_read, std::vector<std::string>{path});
  EXPECT_EQ(ErrorOf("\n" + line + "chain = 'strand'"),
            "fur.toml:2: key 'chain_mesh': no layer has chains at mesh vertices: chain = "
            "\"vertex\", and no shells");
  const std::string missing = ErrorOf("chain_mesh = 'none.glb'\n[[layer]]\nname = 'a'");
  EXPECT_EQ(missing.rfind("fur.toml:1: key 'chain_mesh': ", 0), 0u) << missing;
  EXPECT_NE(missing.find("none.glb"), std::string::npos) << missing;
}

TEST_F(FurSetupTest, LayersReplaceDefaultsKeyByKey) {
  const auto setup = Read(R"(
[defaults]
length = { value = 0.05, randomise = 0.3 }
chain = "strand"
weight = 2
[[layer]]
name = "a"
[[layer]]
name = "b"
length = 0.08
chain = "vertex"
[[layer]]
name = "c"
length = { randomise = 0.1 }
)");
  EXPECT_EQ(setup.layers[0].length.value, 0.05f);
  EXPECT_EQ(setup.layers[0].length.randomise, 0.3f);
  EXPECT_EQ(setup.layers[0].params.points, 5u);
  EXPECT_EQ(setup.layers[1].length.value, 0.08f);
  EXPECT_EQ(setup.layers[1].length.randomise, 0.0f) << "a key is replaced whole";
  EXPECT_EQ(setup.layers[1].params.points, 4u);
  EXPECT_EQ(setup.layers[1].params.weight, 2.0f);
  EXPECT_EQ(setup.layers[2].length.value, 0.03f) << "the built-in value";
}

// What the text says of each is what FillLayerBlock does with it
// (tests/kernels/layer_block_test.cpp holds the numbers).
TEST_F(FurSetupTest, WetKeysSayWhatIsLeft) {
  std::istringstream lines(DescribeSetupKeys());
  const std::pair<const char*, const char*> wanted[] = {
      {"wet_weight", "factor on weight"},
      {"wet_clump", "share of the way from clump to 1"},
      {"wet_hardness", "share of the hardness that is left"},
      {"wet_darken", "share of the brightness that is left"}};
  size_t found = 0;
  for (std::string line; std::getline(lines, line);)
    for (const auto& [key, text] : wanted) {
      if (line.find(key) == std::string::npos) continue;
      EXPECT_NE(line.find(text), std::string::npos) << line;
      ++found;
    }
  EXPECT_EQ(found, std::size(wanted));
}

TEST_F(FurSetupTest, MapsAreFoundFromTheSetup) {
  folder_.Save("fox.toml", "[[layer]]\nname = 'x'\nlength = { value = 0.1, map = 'maps/m.png' }");
  const auto setup = ReadFurSetupFile(folder_ / "fox.toml");
  ASSERT_TRUE(setup.layers[0].length.map.map);
  EXPECT_EQ(setup.layers[0].length.map.map->width, 2u);
  EXPECT_EQ(setup.path, folder_ / "fox.toml");

  const std::string missing = LayerError("\nlength = { map = 'maps/none.png' }");
  EXPECT_EQ(missing.rfind("fur.toml:4: layer 'head': key 'length.map': control map '", 0), 0u)
      << missing;
  EXPECT_NE(missing.find("no such file"), std::string::npos);
  folder_.Save("bad.png", "\x89PNG but not really");
  EXPECT_NE(LayerError("mask = { bald = 'bad.png' }").find("not a PNG"), std::string::npos);
  EXPECT_NE(LayerError("mask = { uv = 'maps' }").find("not a file"), std::string::npos);
}

TEST_F(FurSetupTest, TraitsThatALayerCannotKeepAreRefused) {
  const auto expect = [&](const std::string& keys, const std::string& reason) {
    const std::string error = LayerError(keys);
    EXPECT_NE(error.find(reason), std::string::npos) << keys << ": " << error;
  };
  const std::string one_table = "solver = \"modal\" bends a layer's strands by one table";
  for (const char* key : {"stiffness_scale", "damping_scale"}) {
    expect(std::string(key) + " = 2", "key '" + std::string(key) + "': " + one_table);
    expect(std::string(key) + " = { value = 1, randomise = 0.1 }", one_table);
  }
  expect("angle_limit = { value = 180, map = 'maps/m.png' }", one_table);
  expect("hardness_profile = [1, 1, 1]", "key 'hardness_profile': " + one_table);
  expect("output = 'shells'\nweight_scale = 2", "key 'weight_scale': shells have no chains");
  expect("sag_free = true\nclump_scale = 2", "key 'clump_scale': strands of a sag_free layer");
  expect("solver = 'pbd'\nhardness_profile = [1, 1]", "3 factors");
  expect("solver = 'pbd'\nchain = 'strand'\nhardness_profile = [1, 1, 1]", "4 factors");
  expect("solver = 'pbd'\nhardness_profile = [1, 1, 11]", "out of bounds");
  expect("solver = 'pbd'\nangle_limit = 0", "out of bounds");
  const auto has = [&](const std::string& keys) {
    return Read("[[layer]]\nname = 'x'\n" + keys).layers[0].params.traits;
  };
  EXPECT_TRUE(has("weight_scale = { value = 1, randomise = 0.1 }"));
  EXPECT_TRUE(has("bounce_scale = { value = 1, map = 'maps/m.png' }"));
  EXPECT_FALSE(has("stiffness_scale = 1\nclump_scale = { value = 1 }\nangle_limit = 180"));
}

TEST_F(FurSetupTest, StrandTexturesFitTheirLayers) {
  const std::string key = "fur.toml:3: layer 'head': key 'strand_texture': ";
  const auto expect = [&](const std::string& lines, const std::string& words) {
    EXPECT_EQ(LayerError(lines).rfind(key + words, 0), 0u) << LayerError(lines);
  };
  EXPECT_EQ(LayerError("strand_texture = 'maps/m.png'\nfilm_strips = 2"), "");
  expect("strand_texture = 'maps/none.png'", "control map '");
  expect("strand_texture = 'maps/m.png'\nfilm_strips = 3", "2 texels wide: no multiple of film_s");
  expect("strand_texture = 'maps/m.png'\noutput = 'shells'", "shells have no strands");
  const std::string weather = "strand_texture = 'maps/m.png'\nstrand_channels = 'weather'\n";
  expect(weather, "strand_channels = \"weather\" goes by each strand's wetness");
  EXPECT_EQ(LayerError(weather + "lit = true\npainted = true"), "");
  EXPECT_NE(LayerError("strand_channels = 'wet'").find("not one of look, weather"),
            std::string::npos);
  LayerSetup mapped;
  mapped.type_map.map = std::make_shared<const ControlMap>();
  EXPECT_EQ(FindSurfaceMap(mapped), "type_map") << "needs UVs";
}

TEST_F(FurSetupTest, KeyListNamesEveryKey) {
  const std::string text = DescribeSetupKeys();
  const auto expect = [&](const auto& entries) {
    for (const auto& entry : entries) {
      EXPECT_NE(text.find("\n  " + std::string(entry.info.key) + " "), std::string::npos)
          << entry.info.key;
      EXPECT_FALSE(entry.info.doc.empty()) << entry.info.key;
    }
  };
  expect(Schema<FurSetup>());
  expect(Schema<LayerSetup>());
  expect(Schema<Attribute>());
  expect(Schema<MapChannel>());
  expect(Schema<Mask>());
  expect(Schema<Mask::JointWeight>());
  expect(Schema<Mask::Box>());
  expect(Schema<Mask::Range>());
  expect(Schema<Mask::AwayFrom>());
  expect(Schema<FlowMapSetup>());
  expect(Schema<CombVector>());
  expect(Schema<LayerLook>());
  EXPECT_NE(text.find("default 0.03"), std::string::npos);
  EXPECT_NE(text.find("pbd | verlet | modal"), std::string::npos);
}

TEST_F(FurSetupTest, ShippedSetupsAreRead) {
  int read = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(SourceFolder() + "/bench/scenarios/setups")) {
    if (entry.path().extension() != ".toml") continue;
    FurSetup setup;
    ASSERT_NO_THROW(setup = ReadFurSetupFile(entry.path().string())) << entry.path();
    EXPECT_FALSE(setup.layers.empty());
    ++read;
  }
  EXPECT_GE(read, 6);
  const auto path = [](const char* name) {
    return SourceFolder() + "/bench/scenarios/setups/" + name;
  };
  uint32_t monster = 0;
  for (const auto& layer : ReadFurSetupFile(path("monster.toml")).layers)
    monster += layer.max_strands;
  EXPECT_EQ(monster, 40000u);
  const auto eyepet = ReadFurSetupFile(path("eyepet.toml"));
  EXPECT_EQ(eyepet.layers.at(0).max_strands, 8000u);
  EXPECT_EQ(eyepet.layers.at(0).params.points, 5u);
  std::set<std::string> kinds;
  for (const auto& layer : ReadFurSetupFile(path("tiny.toml")).layers) {
    kinds.insert(std::to_string(int(layer.params.solver)) +
                 std::to_string(int(layer.params.chain)) + std::to_string(layer.params.points));
  }
  EXPECT_EQ(kinds, (std::set<std::string>{"004", "014", "015", "114", "115", "204", "214", "215"}));
}

}  // namespace
}  // namespace pelt::test
