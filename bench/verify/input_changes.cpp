// Every number of the input, listed.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <type_traits>
#include <utility>

#include "bench/verify/checks.hpp"
#include "traces/input_fields.hpp"
#include "traces/input_log_format.hpp"

namespace pelt {
namespace {

// A number added to a frame's input is listed in input_fields.hpp or below, or this does not
// compile.
[[maybe_unused]] void EveryInputIsListed(const FrameInput& in) {
  [[maybe_unused]] const auto& [dt, time, origin, camera, wind, gravity, use_ground, ground,
                                ground_speed, spheres, sphere, sphere_speed, capsules, capsule,
                                weather, importance, cut, strands, lighting, brushes, brush, forces,
                                force, lod, skip] = in;
  [[maybe_unused]] const auto& [of_layer, strand, base, tip, width, strip] = StrandWrite{};
  [[maybe_unused]] const auto& [centre, brush_radius, hardness, channel, amount] = brush[0];
  [[maybe_unused]] const auto& [from, to, radius, character, joint, from_speed, to_speed] =
      capsule[0];
  [[maybe_unused]] const auto& [force_at, half, shape, kind, towards, strength, edge, whose, its] =
      force[0];
  [[maybe_unused]] const auto& [lights, samples, light, sample, sun, sun_rgb, rim, rim_rgb,
                                exponent] = lighting;
  [[maybe_unused]] const auto& [light_at, light_radius, rgb, range] = light[0];
  [[maybe_unused]] const auto& [sample_at, falloff, sky, below, above] = sample[0];
  static_assert(sizeof(camera) == 14 * sizeof(float));  // its eye has two names, and so no binding
  [[maybe_unused]] const auto& [velocity, gusts, period, turbulence, scale, course] = wind;
  [[maybe_unused]] const auto& [detail, least, hysteresis, fade, chains, budget, fast, micros,
                                worst, costs] = lod;
  [[maybe_unused]] const auto& [of_chunk, of_vertex, of_strand, of_node] = costs;
  [[maybe_unused]] const auto& [sleep, unmoved, sort, cull, wind_too, light_too, lod_too] = skip;
  [[maybe_unused]] const auto& [wetness, dirt] = Weather{};
}

template <class T>
void Change(T& value, Amount amount) {
  if constexpr (std::is_same_v<T, bool>) {
    value = !value;
  } else if constexpr (std::is_integral_v<T>) {
    value += amount == Amount::kMuch ? 1 + value / 2 : 1;
  } else if (amount == Amount::kOneUlp) {
    value = std::nextafter(value, std::numeric_limits<T>::infinity());
  } else if (amount == Amount::kBelowFloat) {
    value += value * T(0x1p-27);
  } else {
    constexpr T kShare[] = {T(0), T(1), T(0.05), T(0.0005)};
    value += (T(0.5) * std::abs(value) + T(0.05)) * kShare[size_t(amount)];
  }
}

template <class T>
constexpr InputChange::Type TypeOf() {
  if (std::is_same_v<T, double>) return InputChange::Type::kDouble;
  if (std::is_same_v<T, bool>) return InputChange::Type::kOneWay;
  return std::is_integral_v<T> ? InputChange::Type::kWhole : InputChange::Type::kFloat;
}

// An archive of ListInputFields, and of what stands beside it: notes every number's name, or
// changes one of them.
class Numbers {
 public:
  struct Name {
    std::string text;
    InputChange::Type type;
  };
  explicit Numbers(std::vector<Name>* names) : names_(names) {}
  Numbers(size_t change, Amount amount) : change_(change), amount_(amount) {}

  template <class T>
  void operator()(const std::string& name, T& value) {
    if constexpr (std::is_array_v<T>) {
      for (size_t i = 0; i < std::extent_v<T>; ++i)
        (*this)(fmt::format("{}[{}]", name, i), value[i]);
    } else {
      if (names_) names_->push_back({name, TypeOf<T>()});
      if (at_++ == change_) Change(value, amount_);
    }
  }

