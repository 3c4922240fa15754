// The fur setup: what the artist wrote, as read from TOML. Values are in metres, degrees and
// seconds as the artist typed them; nothing is derived here.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/character/character.hpp"
#include "core/groom/strand_texture.hpp"
#include "core/surroundings.hpp"

namespace pelt {

// An 8-bit picture that scales an attribute over the surface. Rows from the top, as glTF's UV
// origin.
struct ControlMap {
  uint32_t width = 0, height = 0;
  std::vector<uint8_t> rgba;
  // Bilinear; channel 0..3; result in [0, 1].
  float Sample(glm::vec2 uv, int channel, const std::array<Wrap, 2>& wrap = {}) const;
  // Of the nearest texel alone, for maps of which of several things is where.
  float Nearest(glm::vec2 uv, int channel, const std::array<Wrap, 2>& wrap = {}) const;
};

// Decodes a PNG, of any bit depth, or a JPEG of 1..8192 pixels a side; grey fills r, g and b. Throws pelt::Error
// with `name` and the reason.
ControlMap ReadControlMap(std::span<const uint8_t> png, const std::string& name);
ControlMap ReadControlMapFile(const std::string& path);

// One channel of a control map, and what its 0 and its 1 stand for; no map means 1 everywhere.
struct MapChannel {
  std::shared_ptr<const ControlMap> map;
  int channel = 0;
  float low = 0.0f, high = 1.0f;

