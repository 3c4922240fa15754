#include "bench/accuracy/rod_contact.hpp"

#include <algorithm>
#include <cmath>

#include "bench/accuracy/solver_run.hpp"
#include "core/error.hpp"
#include "core/modal/modal_material.hpp"

namespace pelt::accuracy {
namespace {

constexpr int kRestRate = 60;
constexpr double kRestGravity = 9.81;

// ---- Scenes ----------------------------------------------------------------------------------

double WeightOf(const Preset& preset) {
  return GammaOf(preset.frequency, preset.length, kRestGravity);
}

RestCase LevelCase(const Preset& preset, double turn) {
  const RestCurve level{kZero3, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, turn};
  return {preset, {level, {0.0, -WeightOf(preset), 0.0}}, kZero3};
}

constexpr double kTurns[] = {0.0, 0.6};

RestScene BallScene(double radius) {
  const Double3 centre = {0.0, -0.03 - radius, 0.0};
  RestScene scene{std::to_string(radius).substr(0, 4) + " ball", {}, {}};
  for (const Preset& preset : kPresets)
    for (const double at : {0.35, 0.55, 0.75})
      for (const double turn : kTurns) {
        RestCase c = LevelCase(preset, turn);
        c.root = {-at, 0.0, 0.0};
        c.rod.walls.push_back(OutsideBall(centre - c.root, radius));
        scene.cases.push_back(c);
      }
  scene.features = [=](double length) {
    ModalFeatures f;
    f.sphere_radius = radius * length;
    f.sphere_centre = centre * length;
    return f;
  };
  return scene;
}

RestScene GroundScene() {
  constexpr double kBelow = 0.3;
  RestScene scene{"ground, friction", {}, {}};
  scene.friction = 0.4;
  for (const Preset& preset : kPresets) {
    RestCase c = LevelCase(preset, 0.0);
    c.rod.walls.push_back(AbovePlane({0.0, 1.0, 0.0}, kBelow));
    scene.cases.push_back(c);
  }
  scene.features = [=, friction = scene.friction](double length) {
    ModalFeatures f;
    f.use_ground = true;
    f.ground_offset = kBelow * length;
    f.friction = float(friction);
    return f;
  };
  return scene;
}

RestScene LimitScene() {
  constexpr double kLimit = 0.2;
  RestScene scene{"limit", {}, {}};
  for (const Preset& preset : kPresets)
    for (const double turn : kTurns) {
      RestCase c = LevelCase(preset, turn);
      c.rod.walls.push_back(NearRest(c.rod.rest, kLimit));
      scene.cases.push_back(c);
    }
  scene.features = [](double) {
    ModalFeatures f;
    f.max_distance = float(kLimit);
    return f;
  };
  return scene;
}

// Its push is the drag times its speed: of each preset as large as the weight.
RestScene WindScene(const Preset& preset) {
  RestScene scene{"wind, " + std::string(preset.name), {}, {}};
  scene.wind = {0.0, 0.0, kRestGravity / preset.drag};
  for (const double turn : kTurns) {
    RestCase c = LevelCase(preset, turn);
    c.rod.load.z = WeightOf(preset);
    scene.cases.push_back(c);
  }
  scene.features = [](double) { return ModalFeatures{}; };
  return scene;
}

// ---- The rod ---------------------------------------------------------------------------------

// Its shapes of rest from slipping inwards to slipping outwards; one without friction.
std::vector<RodShape> RestsOf(const RestCase& c, double friction, int links) {
  constexpr int kHolds = 2;  // to either side
  std::vector<RodShape> rests;
  const int holds = friction > 0.0 ? kHolds : 0;
  for (int hold = -holds; hold <= holds; ++hold) {
    RodAmongWalls rod = c.rod;
    rod.rub = {friction * double(hold) / kHolds, 0.0, 0.0};
    rests.push_back(FindRest(rod, links));
    if (!rests.back().rests) throw Error("a rod finds no rest among its walls");
  }
  return rests;
}

// Distance of drawn points from the rod's shape, or from the nearest on the way from one shape to the next.
double OffRests(const std::vector<Double3>& points, const std::vector<RodShape>& rests) {
  const auto at = [&](const RodShape& rod, size_t i) {
    return rod.At(double(i + 1) / double(points.size()));
  };
  const auto square_to = [&](const RodShape& from, const RodShape& to) {
    double along = 0.0, way2 = 0.0, square = 0.0;
    for (size_t i = 0; i < points.size(); ++i) {
      const Double3 way = at(to, i) - at(from, i);
      along += Dot(points[i] - at(from, i), way);
      way2 += Dot(way, way);
    }
    const double share = way2 > 0.0 ? std::clamp(along / way2, 0.0, 1.0) : 0.0;
    for (size_t i = 0; i < points.size(); ++i) {
      const Double3 off = points[i] - at(from, i) - (at(to, i) - at(from, i)) * share;
      square += Dot(off, off);
    }
    return square;
  };
  double least = square_to(rests[0], rests[0]);
  for (size_t k = 1; k < rests.size(); ++k)
    least = std::min(least, square_to(rests[k - 1], rests[k]));
  return std::sqrt(least / double(points.size()));
}

double ApartAtThirds(const RodShape& a, const RodShape& b) {
  double square = 0.0;
  for (int third = 1; third <= 3; ++third) {
    const Double3 off = a.At(third / 3.0) - b.At(third / 3.0);
    square += Dot(off, off) / 3.0;
  }
  return std::sqrt(square);
}

// A case that counts.
struct HeldCase {
  const RestCase* from;
  std::vector<RodShape> rests;
  double self_error;

