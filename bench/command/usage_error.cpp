#include "bench/command/usage_error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "core/groom/nearest_word.hpp"

namespace pelt {
namespace {

// The subcommand, or subcommand of a subcommand, that the arguments got to.
const CLI::App& FindDeepest(const CLI::App& root) {
  const CLI::App* app = &root;
  while (!app->get_subcommands().empty()) app = app->get_subcommands().front();
  return *app;
}

std::string FullName(const CLI::App& app) {
  return app.get_parent() ? FullName(*app.get_parent()) + ' ' + app.get_name() : app.get_name();
}

std::vector<std::string> OptionNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::vector<std::string> SubcommandNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(sub->get_name());
  return names;
}

std::string DescribeWord(const CLI::App& app, const std::string& word) {
  if (word.starts_with("-")) {
    const std::string name = word.substr(0, word.find('='));
    return fmt::format("no option '{}'{}", name, DidYouMean(name, OptionNames(app)));
  }
  const std::vector<std::string> names = SubcommandNames(app);
  if (names.empty()) return fmt::format("'{}' is one argument too many", word);
  const std::string suggestion = DidYouMean(word, names);
  return fmt::format(
      "no subcommand '{}'{}", word,
      suggestion.empty() ? fmt::format("; there are: {}", fmt::join(names, ", ")) : suggestion);
}

}  // namespace

std::string DescribeUsage(const CLI::App& root, const CLI::ParseError& error) {
  const CLI::App& app = FindDeepest(root);
  std::vector<std::string> left = root.remaining(true);
  // An option's value is left over beside the mistyped option that it was for; after a mistyped
  // subcommand, all of its options are.
  const bool wants_subcommand = !SubcommandNames(app).empty();
  std::stable_partition(left.begin(), left.end(), [&](const std::string& word) {
    return word.starts_with("-") != wants_subcommand;
  });
  std::erase(left, "--");
  std::string message = left.empty() ? error.what() : DescribeWord(app, left.front());
  return fmt::format("{} (see {} --help)", message, FullName(app));
}

}  // namespace pelt
