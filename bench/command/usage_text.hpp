// What is said to arguments that make no sense: with the word that was meant, where one is near.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace pelt {

// Of what `root` threw while it parsed.
std::string DescribeUsage(const CLI::App& root, const CLI::ParseError& error);

}  // namespace pelt
