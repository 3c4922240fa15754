// A scene's state as bytes:
//
//      header     magic "PELTSNP\n", version, strands per chunk, bytes, layout, options, digest of
//                 the strands, checksum of all behind the header
//      values     what the scene keeps outside its streams: ListState
//      streams    the blocks that are carried (carried_state.hpp), in stream order: of each row its
//                 lanes, one behind the other; those that do not live are 0
//
// Everything is a 32-bit word, little-endian; a double is two, the low one first. So the bytes are the same on every
// machine. What has state lists it once (ListState(io, self)), for an archive that counts, writes, looks or reads. A
// place in the bytes does not depend on what lives, so a scene's snapshots all have one size.
//
// What follows from the state is not there. The next frame makes it: it leaves nothing out, as if all
// of FrameInput::skip were off, which changes no bit. A pause makes it too, of the state alone
// (FrameGate::kFollows).
//
// A snapshot is read as hostile input: the checksum finds damage, counts that kernels would follow are
// looked at besides, and only then is anything changed.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string_view>
#include <type_traits>

#include "core/float_rules.hpp"
#include "core/kernels/frame_params.hpp"
#include "core/modal/modal_course.hpp"
#include "jobs/scene.hpp"

namespace pelt {
namespace {

// Four words of a snapshot, as they lie there or as the machine has them.
typedef uint32_t StateWords __attribute__((vector_size(16)));

StateWords LoadStateWords(const std::byte* from) {
  StateWords words;
  std::memcpy(&words, from, sizeof words);
  return words;
}
StateWords InOtherOrder(StateWords words) {
  if constexpr (std::endian::native == std::endian::big)
    for (int i = 0; i < 4; ++i) words[i] = __builtin_bswap32(words[i]);
  return words;
}

void StoreStateWords(std::byte* to, StateWords words) { std::memcpy(to, &words, sizeof words); }
uint32_t SumOf(StateWords words) { return words[0] + words[1] + words[2] + words[3]; }

// Copies whole vectors into a snapshot, the last one of `vectors` (at least 1) with `mask`. Returns
// `sum` and all that was copied.
StateWords SaveStateWords(std::byte* to, const std::byte* from, size_t vectors, StateWords mask,
                          StateWords sum) {
  const size_t last = sizeof(StateWords) * (vectors - 1);
  for (size_t b = 0; b < last; b += sizeof(StateWords)) {
    const StateWords words = LoadStateWords(from + b);
    StoreStateWords(to + b, InOtherOrder(words));
    sum += words;
  }
  const StateWords words = LoadStateWords(from + last) & mask;
  StoreStateWords(to + last, InOtherOrder(words));
  return sum + words;
}
// And out of it.
void LoadStateVectors(std::byte* to, const std::byte* from, size_t vectors) {
  for (size_t b = 0; b < sizeof(StateWords) * vectors; b += sizeof(StateWords))
    StoreStateWords(to + b, InOtherOrder(LoadStateWords(from + b)));
}
// One word, either way.
uint32_t CopyStateWord(std::byte* to, const std::byte* from) {
  uint32_t word;
  std::memcpy(&word, from, 4);
  const uint32_t other = std::endian::native == std::endian::big ? __builtin_bswap32(word) : word;
  std::memcpy(to, &other, 4);
  return word;
}

// The sum of vectors in a snapshot.
uint32_t SumStateWords(const std::byte* from, size_t vectors) {
  StateWords sum = {}, other = {};
  size_t v = 0;
  for (; v + 2 <= vectors; v += 2) {
    sum += InOtherOrder(LoadStateWords(from + sizeof(StateWords) * v));
    other += InOtherOrder(LoadStateWords(from + sizeof(StateWords) * (v + 1)));
  }
  if (v < vectors) sum += InOtherOrder(LoadStateWords(from + sizeof(StateWords) * v));
  return SumOf(sum + other);
}

// Hands every value of a thing to Archive::Word and Archive::Double, as its type has it.
template <class Archive>
struct StateArchive {
  template <class T>
  void operator()(T& value) {
    auto& archive = static_cast<Archive&>(*this);
    if constexpr (std::is_array_v<T>) {
      for (auto& element : value) (*this)(element);
    } else if constexpr (std::is_same_v<std::remove_const_t<T>, double>) {
      archive.Double(value);
    } else {
      static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
      static_assert(sizeof(T) <= 4);
      archive.Word(value);
    }
  }
};

struct StateCounter : StateArchive<StateCounter> {
  uint64_t words = 0;
  template <class T>
  void Word(T&) {
    ++words;
  }
  template <class T>
  void Double(T&) {
    words += 2;
  }
};

struct StateWriter : StateArchive<StateWriter> {
  explicit StateWriter(std::byte* first) : to(first) {}
  std::byte* to;

