#include "bench/verify/frame_digests.hpp"

#include "traces/digest.hpp"

namespace pelt {
namespace {

uint64_t DigestBookkeeping(const FrameMemory& memory, Stream stream) {
  Digest digest;
  for (uint32_t i = 0; i < memory.shape->ItemCount((*memory.table)[stream].domain); ++i)
    AddItem(digest, memory, stream, i);
  return digest.Value();
}

}  // namespace

StreamDigests DigestsOf(const FurScene& scene) {
  const FrameMemory& memory = scene.memory();
  StreamDigests digests{};
  for (uint32_t s = 0; s < kStreamCount; ++s)
    digests[s] = DescribeStream(Stream(s)).role == Role::kBookkeeping
                     ? DigestBookkeeping(memory, Stream(s))
                     : scene.DigestStream(Stream(s));
  return digests;
}

bool SameDigests(const StreamDigests& a, const StreamDigests& b, const Agreement& agreement) {
  for (uint32_t s = 0; s < kStreamCount; ++s) {
    if (a[s] == b[s]) continue;
    const OutputEntry* const output = FindOutputIn(Stream(s));
    const bool vertices = output && output->in_draw_order == Stream(s);
    const bool bookkeeping = DescribeStream(Stream(s)).role == Role::kBookkeeping;
    if ((agreement.vertices || !vertices) && (agreement.bookkeeping || !bookkeeping)) return false;
  }
  return true;
}

uint64_t DigestLayer(const FurScene& scene, uint32_t layer, LayerPart part) {
  const SceneShape& shape = scene.shape();
  const bool no_paint =
      part == LayerPart::kWithoutPaint && (shape.layer_kind[layer] & kLayerPainted);
  Digest digest;
  for (uint32_t s = 0; s < kStreamCount; ++s) {
    const StreamDesc& desc = DescribeStream(Stream(s));
    if (desc.role != Role::kValue) continue;
    if (no_paint &&
        (Stream(s) == StreamOf<&Streams::paint> || Stream(s) == StreamOf<&Streams::looks>))
      continue;
    if (desc.domain == Domain::kLayer) AddItem(digest, scene.memory(), Stream(s), layer);
    if (!IsInLayer(desc.domain)) continue;
    const uint32_t first = shape.LayerFirst(desc.domain, layer);
    for (uint32_t i = 0; i < shape.LayerItems(desc.domain, layer); ++i)
      AddItem(digest, scene.memory(), Stream(s), first + i);
  }
  return digest.Value();
}

}  // namespace pelt
