// Options that name files. An option says here whether its file is read or written, and all that
// must hold between the files of a command line follows from that: no output is also an input or
// another output, every output can be written, and all of it is known before the work begins.
//
// Breaks if ignored: an output declared in another way cannot be written (output_path.hpp).
#pragma once

#include <CLI/CLI.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/command/output_path.hpp"

namespace pelt {

CLI::Option* AddInputFile(CLI::App& app, const char* name, std::string& target, const char* help);
CLI::Option* AddInputFile(CLI::App& app, const char* name, std::vector<std::string>& target,
                          const char* help);
// Also the name of something built in (IsBuiltInName).
CLI::Option* AddInputFileOrName(CLI::App& app, const char* name, std::string& target,
                                const char* help);
// `extension`: the only one a file may have; empty: any.
CLI::Option* AddOutputFile(CLI::App& app, const char* name, OutputPath& target, const char* help,
                           std::string_view extension = {});
// Files in it are the command's own to check (CheckOutput).
CLI::Option* AddOutputFolder(CLI::App& app, const char* name, OutputPath& target, const char* help);

// Of the parsed options of `app`. Throws CLI::ParseError for files that do not go together, Error
// for an output that cannot be written.
void CheckFiles(const CLI::App& app);
// The same for files that were found to be read later: the maps of a setup, the buffers of a model.
void CheckFilesRead(const CLI::App& app, std::span<const std::string> read);

}  // namespace pelt
