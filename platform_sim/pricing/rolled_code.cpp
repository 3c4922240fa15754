#include "platform_sim/pricing/rolled_code.hpp"

#include <algorithm>
#include <unordered_map>
#include <vector>

namespace pelt {
namespace {

constexpr uint64_t kFnvPrime = 0x100000001b3;

// Hashes of all runs of kLongEnough kinds, by where they begin.
std::vector<uint64_t> HashRuns(const std::vector<uint8_t>& kinds) {
  std::vector<uint64_t> hashes;
  uint64_t hash = 0, leaves = 1;
  for (uint32_t i = 0; i < kLongEnough; ++i) leaves *= kFnvPrime;
  for (size_t i = 0; i < kinds.size(); ++i) {
    hash = hash * kFnvPrime + kinds[i] + 1;
    if (i >= kLongEnough) hash -= leaves * (kinds[i - kLongEnough] + 1u);
    if (i + 1 >= kLongEnough) hashes.push_back(hash);
  }
  return hashes;
}

}  // namespace

double ShareOfOwnCode(const Trace& trace, uint32_t begin, uint32_t end, uint32_t furthest) {
  std::vector<uint8_t> kinds;
  for (uint32_t i = begin; i < end; ++i)
    if (const RecordedKind kind = trace.operations[i].kind; kind != RecordedKind::kSplat)
      kinds.push_back(uint8_t(kind));
  const std::vector<uint64_t> hashes = HashRuns(kinds);
  std::unordered_map<uint64_t, size_t> latest;
  size_t again = 0;
  for (size_t i = 0, entered = 0; i < hashes.size();) {
    for (; entered + kLongEnough <= i; ++entered) latest[hashes[entered]] = entered;
    const auto found = latest.find(hashes[i]);
    size_t length = 0;
    if (found != latest.end() && i - found->second <= furthest)
      while (i + length < kinds.size() && kinds[found->second + length] == kinds[i + length])
        ++length;
    if (length < kLongEnough) {
      ++i;
      continue;
    }
    again += length;
    i += length;
  }
  return kinds.empty() ? 1.0 : double(kinds.size() - again) / double(kinds.size());
}

}  // namespace pelt
