// One place opens outputs, and the command line alone says where they go. The compiler sees to half
// of it (OutputPath); that no code goes round it is read here, in the sources.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "bench/command/output_path.hpp"
#include "tests/source_folder.hpp"

namespace pelt {
namespace {

namespace fs = std::filesystem;

struct Source {
  std::string name, text;  // "bench/command/pelt.cpp"
};

std::vector<Source> SourcesOf(const std::vector<std::string>& rooms) {
  std::vector<Source> sources;
  const fs::path root = test::SourceFolder();
  for (const std::string& room : rooms)
    for (const auto& entry : fs::recursive_directory_iterator(root / room)) {
      const std::string extension = entry.path().extension();
      if (extension != ".cpp" && extension != ".hpp") continue;
      std::ifstream file(entry.path());
      sources.push_back({fs::relative(entry.path(), root).string(),
                         std::string(std::istreambuf_iterator<char>(file), {})});
    }
  return sources;
}

std::set<std::string> FilesWith(const std::string& pattern, const std::vector<std::string>& rooms) {
  std::set<std::string> names;
  for (const Source& source : SourcesOf(rooms))
    if (std::regex_search(source.text, std::regex(pattern))) names.insert(source.name);
  return names;
}

const std::vector<std::string> kRooms = {"core", "traces", "jobs", "platform_sim", "bench"};

TEST(Outputs, OnePlaceOpensFilesToWrite) {
  const std::set<std::string> writer = {"core/file_bytes.cpp"};
  EXPECT_EQ(FilesWith(R"(\b(ofstream|basic_ofstream|freopen|fdopen|stbi_write_png\())", kRooms),
            writer);
  EXPECT_EQ(FilesWith(R"(\brename\()", kRooms), writer);
  EXPECT_EQ(FilesWith(R"([^_]\bf?open\()", kRooms), writer);
}

TEST(Outputs, CommandsWriteWhatTheCommandLineTried) {
  EXPECT_EQ(FilesWith(R"(\b(Try)?Write(FileBytes|GroomFile|DigestLogFile)\()", {"bench"}),
            std::set<std::string>{"bench/command/output_path.cpp"});
  // commands.hpp: the report's own default, which is tried like any other.
  EXPECT_EQ(
      FilesWith(R"(OutputPath::Of\()", {"bench"}),
      (std::set<std::string>{"bench/command/commands.hpp", "bench/command/file_options.cpp"}));
}

// A text is no path to write to: neither in a command nor for an option that is declared in another
// way than AddOutputFile.
static_assert(!std::is_convertible_v<std::string, OutputPath>);
static_assert(!std::is_constructible_v<OutputPath, std::string>);
static_assert(!std::is_assignable_v<OutputPath&, std::string>);

}  // namespace
}  // namespace pelt
