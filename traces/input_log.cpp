// Reads the input log; the layout is described in input_log.hpp, the fields of a frame in
// input_fields.hpp.
#include "traces/input_log.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "core/file_bytes.hpp"
#include "core/format.hpp"
#include "traces/input_fields.hpp"
#include "traces/input_log_format.hpp"

namespace pelt {

using namespace input_log;

namespace {

constexpr std::string_view kWhat = "input log";

// Goes through the bytes. The first failure stays; after it every number is 0.
class Reader {
 public:
  Reader(std::span<const std::byte> file, const std::string& name, std::string& error)
      : file_(file), name_(name), error_(error) {}

  void Fail(size_t at, const std::string& reason) {
    if (!failed_) error_ = Format("{} '{}': {}, byte {}: {}", kWhat, name_, section_, at, reason);
    failed_ = true;
  }
  bool failed() const { return failed_; }
  // Null when they are not there.
  const std::byte* Take(uint64_t count) {
    if (count > Left()) Fail(at_, Format("{} more bytes are needed, {} are left", count, Left()));
    if (failed_) return nullptr;
    const std::byte* from = file_.data() + at_;
    at_ += count;
    return from;
  }
  template <class T>
  T Get() {
    const std::byte* from = Take(sizeof(T));
    return from ? GetNumber<T>(from) : T{};
  }
  // An archive of ListInputFields.
  template <class T>
  void operator()(const char* field, T& value) {
    if constexpr (std::is_same_v<T, double>) {
      value = std::bit_cast<double>(Get<uint64_t>());
    } else if constexpr (std::is_same_v<T, float>) {
      value = std::bit_cast<float>(Get<uint32_t>());
    } else if constexpr (std::is_same_v<T, bool>) {
      const size_t start = at_;
      const auto byte = Get<uint8_t>();
      if (byte > 1) Fail(start, Format("{} is {}, neither 0 nor 1", field, byte));
      value = byte == 1;
    } else if constexpr (std::is_array_v<T>) {
      for (auto& element : value) (*this)(field, element);
    } else {
      value = Get<T>();
    }
  }
  std::string Text() {
    const size_t start = at_;
    const auto size = Get<uint32_t>();
    if (size > kTextBytesLimit) Fail(start, Format("a text of {} bytes", size));
    const std::byte* from = Take(size);
    if (from && !IsPrintable(AsText({from, size})))
      Fail(start, "a text that holds a control character or is no UTF-8");
    return failed_ ? std::string() : std::string(AsText({from, size}));
  }
  // A count of things that take at least `least_bytes` each in what is left of the file.
  void CheckCount(size_t at, uint64_t count, uint64_t least_bytes, std::string_view what) {
    if (count > Left() / least_bytes)
      Fail(at, Format("{} {} do not fit the {} bytes that are left", count, what, Left()));
  }
  void Section(std::string section) { section_ = std::move(section); }
  size_t At() const { return at_; }
  uint64_t Left() const { return file_.size() - at_; }

