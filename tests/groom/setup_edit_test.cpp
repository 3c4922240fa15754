// A key changed in the text of a fur setup.
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "core/groom/fur_setup.hpp"
#include "tests/error_from.hpp"

namespace pelt {
namespace {

constexpr std::string_view kSetup =
    "# A comment.\n"
    "[defaults]\n"
    "weight = 0.5\n"
    "\n"
    "[[layer]]\n"
    "name = \"h\\u00e9ad\"  # umlauts before the value: \xc3\xa4\n"
    "length = { value = 0.085, randomise = 0.35 }\n"
    "density = 120_000 # behind\n"
    "\n"
    "[[layer]]\n"
    "name = \"tail\"\n"
    "density = 1000\n";

std::string Change(std::string_view layer, std::string_view key, std::string_view value) {
  return ChangeLayerKey(kSetup, "setup", layer, key, value);
}
// The text with `from`, which is in it once, replaced.
std::string With(std::string_view from, std::string_view to) {
  std::string text(kSetup);
  return text.replace(text.find(from), from.size(), to);
}

TEST(ChangeLayerKey, LeavesAllElseAsItWasWritten) {
  EXPECT_EQ(Change("tail", "density", "2000.0"), With("density = 1000\n", "density = 2000.0\n"));
  EXPECT_EQ(Change("h\xc3\xa9"
                   "ad",
                   "density", "7"),
            With("120_000", "7"));
}

TEST(ChangeLayerKey, OfATableItsValue) {
  EXPECT_EQ(Change("h\xc3\xa9"
                   "ad",
                   "length", "0.1"),
            With("0.085", "0.1"));
}

TEST(ChangeLayerKey, ANewKeyGoesBelowTheName) {
  const std::string changed = Change("tail", "weight", "2.0");
  EXPECT_EQ(changed, With("name = \"tail\"\n", "name = \"tail\"\nweight = 2.0\n"));
  const FurSetup setup = ReadFurSetup(changed, "setup", "");
  EXPECT_EQ(setup.layers[0].params.weight, 0.5f);
  EXPECT_EQ(setup.layers[1].params.weight, 2.0f);
}

TEST(ChangeLayerKey, RefusesWhatIsNotThere) {
  EXPECT_THROW((void)Change("nose", "weight", "1.0"), Error);
  EXPECT_THROW((void)ChangeLayerKey("[[layer]\n", "setup", "tail", "weight", "1.0"), Error);
}

constexpr std::string_view kName = "[[layer]]\nname = \"x\"\n";

TEST(ChangeLayerKey, OfATableWithoutAValueItGetsOne) {
  EXPECT_EQ(ChangeLayerKey(std::string(kName) + "length = { randomise = 0.2 }\n", "s", "x",
                           "length", "0.5"),
            std::string(kName) + "length = { value = 0.5, randomise = 0.2 }\n");
}

TEST(ChangeLayerKey, ReplacesAListThatIsWrittenInOnePiece) {
  EXPECT_EQ(ChangeLayerKey(std::string(kName) + "comb = [\n  { reach = 1 },\n] # all\n", "s", "x",
                           "comb", "[]"),
            std::string(kName) + "comb = [] # all\n");
  EXPECT_EQ(test::ErrorFrom([] {
              (void)ChangeLayerKey(std::string(kName) + "[[layer.comb]]\nreach = 1\n", "s", "x",
                                   "comb", "[]");
            }),
            "s:3: key 'comb' is written in parts; write it as one list [ ... ] to change it here");
}

TEST(ChangeLayerMap, PutsAMapWhereTheKeyIsAndLeavesTheRest) {
  constexpr std::string_view kCases[][3] = {
      {"length", "", "length = { map = \"m.png\" }\n"},
      {"mask.bald", "", "mask = { bald = \"m.png\" }\n"},
      {"colour_map", "", "colour_map = \"m.png\"\n"},
      {"length", "length = 0.1 # m\n", "length = { value = 0.1, map = \"m.png\" } # m\n"},
      {"length", "length = { value = 0.1 }\n", "length = { map = \"m.png\", value = 0.1 }\n"},
      {"length", "length = {}\n", "length = { map = \"m.png\" }\n"},
      {"length", "length = { map = \"old.png\", low = 0.5 }\n",
       "length = { map = \"m.png\", low = 0.5 }\n"},
      {"mask.bald", "mask = { bald = \"old.png\", materials = [\"a\"] }\n",
       "mask = { bald = \"m.png\", materials = [\"a\"] }\n"},
      {"mask.bald", "mask = { bald = { map = \"o\", low = 1 } }\n",
       "mask = { bald = { map = \"m.png\", low = 1 } }\n"},
      {"colour_map", "colour_map = \"old.png\"\n", "colour_map = \"m.png\"\n"},
      {"colour_map", "colour_map = { map = \"old.png\" }\n", "colour_map = { map = \"m.png\" }\n"},
  };
  for (const auto& [key, before, after] : kCases)
    EXPECT_EQ(ChangeLayerMap(std::string(kName).append(before), "s", "x", key, "m.png"),
              std::string(kName).append(after))
        << before;
}

TEST(ChangeLayerMap, WhatDefaultsSayComesAlong) {
  constexpr std::string_view kText =
      "[defaults]\ndensity = 60_000\nmask = { materials = [\"a\"] }\nlength.value = 0.1\n"
      "[[layer]]\nname = \"x\"\n";
  const auto changed = [&](std::string_view key) {
    return ChangeLayerMap(kText, "s", "x", key, "m.png").substr(kText.size());
  };
  EXPECT_EQ(changed("density"), "density = { value = 60_000, map = \"m.png\" }\n");
  EXPECT_EQ(changed("mask.bald"), "mask = { bald = \"m.png\", materials = [\"a\"] }\n");
  EXPECT_EQ(
      test::ErrorFrom([&] { (void)changed("length"); }),
      "s:4: key 'length' is written in parts; write it as one table { ... } to change it here");
}

}  // namespace
}  // namespace pelt