  float At(const glm::vec2& uv, const std::array<Wrap, 2>& wrap = {}) const {
    return low + (high - low) * map->Sample(uv, channel, wrap);
  }
};

// A value that varies: value * map, then * (1 + randomise * u), u uniform in [-1, 1] by strand;
// clamped to [low, high] where a range is given.
struct Attribute {
  float value = 0.0f;
  float randomise = 0.0f;
  std::optional<glm::vec2> range;
  MapChannel map;
  Attribute() = default;
  Attribute(float constant) : value(constant) {}
};

// Where a layer grows when the mesh has no UVs (or besides them): all that are given are
// multiplied.
struct Mask {
  std::vector<std::string> materials;  // empty: all that are not bare (MaterialLook)
  struct JointWeight {
    std::string joint;
    bool subtree = true;            // the joint's descendants count too
    float low = 0.0f, high = 1.0f;  // smooth ramp of the summed weight
  };
  std::vector<JointWeight> joints;  // the largest counts; empty: all
  struct Box {  // box projection: a map projected along an axis of the rest pose's bounding box
    char axis = 'y';
    MapChannel map;
  };
  std::optional<Box> box;
  struct Range {  // share of the rest bounding box, each axis 0..1
    glm::vec3 low{0.0f}, high{1.0f};
  };
  std::optional<Range> range;
  struct AwayFrom {  // a margin about eyes, a nose: no root is that near, in the rest pose
    std::vector<std::string> materials;
    float distance = 0.02f;  // m
  };
  std::optional<AwayFrom> away_from;
  MapChannel uv;    // stencil: density scale; needs UVs
  MapChannel bald;  // 1 = bald; needs UVs
  // No fur where the surface, which is the image of its material if it has one, has one of these colours, 0xAABBGGRR,
  // in sRGB. No channel differs by more than the tolerance there, as a share of its range.
  std::vector<uint32_t> colours;
  float colour_tolerance = 0.06f;
};

// A picture over the surface that says which way fur lies. Red and green: from root to tip, along u and v, 128 is 0, as
// FlowMap has them.
enum class FlowBlue : uint8_t { kUp, kLength, kUnused };
struct FlowMapSetup {
  MapChannel picture;  // of which every channel is read
  // Up the normal, 128 is 0, and the three are a vector; or the length, over `longest`, of a map with sheets as FlowMap
  // has them. But for kUp, what red and green lack of a vector of unit length goes up.
  FlowBlue blue = FlowBlue::kUp;
  float longest = 0.0f;  // m
};

struct CombVector {
  glm::vec3 position;   // rest pose, m
  glm::vec3 direction;  // rest pose; need not be unit
  float reach = 0.1f;   // m
};

struct LayerSetup {
  std::string name;
  uint64_t seed = 1;
  LayerParams params;
  float density = 1.0e5f;  // strands per square metre where every map is 1
  MapChannel density_map;
  float density_randomise = 0.0f;          // by mesh triangle: density * (1 + randomise * u)
  std::optional<glm::vec2> density_range;  // clamps the density after map and randomise
  uint32_t max_strands = 0;                // 0: density alone decides
  Mask mask;
  Attribute offset;            // of the skin, along the normal, m
  Attribute offset_tip;        // of the tip besides, m; the strand is as long as it then is
  Attribute length{0.03f};     // m
  Attribute width{0.0004f};    // m
  Attribute direction;         // turn about the normal, degrees
  Attribute curl;              // degrees per metre of strand, bending
  Attribute twist;             // degrees per metre of strand, about its own axis
  Attribute azimuth;           // groom direction about the normal from the tangent, degrees
  Attribute elevation{45.0f};  // above the surface, degrees: 90 stands up
  Attribute frizz;             // root frizz: random tilt at the root, degrees
  Attribute strength{1.0f};    // simulation strength, 0..1
  // What strands have of their own (StrandTraits).
  Attribute stiffness_scale{1.0f}, damping_scale{1.0f}, clump_scale{1.0f}, weight_scale{1.0f},
      bounce_scale{1.0f};
  Attribute angle_limit{180.0f};        // degrees
  std::vector<float> hardness_profile;  // factor on each joint's hardness, root first; empty: 1
  std::vector<CombVector> comb;
  float comb_normal_weight = 0.5f;  // how strongly a differing normal weakens a comb vector, 0..1
  std::string comb_joint;  // outside every reach: along this joint's direction; empty: azimuth and
                           // elevation
  // Outside every reach: a direction in the root frame, of any length, in place of azimuth and elevation.
  std::optional<glm::vec3> direction_vector;
  // Outside every reach, where it is painted, in place of all others.
  std::optional<FlowMapSetup> flow_map;
  glm::vec3 direction_range{0.0f};  // added to the unit direction, each times a number in [-1, 1]
  glm::vec3 curl_profile{1.0f, 0.0f, 0.0f};  // curl at a share t: times x + y t + z t^2
  float segment_length = 0.0f;   // of chains at vertices, m; 0: a third of their mean strand
  uint32_t clump_controls = 16;  // control strands per chunk (rounded up to 16)
  // 0xAABBGGRR. Alpha 0: the setup says none, and the surface's own colour is taken, if it has one.
  uint32_t base_colour = 0x00303850, tip_colour = 0x0090a0c0;
  Attribute colour_variation;                  // random brightness, share
  MapChannel colour_map;                       // rgb multiplies both colours
  MapChannel base_colour_map, tip_colour_map;  // rgb multiplies one of them
  uint32_t film_strip_count = 1;  // index is picked below it: by type_map, or at random
  MapChannel type_map;
  std::shared_ptr<const ControlMap> strand_texture;  // of that many strips, side by side
  StrandChannels strand_channels = StrandChannels::kLook;
};

// How a strand differs from its layer in how it moves: factors, and how far a link may bend, degrees; 180: any.
struct StrandTraits {
  float stiffness = 1.0f, damping = 1.0f, clump = 1.0f, weight = 1.0f, bounce = 1.0f;
  float angle_limit = 180.0f;
};

// An attribute that every strand (or mesh vertex) has a value of: its key, and where the value
// goes.
struct StrandAttribute {
  Attribute LayerSetup::*member;
  std::string_view key, unit;
  double low, high;  // inclusive, of `value` and `range`
  std::string_view text;
  KeyGroup group;
  // What its random numbers are drawn by: a number of its own, and part of what a groom looks like,
  // never changed.
  uint64_t random;
  // Where each strand's value is stored, within the bounds of that member's row; null: it shapes
  // the strand (attributes.cpp).
  float (StrandBlock::*stored)[kStrandsPerChunk] = nullptr;
  // Or where it goes in the strand's traits, within the bounds above.
  float StrandTraits::*trait = nullptr;
};

namespace strand_attributes_detail {

using L = LayerSetup;
inline constexpr double kDegrees = 360.0;
inline constexpr double kBend = 1.0e5;  // degrees per metre: a full turn in 3.6 mm

// clang-format off
inline constexpr StrandAttribute kEntries[] = {
    {&L::offset, "offset", "m", -1, 1, "root above the skin, along the normal",
     KeyGroup::kLook, 1},
    {&L::offset_tip, "offset_tip", "m", -1, 1,
     "tip above where it would be, along the normal; the strand is as long as it then is",
     KeyGroup::kLook, 40},
    {&L::length, "length", "m", 1e-4, 10, "root to tip along the strand", KeyGroup::kLook, 2},
    {&L::width, "width", "m", 1e-6, 0.1, "at the root", KeyGroup::kLook, 3, &StrandBlock::width},
    {&L::direction, "direction", "degrees", -kDegrees, kDegrees,
     "turns the groomed direction about the normal", KeyGroup::kLook, 4},
    {&L::curl, "curl", "degrees/m", -kBend, kBend, "bending along the strand", KeyGroup::kLook, 5},
    {&L::twist, "twist", "degrees/m", -kBend, kBend,
     "turning of the bend about the strand's own axis", KeyGroup::kLook, 6},
    {&L::azimuth, "azimuth", "degrees", -kDegrees, kDegrees,
     "groomed direction about the normal, from the tangent", KeyGroup::kLook, 7},
    {&L::elevation, "elevation", "degrees", -90, 90, "above the surface; 90 stands up",
     KeyGroup::kLook, 8},
    {&L::frizz, "frizz", "degrees", 0, 90, "random tilt at the root", KeyGroup::kLook, 9},
    {&L::colour_variation, "colour_variation", "", 0, 1, "random brightness, a share",
     KeyGroup::kLook, 11},
    {&L::strength, "strength", "", 0, 1, "of the simulation; 0 follows the skin",
     KeyGroup::kMotion, 10},
    {&L::stiffness_scale, "stiffness_scale", "", 0, 10,
     "pbd, verlet: factor on the strand's hardness or stiffness", KeyGroup::kMotion, 15, nullptr,
     &StrandTraits::stiffness},
    {&L::damping_scale, "damping_scale", "", 0, 10,
     "pbd, verlet: factor on the strand's velocity_damping", KeyGroup::kMotion, 16, nullptr,
     &StrandTraits::damping},
    {&L::clump_scale, "clump_scale", "", 0, 10, "factor on the strand's clump, up to 1",
     KeyGroup::kMotion, 17, nullptr, &StrandTraits::clump},
    {&L::weight_scale, "weight_scale", "", 0, 10, "factor on the strand's weight",
     KeyGroup::kMotion, 18, nullptr, &StrandTraits::weight},
    {&L::bounce_scale, "bounce_scale", "", 0, 10, "factor on the strand's bounce, up to 1",
     KeyGroup::kMotion, 19, nullptr, &StrandTraits::bounce},
    {&L::angle_limit, "angle_limit", "degrees", 1, 180,
     "pbd, verlet: how far a link may bend from the groom, against the link above it; 180: any",
     KeyGroup::kMotion, 20, nullptr, &StrandTraits::angle_limit},
};
// clang-format on

}  // namespace strand_attributes_detail

inline constexpr std::span<const StrandAttribute> kStrandAttributes =
    strand_attributes_detail::kEntries;
// Its place in kStrandAttributes.
constexpr size_t PlaceOf(Attribute LayerSetup::*member) {
  size_t place = 0;
  while (kStrandAttributes[place].member != member) ++place;
  return place;
}

// Whether strands of the layer have traits: it says so, or a key does that gives them.
bool HasTraits(const LayerSetup& layer);
// A key of theirs that the layer's solver or output cannot keep.
std::optional<BadKey> FindBadTrait(const LayerSetup& layer);

// The lights that a fur setup brings along, as read from its [lights]; in the world, metres. Nothing is derived here
// but directions of unit length. Colours are linear: what they mean is described in core/surroundings.hpp.
struct LightsSetup {
  struct Light {
    glm::vec3 position{0.0f};
    float radius = 0.0f;
    glm::vec3 colour{1.0f};
    float range = 0.0f;
  };
  struct Sample {
    glm::vec3 position{0.0f};
    float falloff = 1000.0f;
    glm::vec3 sky{0.0f}, ground{0.0f};
    glm::vec3 up{0.0f, 1.0f, 0.0f};
  };
  struct Sun {
    glm::vec3 direction{0.0f, 1.0f, 0.0f};
    glm::vec3 colour{0.0f};
  };
  struct Rim {
    glm::vec3 direction{0.0f, 1.0f, 0.0f};
    glm::vec3 colour{0.0f};
    float exponent = 3.0f;
  };
  std::vector<Light> lights;    // at most kLightsPerScene
  std::vector<Sample> samples;  // at most kIrradianceSamplesPerScene
  Sun sun;
  Rim rim;
};

// In the form that a frame takes them.
Lighting MakeLighting(const LightsSetup& setup);

// The texture of a layer's strands as a groom has it; the layer has one.
StrandTexture StrandTextureOf(const LayerSetup& layer);

struct FurSetup {
  std::string path;                   // for messages
  std::string text;                   // that it was read from
  std::optional<float> unit_scale;    // metres a file unit; default from the bounding box
  float crease_angle = 0.0f;          // degrees up to which edges of the mesh are round
  std::string clip;                   // to play; empty: the first
  bool clip_smoothing = true;         // of sampled motion (core/character/clips.hpp)
  std::optional<LightsSetup> lights;  // of the scene that the setup is seen in
  // Coarser, in the same units and rest pose: of a patch's chains at mesh vertices those nearest its vertices go first
  // (chain_order.hpp).
  std::shared_ptr<const Character> chain_mesh;
  std::vector<LayerSetup> layers;
  std::vector<std::string> files_read;  // besides the setup itself: its maps, its chain_mesh
};

// Reads a setup from TOML text. `path` names it in messages; maps are found relative to
// `map_directory`. Throws pelt::Error "path:line: layer 'x': key 'y': reason" on the first mistake
// in the file, in file order within a table.
FurSetup ReadFurSetup(std::string_view text, const std::string& path,
                      const std::string& map_directory);
FurSetup ReadFurSetupFile(const std::string& path);
// What the file holds, for ReadFurSetup. Throws Error.
std::string ReadSetupText(const std::string& path);

// Reads [lights] alone, of a setup or of a file that has nothing else; [defaults], layers and their maps are not looked
// at. Throws as ReadFurSetup does, and where there is no [lights].
LightsSetup ReadLights(std::string_view text, const std::string& path);
LightsSetup ReadLightsFile(const std::string& path);

// A key of a setup's layer changed in its text, which otherwise stays as it was written: comments, order and all.
// `value` is as TOML has it: 0.5, true, "best". Of a key that is written as a table with a `value` that one is changed;
// one that the layer does not have goes below its name, and stands in front of [defaults]. Throws Error, with `path`
// and line, where the text is not TOML, and where there is no such layer. The result is not checked: ReadFurSetup does
// that.
std::string ChangeLayerKey(std::string_view text, const std::string& path, std::string_view layer,
                           std::string_view key, std::string_view value);
// The same of the map of a key: of an attribute ("length"), a map ("colour_map") or one in a table ("mask.bald"). `map`
// is a path without quotes in it. What else the key says stays; what [defaults] says of it comes along into the layer.
std::string ChangeLayerMap(std::string_view text, const std::string& path, std::string_view layer,
                           std::string_view key, std::string_view map);

// A key of the layer that gives a map over the surface, which needs texture coordinates
// ("mask.uv"); empty when none does.
std::string FindSurfaceMap(const LayerSetup& layer);

// Every key a setup may hold, with type, unit, bounds, default and meaning: the text of
// `pelt bake --keys`. Made from the same table that the reader uses.
std::string DescribeSetupKeys();

}  // namespace pelt