  const RodShape& Middle() const { return rests[rests.size() / 2]; }
};

std::vector<HeldCase> HeldCases(const RestScene& scene, int links) {
  std::vector<HeldCase> held;
  for (const RestCase& c : scene.cases) {
    HeldCase found{&c, RestsOf(c, scene.friction, links), 0.0};
    if (!c.rod.walls.empty() && found.Middle().pushed < kLeastHeld * WeightOf(c.preset)) continue;
    found.self_error = ApartAtThirds(found.Middle(), RestsOf(c, 0.0, links / 2)[0]);
    held.push_back(std::move(found));
  }
  return held;
}

// ---- Strands ---------------------------------------------------------------------------------

double NodeAt(const RestModel& model, const Preset& preset, int unknown) {
  if (!model.nodes) return (unknown + 0.5) / model.parts;
  if (model.parts > 3) return kFourNodes.node[size_t(unknown)];
  return (WeightOf(preset) < kStiffGamma ? kThreeStiffNodes : kThreeNodes).node[size_t(unknown)];
}

// Along the rest curve, or as the rod rests.
LinkDirections RestStartOf(const RestModel& model, const RestCase& c, const RodShape& rod,
                           bool dropped) {
  const Preset& preset = c.preset;
  const int count = model.nodes ? std::min(model.parts, 4) : model.parts;
  const double half = model.nodes ? 0.5 / double(rod.point.size()) : 0.5 / model.parts;
  LinkDirections start{};
  for (int i = 0; i < count; ++i) {
    const double s = NodeAt(model, preset, i);
    if (dropped) {
      start[size_t(i)] = c.rod.rest.TangentAt(s);
      continue;
    }
    start[size_t(i)] = Unit(rod.At(std::min(s + half, 1.0)) - rod.At(std::max(s - half, 0.0)));
  }
  return start;
}

// The groom of a layer: parts of equal length along the rest curve.
Strand RestStrandOf(const RestCase& c, int parts) {
  constexpr int kSteps = 64;
  Strand strand{c.root * c.preset.length, {}};
  for (int i = 0; i < parts; ++i) {
    Double3 sum = kZero3;
    for (int k = 0; k < kSteps; ++k)
      sum = sum + c.rod.rest.TangentAt((i + (k + 0.5) / kSteps) / parts);
    strand.rest[size_t(i)] = Unit(sum);
  }
  return strand;
}

// Lets the cases of one preset come to rest and adds their errors.
void Rest(const RestScene& scene, const Preset& preset, const std::vector<HeldCase>& held,
          const RestModel& model, const ModalKernels& kernels, const RestErrorOptions& options,
          RestErrorRow& row) {
  std::vector<const HeldCase*> cases;
  std::vector<Strand> strands;
  std::vector<LinkDirections> start;
  for (const HeldCase& c : held) {
    if (c.from->preset.name != preset.name) continue;
    cases.push_back(&c);
    strands.push_back(RestStrandOf(*c.from, model.parts));
    start.push_back(RestStartOf(model, *c.from, c.Middle(), options.dropped));
  }
  if (cases.empty()) return;
  const ModalFeatures features = scene.features(preset.length);
  const SolverFactory factory = model.nodes ? LayerFactory(kernels, row.quality, features)
                                            : ModalFactory(kernels, row.quality, features);
  BodyPose pose = StillPose();
  pose.wind = scene.wind;
  SolverRun run(factory, MakeMaterial(preset, model.parts, Coefficients::kCalibrated),
                1.0 / kRestRate, strands, start, pose);
  if (!run.valid()) throw Error("no kernel for " + model.name);
  std::vector<std::vector<Double3>> points(cases.size()), before;
  const int frames = int(std::lround(options.seconds * kRestRate));
  for (int frame = 0; frame < frames; ++frame) {
    run.Step(pose);
    before = points;
    for (size_t s = 0; s < cases.size(); ++s) {
      points[s].clear();
      for (int i = 0; i < model.parts; ++i)
        points[s].push_back(run.Point(s, i) * (1.0 / preset.length));
    }
  }
  for (size_t s = 0; s < cases.size(); ++s) {
    row.errors.push_back(OffRests(points[s], cases[s]->rests));
    for (size_t i = 0; i < points[s].size(); ++i)
      row.speed = std::max(row.speed, Length(points[s][i] - before[s][i]) * kRestRate);
  }
}

}  // namespace

std::vector<RestScene> BallScenes() { return {BallScene(0.15), BallScene(0.30), BallScene(0.60)}; }

std::vector<RestScene> OtherRestScenes() {
  std::vector<RestScene> scenes = {GroundScene(), LimitScene()};
  for (const Preset& preset : kPresets) scenes.push_back(WindScene(preset));
  return scenes;
}

std::vector<RestModel> RestModels() {
  return {{"3 nodes", 3, true},
          {"4 nodes", 4, true},
          {"4 nodes, 9 points", 8, true},
          {"3 links", 3, false},
          {"4 links", 4, false}};
}

RestErrorTable MeasureRest(const std::vector<RestScene>& scenes, Isa isa,
                           const RestErrorOptions& options) {
  const ModalKernels kernels = ModalKernelsOf(isa);
  RestErrorTable table;
  for (const RestScene& scene : scenes) {
    const std::vector<HeldCase> held = HeldCases(scene, options.links);
    table.self_errors.emplace_back();
    table.gammas.emplace_back();
    for (const HeldCase& c : held) {
      table.self_errors.back().push_back(c.self_error);
      table.gammas.back().push_back(WeightOf(c.from->preset));
    }
    for (const RestModel& model : options.models)
      for (const ModalQuality quality :
           {ModalQuality::kFast, ModalQuality::kFine, ModalQuality::kBest}) {
        RestErrorRow row{scene.name, model.name, quality, {}, 0.0};
        for (const Preset& preset : kPresets)
          Rest(scene, preset, held, model, kernels, options, row);
        table.rows.push_back(std::move(row));
      }
  }
  return table;
}

}  // namespace pelt::accuracy
