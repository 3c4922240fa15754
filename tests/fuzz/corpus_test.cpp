// A fuzz target as an ordinary test: every seed of its corpus, and mutations of each that are the
// same in every run. Fails on what the target must not do, and when heap use passes the stated
// bound; a crash names its input, because that is printed first when PELT_FUZZ_VERBOSE is set.
//   corpus_test CORPUS_FOLDER...
#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <vector>

#include "core/file_bytes.hpp"
#include "core/random.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace {

std::atomic<size_t> live_bytes{0}, peak_bytes{0};

void* Count(void* p) {
  if (!p) throw std::bad_alloc();
  const size_t now = live_bytes += malloc_usable_size(p);
  size_t peak = peak_bytes;
  while (now > peak && !peak_bytes.compare_exchange_weak(peak, now)) {
  }
  return p;
}
void Forget(void* p) {
  if (p) live_bytes -= malloc_usable_size(p);
  std::free(p);
}

}  // namespace

void* operator new(size_t n) { return Count(std::malloc(n ? n : 1)); }
void* operator new[](size_t n) { return Count(std::malloc(n ? n : 1)); }
// std::stable_sort asks this way.
void* operator new(size_t n, const std::nothrow_t&) noexcept {
  void* p = std::malloc(n ? n : 1);
  return p ? Count(p) : nullptr;
}
void* operator new(size_t n, std::align_val_t a) {
  return Count(std::aligned_alloc(size_t(a), (n + size_t(a) - 1) / size_t(a) * size_t(a)));
}
void operator delete(void* p) noexcept { Forget(p); }
void operator delete[](void* p) noexcept { Forget(p); }
void operator delete(void* p, size_t) noexcept { Forget(p); }
void operator delete[](void* p, size_t) noexcept { Forget(p); }
void operator delete(void* p, const std::nothrow_t&) noexcept { Forget(p); }
void operator delete(void* p, std::align_val_t) noexcept { Forget(p); }
void operator delete(void* p, size_t, std::align_val_t) noexcept { Forget(p); }

namespace pelt::fuzz {
namespace {

std::vector<std::byte> ReadAll(const std::filesystem::path& path) {
  return ReadFileBytes("file", path.string()).OrThrow();
}

std::vector<std::byte> Mutate(std::vector<std::byte> bytes, Random& random) {
  if (bytes.empty()) return bytes;
  const auto anywhere = [&] { return random.Below(uint32_t(bytes.size())); };
  for (uint32_t times = 1 + random.Below(6); times > 0; --times) {
    const uint32_t at = anywhere();
    switch (random.Below(6)) {
      case 0:
        bytes[at] ^= std::byte(1u << random.Below(8));
        break;
      case 1:
        bytes[at] = std::byte(random.Below(2) ? 0xff : 0x00);
        break;
      case 2:
        bytes[at] = std::byte("0123456789-.eE\"[]{}=,\n "[random.Below(23)]);
        break;
      case 3:  // a piece again, over another
        std::copy_n(
            bytes.begin() + at, std::min<size_t>(8, bytes.size() - at),
            bytes.begin() + std::min<size_t>(
                                anywhere(), bytes.size() - std::min<size_t>(8, bytes.size() - at)));
        break;
      case 4:  // four bytes of another number
        for (uint32_t i = at; i < std::min<size_t>(at + 4, bytes.size()); ++i)
          bytes[i] = std::byte(random.Below(256));
        break;
      default:
        if (random.Below(4) == 0) bytes.resize(std::max<size_t>(1, at));
    }
    if (bytes.empty()) break;
  }
  return bytes;
}

// False when the bound was passed.
bool RunOne(const std::vector<std::byte>& input, const std::string& what, size_t& most) {
  if (std::getenv("PELT_FUZZ_VERBOSE")) std::fprintf(stderr, "%s\n", what.c_str());
  const size_t before = live_bytes;
  peak_bytes = before;
  try {
    ReadHostile(input);
  } catch (const std::exception& error) {
    std::printf("FAILED %s: an exception left the target: %s\n", what.c_str(), error.what());
    return false;
  }
  const size_t used = peak_bytes - before;
  most = std::max(most, used);
  if (used <= MemoryBound(input.size())) return true;
  std::printf("FAILED %s: %zu bytes of heap for %zu of input, more than %zu\n", what.c_str(), used,
              input.size(), MemoryBound(input.size()));
  return false;
}

constexpr uint32_t kMutations = 1000;  // of each seed

int RunCorpus(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> seeds;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.is_regular_file()) seeds.push_back(entry.path());
  std::sort(seeds.begin(), seeds.end());
  if (seeds.empty()) {
    std::printf("FAILED no seeds in %s\n", folder.filename().c_str());
    return 1;
  }
  uint32_t failed = 0, ran = 0;
  size_t most = 0;
  for (const auto& seed : seeds) {
    const std::vector<std::byte> bytes = ReadAll(seed);
    const std::string name = seed.filename().string();
    failed += !RunOne(bytes, name, most);
    for (uint32_t m = 1; m <= kMutations; ++m) {
      Random random(MixSeed(bytes.size(), m));
      failed += !RunOne(Mutate(bytes, random), name + ", mutation " + std::to_string(m), most);
    }
    ran += 1 + kMutations;
  }
  std::printf("%s: %zu seeds, %u inputs, at most %zu KB of heap\n", folder.filename().c_str(),
              seeds.size(), ran, most / 1000);
  return failed ? 1 : 0;
}

}  // namespace
}  // namespace pelt::fuzz

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: corpus_test CORPUS_FOLDER...\n");
    return 2;
  }
  int failed = 0;
  for (int folder = 1; folder < argc; ++folder) failed |= pelt::fuzz::RunCorpus(argv[folder]);
  return failed;
}
