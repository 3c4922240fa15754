// What happens to all that may be at a path that is written, and what may be read.
#include "core/file_bytes.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <thread>

#include "core/output_place.hpp"

namespace pelt {
namespace {

namespace fs = std::filesystem;

class FileBytes : public ::testing::Test {
 protected:
  FileBytes() : folder_(fs::path(::testing::TempDir()) / ("pelt_file_bytes_" + Unique())) {
    fs::create_directories(folder_);
  }
  ~FileBytes() override { fs::remove_all(folder_); }

  static std::string Unique() {
    return std::to_string(getpid()) + "_" +
           ::testing::UnitTest::GetInstance()->current_test_info()->name();
  }
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  std::string Put(const std::string& name, const std::string& text) const {
    std::ofstream(Path(name), std::ios::binary) << text;
    return Path(name);
  }
  static std::string Get(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  std::set<std::string> Names() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) names.insert(entry.path().filename());
    return names;
  }
  // Empty, or the error.
  static std::string Write(const std::string& path, const std::string& text) {
    return WriteFileBytes("thing", path, AsBytes(text)).error();
  }
  static std::string Try(const std::string& path) { return TryOutput("thing", path).error(); }
  static std::string Read(const std::string& path, uint64_t limit = 1000) {
    const auto bytes = ReadWhole(path, limit);
    return bytes ? "= " + std::string(AsText(*bytes)) : bytes.error();
  }
  static mode_t ModeOf(const std::string& path) {
    struct stat status {};
    stat(path.c_str(), &status);
    return status.st_mode & 0777;
  }

  fs::path folder_;
};

TEST_F(FileBytes, FileIsReplacedWholeAndKeepsItsMode) {
  const std::string path = Put("a", "old");
  for (const mode_t mode : {0600, 0644, 0640, 0755}) {
    chmod(path.c_str(), mode);
    EXPECT_EQ(Write(path, "new"), "");
    EXPECT_EQ(ModeOf(path), mode);
  }
  EXPECT_EQ(Get(path), "new");
  EXPECT_EQ(Names(), std::set<std::string>{"a"});
}

TEST_F(FileBytes, OwnerIsKeptWhereItMayBe) {
  if (geteuid() != 0) GTEST_SKIP() << "only root may give files away";
  const std::string path = Put("a", "old");
  ASSERT_EQ(chown(path.c_str(), 1234, 2345), 0);
  chmod(path.c_str(), 0640);
  EXPECT_EQ(Write(path, "new"), "");
  struct stat status {};
  stat(path.c_str(), &status);
  EXPECT_EQ(status.st_uid, 1234u);
  EXPECT_EQ(status.st_gid, 2345u);
  EXPECT_EQ(ModeOf(path), 0640u);
}

// A reader that opened the old file must not see the new one grow under it.
TEST_F(FileBytes, ReaderKeepsTheOldFile) {
  const std::string path = Put("a", "old");
  std::ifstream reader(path);
  EXPECT_EQ(Write(path, "new and longer"), "");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(reader), {}), "old");
}

TEST_F(FileBytes, LinksAreFollowed) {
  fs::create_directory(folder_ / "below");
  Put("below/real", "old");
  fs::create_symlink("below/real", folder_ / "one");
  fs::create_symlink("one", folder_ / "two");
  EXPECT_EQ(Write(Path("two"), "new"), "");
  EXPECT_TRUE(fs::is_symlink(folder_ / "one"));
  EXPECT_TRUE(fs::is_symlink(folder_ / "two"));
  EXPECT_EQ(Get(Path("below/real")), "new");
  // To what is not there yet.
  fs::create_symlink("below/made", folder_ / "dangling");
  EXPECT_EQ(Write(Path("dangling"), "made"), "");
  EXPECT_TRUE(fs::is_symlink(folder_ / "dangling"));
  EXPECT_EQ(Get(Path("below/made")), "made");
  EXPECT_EQ(Names(), (std::set<std::string>{"below", "one", "two", "dangling"}));
  fs::create_symlink("nowhere/x", folder_ / "lost");
  EXPECT_NE(Write(Path("lost"), "x").find("nowhere' is not there"), std::string::npos);
  fs::create_symlink("round", folder_ / "round");
  EXPECT_NE(Write(Path("round"), "x").find("symbolic links"), std::string::npos);
}

