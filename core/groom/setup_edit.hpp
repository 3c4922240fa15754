// A key of a fur setup's layer changed in its text, which otherwise stays as it was written: comments, order and all.
#pragma once

#include <string>
#include <string_view>

namespace pelt {

// `value` as TOML has it: 0.5, true, "best". Of a key that is written as a table with a `value` that one is changed; one
// that the layer does not have goes below its name, and stands in front of [defaults]. Throws Error, with `path` and line, where the text is
// not TOML, and where there is no such layer. The result is not checked: ReadFurSetup does that.
std::string ChangeLayerKey(std::string_view text, const std::string& path, std::string_view layer,
                           std::string_view key, std::string_view value);

}  // namespace pelt
