// The input log: all input of a run, so that it can be run again bit for bit, elsewhere.
//
//      header      magic "PELTINP\n", version, strands per chunk, options (bit 0: index buffer,
//                  bit 1: velocities, bit 2: origins, bit 3: snapshot, bit 4: lists), number of grooms,
//                  characters and frames, file size, hash
//      texts       scene, note
//      characters  the number of each one's groom
//      grooms      each as the bytes of a groom file, opaque here
//      snapshot    where there is one, its size and bytes (FurScene::Snapshot), opaque here: what the
//                  scene was before the first frame; else that is the scene's first
//      frames      FrameInput, weather, poses (with velocities: each followed by its own), with
//                  origins the frame's and each character's, digest: one after the other
//      colliders   from version 6 on: the number of frames in which some collider has a velocity;
//                  of each, its number and the velocities
//      lists       where there are any: the number of frames in which FrameInput's importance, cut or
//                  strands are not the last frame's; of each, its number and these, each with its length
//
// An engine records by itself, without a scenario: Begin once, AddFrame after every frame, Finish.
// What it sends can be replayed on any machine, and the recorded digests say whether that machine
// computes the same (traces/README.md).
//
// Everything is little-endian and goes through one list of fields (input_fields.hpp), floats by
// their bits; of a pose only the joints in use. A pose that is the last frame's is not written
// again, nor are its velocities. The hash covers all bytes but its own.
//
// A file is read as hostile input: a count is checked against the bytes that are left before anything
// is allocated for it, and poses stay packed as they lie in the file. The hash finds damage; it is
// not what safety rests on. Values are not judged here: FurScene::BeginFrame does.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/chunk.hpp"
#include "core/error.hpp"
#include "core/frame_input.hpp"

namespace pelt {

// 1: without capsules, 2: without lights, 3: without brushes, 4: without velocities, 5: without
// origins, a modal quality by size on the screen and velocities of colliders, 6: without a snapshot,
// 7: all chains simulated, 8: without a budget of time, 9: without lists, kinds of wind and force volumes; all still
// read.
inline constexpr uint32_t kInputLogVersion = 10;

// The joints in use of a PoseBlock.
struct PackedPose {
  uint32_t joint_count = 0, teleported = 0;
  size_t first_word = 0;  // in InputLog::pose_words
  size_t byte = 0;        // where it begins in the file
};

// The velocities of one.
struct PackedRates {
  uint32_t joint_count = 0;
  size_t first_word = 0;  // in InputLog::pose_words
};

// What of a frame's input is about layers and strands, until a later frame's.
struct InputLogLists {
  uint32_t frame = 0;
  std::vector<float> importance;
  std::vector<uint8_t> cut;
  std::vector<StrandWrite> strands;
};

struct InputLogFrame {
  FrameInput input;          // without weather and lists: see InputLog::Input
  size_t first_weather = 0;  // in InputLog::weather
  uint32_t weather_count = 0;
  uint64_t digest = 0;  // of the frame, as FurScene::DigestFrame gives it
};

// What a log says besides its frames.
struct InputLogScene {
  std::string scene;          // a name, for people
  std::string note;           // free text: settings, build, machine
  bool index_buffer = false;  // SceneOptions::vertex_order is VertexOrder::kIndexBuffer
  bool velocities = false;    // SceneOptions::velocities
  bool origins = false;       // SceneOptions::origins
};

struct InputLog {
  InputLogScene about;
  uint32_t version = 0;                        // of the program that wrote it
  uint32_t chunk_strands = 0;                  // likewise
  std::vector<std::vector<std::byte>> grooms;  // groom files
  std::vector<uint32_t> character_groom;       // of each character, into `grooms`
  std::vector<std::byte> snapshot;  // of the scene before frame 0; empty: it had run none
  std::vector<InputLogFrame> frames;
  std::vector<uint32_t> frame_pose;  // [frame][character], into `poses`
  std::vector<PackedPose> poses;     // those that differ from the frame before
  static constexpr uint32_t kNoRates = ~0u;
  // With about.velocities: [frame][character], into `rates`, or kNoRates where none were given.
  std::vector<uint32_t> frame_rates;
  std::vector<PackedRates> rates;  // those that differ from the frame before
  std::vector<double> origins;     // with about.origins: [frame][character][axis], m
  std::vector<uint32_t> pose_words;
  std::vector<Weather> weather;
  std::vector<InputLogLists> lists;  // by ascending frame
  uint64_t file_bytes = 0;

  uint32_t FrameCount() const { return uint32_t(frames.size()); }
  uint32_t CharacterCount() const { return uint32_t(character_groom.size()); }
  // Valid as long as the log.
  FrameInput Input(uint32_t frame) const;
  // What SceneOptions::strand_writes has to be for it.
  uint32_t MostStrandWrites() const;
  // Writes every byte of `pose`; joints not in use are 0.
  void FillPose(uint32_t frame, uint32_t character, PoseBlock* pose) const;
  // Of a log with about.origins; else 0.
  void FillOrigin(uint32_t frame, uint32_t character, double* origin) const;
  // The same as FillPose of its velocities; with `given` 0 where there were none.
  void FillPoseRates(uint32_t frame, uint32_t character, PoseRateBlock* block) const;
};

// The text of a failure is "input log 'name': frame 3, byte 1234: reason"; the byte counts from the
// start of the file. Holds at most twenty times the size of `bytes` in memory, and 64 KiB.
Result<InputLog> ReadInputLog(std::span<const std::byte> bytes, const std::string& name);
Result<InputLog> ReadInputLogFile(const std::string& path);

// Whether a file begins like an input log.
bool LooksLikeInputLog(std::span<const std::byte> bytes);

// Records a run, in memory, without exceptions. Not for several threads at once. A frame costs
// about 200 bytes for each joint that is in use, or 1 byte for a character that stands still. What
// fails returns the reason and changes nothing; null is success.
class InputLogWriter {
 public:
  // `character_grooms` holds the bytes of a groom file (WriteGroom) for each character; the same
  // bytes are written once. `snapshot`: of a scene that has run frames before the first one that is
  // recorded (FurScene::Snapshot). Forgets what was recorded before.
  const char* Begin(const InputLogScene& about,
                    std::span<const std::span<const std::byte>> character_grooms,
                    std::span<const std::byte> snapshot = {});

  // One frame that ran: what BeginFrame was given, the scene's poses ({&scene.Pose(0),
  // characters}), and DigestFrame() after it. With InputLogScene::velocities, also their velocities
  // ({scene.PoseRates(0), characters}); else none. With InputLogScene::origins likewise
  // {scene.Origin(0), 3 * characters}.
  const char* AddFrame(const FrameInput& input, std::span<const PoseBlock> poses, uint64_t digest,
                       std::span<const PoseRateBlock> rates = {},
                       std::span<const double> origins = {});

  uint32_t FrameCount() const { return frame_count_; }
  // The bytes of the file so far; recording may go on after it. Empty before Begin.
  std::vector<std::byte> Finish() const;

 private:
  std::vector<std::byte> bytes_, collider_bytes_;  // the latter: of frames that have velocities
  uint32_t collider_frames_ = 0;                   // how many these are
  std::vector<std::byte> list_bytes_;              // likewise, of frames whose lists are others
  uint32_t list_frames_ = 0;
  InputLogLists last_lists_;
  std::vector<std::vector<std::byte>> last_pose_, last_rates_;  // of each character, as written
  bool velocities_ = false, origins_ = false;
  uint32_t frame_count_ = 0;
};

}  // namespace pelt