 private:
  std::vector<Name>* names_ = nullptr;
  size_t at_ = 0, change_ = ~size_t(0);
  Amount amount_{};
};

void Visit(Numbers& numbers, FrameInput& in, std::vector<Weather>& weather) {
  // First: one of the counts, which are among the fields, may be the number that changes.
  const auto counted = [&](const char* what, uint32_t i, const char* field, auto& value) {
    numbers(fmt::format("{} {}{}{}", what, i, *field ? " " : "", field), value);
  };
  ListCountedFields(counted, in);
  ListColliderVelocities(counted, in);
  ListInputFields(numbers, in);
  for (size_t c = 0; c < weather.size(); ++c) {
    numbers(fmt::format("wetness of character {}", c), weather[c].wetness);
    numbers(fmt::format("dirt of character {}", c), weather[c].dirt);
  }
}

InputChange::Part PartOf(const std::string& name) {
  if (name.starts_with("skip.")) return InputChange::Part::kSkip;
  if (name.starts_with("lod.")) return InputChange::Part::kLod;
  for (const char* light : {"light ", "irradiance ", "sun.", "rim."})
    if (name.starts_with(light)) return InputChange::Part::kLights;
  return InputChange::Part::kFrame;
}

void AddFrameInputs(const FrameInput& input, std::vector<InputChange>& changes) {
  std::vector<Numbers::Name> names;
  Numbers lister(&names);
  FrameInput copy = input;
  std::vector<Weather> weather(input.weather.begin(), input.weather.end());
  Visit(lister, copy, weather);
  const auto kept = std::make_shared<std::vector<Weather>>();
  for (size_t n = 0; n < names.size(); ++n) {
    const std::string& name = names[n].text;
    if (name == "skip.cull" || name == "skip.lod") continue;
    changes.push_back(
        {name, PartOf(name), names[n].type, [n, kept](FrameInput& in, FurScene&, Amount a) {
           kept->assign(in.weather.begin(), in.weather.end());
           Numbers changer(n, a);
           Visit(changer, in, *kept);
           in.weather = *kept;
         }});
  }
}

std::string NameOfPoseWord(size_t offset_bytes) {
  for (const RowDesc& row : DescribeStream(StreamOf<&Streams::pose>).rows)
    if (offset_bytes >= row.offset_bytes &&
        offset_bytes < row.offset_bytes + 4 * row.element_count) {
      const size_t element = (offset_bytes - row.offset_bytes) / 4;
      return row.element_count == row.lane_count
                 ? fmt::format("{}[{}]", row.name, element)
                 : fmt::format("{}[{}], joint {}", row.name, element / row.lane_count,
                               element % row.lane_count);
    }
  return fmt::format("byte {}", offset_bytes);
}

void AddPoseWord(uint32_t character, size_t offset, InputChange::Type type,
                 std::vector<InputChange>& changes) {
  changes.push_back({fmt::format("pose of character {}, {}", character, NameOfPoseWord(offset)),
                     InputChange::Part::kPose, type,
                     [character, offset](FrameInput&, FurScene& scene, Amount amount) {
                       auto* at = reinterpret_cast<std::byte*>(&scene.Pose(character)) + offset;
                       float value;
                       std::memcpy(&value, at, 4);
                       Change(value, amount);
                       std::memcpy(at, &value, 4);
                     }});
}

// Each of the joints turns and does nothing else, about one axis or another.
void AddTurns(const std::set<std::pair<uint32_t, uint32_t>>& joints,
              std::vector<InputChange>& changes) {
  for (const auto& [character, joint] : joints)
    changes.push_back({fmt::format("joint {} of character {} turned", joint, character),
                       InputChange::Part::kPose, InputChange::Type::kOneWay,
                       [c = character, j = joint](FrameInput&, FurScene& scene, Amount) {
                         for (auto& key : scene.Pose(c).rotation_key) key[j % 3][j] += 0.1f;
                       }});
}

// Its origin by as much as floats have not exactly, and its pose back: a shift, and its rounding.
void AddOrigins(const FurScene& scene, std::vector<InputChange>& changes) {
  if (!(scene.shape().layer_kind[0] & kLayerApart)) return;
  for (uint32_t c = 0; c < scene.shape().character_count; ++c)
    changes.push_back({fmt::format("origin of character {}", c), InputChange::Part::kFrame,
                       InputChange::Type::kOneWay, [c](FrameInput&, FurScene& s, Amount) {
                         constexpr double kBy = 0.1;
                         s.Origin(c)[c % 3] += kBy;
                         s.Pose(c).root[4 * (c % 3) + 3] -= float(kBy);
                       }});
}

void AddPoses(const FurScene& scene, std::vector<InputChange>& changes) {
  const SceneShape& shape = scene.shape();
  uint32_t row = 0;
  size_t first_joint_row = 0;
  std::set<std::pair<uint32_t, uint32_t>> moved;  // character, joint
  const uint32_t joints = scene.memory().Of<&Streams::pose>(0)->joint_count;
  input_log::ForEachPoseRow(joints, [&](size_t offset, uint32_t lanes) {
    const uint32_t turn = row++;
    if (lanes != joints)  // not one a joint: the placement
      for (uint32_t lane = 0; lane < lanes; ++lane)
        AddPoseWord(lane % shape.character_count, offset + 4 * lane, InputChange::Type::kFloat,
                    changes);
    if (lanes != joints) return;
    if (moved.empty()) first_joint_row = offset;
    const uint32_t layer = turn % shape.layer_count;
    const auto& moved_by = *scene.memory().Of<&Streams::layer_joints>(layer);
    if (moved_by.count == 0) return;
    const uint32_t joint = moved_by.joint[turn / shape.layer_count % moved_by.count];
    moved.insert({shape.layer_character[layer], joint});
    AddPoseWord(shape.layer_character[layer], offset + 4 * joint, InputChange::Type::kFloat,
                changes);
  });
  for (uint32_t l = 0; l < shape.layer_count; ++l) {
    const auto& moved_by = *scene.memory().Of<&Streams::layer_joints>(l);
    for (uint32_t j = 0; j < moved_by.count; ++j)
      if (moved.insert({shape.layer_character[l], moved_by.joint[j]}).second)
        AddPoseWord(shape.layer_character[l], first_joint_row + 4 * moved_by.joint[j],
                    InputChange::Type::kOneWay, changes);
  }
  AddTurns(moved, changes);
  for (uint32_t c = 0; c < std::min(shape.character_count, 2u); ++c)
    changes.push_back({fmt::format("character {} teleported", c), InputChange::Part::kPose,
                       InputChange::Type::kOneWay,
                       [c](FrameInput&, FurScene& s, Amount) { s.Pose(c).teleported = 1; }});
}

// A sphere more, around one that stands there already and a quarter larger; the last one gone. The
// same of capsules.
void AddColliders(const FrameInput& input, std::vector<InputChange>& changes) {
  for (uint32_t s = 0; s < input.sphere_count && input.sphere_count < kSpheresPerScene; ++s)
    changes.push_back({fmt::format("a sphere more, around sphere {}", s), InputChange::Part::kFrame,
                       InputChange::Type::kOneWay, [s](FrameInput& in, FurScene&, Amount) {
                         std::copy_n(in.sphere[s], 4, in.sphere[in.sphere_count]);
                         in.sphere[in.sphere_count++][3] *= 1.25f;
                       }});
  if (input.sphere_count > 0)
    changes.push_back({"a sphere less", InputChange::Part::kFrame, InputChange::Type::kOneWay,
                       [](FrameInput& in, FurScene&, Amount) { --in.sphere_count; }});
  for (uint32_t c = 0; c < input.capsule_count && input.capsule_count < kCapsulesPerScene; ++c)
    changes.push_back({fmt::format("a capsule more, around capsule {}", c),
                       InputChange::Part::kFrame, InputChange::Type::kOneWay,
                       [c](FrameInput& in, FurScene&, Amount) {
                         in.capsule[in.capsule_count] = in.capsule[c];
                         in.capsule[in.capsule_count++].radius *= 1.25f;
                       }});
  if (input.capsule_count > 0)
    changes.push_back({"a capsule less", InputChange::Part::kFrame, InputChange::Type::kOneWay,
                       [](FrameInput& in, FurScene&, Amount) { --in.capsule_count; }});
}

// Lights that leave: what is behind the last of them is nothing.
void AddLights(const FrameInput& input, std::vector<InputChange>& changes) {
  const auto add = [&](const char* name, uint32_t Lighting::*count) {
    if (input.lighting.*count > 0)
      changes.push_back({name, InputChange::Part::kLights, InputChange::Type::kOneWay,
                         [count](FrameInput& in, FurScene&, Amount) { --(in.lighting.*count); }});
  };
  add("a light less", &Lighting::light_count);
  add("an irradiance sample less", &Lighting::sample_count);
}

// A large sphere that comes over an edge of a layer's box, along two axes at once, as far as its middle.
void AddOverEdges(const FrameInput& input, const FurScene& scene,
                  std::vector<InputChange>& changes) {
  if (input.sphere_count == kSpheresPerScene) return;
  for (uint32_t l = 0; l < scene.shape().layer_count; ++l) {
    if (!(scene.memory().Of<&Streams::layers>(l)->flags & kLayerSimulate)) continue;
    const BoundsBlock box = *scene.memory().Of<&Streams::bounds>(l);
    const std::array<double, 3> from = scene.OriginOfLayer(l);
    changes.push_back({fmt::format("a sphere over an edge of layer {}", l),
                       InputChange::Part::kFrame, InputChange::Type::kOneWay,
                       [box, from, l](FrameInput& in, FurScene&, Amount) {
                         constexpr float kDiagonal = 0.70710678f;
                         float* sphere = in.sphere[in.sphere_count++];
                         float half = 0.0f;
                         for (int axis = 0; axis < 3; ++axis)
                           half = std::max(half, 0.5f * (box.high[axis] - box.low[axis]));
                         sphere[3] = 4.0f * half;
                         for (int axis = 0; axis < 3; ++axis) {
                           const float middle = 0.5f * (box.low[axis] + box.high[axis]);
                           const bool along = axis != int(l % 3);
                           sphere[axis] = middle + float(from[size_t(axis)]) +
                                          (along ? 0.95f * kDiagonal * sphere[3] : 0.0f);
                         }
                       }});
  }
}

constexpr float kTooWeak = 1.0e-20f;  // m/s, or m/s^2: moves no bit

// Wind has a chunk awake because it blows, not because it changed. One too weak to move a bit lets
// every step give back its state, as in a long constant wind: only then is that rule looked at.
void AddWind(std::vector<InputChange>& changes) {
  constexpr float kStrong = 5.0f;  // m/s
  const auto blow = [](FrameInput& in, float speed) {
    in.wind = {};
    in.wind.velocity[0] = speed;
  };
  changes.push_back({"wind that blew already", InputChange::Part::kFrame,
                     InputChange::Type::kOneWay,
                     [blow](FrameInput& in, FurScene&, Amount) { blow(in, kStrong); },
                     [blow](FrameInput& in) { blow(in, kTooWeak); }});
}

// Layers that are switched off or matter less, strands that are cut off, and one that is written.
void AddLists(const FurScene& scene, std::vector<InputChange>& changes) {
  const SceneShape& shape = scene.shape();
  const auto add = [&](std::string name, InputChange::Part part, auto list, auto member) {
    const auto kept = std::make_shared<decltype(list)>(std::move(list));
    changes.push_back({std::move(name), part, InputChange::Type::kOneWay,
                       [kept, member](FrameInput& in, FurScene&, Amount) { in.*member = *kept; }});
  };
  for (uint32_t l = 0; l < shape.layer_count; ++l) {
    std::vector<float> importance(shape.layer_count, 1.0f);
    importance[l] = 0.0f;
    add(fmt::format("layer {} off", l), InputChange::Part::kFrame, importance,
        &FrameInput::importance);
    importance[l] = 0.25f;
    add(fmt::format("layer {} less important", l), InputChange::Part::kLod, importance,
        &FrameInput::importance);
    if (shape.layer_kind[l] & kLayerShells) continue;
    add(fmt::format("a strand of layer {} written", l), InputChange::Part::kFrame,
        std::vector<StrandWrite>{{l, 0, 0xff2040ff, 0xffff8000, 0.001f, 1}}, &FrameInput::strands);
  }
  std::vector<uint8_t> cut(size_t(kStrandsPerChunk) * shape.chunk_count);
  for (size_t place = 0; place < cut.size(); place += 3) cut[place] = 1;
  add("strands cut off", InputChange::Part::kFrame, std::move(cut), &FrameInput::cut);
}

// In each layer one of: a volume that comes and goes, one that was there already and pulls more, one on a joint.
void AddForces(const FurScene& scene, std::vector<InputChange>& changes) {
  for (uint32_t l = 0; l < scene.shape().layer_count; ++l) {
    if (!(scene.memory().Of<&Streams::layers>(l)->flags & kLayerSimulate)) continue;
    const BoundsBlock& box = *scene.memory().Of<&Streams::bounds>(l);
    const std::array<double, 3> from = scene.OriginOfLayer(l);
    ForceVolume force;
    force.kind = l % 2;
    force.shape = l / 2 % 2;
    force.character = scene.shape().layer_character[l];
    if (l % 3 == 2) force.joint = scene.memory().Of<&Streams::layer_joints>(l)->joint[0];
    for (size_t k = 0; k < 3; ++k) {
      const double middle = 0.5 * (double(box.low[k]) + double(box.high[k])) + from[k];
      force.centre[k] = l % 3 == 2 ? 0.0f : float(middle);
      force.half[k] = 0.3f * (box.high[k] - box.low[k]) + 1.0e-3f;
    }
    const auto pull = [force](FrameInput& in, float strength) {
      in.force[0] = force;
      in.force[0].strength = strength;
      in.force_count = 1;
    };
    changes.push_back({fmt::format("a force volume in layer {}", l), InputChange::Part::kFrame,
                       InputChange::Type::kOneWay,
                       [pull](FrameInput& in, FurScene&, Amount) { pull(in, 5.0f); }});
    if (l % 3 == 1) changes.back().around = [pull](FrameInput& in) { pull(in, kTooWeak); };
  }
}

// The camera looks along an axis and moves across it: no strand's depth changes, so no sort key
// does, and what faces the camera does all the same. So little that none turns its back.
void AddEye(std::vector<InputChange>& changes) {
  const auto along_z = [](FrameInput& in) {
    Camera& c = in.camera;
    const float distance =
        std::hypot(c.eye[0] - c.target[0], c.eye[1] - c.target[1], c.eye[2] - c.target[2]);
    for (int i = 0; i < 3; ++i) {
      c.eye[i] = c.target[i] + (i == 2 ? distance : 0.0f);
      c.up[i] = i == 1 ? 1.0f : 0.0f;
    }
  };
  for (const int axis : {0, 1})
    changes.push_back({fmt::format("eye and target[{}]", axis), InputChange::Part::kFrame,
                       InputChange::Type::kOneWay,
                       [axis](FrameInput& in, FurScene&, Amount) {
                         Camera& c = in.camera;
                         const float across = 1.0e-5f * (c.eye[2] - c.target[2]);
                         c.eye[axis] += across;
                         c.target[axis] = c.eye[axis];
                       },
                       along_z});
}

// Fewer strands live, by whole groups of lanes in every chunk of a layer, and none that stays changes:
// only the keys of those that left say that the layer is to be sorted again.
void AddThinning(const FrameInput& input, const FurScene& scene,
                 std::vector<InputChange>& changes) {
  const SceneShape& shape = scene.shape();
  const auto settle = [](FrameInput& in) {
    LodSettings& lod = in.lod;
    lod.fade_share = lod.hysteresis = 0.0f;
    lod.strand_budget = lod.budget_us = 0;
  };
  for (uint32_t l = 0; l < shape.layer_count; ++l) {
    const uint32_t first = shape.layer_first_chunk[l], end = shape.layer_first_chunk[l + 1];
    if (!input.skip.lod || end != first + 1) continue;
    const auto& state = *scene.memory().Of<&Streams::chunk_state>(first);
    if (state.live_strands <= kLaneGroup) continue;
    const uint32_t left = (state.live_strands - 1) / kLaneGroup * kLaneGroup;
    // Half a strand less, which is rounded up.
    const float share =
        (float(left) - 0.5f) / float(scene.memory().Of<&Streams::strands>(first)->strand_count);
    changes.push_back({fmt::format("layer {} thinned to {} strands", l, left),
                       InputChange::Part::kLod, InputChange::Type::kOneWay,
                       [share](FrameInput& in, FurScene&, Amount) {
                         in.lod.min_fraction = share;
                         in.lod.full_detail_px = 1.0e9f;
                       },
                       settle});
  }
}

}  // namespace

std::string_view AmountName(Amount amount) {
  return amount == Amount::kOneUlp       ? "one ulp"
         : amount == Amount::kBelowFloat ? "less than a float's ulp"
                                         : "a lot";
}

std::vector<InputChange> ListInputChanges(const FrameInput& input, const FurScene& scene) {
  std::vector<InputChange> changes;
  AddFrameInputs(input, changes);
  changes.push_back({"dt_s 0: a pause", InputChange::Part::kFrame, InputChange::Type::kOneWay,
                     [](FrameInput& in, FurScene&, Amount) { in.dt_s = 0.0; }});
  AddColliders(input, changes);
  AddLights(input, changes);
  AddOverEdges(input, scene, changes);
  AddOrigins(scene, changes);
  AddWind(changes);
  AddForces(scene, changes);
  AddEye(changes);
  AddThinning(input, scene, changes);
  AddLists(scene, changes);
  AddPoses(scene, changes);
  return changes;
}

}  // namespace pelt
