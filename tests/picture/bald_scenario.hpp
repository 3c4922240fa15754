// A character whose fur is bald in every other square of its texture, squares that are finer than its mesh. Its skin is
// unlit and shows them: green where fur grows, red where none does.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bench/picture/png.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {

inline constexpr uint32_t kBaldSide = 512, kSquares = 16;  // texels; squares along the texture

inline bool IsBaldTexel(uint32_t x, uint32_t y) {
  constexpr uint32_t kWide = kBaldSide / kSquares;
  return (x / kWide + y / kWide) % 2 == 1;
}

inline std::shared_ptr<const ControlMap> BaldMap() {
  ControlMap map{kBaldSide, kBaldSide, {}};
  for (uint32_t y = 0; y < kBaldSide; ++y)
    for (uint32_t x = 0; x < kBaldSide; ++x)
      map.rgba.insert(map.rgba.end(), 4, uint8_t(IsBaldTexel(x, y) ? 255 : 0));
  return std::make_shared<const ControlMap>(std::move(map));
}

inline std::vector<std::byte> BaldImage() {
  std::vector<uint8_t> rgb;
  for (uint32_t y = 0; y < kBaldSide; ++y)
    for (uint32_t x = 0; x < kBaldSide; ++x)
      for (const int channel : {IsBaldTexel(x, y) ? 180 : 0, IsBaldTexel(x, y) ? 0 : 180, 0})
        rgb.push_back(uint8_t(channel));
  return EncodePng(rgb, kBaldSide, kBaldSide, 3);
}

// `layer`: lines of the setup's one layer.
inline Scenario BaldScenario(const std::string& layer, bool unlit) {
  Scenario scenario = TinyScenario();
  scenario.actors.resize(1);
  scenario.actors[0].groom = 0;
  Character& character = scenario.characters[scenario.actors[0].character];
  FurSetup setup = ReadFurSetup("[[layer]]\nname = 'coat'\n" + layer, "bald", ".");
  setup.layers[0].mask.bald.map = BaldMap();
  scenario.grooms = {BakeForActor(scenario, setup)};
  scenario.setups = {setup};
  character.images = {BaldImage()};
  character.mesh.looks.assign(character.mesh.materials.size(),
                              {.stated = true, .unlit = unlit, .image = 0});
  return scenario;
}

}  // namespace pelt::testing
