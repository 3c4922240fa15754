// The fur setup: each mistake is reported with file, line, key and reason.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <sstream>

#include "core/error.hpp"
#include "core/groom/fur_setup.hpp"
#include "core/groom/setup_schema.hpp"
#include "tests/groom/setup_folder.hpp"
#include "tests/source_folder.hpp"
#include "tests/test_folder.hpp"

namespace pelt::test {
namespace {

using FurSetupErrors = SetupFolder;

TEST_F(FurSetupErrors, MistypedKeysAreNamedWithASuggestion) {
  const std::pair<const char*, const char*> cases[] = {
      {"width = 0.001\nlenght = 0.3",
       "4: layer 'head': unknown key 'lenght'; did you mean 'length'?"},
      {"base_color = '#000000'",
       "3: layer 'head': unknown key 'base_color'; did you mean 'base_colour'?"},
      {"mask = { materals = [] }",
       "3: layer 'head': unknown key 'mask.materals'; did you mean 'mask.materials'?"},
      {"length = { value = 0.1, randomize = 1 }",
       "3: layer 'head': unknown key 'length.randomize'; did you mean 'length.randomise'?"},
      {"\n\n[[layer.mask.joints]]\njoint = 'a'\n[[layer.mask.joints]]\nlwo = 0.5\n",
       "8: layer 'head': unknown key 'mask.joints[1].lwo'; did you mean 'mask.joints[1].low'?"},
      {"comb = [{ position = [0,0,0], diretcion = [0,1,0] }]",
       "3: layer 'head': unknown key 'comb[0].diretcion'; did you mean 'comb[0].direction'?"},
      {"look = { scater = 1 }",
       "3: layer 'head': unknown key 'look.scater'; did you mean 'look.scatter'?"},
      {"quaternion = 1",
       "3: layer 'head': unknown key 'quaternion'; pelt bake --keys lists the known ones"},
  };
  for (const auto& [lines, message] : cases)
    EXPECT_EQ(LayerError(lines), std::string("fur.toml:") + message) << lines;
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
TEST_F(FurSetupErrors, EveryBoundHolds) {
  int tried = 0;
  const auto text = [](double value) {
    std::ostringstream out;
    out.precision(17);
    out << value;
    return out.str();
  };
  for (const auto& entry : Schema<LayerSetup>()) {
    const KeyInfo& info = entry.info;
    const bool whole = info.type == "whole number";
    if (!(info.low < info.high) || (info.type != "number" && info.type != "attribute" && !whole)) {
      continue;
    }
    const std::string key(info.key);
    const double step = whole ? 1 : (info.high - info.low) * 1e-3;
    const bool of_links =
        key == "stiffness_scale" || key == "damping_scale" || key == "angle_limit";
    const std::string fixed = key == "points" ? "chain = 'strand'\n"
                              : of_links      ? "solver = 'pbd'\n"
                                              : "";
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

TEST_F(FurSetupErrors, WrongValuesAreTold) {
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
      {"length = { value = 0.1, high = 2 }", "key 'length.high': has no map"},
      {"mask = { uv = { map = 'maps/m.png', high = 101 } }",
       "key 'mask.uv.high': 101 is out of bounds; allowed are -100 to 100"},
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
      {"direction_vector = [0, 0, 0]", "key 'direction_vector': is zero"},
      {"direction_vector = [0, 0, 1]\ncomb_joint = 'a'",
       "key 'direction_vector': comb_joint says the direction"},
      {"direction_range = [0, -1, 0]",
       "key 'direction_range': -1 is out of bounds; allowed are 0 to 10"},
      {"curl_profile = [1, 0]", "key 'curl_profile': has 2 entries; 3 are needed"},
      {"segment_length = 0.1\nchain = 'strand'",
       "key 'segment_length': of chains at mesh vertices alone: chain = \"vertex\", and no shells"},
      {"segment_length = 0.1\noutput = 'shells'",
       "key 'segment_length': of chains at mesh vertices alone: chain = \"vertex\", and no shells"},
      {"flow_map = { blue = 'up' }", "key 'flow_map.map': is needed here and missing"},
      {"flow_map = { map = 'maps/m.png', blue = 'length' }",
       "key 'flow_map': blue = \"length\" and longest go together"},
      {"flow_map = { map = 'maps/m.png', longest = 1 }",
       "key 'flow_map': blue = \"length\" and longest go together"},
      {"length = { map = 'maps/m.png' }\nflow_map = { map = 'maps/m.png', blue = 'length', longest "
       "= "
       "1 }",
       "key 'length': its map and flow_map's blue both say it"},
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

TEST_F(FurSetupErrors, WrongFilesAreTold) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "1: a fur setup needs at least one [[layer]]"},
      {"layer = []", "1: a fur setup needs at least one [[layer]]"},
      {"layer = [3]", "1: layer 1: write each layer as [[layer]]"},
      {"defaults = 3\n[[layer]]\nname='x'", "1: defaults: write it as [defaults]"},
      {"[[layer]]\nlength = 0.1", "1: layer 1: key 'name': is needed here and missing"},
      {"[defaults]\nname = 'x'\n[[layer]]\nname = 'x'",
       "2: defaults: key 'name': belongs to one layer; it has no default"},
      {"[[layer]]\nname = 'x'\n\n[[layer]]\nname = 'x'",
       "5: layer 'x': key 'name': another layer has this name"},
      // The TOML library asserts here.
      {"[[layer]]\nname = 'x'\n\n[=]\nlength = 1\n",
       "4: not valid TOML: a key is missing or malformed"},
  };
  for (const auto& [text, message] : cases)
    EXPECT_EQ(ErrorOf(text), std::string("fur.toml:") + message) << text;
  EXPECT_EQ(ErrorOf("[[layer]]\nname = 'x'\nlength = = 3").rfind("fur.toml:3: not valid TOML: ", 0),
            0u);
  EXPECT_EQ(ErrorOf("[[layer]]\nname = 'x'\nname = 'y'").rfind("fur.toml:3: not valid TOML: ", 0),
            0u);
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
  EXPECT_THROW(ReadFurSetupFile(folder_ / "none.toml"), Error);
  EXPECT_THROW(ReadFurSetupFile(folder_.path().string()), Error);
}

TEST_F(FurSetupErrors, ParamsFromElsewhereAreChecked) {
  EXPECT_EQ(FindBadParam(LayerParams{}), "");
  const std::pair<const char*, void (*)(LayerParams&)> cases[] = {
      {"bounce", [](LayerParams& params) { params.bounce = NAN; }},
      {"solver", [](LayerParams& params) { params.solver = Solver(9); }},
      {"iterations", [](LayerParams& params) { params.iterations = 1u << 31; }},
      {"dirt_colour", [](LayerParams& params) { params.dirt_colour[1] = 2.0f; }},
      {"points", [](LayerParams& params) { params.points = 5; }},
  };
  for (const auto& [key, spoil] : cases) {
    LayerParams params;
    spoil(params);
    EXPECT_NE(FindBadParam(params).find(key), std::string::npos) << key;
  }
}

TEST_F(FurSetupErrors, DamagedTextsNeverCrash) {
  const std::string good = ReadText(SourceFolder() + "/bench/scenarios/setups/tiny.toml");
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
}  // namespace pelt::test
