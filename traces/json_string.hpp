// A JSON string that every reader takes, whatever bytes are in it: names of layers and files come
// from outside.
//
// Invariant: what is appended is valid JSON and valid UTF-8. A byte that is no UTF-8 becomes the
// replacement character; if it went through, a viewer would refuse the whole file.
#pragma once

#include <string>
#include <string_view>

namespace pelt {

// Appends `text` with its quotation marks.
void AppendJsonString(std::string& out, std::string_view text);

}  // namespace pelt