  void Put(uint32_t word) {
    CopyStateWord(to, reinterpret_cast<const std::byte*>(&word));
    to += 4;
  }
  template <class T>
  void Word(const T& value) {
    if constexpr (std::is_same_v<T, float>)
      Put(std::bit_cast<uint32_t>(value));
    else
      Put(uint32_t(value));
  }
  void Double(double value) {
    const auto bits = std::bit_cast<uint64_t>(value);
    Put(uint32_t(bits));
    Put(uint32_t(bits >> 32));
  }
};

struct StateReader : StateArchive<StateReader> {
  explicit StateReader(const std::byte* first) : from(first) {}
  const std::byte* from;

  uint32_t Get() {
    uint32_t word;
    CopyStateWord(reinterpret_cast<std::byte*>(&word), from);
    from += 4;
    return word;
  }
  template <class T>
  void Word(T& value) {
    if constexpr (std::is_same_v<T, float>)
      value = std::bit_cast<float>(Get());
    else if constexpr (std::is_same_v<T, bool>)
      value = Get() != 0;
    else
      value = T(Get());
  }
  void Double(double& value) {
    const uint64_t low = Get();
    value = std::bit_cast<double>(low | uint64_t(Get()) << 32);
  }
};

// Goes over what a reader would read and changes nothing: doubles must be finite.
struct StateLooker : StateArchive<StateLooker> {
  explicit StateLooker(const std::byte* first) : reader(first) {}
  StateReader reader;
  bool finite = true;

  template <class T>
  void Word(const T&) {
    reader.Get();
  }
  void Double(const double&) {
    double value;
    reader.Double(value);
    finite = finite && std::isfinite(value);
  }
};

constexpr std::string_view kMagic = "PELTSNP\n";
// Goes up when the meaning of values changes; changes of streams show in the layout.
constexpr uint32_t kVersion = 2;
constexpr size_t kHeaderBytes = 64, kChecksumAt = 48;
static_assert(sizeof(FrameParams) % 4 == 0 && alignof(FrameParams) == 4,
              "parameters are words, and go into a snapshot as such");

struct Header {
  uint32_t version = 0, chunk_strands = 0;
  uint64_t bytes = 0;
  uint32_t layout = 0, options = 0;
  uint64_t strands = 0;

