#include "bench/scenarios/embedded_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/error.hpp"
#include "core/groom/nearest_word.hpp"

namespace pelt {

const EmbeddedFile* FindEmbedded(std::span<const EmbeddedFile> files, std::string_view name) {
  const auto found = std::ranges::find(files, name, &EmbeddedFile::name);
  return found == files.end() ? nullptr : &*found;
}

std::vector<std::string_view> NamesOf(std::span<const EmbeddedFile> files) {
  std::vector<std::string_view> names;
  for (const EmbeddedFile& file : files) names.push_back(file.name);
  return names;
}

const EmbeddedFile* NamedOrPath(std::span<const EmbeddedFile> files, std::string_view what,
                                const std::string& name_or_path) {
  const EmbeddedFile* found = FindEmbedded(files, name_or_path);
  if (found || name_or_path.find_first_of("./") != std::string::npos) return found;
  const std::vector<std::string_view> names = NamesOf(files);
  throw Error(fmt::format("no built-in {} '{}' (there are: {}); a file's path ends in .toml{}",
                          what, name_or_path, fmt::join(names, ", "),
                          DidYouMean(name_or_path, names)));
}

}  // namespace pelt