TEST_F(FileBytes, FifoIsWrittenToAndNotReplaced) {
  const std::string fifo = Path("fifo");
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  fs::create_symlink("fifo", folder_ / "link");
  std::string got;
  std::thread reader([&] { got = Get(fifo); });
  const std::string text(200'000, 'x');  // more than a pipe holds
  EXPECT_EQ(Write(Path("link"), text), "");
  reader.join();
  EXPECT_EQ(got, text);
  EXPECT_TRUE(fs::is_fifo(fifo));
  EXPECT_EQ(Names(), (std::set<std::string>{"fifo", "link"}));
}

// Opened and closed for a try, it would give its reader an end of file; without a reader, opening
// it would wait for ever.
TEST_F(FileBytes, TryingLeavesAFifoAlone) {
  const std::string fifo = Path("fifo");
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_EQ(Try(fifo), "");  // no reader
  std::string got;
  std::thread reader([&] { got = Get(fifo); });
  for (int i = 0; i < 50; ++i) EXPECT_EQ(Try(fifo), "");
  EXPECT_EQ(Write(fifo, "all"), "");
  reader.join();
  EXPECT_EQ(got, "all");
}

TEST_F(FileBytes, TryingChangesNothing) {
  const std::string path = Put("a", "old");
  const auto before = fs::last_write_time(path);
  EXPECT_EQ(Try(path), "");
  EXPECT_EQ(Try(Path("new")), "");
  EXPECT_EQ(Get(path), "old");
  EXPECT_EQ(fs::last_write_time(path), before);
  EXPECT_EQ(Names(), std::set<std::string>{"a"});
}

// A try says what writing would say.
TEST_F(FileBytes, ReasonsAreTheRightOnes) {
  const std::string file = Put("file", "x");
  const std::pair<std::string, std::string> cases[] = {{Path("no/x"), "no' is not there"},
                                                       {Path("file/x"), "file' is not a folder"},
                                                       {folder_.string(), "a folder, not a file"},
                                                       {Path("new/"), "there is no such folder"},
                                                       {"", "the path is empty"},
                                                       {Path(std::string(256, 'n')), "too long"},
                                                       {Path(std::string(5000, 'n')), "too long"}};
  for (const auto& [path, reason] : cases) {
    EXPECT_NE(Try(path).find(reason), std::string::npos) << Try(path);
    EXPECT_EQ(Write(path, "x"), Try(path));
  }
  EXPECT_EQ(Names(), std::set<std::string>{"file"});
}

TEST_F(FileBytes, SocketIsNamed) {
  const int listener = socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string path = Path("s");
  if (path.size() >= sizeof address.sun_path) GTEST_SKIP() << "the folder's path is too long";
  path.copy(address.sun_path, path.size());
  ASSERT_EQ(bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  EXPECT_NE(Write(path, "x").find("a socket, not a file"), std::string::npos);
  EXPECT_EQ(Read(path), "a socket, not a file");
  close(listener);
  EXPECT_TRUE(fs::is_socket(path));
}

TEST_F(FileBytes, LongestNamesWork) {
  for (const size_t length : {230, 240, 250, 255}) {
    const std::string path = Path(std::string(length, 'n'));
    EXPECT_EQ(Try(path), "");
    EXPECT_EQ(Write(path, "x"), "");
    EXPECT_EQ(Get(path), "x");
  }
  // 255 bytes of characters of three: the partial file's name is not cut inside one.
  std::string name;
  while (name.size() < 255) name += "\xe2\x82\xac";
  EXPECT_EQ(Write(Path(name), "x"), "");
  EXPECT_EQ(Names().size(), 5u);
}

TEST_F(FileBytes, ReadOnlyIsRefused) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write everything";
  const std::string path = Put("a", "old");
  chmod(path.c_str(), 0400);
  EXPECT_NE(Try(path).find("may not be written"), std::string::npos);
  chmod(folder_.c_str(), 0500);
  EXPECT_NE(Try(Path("b")).find("nothing can be written to the folder"), std::string::npos);
  chmod(folder_.c_str(), 0700);
}

// Writers at once, of one file and of many: each leaves a whole file.
TEST_F(FileBytes, WritersAtOnceDoNotMix) {
  std::vector<std::thread> writers;
  for (char c = 'a'; c < 'i'; ++c)
    writers.emplace_back([this, c] {
      for (int i = 0; i < 20; ++i) EXPECT_EQ(Write(Path("one"), std::string(30'000, c)), "");
    });
  for (std::thread& writer : writers) writer.join();
  const std::string text = Get(Path("one"));
  EXPECT_EQ(text, std::string(30'000, text[0]));
  EXPECT_EQ(Names(), std::set<std::string>{"one"});
}

TEST_F(FileBytes, InputsAreNamedForWhatTheyAre) {
  EXPECT_EQ(Read(Put("a", "text")), "= text");
  EXPECT_EQ(Read(Put("empty", "")), "= ");
  EXPECT_EQ(Read(Put("b", "12345"), 5), "= 12345");
  EXPECT_EQ(Read(Path("b"), 4), "larger than 4 bytes");
  EXPECT_EQ(Read(Path("none")), "no such file");
  EXPECT_EQ(Read(folder_.string()), "a folder, not a file");
  fs::create_symlink("none", folder_ / "lost");
  EXPECT_EQ(Read(Path("lost")), "a link to what is not there");
  EXPECT_NE(Read(Path(std::string(300, 'n'))).find("too long"), std::string::npos);
  EXPECT_EQ(Read("/dev/null"), "= ");
  EXPECT_EQ(Read("/dev/zero"), "larger than 1000 bytes") << "a device that never ends";
  EXPECT_GT(Read("/proc/self/status", 1 << 20).size(), 100u) << "its size is said to be 0";
}

TEST_F(FileBytes, FifosAreRead) {
  const std::string fifo = Path("fifo");
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  for (const size_t size : {size_t{0}, size_t{5}, size_t{300'000}}) {
    std::thread writer([&] { std::ofstream(fifo) << std::string(size, 'x'); });
    EXPECT_EQ(Read(fifo, 1 << 20), "= " + std::string(size, 'x'));
    writer.join();
  }
}

// Control characters in a path are shown as escapes, not printed.
TEST_F(FileBytes, PathsInErrorsArePrintable) {
  const std::string error = Write(Path("no\x1b[2J/x"), "x");
  EXPECT_NE(error.find("no\\x1b[2J"), std::string::npos) << error;
  EXPECT_EQ(error.find('\x1b'), std::string::npos);
}

TEST_F(FileBytes, SameFileUnderAnyName) {
  const std::string a = Put("a", "x"), b = Put("b", "x");
  fs::create_directory(folder_ / "below");
  fs::create_hard_link(a, folder_ / "hard");
  fs::create_symlink("a", folder_ / "soft");
  fs::create_directory_symlink("below", folder_ / "link");
  ASSERT_EQ(mkfifo(Path("fifo").c_str(), 0600), 0);
  fs::create_symlink("fifo", folder_ / "to_fifo");
  fs::create_symlink("below/new", folder_ / "dangling");
  const std::pair<std::string, std::string> same[] = {
      {"a", "a"},          {"a", "./a"},
      {"a", "hard"},       {"a", "soft"},
      {"a", "below/../a"}, {"new", "new"},
      {"new", "./new"},    {"below/new", "link/new"},
      {"fifo", "to_fifo"}, {"dangling", "link/new"}};
  for (const auto& [x, y] : same) {
    EXPECT_TRUE(IsSameFile(Path(x), Path(y))) << x << " " << y;
    EXPECT_TRUE(IsSameFile(Path(y), Path(x))) << x << " " << y;
  }
  const std::pair<std::string, std::string> others[] = {
      {"a", "b"}, {"a", "new"}, {"new", "newer"}, {"new", "below/new"}, {"fifo", "a"}};
  for (const auto& [x, y] : others) EXPECT_FALSE(IsSameFile(Path(x), Path(y))) << x << " " << y;
  EXPECT_FALSE(IsSameFile("", ""));
}

}  // namespace
}  // namespace pelt
