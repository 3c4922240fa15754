// The pages' HTML, CSS and JavaScript, which are part of the program, and how data comes into them.
//
// Invariant: text from outside (names of layers, characters, files) reaches a page only inside its
// JSON, where no '<' can end it, and the script only ever shows it as text.
#pragma once

#include <string>
#include <string_view>

namespace pelt {

// As bench/report/CMakeLists.txt embeds them.
struct EmbeddedPage {
  std::string_view html, css, script;
};
EmbeddedPage EmbeddedReport();
EmbeddedPage EmbeddedPair();
// The text of json_keys.txt.
std::string_view JsonKeys();

// One file that needs nothing else; `json` as printed.
std::string FillPage(const EmbeddedPage& parts, std::string json);

}  // namespace pelt