  void List(auto& io) {
    uint32_t low = uint32_t(bytes), high = uint32_t(bytes >> 32);
    uint32_t first = uint32_t(strands), second = uint32_t(strands >> 32);
    for (uint32_t* word :
         {&version, &chunk_strands, &low, &high, &layout, &options, &first, &second})
      io(*word);
    bytes = low | uint64_t(high) << 32;
    strands = first | uint64_t(second) << 32;
  }
};

uint32_t OptionBits(const SceneOptions& options) {
  return (options.velocities ? 1u : 0u) | (options.origins ? 2u : 0u);
}

// Every word of a thing that is made of words.
template <class T>
void ListWords(auto& io, T& thing) {
  static_assert(sizeof(T) % 4 == 0);
  uint32_t words[sizeof(T) / 4];
  std::memcpy(words, &thing, sizeof words);
  io(words);
  if constexpr (!std::is_const_v<T>) std::memcpy(&thing, words, sizeof words);
}

void AddRow(const auto& row, uint32_t lanes, Digest& digest) {
  for (uint32_t l = 0; l < lanes; ++l) digest.Add(std::bit_cast<uint32_t>(row[l]));
}

// Where strands stand on which skin: what a state is of.
void AddVertices(const MeshBlock& mesh, Digest& digest) {
  digest.Add(mesh.vertex_count);
  for (const auto& axis : mesh.position) AddRow(axis, mesh.vertex_count, digest);
}
void AddStrands(const HaloBlock& halo, const StrandBlock& strands, Digest& digest) {
  digest.Add(strands.strand_count);
  digest.Add(strands.vertex_count);
  AddRow(halo.vertex, strands.vertex_count, digest);
  for (const auto& share : strands.bary) AddRow(share, strands.strand_count, digest);
  for (const auto& corner : strands.vertex)
    for (uint32_t s = 0; s < strands.strand_count; ++s) digest.Add(corner[s]);
}

void AddText(std::string_view text, Digest& digest) {
  for (const char c : text) digest.Add(uint8_t(c));
}

bool HaveRoom(const FrameParams& p) {
  return p.simulate.sphere_count <= kSpheresPerScene &&
         p.simulate.capsule_count <= kCapsulesPerScene &&
         p.light_layer.lighting.light_count <= kLightsPerScene &&
         p.light_layer.lighting.sample_count <= kIrradianceSamplesPerScene &&
         p.paint_strands.count <= kBrushesPerScene && p.wind.forces.count <= kForceVolumesPerScene;
}

}  // namespace

void FurScene::ListState(auto& io, auto& self) {
  io(self.first_frame_);
  io(self.last_dt_s_);
  for (auto& params : self.params_) ListWords(io, params);
  for (auto& course : self.colliders_) ColliderCourse::ListState(io, course);
  for (auto& place : self.given_origins_) io(place);
  for (auto& origin : self.origins_) CharacterOrigin::ListState(io, origin);
  for (auto& scale : self.scales_) io(scale);
  for (auto& course : self.modal_) ModalCourse::ListState(io, course);
  PoseGate::ListState(io, self.pose_gate_);
}

void FurScene::MeasureSnapshot(std::span<const Groom* const> grooms) {
  Digest strands, layout;
  std::vector<uint32_t> joints;
  for (uint32_t c = 0; c < shape().character_count; ++c) {
    const SkeletonBlock& skeleton = *memory_.Of<&Streams::skeleton>(c);
    joints.push_back(RoundUpToLaneGroups(grooms[c]->joint_count));
    strands.Add(grooms[c]->joint_count);
    for (uint32_t j = 0; j < grooms[c]->joint_count; ++j) strands.Add(uint32_t(skeleton.parent[j]));
  }
  for (uint32_t l = 0; l < shape().layer_count; ++l) {
    strands.Add(shape().layer_character[l]);
    strands.Add(shape().layer_kind[l] & ~kLayerSortInPieces);  // how it is sorted is not state
  }
  // As if all of it lived: room for the most there can be.
  for (uint32_t p = 0; p < shape().patch_count; ++p) {
    const MeshBlock& mesh = *memory_.Of<&Streams::mesh>(p);
    strands.Add(shape().patch_layer[p]);
    AddVertices(mesh, strands);
    ChunkStateBlock& state = *memory_.Of<&Streams::patch_state>(p);
    state.live_vertices = state.live_chains = mesh.vertex_count;
  }
  for (uint32_t c = 0; c < shape().chunk_count; ++c) {
    const StrandBlock& block = *memory_.Of<&Streams::strands>(c);
    strands.Add(shape().chunk_layer[c]);
    AddStrands(*memory_.Of<&Streams::halo>(c), block, strands);
    memory_.Of<&Streams::chunk_state>(c)->live_strands = block.strand_count;
  }
  carried_ = FindCarried(memory_, plan_, joints);
  for (uint32_t p = 0; p < shape().patch_count; ++p)
    *memory_.Of<&Streams::patch_state>(p) = ChunkStateBlock{};
  for (uint32_t c = 0; c < shape().chunk_count; ++c)
    *memory_.Of<&Streams::chunk_state>(c) = ChunkStateBlock{};

  StateCounter values;
  ListState(values, *this);
  value_words_ = (values.words + 3) / 4 * 4;
  snapshot_bytes_ = kHeaderBytes + 4 * value_words_;
  layout.Add(uint32_t(values.words));
  for (const CarriedBlock& block : carried_.blocks) {
    snapshot_bytes_ += 4 * uint64_t(block.words);
    layout.Add(block.words);
    if (block.item != 0) continue;
    const StreamDesc& desc = DescribeStream(block.stream);
    AddText(desc.name, layout);
    for (const RowDesc& row : desc.rows) AddText(row.name, layout);
  }
  strands_digest_ = strands.Value();
  state_layout_ = uint32_t(layout.Value());
}

namespace {

// What is copied next of the stream: a few lanes of many rows, which no hardware fetches ahead.
void FetchNext(const std::byte* row, size_t bytes) {
  for (size_t line = 0; line < bytes; line += 64) __builtin_prefetch(row + line);
}

// The first `count` of four words.
StateWords FirstOf(uint32_t count) {
  StateWords mask;
  for (uint32_t i = 0; i < 4; ++i) mask[i] = i < count ? ~0u : 0u;
  return mask;
}

}  // namespace

// Returns the sum of the words.
uint32_t FurScene::SaveBlock(const CarriedBlock& block, std::byte* to) const {
  const StreamDesc& desc = DescribeStream(block.stream);
  const std::byte* const from = memory_.Block(block.stream, block.item);
  const std::byte* const end = to + 4 * size_t(block.words);
  const uint32_t live = IsInLayer(desc.domain) ? LiveLanes(block.stream, block.item) : block.lanes;
  uint32_t single = 0;
  StateWords sum = {};
  for (const CarriedRun& run : carried_.runs[size_t(block.stream)]) {
    const uint32_t all = run.Words(block.lanes), some = std::min(all, run.Words(live));
    const uint32_t vectors = all % 4 == 0 ? (some + 3) / 4 : all / 4;
    const StateWords mask = all % 4 == 0 ? FirstOf(some - 4 * (vectors - 1)) : FirstOf(4);
    const std::byte* row = from + run.offset;
    for (uint32_t r = 0; r < run.rows; ++r, row += run.step, to += 4 * size_t(all)) {
      if (2 * 4 * some < run.step) FetchNext(row + desc.block_bytes, 4 * some);
      if (vectors != 0) sum = SaveStateWords(to, row, vectors, mask, sum);
      for (uint32_t w = 4 * vectors; w < all; ++w) {
        if (all % 4 != 0)
          single += CopyStateWord(to + 4 * w, row + 4 * w);
        else
          std::memset(to + 4 * w, 0, 4);
      }
    }
  }
  std::memset(to, 0, size_t(end - to));
  return single + SumOf(sum);
}

void FurScene::LoadBlock(const CarriedBlock& block, const std::byte* from) {
  std::byte* const to = memory_.Block(block.stream, block.item);
  for (const CarriedRun& run : carried_.runs[size_t(block.stream)]) {
    const uint32_t all = run.Words(block.lanes);
    std::byte* row = to + run.offset;
    for (uint32_t r = 0; r < run.rows; ++r, row += run.step, from += 4 * size_t(all)) {
      LoadStateVectors(row, from, all / 4);
      for (uint32_t w = all / 4 * 4; w < all; ++w) CopyStateWord(row + 4 * w, from + 4 * w);
    }
  }
}

const char* FurScene::Snapshot(std::span<std::byte> to) const {
  const BetweenFrames between(phase_);
  if (between.fault()) return between.fault();
  if (to.size() < snapshot_bytes_)
    return "there is no room for the snapshot: SnapshotBytes() says how much it needs";
  StateWriter values(to.data() + kHeaderBytes);
  ListState(values, *this);
  while ((values.to - to.data()) % 16 != 0) values.Put(0);
  Digest checksum;
  const std::byte* const first = to.data() + kHeaderBytes;
  checksum.Add(SumStateWords(first, size_t(values.to - first) / sizeof(StateWords)));
  for (const CarriedBlock& block : carried_.blocks) {
    checksum.Add(SaveBlock(block, values.to));
    values.to += 4 * size_t(block.words);
  }
  std::memset(to.data(), 0, kHeaderBytes);
  std::memcpy(to.data(), kMagic.data(), kMagic.size());
  StateWriter header(to.data() + kMagic.size());
  Header{kVersion,      kStrandsPerChunk,     snapshot_bytes_,
         state_layout_, OptionBits(options_), strands_digest_}
      .List(header);
  StateWriter sum(to.data() + kChecksumAt);
  sum.Put(uint32_t(checksum.Value()));
  sum.Put(uint32_t(checksum.Value() >> 32));
  return nullptr;
}

// A literal, or null.
const char* FurScene::FindSnapshotFault(std::span<const std::byte> from) const {
  constexpr const char* kDamaged =
      "the snapshot is damaged: its content does not match its checksum";
  if (from.size() < kHeaderBytes || std::memcmp(from.data(), kMagic.data(), kMagic.size()) != 0)
    return "the bytes are no snapshot";
  Header header;
  StateReader reader(from.data() + kMagic.size());
  header.List(reader);
  if (header.version != kVersion) return "the snapshot is of another version of Pelt";
  if (header.chunk_strands != kStrandsPerChunk)
    return "the snapshot is of a Pelt with another number of strands per chunk";
  if (header.options != OptionBits(options_))
    return "the snapshot is of a scene with other options: velocities, or origins";
  if (header.strands != strands_digest_)
    return "the snapshot is of other grooms: characters, layers or strands are not this scene's";
  if (header.layout != state_layout_ || header.bytes != snapshot_bytes_)
    return "the snapshot is of a Pelt that keeps state otherwise";
  if (from.size() < header.bytes) return "the snapshot was cut: bytes are missing at its end";
  Digest checksum;
  const std::byte* at = from.data() + kHeaderBytes;
  const auto add = [&](size_t words) {
    checksum.Add(SumStateWords(at, words / 4));
    at += 4 * words;
  };
  add(value_words_);
  for (const CarriedBlock& block : carried_.blocks) add(block.words);
  StateReader sum(from.data() + kChecksumAt);
  const uint64_t low = sum.Get();
  if (checksum.Value() != (low | uint64_t(sum.Get()) << 32)) return kDamaged;
  return FindStateFault(from);
}

// What kernels would follow: counts, and places in a layer.
const char* FurScene::FindStateFault(std::span<const std::byte> from) const {
  constexpr const char* kImpossible =
      "the snapshot holds what no scene of these grooms can: it is damaged";
  StateLooker looker(from.data() + kHeaderBytes);
  ListState(looker, *this);
  if (!looker.finite) return kImpossible;
  StateReader params(from.data() + kHeaderBytes);
  params.from += 4 * (1 + 2);  // first_frame_, last_dt_s_
  for (size_t s = 0; s < params_.size(); ++s) {
    FrameParams some;
    ListWords(params, some);
    if (!HaveRoom(some)) return kImpossible;
  }
  const std::byte* at = from.data() + kHeaderBytes + 4 * value_words_;
  for (const CarriedBlock& block : carried_.blocks) {
    const auto word = [&](size_t index) { return StateReader(at + 4 * index).Get(); };
    if (block.stream == StreamOf<&Streams::patch_state>) {
      const uint32_t vertices = memory_.Of<&Streams::patches>(block.item)->vertex_count;
      for (const size_t offset :
           {offsetof(ChunkStateBlock, live_vertices), offsetof(ChunkStateBlock, live_chains),
            offsetof(ChunkStateBlock, whole_chains)})
        if (word(offset / 4) > vertices) return kImpossible;
    } else if (block.stream == StreamOf<&Streams::lod>) {
      if (word(offsetof(LodBlock, chain_level) / 4) >= kChainLevels) return kImpossible;
    } else if (block.stream == StreamOf<&Streams::chunk_state>) {
      const StrandBlock& strands = *memory_.Of<&Streams::strands>(block.item);
      const auto is_at_most = [&](size_t offset, uint32_t most) {
        return word(offset / 4) <= most;
      };
      using S = ChunkStateBlock;
      if (!is_at_most(offsetof(S, live_strands), strands.strand_count) ||
          !is_at_most(offsetof(S, visible_strands), strands.strand_count) ||
          (word(offsetof(S, flags) / 4) &&
           word(offsetof(S, first_place) / 4) != strands.first_strand))
        return kImpossible;
    } else if (block.stream == StreamOf<&Streams::modal_tables>) {
      if (word(offsetof(ModalTableBlock, substeps) / 4) > kModalSubsteps) return kImpossible;
    }
    at += 4 * size_t(block.words);
  }
  return nullptr;
}

const char* FurScene::Restore(std::span<const std::byte> from) {
  const BetweenFrames between(phase_);
  if (between.fault()) return between.fault();
  if (const char* fault = FindSnapshotFault(from)) return fault;
  StateReader values(from.data() + kHeaderBytes);
  ListState(values, *this);
  for (ModalCourse& course : modal_) course.ForgetLayer();
  pose_gate_.ForgetRefused();
  const std::byte* at = from.data() + kHeaderBytes + 4 * value_words_;
  for (const CarriedBlock& block : carried_.blocks) {
    LoadBlock(block, at);
    at += 4 * size_t(block.words);
  }
  memory_.paused = false;
  restored_ = is_cut_ = true;
  return nullptr;
}

}  // namespace pelt
