// Knows the plug-in and nothing of Pelt.
#include <cinttypes>
#include <cstdint>
#include <cstdio>

extern "C" uint64_t PluginFirstFrame(const char* groom_path);

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const uint64_t digest = PluginFirstFrame(argv[1]);
  std::printf("%016" PRIx64 "\n", digest);
  return digest == 0;
}
