// What an engine without exceptions and RTTI does with Pelt: reads a groom, gets the faults of bad
// input reported, and runs frames. Prints the digest of the README's example, which runs the first
// of them; returns the number of checks that failed.
//
//   no_exceptions GROOM
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "pelt/core/bind_pose.hpp"
#include "pelt/core/error.hpp"
#include "pelt/core/groom/groom_file.hpp"
#include "pelt/jobs/scene.hpp"
#include "pelt/platform_sim/local_store.hpp"

namespace {

int failures = 0;

void Expect(bool holds, const char* what, const std::string& text) {
  if (holds) return;
  std::fprintf(stderr, "FAILED: %s: '%s'\n", what, text.c_str());
  ++failures;
}

// The text must name what is wrong.
template <class T>
void ExpectError(const pelt::Result<T>& result, const char* word) {
  Expect(!result && result.error().find(word) != std::string::npos, word, result.error());
}

std::vector<std::byte> ReadBytes(const char* path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<std::byte> bytes;
  for (std::istreambuf_iterator<char> at(file), end; at != end; ++at)
    bytes.push_back(static_cast<std::byte>(*at));
  return bytes;
}

void TryBadGrooms(const std::vector<std::byte>& good) {
  std::vector<std::byte> bad = good;
  bad.resize(bad.size() / 2);
  ExpectError(pelt::ReadGroom(bad, "cut"), "it was cut or extended");
  bad = good;
  bad[good.size() / 2] ^= std::byte{1};
  ExpectError(pelt::ReadGroom(bad, "damaged"), "damaged");
  bad.assign(20, std::byte{0x50});
  ExpectError(pelt::ReadGroom(bad, "noise"), "not a groom file");
  ExpectError(pelt::ReadGroomFile("/no/such.groom"), "no such file");
}

void TryBadScenes(std::span<const pelt::Groom* const> grooms, uint64_t bytes) {
  ExpectError(pelt::MeasureScene({}, {}), "at least one groom");
  pelt::SceneOptions options;
  options.memory_budget_bytes = bytes - 1;
  ExpectError(pelt::MeasureScene(grooms, options), "1 more than its memory budget");
  options.memory_budget_bytes = bytes;
  const auto fits = pelt::MeasureScene(grooms, options);
  Expect(bool(fits), "exactly the budget", fits.error());
  pelt::SceneBlock block(bytes + pelt::kBlockAlignment);
  ExpectError(pelt::FurScene::Create(grooms, {}, {block.bytes().first(bytes - 1)}), "was given");
  ExpectError(pelt::FurScene::Create(grooms, {}, {block.bytes().subspan(4)}), "aligned");
  pelt::SceneOptions tight;
  tight.plan.must_fit = true;
  tight.plan.local_store_data_bytes = 20000;
  ExpectError(pelt::FurScene::Create(grooms, tight), "bytes of local store");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const std::vector<std::byte> bytes = ReadBytes(argv[1]);
  TryBadGrooms(bytes);
  const pelt::Result<pelt::Groom> groom = pelt::ReadGroom(bytes, argv[1]);
  Expect(bool(groom), "reads", groom.error());
  if (!groom) return 1;
  const auto again = pelt::WriteGroom(*groom);
  Expect(again && *again == bytes, "writes the bytes it read", again.error());

  const pelt::Groom* grooms[] = {&*groom};
  const pelt::Result<pelt::SceneLayout> layout = pelt::MeasureScene(grooms, {});
  Expect(bool(layout), "measures", layout.error());
  if (!layout) return 1;
  TryBadScenes(grooms, layout->total_bytes);

  uint64_t first[2], last[2];
  pelt::SerialExecutor serial;
  pelt::LocalStoreExecutor local_store(pelt::SceneOptions{}.plan.local_store_data_bytes);
  pelt::Executor* executors[] = {&serial, &local_store};
  for (int e = 0; e < 2; ++e) {
    const auto made = pelt::FurScene::Create(grooms);
    Expect(bool(made), "creates", made.error());
    if (!made) return 1;
    const auto& scene = *made;
    pelt::FillBindPose(*groom, scene->Pose(0));
    pelt::FrameInput input;
    input.dt_s = std::numeric_limits<double>::quiet_NaN();
    const char* fault = scene->BeginFrame(input);
    Expect(fault && std::strstr(fault, "dt_s"), "dt_s", fault ? fault : "");
    input.dt_s = 1.0 / 60.0;
    for (int f = 0; f < 5; ++f) {
      fault = scene->BeginFrame(input);
      Expect(fault == nullptr, "begins", fault ? fault : "");
      executors[e]->Run(scene->CurrentFrame());
      last[e] = scene->DigestFrame();
      if (f == 0) first[e] = last[e];
    }
  }
  Expect(local_store.faults().empty(), "local store", "a kernel touched what it did not declare");
  Expect(first[0] == first[1] && last[0] == last[1], "digests", "two executors differ");
  std::printf("%016llx\n", static_cast<unsigned long long>(first[0]));
  return failures;
}
