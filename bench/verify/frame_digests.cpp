#include "bench/verify/frame_digests.hpp"

#include "traces/digest.hpp"

namespace pelt {
namespace {

void AddItem(Digest& digest, const FurScene& scene, Stream stream, uint32_t item) {
  const StreamDesc& desc = DescribeStream(stream);
  const std::byte* block = scene.memory().Block(stream, item);
  if (!block) return;
  const uint32_t lanes = scene.LiveLanes(stream, desc.domain == Domain::kChunk ? item : 0);
  digest.Add(lanes);
  AddBlock(digest, desc, block, lanes);
}

uint64_t DigestBooking(const FurScene& scene, Stream stream) {
  Digest digest;
  for (uint32_t i = 0; i < scene.shape().ItemCount(DescribeStream(stream).domain); ++i)
    AddItem(digest, scene, stream, i);
  return digest.Value();
}

}  // namespace

StreamDigests DigestsOf(const FurScene& scene) {
  StreamDigests digests{};
  for (uint32_t s = 0; s < kStreamCount; ++s)
    digests[s] = DescribeStream(Stream(s)).role == Role::kBookkeeping
                     ? DigestBooking(scene, Stream(s))
                     : scene.DigestStream(Stream(s));
  return digests;
}

bool SameDigests(const StreamDigests& a, const StreamDigests& b, const Agreement& agreement) {
  for (uint32_t s = 0; s < kStreamCount; ++s) {
    if (a[s] == b[s]) continue;
    const bool vertices = Stream(s) == StreamOf<&Streams::instances> ||
                          Stream(s) == StreamOf<&Streams::ribbon_vertices>;
    const bool bookkeeping = DescribeStream(Stream(s)).role == Role::kBookkeeping;
    if ((agreement.vertices || !vertices) && (agreement.bookkeeping || !bookkeeping)) return false;
  }
  return true;
}

uint64_t DigestLayer(const FurScene& scene, uint32_t layer) {
  const SceneShape& shape = scene.shape();
  Digest digest;
  for (uint32_t s = 0; s < kStreamCount; ++s) {
    const StreamDesc& desc = DescribeStream(Stream(s));
    if (desc.role != Role::kValue) continue;
    if (desc.domain == Domain::kLayer) AddItem(digest, scene, Stream(s), layer);
    if (desc.domain != Domain::kChunk) continue;
    for (uint32_t c = shape.layer_first_chunk[layer]; c < shape.layer_first_chunk[layer + 1]; ++c)
      AddItem(digest, scene, Stream(s), c);
  }
  return digest.Value();
}

}  // namespace pelt
