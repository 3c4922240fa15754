#include "bench/verify/replay.hpp"

#include <fmt/format.h>

#include "core/groom/groom_file.hpp"

namespace pelt {
namespace {

Result<std::vector<Groom>> ReadGrooms(const InputLog& log, const std::string& name) {
  std::vector<Groom> grooms;
  for (size_t g = 0; g < log.grooms.size(); ++g) {
    Result<Groom> groom = ReadGroom(log.grooms[g], fmt::format("{}, groom {}", name, g));
    if (!groom) return Failure{groom.error()};
    grooms.push_back(*std::move(groom));
  }
  return grooms;
}

std::vector<const Groom*> GroomOfEach(const InputLog& log, const std::vector<Groom>& grooms) {
  std::vector<const Groom*> each;
  for (const uint32_t groom : log.character_groom) each.push_back(&grooms[groom]);
  return each;
}

// What of a scene's options changes bits.
SceneOptions WithOptionsOf(const InputLog& log, SceneOptions options) {
  options.velocities = log.about.velocities;
  options.origins = log.about.origins;
  options.strand_writes = log.MostStrandWrites();
  options.vertex_order = log.about.index_buffer ? VertexOrder::kIndexBuffer : VertexOrder::kSorted;
  return options;
}

}  // namespace

Result<ReplayScene> ReplayScene::Open(const InputLog& log, const std::string& name,
                                      SceneOptions options) {
  if (log.chunk_strands != kStrandsPerChunk)
    return Failure{
        fmt::format("input log '{}': recorded with {} strands per chunk, this program has {}: "
                    "other sums, other "
                    "bits. A build with PELT_CHUNK_STRANDS={} replays it",
                    name, log.chunk_strands, kStrandsPerChunk, log.chunk_strands)};
  Result<std::vector<Groom>> grooms = ReadGrooms(log, name);
  if (!grooms) return Failure{grooms.error()};
  ReplayScene replay(log, WithOptionsOf(log, options));
  replay.grooms_ = *std::move(grooms);
  Result<std::unique_ptr<FurScene>> scene =
      FurScene::Create(GroomOfEach(log, replay.grooms_), replay.options_);
  if (!scene) return Failure{scene.error()};
  replay.scene_ = *std::move(scene);
  if (!log.snapshot.empty())
    if (const char* fault = replay.scene_->Restore(log.snapshot))
      return Failure{fmt::format("input log '{}': its snapshot: {}", name, fault)};
  return replay;
}

const char* ReplayScene::Begin(uint32_t frame) {
  for (uint32_t c = 0; c < log_.CharacterCount(); ++c) {
    log_.FillPose(frame, c, &scene_->Pose(c));
    if (PoseRateBlock* rates = scene_->PoseRates(c)) log_.FillPoseRates(frame, c, rates);
    if (double* origin = scene_->Origin(c)) log_.FillOrigin(frame, c, origin);
  }
  return scene_->BeginFrame(log_.Input(frame));
}

bool ReplayCourse::RunNext(Executor& executor) {
  const uint32_t f = result_.frames;
  const uint64_t recorded = log_.frames[f].digest;
  if (const char* fault = replay_.Begin(f)) {
    refused_ = true;
    ++result_.mismatches;
    if (!result_.first) result_.first = {f, recorded, 0, fault};
    return false;
  }
  if (const char* note = replay_.scene().NextNote(); note && result_.note.empty())
    result_.note = note;
  for (const RefusedPose& refused : replay_.scene().RefusedPoses())
    if (result_.refused_pose.empty())
      result_.refused_pose = fmt::format("frame {}: {}", f, DescribeRefusedPose(refused));
  executor.Run(replay_.scene().CurrentFrame());
  ++result_.frames;
  found_ = replay_.scene().DigestFrame();
  fold_.Add64(found_);
  result_.digest = fold_.Value();
  if (found_ == recorded) return true;
  ++result_.mismatches;
  if (!result_.first) result_.first = {f, recorded, found_, {}};
  return true;
}

ReplayResult Replay(const InputLog& log, ReplayScene& replay, Executor& executor,
                    const std::function<void(uint32_t frame)>& after_frame) {
  ReplayCourse course(log, replay);
  while (course.HasNext() && course.RunNext(executor))
    if (after_frame) after_frame(course.result().frames - 1);
  return course.result();
}

std::string DescribeReplay(const ReplayResult& result) {
  std::string held =
      result.refused_pose.empty() ? std::string() : "; not used, " + result.refused_pose;
  if (!result.note.empty()) held += "; note: " + result.note;
  if (result.Same())
    return fmt::format("SAME BITS in all {} frames, digest {:016x}{}", result.frames, result.digest,
                       held);
  const ReplayMismatch& first = *result.first;
  if (!first.refused.empty())
    return fmt::format("REFUSED: frame {} cannot run: {}", first.frame, first.refused);
  return fmt::format(
      "DIFFERENT BITS in {} of {} frames, the first is frame {}: recorded {:016x}, found "
      "{:016x}{}",
      result.mismatches, result.frames, first.frame, first.recorded, first.found, held);
}

}  // namespace pelt
