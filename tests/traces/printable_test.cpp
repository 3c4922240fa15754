#include <gtest/gtest.h>

#include <random>

#include "core/format.hpp"
#include "traces/chrome_trace.hpp"

namespace pelt {
namespace {

TEST(Printable, TextStaysAsItIs) {
  for (const std::string text : {"", "tail", "a b.c/d\\e", "Fell, Pelz, \xc3\xa9toffe",
                                 "\xe6\xaf\x9b", "\xf0\x9f\xa6\x8a"}) {
    EXPECT_EQ(Printable(text), text);
    EXPECT_TRUE(IsPrintable(text));
  }
}

TEST(Printable, ControlCharactersAreTold) {
  EXPECT_EQ(Printable("\x1b[2J"), "\\x1b[2J");
  EXPECT_EQ(Printable("a\nb\tc\r"), "a\\x0ab\\x09c\\x0d");
  EXPECT_EQ(Printable(std::string("\0", 1)), "\\x00");
  EXPECT_EQ(Printable("\x7f"), "\\x7f");
  EXPECT_EQ(Printable("\xc2\x9b"
                      "31m"),
            "\\u009b31m")
      << "terminals take it for ESC [";
  EXPECT_EQ(Printable("\xe2\x80\xae"
                      "gpj.exe"),
            "\\u202egpj.exe")
      << "text runs backwards after it";
  EXPECT_EQ(Printable("\xe2\x80\xa8"), "\\u2028") << "a line's end";
}

TEST(Printable, WhatIsNoUtf8IsTold) {
  EXPECT_EQ(Printable("\x9b"
                      "1m"),
            "\\x9b1m");
  EXPECT_EQ(Printable("\xff\xc3"), "\\xff\\xc3");
  EXPECT_EQ(Printable("\xc0\xaf"), "\\xc0\\xaf") << "longer than it need be";
  EXPECT_EQ(Printable("\xed\xa0\x80"), "\\xed\\xa0\\x80") << "half a surrogate pair";
}

TEST(Printable, AnyBytesBecomeOneHarmlessLine) {
  std::mt19937 random(7);
  for (int i = 0; i < 2000; ++i) {
    std::string text(random() % 40, ' ');
    for (char& c : text) c = char(random());
    const std::string out = Printable(text);
    EXPECT_TRUE(IsPrintable(out));
    EXPECT_EQ(Printable(out), out);
    for (const char c : out) EXPECT_TRUE(uint8_t(c) >= 0x20 && c != 0x7f);
    EXPECT_EQ(IsPrintable(text), out == text);
  }
}

// JSON goes to terminals too.
TEST(Printable, JsonHasNoControlCharacters) {
  std::string json;
  AppendJsonString(json, "\x1b[2J \x7f \xc2\x9b \xe2\x80\xae \"\\");
  EXPECT_EQ(json, R"("\u001b[2J \u007f \u009b \u202e \"\\")");
}

}  // namespace
}  // namespace pelt
