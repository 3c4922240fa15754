// A key changed in the text of a fur setup.
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "core/groom/fur_setup.hpp"

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

}  // namespace
}  // namespace pelt
