// The fur setup: each key lands in its field, and each mistake is reported with file, line, key and
// reason. Over 400 lines because every key of the schema has its row here; one without fails.
#include "core/groom/fur_setup.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <set>
#include <sstream>

#include "core/error.hpp"
#include "core/groom/setup_schema.hpp"
#include "tests/error_from.hpp"
#include "tests/groom/png.hpp"
#include "tests/source_folder.hpp"

namespace pelt {
namespace {

// A folder with one map, `m.png`: 2 x 1, red 10 and 200.
class FurSetupTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("pelt_fur_setup_" + std::to_string(reinterpret_cast<uintptr_t>(this)) + "_" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_ / "maps");
    const auto png = test::MakePng(2, 1, 4, {10, 20, 30, 40, 200, 210, 220, 230});
    Save("maps/m.png", std::string(png.begin(), png.end()));
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  void Save(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  FurSetup Read(const std::string& text) {
    return ReadFurSetup(text, "fur.toml", folder_.string());
  }
  // The message, or "" when the text is read.
  std::string ErrorOf(const std::string& text) {
    return test::ErrorFrom([&] { Read(text); });
  }
  // One layer 'head' whose keys begin on line 3.
  std::string LayerError(const std::string& lines) {
    return ErrorOf("[[layer]]\nname = 'head'\n" + lines);
  }
  std::filesystem::path folder_;
};

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
       "{ value = 5e4, randomise = 0.25, range = [1e4, 9e4], map = 'maps/m.png', channel = 'b' }",
       [](L l) {
         return l.density == 5e4f && l.density_randomise == 0.25f &&
                *l.density_range == glm::vec2(1e4f, 9e4f) && l.density_map.map &&
                l.density_map.channel == 2;
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
      {"base_colour", "'#123456'", [](L l) { return l.base_colour == 0xff563412u; }},
      {"tip_colour", "'#aBcDeF'", [](L l) { return l.tip_colour == 0xffefcdabu; }},
      {"colour_variation", "0.3", [](L l) { return Near(l.colour_variation.value, 0.3f); }},
      {"colour_map", "'maps/m.png'",
       [](L l) { return l.colour_map.map && l.colour_map.channel == 0; }},
      {"film_strips", "7", [](L l) { return l.film_strip_count == 7; }},
      {"quality", "'best'", [](L l) { return l.params.quality == ModalQuality::kBest; }},
      {"curl_follows", "'root'", [](L l) { return l.params.curl_follows == CurlFollows::kRoot; }},
      {"sag_free", "true", [](L l) { return l.params.sag_free; }},
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
  for (const auto& row : Schema<LayerSetup>()) {
    // Numbers and attributes that have a row are tried below, each against all others.
    if (row.info.type == "number" || row.info.type == "attribute") continue;
    EXPECT_EQ(tried.count(std::string(row.info.key)), 1u) << row.info.key << " is not tried above";
  }
}

TEST_F(FurSetupTest, EveryNumberOfALayerLandsInItsMemberAlone) {
  const LayerParams builtin;
  uint32_t tried = 0;
  ForEachLayerParam([&]<class T>(const LayerParamRow<T>& row) {
    if constexpr (std::is_same_v<T, float>) {
      const double value = (row.low + 3.0 * row.high) / 4.0;
      const LayerParams read =
          Read("[[layer]]\nname = 'x'\n" + std::string(row.key) + " = " + std::to_string(value))
              .layers.at(0)
              .params;
      EXPECT_EQ(read.*row.member, float(value)) << row.key;
      ForEachLayerParam([&](const auto& other) {
        EXPECT_EQ(read.*other.member == builtin.*other.member, other.key != row.key)
            << row.key << ", " << other.key;
      });
      ++tried;
    }
  });
  EXPECT_GT(tried, 20u);
}

TEST_F(FurSetupTest, EveryAttributeTakesItsTable) {
  size_t tried = 0;
  for (const auto& row : Schema<LayerSetup>()) {
    if (row.info.type != "attribute" || row.info.key == "density") continue;
    const std::string key(row.info.key);
    std::ostringstream half;
    half << (row.info.low + row.info.high) / 2;
    const auto setup = Read("[[layer]]\nname = 'x'\n" + key + " = { value = " + half.str() +
                            ", randomise = 0.5, " + "range = [" + half.str() + ", " + half.str() +
                            "], map = 'maps/m.png', channel = 'g' }");
    const LayerSetup& l = setup.layers[0];
    for (const StrandAttribute& attribute : kStrandAttributes) {
      const Attribute& a = l.*attribute.member;
      const bool changed = a.randomise == 0.5f && a.range && a.map.map && a.map.channel == 1;
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

TEST_F(FurSetupTest, MistypedKeysAreNamedWithASuggestion) {
  EXPECT_EQ(LayerError("width = 0.001\nlenght = 0.3"),
            "fur.toml:4: layer 'head': unknown key 'lenght'; did you mean 'length'?");
  EXPECT_EQ(LayerError("base_color = '#000000'"),
            "fur.toml:3: layer 'head': unknown key 'base_color'; did you mean 'base_colour'?");
  EXPECT_EQ(
      LayerError("mask = { materals = [] }"),
      "fur.toml:3: layer 'head': unknown key 'mask.materals'; did you mean 'mask.materials'?");
  EXPECT_EQ(LayerError("length = { value = 0.1, randomize = 1 }"),
            "fur.toml:3: layer 'head': unknown key 'length.randomize'; did you mean "
            "'length.randomise'?");
  EXPECT_EQ(
      LayerError("\n\n[[layer.mask.joints]]\njoint = 'a'\n[[layer.mask.joints]]\nlwo = 0.5\n"),
      "fur.toml:8: layer 'head': unknown key 'mask.joints[1].lwo'; did you mean "
      "'mask.joints[1].low'?");
  EXPECT_EQ(LayerError("comb = [{ position = [0,0,0], diretcion = [0,1,0] }]"),
            "fur.toml:3: layer 'head': unknown key 'comb[0].diretcion'; did you mean "
            "'comb[0].direction'?");
  EXPECT_EQ(LayerError("quaternion = 1"),
            "fur.toml:3: layer 'head': unknown key 'quaternion'; pelt bake --keys lists the known "
            "ones");
  EXPECT_EQ(ErrorOf("[[layers]]\nname = 'x'"),
            "fur.toml:1: unknown key 'layers'; did you mean 'layer'?");
  EXPECT_EQ(ErrorOf("\n\nunitscale = 1\n[[layer]]\nname = 'x'"),
            "fur.toml:3: unknown key 'unitscale'; did you mean 'unit_scale'?");
  EXPECT_EQ(ErrorOf("[defaults]\nwieght = 1\n[[layer]]\nname = 'x'"),
            "fur.toml:2: defaults: unknown key 'wieght'; did you mean 'weight'?");
  EXPECT_EQ(LayerError("b_unknown = 1\na_unknown = 1").substr(0, 37),
            "fur.toml:3: layer 'head': unknown key")
      << "the first in the file, not in the alphabet";
}

// A number just outside each bound is refused at its line, and the bound itself is not.
TEST_F(FurSetupTest, EveryBoundHolds) {
  int tried = 0;
  const auto text = [](double value) {
    std::ostringstream out;
    out.precision(17);
    out << value;
    return out.str();
  };
  for (const auto& row : Schema<LayerSetup>()) {
    const KeyInfo& info = row.info;
    const bool whole = info.type == "whole number";
    if (!(info.low < info.high) || (info.type != "number" && info.type != "attribute" && !whole)) {
      continue;
    }
    const std::string key(info.key);
    const double step = whole ? 1 : (info.high - info.low) * 1e-3;
    const std::string fixed = key == "points" ? "chain = 'strand'\n" : "";
    EXPECT_EQ(LayerError(key + " = " + text(info.low) + "\n" + fixed), "") << key;
    EXPECT_EQ(LayerError(key + " = " + text(info.high) + "\n" + fixed), "") << key;
    for (double bad : {info.low - step, info.high + step}) {
      const std::string message = LayerError(key + " = " + text(bad) + "\n" + fixed);
      EXPECT_EQ(message.rfind("fur.toml:3: layer 'head': key '" + key + "': ", 0), 0u) << message;
      EXPECT_NE(message.find("out of bounds; allowed are"), std::string::npos) << message;
    }
    for (const char* bad : {"nan", "inf", "-inf"}) {
      const std::string message = LayerError(key + " = " + bad);
      const char* reason = whole ? "expected a whole number" : "is not a finite number";
      EXPECT_NE(message.find(reason), std::string::npos) << key << ": " << message;
    }
    EXPECT_NE(LayerError(key + " = 'text'").find("found a text"), std::string::npos) << key;
    EXPECT_NE(LayerError(key + " = [1]").find("found a list"), std::string::npos) << key;
    EXPECT_NE(LayerError(key + " = 1979-05-27").find("found a date or time"), std::string::npos);
    ++tried;
  }
  EXPECT_GT(tried, 35);
}

TEST_F(FurSetupTest, WrongValuesAreTold) {
  const std::pair<const char*, const char*> cases[] = {
      {"solver = 'pdb'",
       "key 'solver': 'pdb' is not one of pbd, verlet, modal; did you mean 'pbd'?"},
      {"chain = 3", "key 'chain': expected a text in quotes, found a whole number"},
      {"enabled = 1", "key 'enabled': expected true or false, found a whole number"},
      {"points = 4.5", "key 'points': expected a whole number, found a number"},
      {"points = 5",
       "key 'points': chains at mesh vertices have 4 points; chain = \"strand\" has 4, 5 or 9"},
      {"points = 7\nchain = 'strand'", "key 'points': 4, 5 or 9"},
      {"points = 9\nchain = 'strand'\nsolver = 'pbd'",
       "key 'points': only solver = \"modal\" has chains of 9; the others have 4 or 5"},
      {"solver = 'verlet'",
       "key 'solver': verlet needs a chain for each strand: chain = \"strand\""},
      {"output = 'shells'\nchain = 'strand'",
       "key 'output': shells stand on mesh vertices: chain = \"vertex\""},
      {"max_distance = 0.04",
       "key 'max_distance': 0 (no limit) or at least 0.05; strength = 0 holds a strand"},
      {"sag_free = true\nsolver = 'pbd'",
       "key 'sag_free': only solver = \"modal\" holds a groom up"},
      {"friction = 0.5\nsolver = 'pbd'", "key 'friction': only solver = \"modal\" has it"},
      {"friction = 2.5", "key 'friction': 2.5 is out of bounds; allowed are 0 to 2"},
      {"painted = true", "key 'painted': paint is in what lit layers are shaded with: lit = true"},
      {"seed = -1", "key 'seed': -1 is out of bounds; allowed are 0 to 9223372036854775807"},
      {"max_strands = 9000000",
       "key 'max_strands': 9000000 is out of bounds; allowed are 0 to 8388608"},
      {"base_colour = 'red'", "key 'base_colour': 'red' is not a colour; write \"#rrggbb\""},
      {"base_colour = '#12345g'",
       "key 'base_colour': '#12345g' is not a colour; write \"#rrggbb\""},
      {"length = { range = [0.02, 0.01] }",
       "key 'length.range': its low end is above its high end"},
      {"length = { range = [0.02] }", "key 'length.range': has 1 entries; 2 are needed"},
      {"length = { range = [0.02, 99] }",
       "key 'length.range': 99 is out of bounds; allowed are 0.0001 to 10 m"},
      {"length = { value = 0.1, range = [0.01, 0.02] }",
       "key 'length': its value lies above its range"},
      {"length = { randomise = 1.5 }",
       "key 'length.randomise': 1.5 is out of bounds; allowed are 0 to 1"},
      {"length = { channel = 'r' }", "key 'length.channel': has no map"},
      {"length = { map = 'maps/m.png', channel = 'x' }",
       "key 'length.channel': 'x' is not one of r, g, b, a"},
      {"colour_map = { channel = 'r' }", "key 'colour_map.map': is needed here and missing"},
      {"mask = 3", "key 'mask': expected a table { ... }, found a whole number"},
      {"mask = { materials = [1] }",
       "key 'mask.materials': expected a text in quotes, found a whole number"},
      {"mask = { joints = [{ low = 0.1 }] }",
       "key 'mask.joints[0].joint': is needed here and missing"},
      {"mask = { joints = [{ joint = 'a', low = 0.5, high = 0.5 }] }",
       "key 'mask.joints[0]': low must be below high"},
      {"mask = { range = { low = [0, 0.5, 0], high = [1, 0.5, 1] } }",
       "key 'mask.range': low y must be below high y"},
      {"mask = { range = { low = [0, -0.5, 0] } }",
       "key 'mask.range.low': -0.5 is out of bounds; allowed are 0 to 1"},
      {"mask = { away_from = { distance = 0.1 } }",
       "key 'mask.away_from.materials': is needed here and missing"},
      {"mask = { away_from = { materials = [] } }",
       "key 'mask.away_from.materials': has 0 entries; 1 to 64 are allowed"},
      {"mask = { box = { axis = 'w', map = 'maps/m.png' } }",
       "key 'mask.box.axis': 'w' is not one of x, y, z"},
      {"mask = { box = { axis = 'x' } }", "key 'mask.box.map': is needed here and missing"},
      {"mask = { colours = [] }", "key 'mask.colours': has 0 entries; 1 to 64 are allowed"},
      {"mask = { colours = ['#102030', 'red'] }",
       "key 'mask.colours': 'red' is not a colour; write \"#rrggbb\""},
      {"mask = { colour_tolerance = 2 }",
       "key 'mask.colour_tolerance': 2 is out of bounds; allowed are 0 to 1"},
      {"comb = [{ position = [0, 0, 0] }]", "key 'comb[0].direction': is needed here and missing"},
      {"comb = [{ position = [0, 0, 0], direction = [0, 0, 0] }]",
       "key 'comb[0]': direction is zero"},
      {"comb = [{ position = [0, 0], direction = [0, 0, 1] }]",
       "key 'comb[0].position': has 2 entries; 3 are needed"},
      {"clump = 0.5\nclump_controls = 0", "key 'clump': needs clump_controls above 0"},
      {"comb_joint = ''", "key 'comb_joint': is empty"},
      {"comb_joint = \"a\\u0007\"", "key 'comb_joint': holds a control character"},
      {"comb_joint = \"a\\u009b\"", "key 'comb_joint': holds a control character"},
  };
  for (const auto& [line, reason] : cases) {
    EXPECT_EQ(LayerError(line), std::string("fur.toml:3: layer 'head': ") + reason) << line;
  }
  // What an error quotes of the file must not reach a terminal as it is.
  EXPECT_NE(LayerError("\"a\\u001b[2J\" = 1").find("unknown key 'a\\x1b[2J'"), std::string::npos);
  EXPECT_NE(LayerError("solver = \"m\\u001b[1m\"").find("'m\\x1b[1m' is not one of"),
            std::string::npos);
  // A broken rule between keys is reported at the key, wherever that stands.
  EXPECT_EQ(ErrorOf("[defaults]\n\npoints = 5\n[[layer]]\nname = 'x'"),
            "fur.toml:3: layer 'x': key 'points': chains at mesh vertices have 4 points; chain = "
            "\"strand\" has 4, 5 or 9");
}

TEST_F(FurSetupTest, WrongFilesAreTold) {
  EXPECT_EQ(ErrorOf(""), "fur.toml:1: a fur setup needs at least one [[layer]]");
  EXPECT_EQ(ErrorOf("layer = []"), "fur.toml:1: a fur setup needs at least one [[layer]]");
  EXPECT_EQ(ErrorOf("layer = [3]"), "fur.toml:1: layer 1: write each layer as [[layer]]");
  EXPECT_EQ(ErrorOf("defaults = 3\n[[layer]]\nname='x'"),
            "fur.toml:1: defaults: write it as [defaults]");
  EXPECT_EQ(ErrorOf("[[layer]]\nlength = 0.1"),
            "fur.toml:1: layer 1: key 'name': is needed here and missing");
  EXPECT_EQ(ErrorOf("[defaults]\nname = 'x'\n[[layer]]\nname = 'x'"),
            "fur.toml:2: defaults: key 'name': belongs to one layer; it has no default");
  EXPECT_EQ(ErrorOf("[[layer]]\nname = 'x'\n\n[[layer]]\nname = 'x'"),
            "fur.toml:5: layer 'x': key 'name': another layer has this name");
  EXPECT_EQ(ErrorOf("[[layer]]\nname = 'x'\nlength = = 3").rfind("fur.toml:3: not valid TOML: ", 0),
            0u);
  EXPECT_EQ(ErrorOf("[[layer]]\nname = 'x'\nname = 'y'").rfind("fur.toml:3: not valid TOML: ", 0),
            0u);
  // The TOML library asserts here.
  EXPECT_EQ(ErrorOf("[[layer]]\nname = 'x'\n\n[=]\nlength = 1\n"),
            "fur.toml:4: not valid TOML: a key is missing or malformed");
  // Beyond ASCII only in quotes and comments: the TOML library is undefined elsewhere.
  EXPECT_EQ(ErrorOf("\xef\xbb\xbf[[layer]]\nname = \"\xca\x91\" # \xca\x91\n"), "");
  EXPECT_EQ(ErrorOf("[[layer]]\nname = \'\'\'\n\xca\x91\\\'\'\'"), "");
  for (const std::string stray :
       {"ty \xca\x91", "a = \"\\\"x\" \xca\x91", "a = \'x\\\' \xca\x91",
        "a = \"\"\"x\"\"\"\" \xca\x91", "a = \"\" \xca\x91", "a = \"open \n\xca\x91"})
    EXPECT_NE(ErrorOf("#\n" + stray).find("a character beyond ASCII outside"), std::string::npos)
        << stray;
  EXPECT_NE(ErrorOf(std::string(5 << 20, '#')).find("a fur setup has at most"), std::string::npos);
  EXPECT_NE(ErrorOf("a = " + std::string(100000, '[')).find("not valid TOML"), std::string::npos);
  std::string many;
  for (int i = 0; i < 1025; ++i) many += "[[layer]]\nname = 'l" + std::to_string(i) + "'\n";
  EXPECT_NE(ErrorOf(many).find("more than 1024 layers"), std::string::npos);
  EXPECT_THROW(ReadFurSetupFile((folder_ / "none.toml").string()), Error);
  EXPECT_THROW(ReadFurSetupFile(folder_.string()), Error);
}

TEST_F(FurSetupTest, MapsAreFoundFromTheSetup) {
  Save("fox.toml", "[[layer]]\nname = 'x'\nlength = { value = 0.1, map = 'maps/m.png' }");
  const auto setup = ReadFurSetupFile((folder_ / "fox.toml").string());
  ASSERT_TRUE(setup.layers[0].length.map.map);
  EXPECT_EQ(setup.layers[0].length.map.map->width, 2u);
  EXPECT_EQ(setup.path, (folder_ / "fox.toml").string());

  const std::string missing = LayerError("\nlength = { map = 'maps/none.png' }");
  EXPECT_EQ(missing.rfind("fur.toml:4: layer 'head': key 'length.map': control map '", 0), 0u)
      << missing;
  EXPECT_NE(missing.find("no such file"), std::string::npos);
  Save("bad.png", "\x89PNG but not really");
  EXPECT_NE(LayerError("mask = { bald = 'bad.png' }").find("not a PNG"), std::string::npos);
  EXPECT_NE(LayerError("mask = { uv = 'maps' }").find("not a file"), std::string::npos);
}

TEST_F(FurSetupTest, ParamsFromElsewhereAreChecked) {
  EXPECT_EQ(FindBadParam(LayerParams{}), "");
  LayerParams params;
  params.bounce = NAN;
  EXPECT_NE(FindBadParam(params).find("bounce"), std::string::npos);
  params = {};
  params.solver = Solver(9);
  EXPECT_NE(FindBadParam(params).find("solver"), std::string::npos);
  params = {};
  params.iterations = 1u << 31;
  EXPECT_NE(FindBadParam(params).find("iterations"), std::string::npos);
  params = {};
  params.dirt_colour[1] = 2.0f;
  EXPECT_NE(FindBadParam(params).find("dirt_colour"), std::string::npos);
  params = {};
  params.points = 5;
  EXPECT_NE(FindBadParam(params).find("points"), std::string::npos);
}

TEST_F(FurSetupTest, KeyListNamesEveryKey) {
  const std::string text = DescribeSetupKeys();
  const auto expect = [&](const auto& rows) {
    for (const auto& row : rows) {
      EXPECT_NE(text.find("\n  " + std::string(row.info.key) + " "), std::string::npos)
          << row.info.key;
      EXPECT_FALSE(row.info.doc.empty()) << row.info.key;
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
  expect(Schema<CombVector>());
  EXPECT_NE(text.find("default 0.03"), std::string::npos);
  EXPECT_NE(text.find("pbd | verlet | modal"), std::string::npos);
}

TEST_F(FurSetupTest, ShippedSetupsAreRead) {
  int read = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(test::SourceFolder() + "/bench/scenarios/setups")) {
    if (entry.path().extension() != ".toml") continue;
    FurSetup setup;
    ASSERT_NO_THROW(setup = ReadFurSetupFile(entry.path().string())) << entry.path();
    EXPECT_FALSE(setup.layers.empty());
    ++read;
  }
  EXPECT_GE(read, 6);
  const auto path = [](const char* name) {
    return test::SourceFolder() + "/bench/scenarios/setups/" + name;
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

TEST_F(FurSetupTest, DamagedTextsNeverCrash) {
  std::ifstream file(test::SourceFolder() + "/bench/scenarios/setups/tiny.toml", std::ios::binary);
  const std::string good{std::istreambuf_iterator<char>(file), {}};
  ASSERT_EQ(ErrorOf(good), "");
  std::mt19937 random(4242);
  int refused = 0;
  const std::string alphabet = "[]{}=.,#'\"\n0123456789e+-_ truefalsnaiy";
  for (int i = 0; i < 3000; ++i) {
    std::string bad = good;
    if (i % 10 == 0) bad.resize(random() % bad.size());
    for (size_t n = 1 + random() % 4; n > 0; --n) {
      const size_t at = random() % (bad.size() + 1);
      const char c = random() % 8 ? alphabet[random() % alphabet.size()] : char(random());
      if (random() % 2) {
        bad.insert(at, 1, c);
      } else if (at < bad.size()) {
        bad[at] = c;
      }
    }
    const std::string message = ErrorOf(bad);
    if (message.empty()) continue;
    ++refused;
    EXPECT_EQ(message.rfind("fur.toml:", 0), 0u) << message;
  }
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace pelt
