// What Unity or Godot would load: a shared library that has Pelt inside and shows one C function.
#include <cstdint>

#include "pelt/core/bind_pose.hpp"
#include "pelt/core/groom/groom_file.hpp"
#include "pelt/jobs/scene.hpp"

extern "C" uint64_t PluginFirstFrame(const char* groom_path);

// The digest of the README's example; 0 when anything fails.
extern "C" uint64_t PluginFirstFrame(const char* groom_path) {
  const auto groom = pelt::ReadGroomFile(groom_path);
  if (!groom) return 0;
  const pelt::Groom* grooms[] = {&*groom};
  const auto made = pelt::FurScene::Create(grooms);
  if (!made) return 0;
  const auto& scene = *made;
  pelt::FillBindPose(*groom, scene->Pose(0));
  if (scene->BeginFrame({}) || pelt::SerialExecutor().Run(scene->CurrentFrame())) return 0;
  return scene->DigestFrame();
}
