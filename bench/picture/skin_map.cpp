#include "bench/picture/skin_map.hpp"

#include "bench/picture/body.hpp"
#include "bench/picture/picture_scene.hpp"
#include "bench/scenarios/scenarios.hpp"
#include "core/error.hpp"
#include "core/groom/flow_map.hpp"
#include "jobs/frame.hpp"

namespace pelt {

std::vector<uint8_t> MakeSkinMap(const Character& character, const FurSetup& setup,
                                 const Groom& groom, uint32_t side,
                                 std::vector<std::string>& notes) {
  Actor actor{};
  actor.clip = -1;
  actor.unit_scale = groom.unit_scale;
  Scenario scenario;
  scenario.name = setup.path;
  scenario.characters = {character};
  scenario.grooms = {groom};
  scenario.setups = {setup};
  scenario.actors = {actor};
  RunningScenario running(scenario, {});
  running.Begin(0);
  if (const char* fault = SerialExecutor().Run(running.scene().CurrentFrame()))
    throw Error(setup.path + ": " + fault);
  PictureScene shown = GatherPicture(scenario, running.scene(), {}, VertexOrder::kSorted, notes);
  Body& body = shown.bodies.front();
  JoinSeams(body);
  return MakeSkinTexels(character.mesh, side,
                        setup.path + ": skin map: ", [&](const SurfacePoint& at) {
                          return uint8_t(0.5f + 255.0f * DepthFloor(CoveredAt(body, at)));
                        });
}

}  // namespace pelt
