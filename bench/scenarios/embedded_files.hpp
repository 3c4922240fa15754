// TOML files that are built into the program: each is found by its name without ending.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pelt {

struct EmbeddedFile {
  std::string_view name;  // "monster"
  std::string_view text;  // TOML
};

std::span<const EmbeddedFile> EmbeddedSetups();  // bench/scenarios/setups
std::span<const EmbeddedFile> EmbeddedLights();  // bench/scenarios/lights

// Null where there is none of that name.
const EmbeddedFile* FindEmbedded(std::span<const EmbeddedFile> files, std::string_view name);

std::vector<std::string_view> NamesOf(std::span<const EmbeddedFile> files);

// The one that a command line's NAME means; null: it is the path of a file. Throws Error for what is neither, with
// the names that there are; `what` is what the files hold, "setup".
const EmbeddedFile* NamedOrPath(std::span<const EmbeddedFile> files, std::string_view what,
                                const std::string& name_or_path);

}  // namespace pelt
