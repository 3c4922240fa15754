// Idea and invariant: see command_options.hpp. What an option does with its file is the name of its
// type in CLI11, which the help text shows: there is no list beside the options.
#include <fmt/format.h>

#include <cctype>
#include <filesystem>
#include <functional>

#include "bench/command/command_options.hpp"
#include "bench/command/usage_error.hpp"
#include "bench/scenarios/scenarios.hpp"
#include "core/output_place.hpp"

namespace pelt {
namespace {

namespace fs = std::filesystem;

constexpr const char* kInputFile = "INPUT-FILE";
constexpr const char* kInputFileOrName = "INPUT-FILE|NAME";
constexpr const char* kOutputFile = "OUTPUT-FILE";
constexpr const char* kOutputFolder = "OUTPUT-FOLDER";

bool IsRegularOrNew(const std::string& path) {
  std::error_code code;
  const fs::file_status status = fs::status(path, code);
  return !fs::exists(status) || fs::is_regular_file(status);
}

// Both outputs may go to /dev/null.
bool IsDevice(const std::string& path) {
  std::error_code code;
  return fs::is_character_file(fs::status(path, code));
}

CLI::Validator IsNotEmpty() {
  return CLI::Validator([](std::string& path) { return path.empty() ? "the path is empty" : ""; },
                        "");
}

// Of what becomes a file; a device or a FIFO is called as it likes.
CLI::Validator HasExtension(std::string_view extension) {
  const auto check = [extension](std::string& path) -> std::string {
    std::string has = fs::path(path).extension().string();
    for (char& c : has) c = char(std::tolower(uint8_t(c)));
    if (has == extension || !IsRegularOrNew(path)) return {};
    return fmt::format("'{}' does not end in {}, which is what will be written", path, extension);
  };
  return CLI::Validator(check, "");
}

CLI::Option* AddOutput(CLI::App& app, const char* name, OutputPath& target, const char* help,
                       const char* type) {
  CLI::Option* option = app.add_option_function<std::string>(
      name, [&target](const std::string& path) { target = OutputPath::Of(path); }, help);
  option->type_name(type)->check(IsNotEmpty());
  if (!target.empty()) option->default_str(target.path());
  return option;
}

struct NamedFile {
  std::string option, path;

  std::string Describe() const { return fmt::format("{} '{}'", option, path); }
};

// The parsed subcommands of subcommands, too.
void ForEachOption(const CLI::App& app, const std::function<void(const CLI::Option&)>& use) {
  for (const CLI::Option* option : app.get_options()) use(*option);
  for (const CLI::App* parsed : app.get_subcommands()) ForEachOption(*parsed, use);
}

std::vector<std::string> ValuesOf(const CLI::Option& option) {
  if (option.count()) return option.results();
  if (option.get_default_str().empty()) return {};
  return {option.get_default_str()};
}

std::vector<NamedFile> ListFiles(const CLI::App& app, std::string_view type) {
  std::vector<NamedFile> files;
  ForEachOption(app, [&](const CLI::Option& option) {
    if (option.get_type_name() != type) return;
    for (const std::string& path : ValuesOf(option)) files.push_back({option.get_name(), path});
  });
  return files;
}

std::vector<NamedFile> ListInputs(const CLI::App& app) {
  std::vector<NamedFile> inputs = ListFiles(app, kInputFile);
  for (NamedFile& file : ListFiles(app, kInputFileOrName))
    if (!IsBuiltInName(file.path)) inputs.push_back(std::move(file));
  return inputs;
}

// What the shell sent to a file is written to from start to end while the command runs.
void CheckNotStandardStream(const NamedFile& output) {
  constexpr std::pair<const char*, const char*> kStreams[] = {{"/dev/stdout", "standard output"},
                                                              {"/dev/stderr", "standard error"}};
  for (const auto& [stream, name] : kStreams)
    if (IsRegularOrNew(stream) && IsSameFile(output.path, stream))
      throw UsageError(fmt::format("{} is the file that {} goes to", output.Describe(), name));
}

void CheckOutputsDiffer(const std::vector<NamedFile>& outputs) {
  for (size_t i = 0; i < outputs.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      if (IsSameFile(outputs[i].path, outputs[j].path) && !IsDevice(outputs[i].path))
        throw UsageError(fmt::format("{} and {} are one file, and each would be written to it",
                                     outputs[j].Describe(), outputs[i].Describe()));
}

// An output folder that is not there yet is made below one that is.
void TryFolder(const NamedFile& folder) {
  std::error_code code;
  fs::path there = fs::absolute(folder.path, code).lexically_normal();
  while (!fs::exists(there, code) && there.has_relative_path()) there = there.parent_path();
  if (!fs::is_directory(there, code))
    throw Error(fmt::format("{}: '{}' is not a folder", folder.Describe(), there.string()));
  CheckOutput(folder.option, OutputPath::Of((there / "pelt").string()));
}

}  // namespace

CLI::Option* AddInputFile(CLI::App& app, const char* name, std::string& target, const char* help) {
  return app.add_option(name, target, help)->type_name(kInputFile)->check(IsNotEmpty());
}

CLI::Option* AddInputFile(CLI::App& app, const char* name, std::vector<std::string>& target,
                          const char* help) {
  return app.add_option(name, target, help)->type_name(kInputFile)->check(IsNotEmpty());
}

CLI::Option* AddInputFileOrName(CLI::App& app, const char* name, std::string& target,
                                const char* help) {
  return AddInputFile(app, name, target, help)->type_name(kInputFileOrName);
}

CLI::Option* AddOutputFile(CLI::App& app, const char* name, OutputPath& target, const char* help,
                           std::string_view extension) {
  CLI::Option* option = AddOutput(app, name, target, help, kOutputFile);
  if (!extension.empty()) option->check(HasExtension(extension));
  return option;
}

CLI::Option* AddOutputFolder(CLI::App& app, const char* name, OutputPath& target,
                             const char* help) {
  return AddOutput(app, name, target, help, kOutputFolder);
}

void CheckFiles(const CLI::App& app) {
  const std::vector<NamedFile> outputs = ListFiles(app, kOutputFile);
  for (const NamedFile& output : outputs) {
    CheckNotStandardStream(output);
    for (const NamedFile& input : ListInputs(app))
      if (IsSameFile(output.path, input.path))
        throw UsageError(
            fmt::format("{} is the file that {} reads", output.Describe(), input.Describe()));
  }
  CheckOutputsDiffer(outputs);
  for (const NamedFile& output : outputs) CheckOutput(output.option, OutputPath::Of(output.path));
  for (const NamedFile& folder : ListFiles(app, kOutputFolder)) TryFolder(folder);
}

void CheckFilesRead(const CLI::App& app, std::span<const std::string> read) {
  for (const NamedFile& output : ListFiles(app, kOutputFile))
    for (const std::string& path : read)
      if (IsSameFile(output.path, path))
        throw UsageError(fmt::format("{} is '{}', which is read", output.Describe(), path));
}

}  // namespace pelt
