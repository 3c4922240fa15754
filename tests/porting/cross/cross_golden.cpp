// Replays a recording on this processor, on every set of kernels it has, and writes what it
// computed as a digest log. Returns non-zero when a frame's digest is not the recorded one.
//
//   cross_golden RECORDING DIGEST_LOG
#include "bench/verify/replay.hpp"
#include "bench/verify/stage_digests.hpp"
#include "core/kernels/frame_table.hpp"
#include "tests/porting/cross/program.hpp"

namespace {

using namespace pelt;

int ReplayAll(const char* recording, const char* digest_log) {
  const InputLog log = OrExit(ReadInputLog(ReadBytes(recording), recording));
  int failed = 0;
  for (const Isa isa : kAllIsas) {
    if (!FindKernels(isa)) continue;
    SceneOptions options;
    options.isa = isa;
    ReplayScene replay = OrExit(ReplayScene::Open(log, recording, options));
    const StageDigests stages(replay.scene());
    DigestLog digests = stages.Begin(log.about.scene, "", replay.options().vertex_order);
    SerialExecutor serial;
    const ReplayResult result =
        Replay(log, replay, serial, [&](uint32_t) { stages.AddFrame(replay.scene(), digests); });
    std::printf("%s: %s\n", IsaName(isa).data(), DescribeReplay(result).c_str());
    failed += !result.Same();
    std::ofstream(digest_log, std::ios::binary) << WriteDigestLog(digests);
  }
  return failed ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return std::puts("usage: cross_golden RECORDING DIGEST_LOG"), 2;
  return ReplayAll(argv[1], argv[2]);
}