 private:
  std::span<const std::byte> file_;
  const std::string& name_;
  std::string& error_;
  std::string section_ = "header";
  size_t at_ = 0;
  bool failed_ = false;
};

struct Counts {
  uint32_t grooms = 0, characters = 0, frames = 0;
  bool snapshot = false, lists = false;
};

Counts ReadHeader(Reader& reader, std::span<const std::byte> file, InputLog& log) {
  if (!LooksLikeInputLog(file)) reader.Fail(0, "not an input log");
  if (file.size() < kHeaderBytes)
    reader.Fail(0, Format("{} bytes are less than a header", file.size()));
  reader.Take(kMagic.size());
  log.version = reader.Get<uint32_t>();
  if (log.version < 1 || log.version > kInputLogVersion)
    reader.Fail(8, Format("version {}, this program reads 1 to {}", log.version, kInputLogVersion));
  Counts counts;
  log.chunk_strands = reader.Get<uint32_t>();
  const auto options = reader.Get<uint32_t>();
  counts.grooms = reader.Get<uint32_t>();
  counts.characters = reader.Get<uint32_t>();
  counts.frames = reader.Get<uint32_t>();
  log.file_bytes = reader.Get<uint64_t>();
  const auto hash = reader.Get<uint64_t>();
  if (log.file_bytes != file.size())
    reader.Fail(kFileBytesAt,
                Format("the file should have {} bytes and has {}: it was cut or extended",
                       log.file_bytes, file.size()));
  if (!reader.failed() && hash != HashOf(file))
    reader.Fail(kHashAt, "the content does not match its hash: the file is damaged");
  const uint32_t known = kWithIndexBuffer | (log.version >= 5 ? kWithVelocities : 0u) |
                         (log.version >= 6 ? kWithOrigins : 0u) |
                         (log.version >= 7 ? kWithSnapshot : 0u) |
                         (log.version >= 10 ? kWithLists : 0u);
  if (options & ~known)
    reader.Fail(kOptionsAt, Format("options are {}, version {} has none above {}", options,
                                   log.version, known));
  log.about.index_buffer = (options & kWithIndexBuffer) != 0;
  log.about.velocities = (options & kWithVelocities) != 0;
  log.about.origins = (options & kWithOrigins) != 0;
  counts.snapshot = (options & kWithSnapshot) != 0;
  counts.lists = (options & kWithLists) != 0;
  if (counts.characters == 0 || counts.characters > kCharactersLimit)
    reader.Fail(24, Format("{} characters, not 1 to {}", counts.characters, kCharactersLimit));
  if (counts.grooms == 0 || counts.grooms > counts.characters)
    reader.Fail(kGroomCountAt,
                Format("{} grooms for {} characters", counts.grooms, counts.characters));
  return counts;
}

void ReadGrooms(Reader& reader, const Counts& counts, InputLog& log) {
  reader.Section("characters");
  for (uint32_t c = 0; c < counts.characters && !reader.failed(); ++c) {
    const size_t at = reader.At();
    log.character_groom.push_back(reader.Get<uint32_t>());
    if (log.character_groom.back() >= counts.grooms)
      reader.Fail(at, Format("character {} has groom {} of {}", c, log.character_groom.back(),
                             counts.grooms));
  }
  for (uint32_t g = 0; g < counts.grooms; ++g) {
    reader.Section(Format("groom {}", g));
    const auto size = reader.Get<uint64_t>();
    const std::byte* from = reader.Take(size);
    if (reader.failed()) return;
    log.grooms.emplace_back(from, from + size);
  }
}

void ReadSnapshot(Reader& reader, InputLog& log) {
  reader.Section("snapshot");
  const size_t at = reader.At();
  const auto size = reader.Get<uint64_t>();
  const std::byte* from = reader.Take(size);
  if (size == 0) reader.Fail(at, "a snapshot of no bytes");
  if (!reader.failed()) log.snapshot.assign(from, from + size);
}

bool ReadWords(Reader& reader, size_t words, InputLog& log) {
  const std::byte* from = reader.Take(4 * words);
  if (reader.failed()) return false;
  for (size_t w = 0; w < words; ++w) log.pose_words.push_back(GetNumber<uint32_t>(from + 4 * w));
  return true;
}

void ReadPose(Reader& reader, InputLog& log) {
  PackedPose pose;
  pose.byte = reader.At();
  pose.joint_count = reader.Get<uint32_t>();
  if (pose.joint_count > kJointsPerCharacter)
    reader.Fail(pose.byte, Format("{} joints, a character has at most {}", pose.joint_count,
                                  kJointsPerCharacter));
  pose.teleported = reader.Get<uint32_t>();
  pose.first_word = log.pose_words.size();
  if (reader.failed()) return;
  if (ReadWords(reader, CountPoseWords(pose.joint_count), log)) log.poses.push_back(pose);
}

// Velocities of the pose that was just read, or is the last frame's.
void ReadRates(Reader& reader, uint32_t frame, uint32_t joint_count, InputLog& log) {
  const size_t at = reader.At();
  const auto kind = reader.Get<uint8_t>();
  const size_t characters = log.CharacterCount();
  const uint32_t before =
      frame > 0 ? log.frame_rates[log.frame_rates.size() - characters] : InputLog::kNoRates;
  if (kind == kNoRatesGiven) {
    log.frame_rates.push_back(InputLog::kNoRates);
  } else if (kind == kRatesFollow) {
    log.frame_rates.push_back(uint32_t(log.rates.size()));
    const PackedRates rates{joint_count, log.pose_words.size()};
    if (ReadWords(reader, CountPoseWords<&Streams::pose_rates>(joint_count), log))
      log.rates.push_back(rates);
  } else if (kind == kRatesUnchanged && before != InputLog::kNoRates &&
             log.rates[before].joint_count == joint_count) {
    log.frame_rates.push_back(before);
  } else {
    reader.Fail(at, Format("velocities of kind {}{}", kind,
                           kind == kRatesUnchanged ? ", and the frame before has none" : ""));
  }
}

// The counts are the last fields; older versions have fewer of them.
void CheckInputCounts(Reader& reader, const FrameInput& in, uint32_t version) {
  const struct {
    uint32_t count, most;
    const char* what;
    uint32_t since;
  } counts[] = {{in.sphere_count, kSpheresPerScene, "spheres", 1},
                {in.capsule_count, kCapsulesPerScene, "capsules", 2},
                {in.lighting.light_count, kLightsPerScene, "lights", 3},
                {in.lighting.sample_count, kIrradianceSamplesPerScene, "irradiance samples", 3},
                {in.brush_count, kBrushesPerScene, "brushes", 4},
                {in.force_count, kForceVolumesPerScene, "force volumes", 10}};
  size_t at = reader.At();
  for (const auto& c : counts) at -= version >= c.since ? 4 : 0;
  for (const auto& c : counts) {
    if (version < c.since) return;
    if (c.count > c.most)
      reader.Fail(at, Format("{} {}, a scene has at most {}", c.count, c.what, c.most));
    at += 4;
  }
}

void ReadFrame(Reader& reader, uint32_t index, InputLog& log) {
  InputLogFrame frame;
  // What they then had.
  if (log.version < 6) frame.input.lod.fast_quality_px = 0.0f;
  if (log.version < 8) frame.input.lod.least_chains = 1.0f;
  ListInputFields(reader, frame.input, log.version);
  CheckInputCounts(reader, frame.input, log.version);
  if (reader.failed()) return;
  ListCountedFields(
      [&reader](const char*, uint32_t, const char* field, auto& value) { reader(field, value); },
      frame.input);
  const uint32_t characters = log.CharacterCount();
  frame.first_weather = log.weather.size();
  frame.weather_count = reader.Get<uint32_t>();
  if (frame.weather_count != 0 && frame.weather_count != characters)
    reader.Fail(reader.At() - 4,
                Format("weather for {} of {} characters", frame.weather_count, characters));
  if (reader.failed()) return;
  for (uint32_t w = 0; w < frame.weather_count; ++w) {
    Weather weather;
    reader("wetness", weather.wetness);
    reader("dirt", weather.dirt);
    log.weather.push_back(weather);
  }
  for (uint32_t c = 0; c < characters && !reader.failed(); ++c) {
    const size_t at = reader.At();
    const auto kind = reader.Get<uint8_t>();
    if (kind == kPoseFollows) {
      log.frame_pose.push_back(uint32_t(log.poses.size()));
      ReadPose(reader, log);
    } else if (kind == kPoseUnchanged && index > 0) {
      log.frame_pose.push_back(log.frame_pose[log.frame_pose.size() - characters]);
    } else {
      reader.Fail(at, Format("a pose of kind {}{}", kind,
                             kind == kPoseUnchanged ? " in the first frame" : ""));
    }
    if (log.about.velocities && !reader.failed())
      ReadRates(reader, index, log.poses[log.frame_pose.back()].joint_count, log);
  }
  if (log.about.origins) {
    reader("origin", frame.input.origin);
    for (uint32_t place = 0; place < 3 * characters; ++place)
      reader("origin of a character", log.origins.emplace_back());
  }
  frame.digest = reader.Get<uint64_t>();
  log.frames.push_back(frame);
}

// Frames in which colliders have velocities, in their order.
void ReadColliderVelocities(Reader& reader, InputLog& log) {
  reader.Section("colliders' velocities");
  const size_t count_at = reader.At();
  const auto count = reader.Get<uint32_t>();
  constexpr uint64_t kLeastBytes = 4 + sizeof FrameInput::ground_velocity;
  reader.CheckCount(count_at, count, kLeastBytes, "frames");
  uint32_t next = 0;
  for (uint32_t i = 0; i < count && !reader.failed(); ++i) {
    const size_t at = reader.At();
    const auto frame = reader.Get<uint32_t>();
    if (frame < next || frame >= log.FrameCount())
      reader.Fail(at, Format("frame {}, not one from {} on of {}", frame, next, log.FrameCount()));
    if (reader.failed()) return;
    ListColliderVelocities(
        [&reader](const char*, uint32_t, const char* field, auto& value) { reader(field, value); },
        log.frames[frame].input);
    next = frame + 1;
  }
}

// Frames whose lists are not the last frame's, in their order.
void ReadLists(Reader& reader, InputLog& log) {
  reader.Section("lists");
  const size_t count_at = reader.At();
  const auto count = reader.Get<uint32_t>();
  reader.CheckCount(count_at, count, 4 * 4, "frames");
  if (reader.failed()) return;
  log.lists.reserve(count);
  for (uint32_t i = 0, next = 0; i < count && !reader.failed(); ++i) {
    const size_t at = reader.At();
    InputLogLists& lists = log.lists.emplace_back();
    lists.frame = reader.Get<uint32_t>();
    if (lists.frame < next || lists.frame >= log.FrameCount())
      reader.Fail(
          at, Format("frame {}, not one from {} on of {}", lists.frame, next, log.FrameCount()));
    next = lists.frame + 1;
    ListLayerLists(
        [&reader](const char* name, auto& list) {
          using Element = std::remove_reference_t<decltype(list[0])>;
          const size_t size_at = reader.At();
          const auto size = reader.Get<uint32_t>();
          reader.CheckCount(size_at, size, sizeof(Element), name);
          if (reader.failed()) return;
          list.resize(size);
          for (Element& element : list) ListElement(reader, element);
        },
        lists);
  }
}

// Of a frame without spheres, capsules, lights, brushes, force volumes, weather and poses.
uint64_t LeastFrameBytes(uint32_t characters, const InputLog& log) {
  std::vector<std::byte> input;
  Writer writer{input};
  const FrameInput nothing;
  ListInputFields(writer, nothing, log.version);
  const uint64_t origins = log.about.origins ? 24 * (1 + uint64_t(characters)) : 0;
  return input.size() + 4 + characters * (log.about.velocities ? 2 : 1) + origins + 8;
}

template <auto kRow>
void FillRows(const uint32_t* from, uint32_t joint_count, BlockOf<kRow>* block) {
  ForEachPoseRow<kRow>(joint_count, [&](size_t offset, uint32_t lanes) {
    std::memcpy(reinterpret_cast<std::byte*>(block) + offset, from, 4 * size_t(lanes));
    from += lanes;
  });
}

}  // namespace

// ---- What is in a log ---------------------------------------------------------------------------

FrameInput InputLog::Input(uint32_t frame) const {
  FrameInput input = frames[frame].input;
  input.weather =
      std::span(weather).subspan(frames[frame].first_weather, frames[frame].weather_count);
  const auto later = std::ranges::upper_bound(lists, frame, {}, &InputLogLists::frame);
  if (later == lists.begin()) return input;
  const InputLogLists& now = later[-1];
  input.importance = now.importance;
  input.cut = now.cut;
  input.strands = now.strands;
  return input;
}

uint32_t InputLog::MostStrandWrites() const {
  size_t most = 0;
  for (const InputLogLists& some : lists) most = std::max(most, some.strands.size());
  return uint32_t(most);
}

void InputLog::FillPose(uint32_t frame, uint32_t character, PoseBlock* pose) const {
  const PackedPose& packed = poses[frame_pose[size_t(frame) * CharacterCount() + character]];
  *pose = PoseBlock{};
  pose->joint_count = packed.joint_count;
  pose->teleported = packed.teleported;
  FillRows<&Streams::pose>(pose_words.data() + packed.first_word, packed.joint_count, pose);
}

void InputLog::FillOrigin(uint32_t frame, uint32_t character, double* origin) const {
  const size_t first = 3 * (size_t(frame) * CharacterCount() + character);
  for (size_t k = 0; k < 3; ++k) origin[k] = origins.empty() ? 0.0 : origins[first + k];
}

void InputLog::FillPoseRates(uint32_t frame, uint32_t character, PoseRateBlock* block) const {
  *block = PoseRateBlock{};
  if (frame_rates.empty()) return;
  const uint32_t at = frame_rates[size_t(frame) * CharacterCount() + character];
  if (at == kNoRates) return;
  const PackedRates& packed = rates[at];
  block->given = 1;
  FillRows<&Streams::pose_rates>(pose_words.data() + packed.first_word, packed.joint_count, block);
}

Result<InputLog> ReadInputLog(std::span<const std::byte> bytes, const std::string& name) {
  std::string error;
  Reader reader(bytes, name, error);
  InputLog log;
  const Counts counts = ReadHeader(reader, bytes, log);
  if (reader.failed()) return Failure{std::move(error)};
  reader.Section("texts");
  log.about.scene = reader.Text();
  log.about.note = reader.Text();
  ReadGrooms(reader, counts, log);
  if (counts.snapshot) ReadSnapshot(reader, log);
  reader.Section("frames");
  reader.CheckCount(kFrameCountAt, counts.frames, LeastFrameBytes(counts.characters, log),
                    "frames");
  if (reader.failed()) return Failure{std::move(error)};
  log.frames.reserve(counts.frames);
  log.frame_pose.reserve(size_t(counts.frames) * counts.characters);
  for (uint32_t f = 0; f < counts.frames && !reader.failed(); ++f) {
    reader.Section(Format("frame {}", f));
    ReadFrame(reader, f, log);
  }
  if (log.version >= 6 && !reader.failed()) ReadColliderVelocities(reader, log);
  if (counts.lists && !reader.failed()) ReadLists(reader, log);
  if (reader.Left() != 0)
    reader.Fail(reader.At(), Format("{} bytes behind the last frame", reader.Left()));
  if (reader.failed()) return Failure{std::move(error)};
  return log;
}

Result<InputLog> ReadInputLogFile(const std::string& path) {
  const auto bytes = ReadFileBytes(kWhat, path);
  if (!bytes) return Failure{bytes.error()};
  return ReadInputLog(*bytes, path);
}

bool LooksLikeInputLog(std::span<const std::byte> bytes) {
  return AsText(bytes).substr(0, kMagic.size()) == kMagic;
}

}  // namespace pelt
