// What whole scenes survive.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "bench/accuracy/double3.hpp"
#include "bench/accuracy/stress.hpp"
#include "bench/scenarios/scenarios.hpp"
#include "jobs/frame.hpp"

namespace pelt::accuracy {
namespace {

constexpr double kRate = 60.0;
constexpr uint32_t kWarmUp = 60;    // frames before the disturbance
constexpr uint32_t kCompared = 30;  // from it on
constexpr uint32_t kMoving = 120;   // from it on until all rests
constexpr uint32_t kResting = 300;

// Points of a strand from its root, in lengths of the strand; and those of its groom.
struct SceneStrand {
  double length;  // m
  std::vector<Double3> point, groom;
};

Double3 At(const float (&rows)[3][kStrandsPerChunk], uint32_t lane) {
  return {rows[0][lane], rows[1][lane], rows[2][lane]};
}

template <uint32_t kPoints>
void ReadStrand(const RootBlock& roots, const RestBlock<kPoints>& rest,
                const PointBlock<kPoints>& points, double scale, uint32_t lane, SceneStrand& out) {
  const Double3 root = At(roots.position, lane), normal = At(roots.normal, lane);
  const Double3 tangent = At(roots.tangent, lane), across = Cross(normal, tangent);
  out.length = scale * double(rest.segment_length[lane]) * (kPoints - 1);
  out.point.clear();
  out.groom.clear();
  for (uint32_t i = 0; i < kPoints - 1; ++i) {
    const Double3 g = At(rest.offset[i], lane) * scale;
    out.point.push_back((At(points.position[i], lane) - root) * (1.0 / out.length));
    out.groom.push_back((tangent * g.x + across * g.y + normal * g.z) * (1.0 / out.length));
  }
}

std::vector<SceneStrand> ReadStrands(const FurScene& scene) {
  std::vector<SceneStrand> all;
  const FrameMemory& memory = scene.memory();
  for (uint32_t c = 0; c < scene.shape().chunk_count; ++c) {
    const uint32_t layer = scene.shape().chunk_layer[c];
    const double scale = memory.Of<&Streams::layers>(layer)->scale;
    const RootBlock& roots = *memory.Of<&Streams::roots>(c);
    for (uint32_t s = 0; s < memory.Of<&Streams::chunk_state>(c)->live_strands; ++s) {
      SceneStrand& strand = all.emplace_back();
      WithPoints(StrandPointsOf(scene.shape().layer_kind[layer]), [&]<uint32_t kPoints> {
        using Of = ChainStreams<kPoints, false>;
        ReadStrand(roots, *memory.Of<Of::kRest>(c), *memory.Of<Of::kPosition>(c), scale, s, strand);
      });
    }
  }
  return all;
}

// A scene that goes its way; `change` is asked before each frame, counted from the disturbance.
struct Course {
  Scenario scenario;
  // May change the scenario and, of the frame's input, what it likes.
  std::function<void(Scenario&, int frame)> before = [](Scenario&, int) {};
  std::function<void(FrameInput&, FurScene&, int frame)> change = [](FrameInput&, FurScene&, int) {
  };
  bool any_scale = false;  // SceneOptions::any_scale: else a note of it is an error
};

class CourseRun {
 public:
  CourseRun(Course& course, Isa isa)
      : course_(course), run_(course.scenario, Options(course, isa)) {}

  // A frame; `steps` times with the clip's time in between.
  std::vector<SceneStrand> Step() {
    const int from = int(frame_) - int(kWarmUp);
    course_.before(course_.scenario, from);
    FrameInput input =
        run_.Prepare(frame_++, course_.scenario.base.skip, course_.scenario.base.lod);
    course_.change(input, run_.scene(), from);
    if (!run_.TryBegin(input)) throw Error(run_.RefusalText(frame_ - 1));
    if (const char* note = run_.scene().NextNote()) throw Error(note);
    SerialExecutor().Run(run_.scene().CurrentFrame());
    return ReadStrands(run_.scene());
  }
  const FurScene& scene() const { return run_.scene(); }

 private:
  static SceneOptions Options(const Course& course, Isa isa) {
    SceneOptions options;
    options.isa = isa;
    options.any_scale = course.any_scale;
    return options;
  }
  Course& course_;
  RunningScenario run_;
  uint32_t frame_ = 0;
};

// ---- Figures -------------------------------------------------------------------------------------

void Inspect(const std::vector<SceneStrand>& strands, SceneStressResult& result) {
  for (const SceneStrand& strand : strands) {
    Double3 upper = kZero3;
    for (const Double3& p : strand.point) {
      if (!IsFinite(p)) {
        ++result.non_finite;
        break;
      }
      const double links = double(strand.point.size());
      result.worst_stretch = std::max(result.worst_stretch, Length(p - upper) * links - 1.0);
      upper = p;
    }
  }
}

struct Apart {
  double sum = 0.0, rigid = 0.0;
  uint64_t points = 0;
  std::vector<double> all;

  void Add(const std::vector<SceneStrand>& strands, const std::vector<SceneStrand>& expected) {
    for (size_t s = 0; s < std::min(strands.size(), expected.size()); ++s)
      for (size_t i = 0; i < expected[s].point.size(); ++i, ++points) {
        const Double3 off = strands[s].point[i] - expected[s].point[i];
        const Double3 still = expected[s].groom[i] - expected[s].point[i];
        sum += Dot(off, off);
        rigid += Dot(still, still);
        all.push_back(Length(off));
      }
  }
  double Rms() const { return std::sqrt(sum / double(points)); }
  double RigidRms() const { return std::sqrt(rigid / double(points)); }
  // What all but a hundredth of the points are within.
  double OfMost() {
    const auto at = all.begin() + ptrdiff_t(0.99 * double(all.size() - 1));
    std::nth_element(all.begin(), at, all.end());
    return *at;
  }
};

uint64_t CountMoving(const std::vector<SceneStrand>& now, const std::vector<SceneStrand>& before) {
  uint64_t count = 0;
  for (size_t s = 0; s < now.size(); ++s) {
    double moved = 0.0;
    for (size_t i = 0; i < now[s].point.size(); ++i)
      moved = std::max(moved, Length(now[s].point[i] - before[s].point[i]));
    count += !(moved <= 1e-4);
  }
  return count;
}

// Runs the course, beside `expected` if there is one: the same frames from the disturbance on.
SceneStressResult RunBeside(std::string name, Course course, Course* expected, Isa isa) {
  SceneStressResult result;
  result.name = std::move(name);
  CourseRun run(course, isa);
  std::optional<CourseRun> other;
  if (expected) other.emplace(*expected, isa);
  Apart apart, at_end;
  std::vector<SceneStrand> now, before, should;
  for (uint32_t f = 0; f < kWarmUp + kMoving + kResting; ++f) {
    before = std::move(now);
    now = run.Step();
    Inspect(now, result);
    if (!other) continue;
    should = other->Step();
    if (f >= kWarmUp && f < kWarmUp + kCompared) apart.Add(now, should);
  }
  result.strands = now.size();
  result.unsettled = CountMoving(now, before);
  if (other) {
    at_end.Add(now, should);
    result.apart = apart.Rms();
    result.rigid_apart = apart.RigidRms();
    result.apart_at_end = at_end.OfMost();
  }
  return result;
}

// ---- Rows ----------------------------------------------------------------------------------------

Course Plain() {
  Course course{LoadScenario(ScenarioRequest{.scene = "tiny", .solver = Solver::kModal})};
  Scenario& scenario = course.scenario;
  scenario.dt_s = 1.0 / kRate;
  for (Actor& actor : scenario.actors) actor.teleport_frame = -1;
  scenario.weather_course = {};
  scenario.spheres.clear();
  scenario.base.wind = {};
  scenario.rest_from_frame = kWarmUp + kMoving;
  return course;
}

// One frame of `seconds`; the other scene steps through them.
SceneStressResult Hitch(double seconds, Isa isa) {
  Course hitch = Plain(), stepped = Plain();
  const auto skip = [](Scenario& scenario, double by) {
    for (Actor& actor : scenario.actors) actor.phase_s += by;
  };
  const double late = seconds - 1.0 / kRate;
  hitch.before = [=](Scenario& s, int f) {
    if (f == 0) skip(s, late);
  };
  hitch.change = [=](FrameInput& input, FurScene&, int f) {
    if (f == 0) input.dt_s = seconds;
  };
  // As many frames as the hitch lasted, before the one that both have.
  const int steps = int(std::lround(late * kRate));
  SceneStressResult result;
  stepped.scenario.rest_from_frame += uint32_t(steps);
  CourseRun ahead(stepped, isa);
  CourseRun run(hitch, isa);
  result.name = fmt::format("a frame of {} s", seconds);
  Apart apart, at_end;
  std::vector<SceneStrand> now, before, should;
  for (uint32_t f = 0; f < kWarmUp + kMoving + kResting; ++f) {
    before = std::move(now);
    now = run.Step();
    if (f == kWarmUp)
      for (int i = 0; i < steps; ++i) ahead.Step();
    should = ahead.Step();
    Inspect(now, result);
    if (f >= kWarmUp && f < kWarmUp + kCompared) apart.Add(now, should);
  }
  at_end.Add(now, should);
  result.strands = now.size();
  result.unsettled = CountMoving(now, before);
  result.apart = apart.Rms();
  result.rigid_apart = apart.RigidRms();
  result.apart_at_end = at_end.OfMost();
  // No worse than no simulation.
  result.most_apart = result.rigid_apart;
  result.most_at_end = 0.01;
  return result;
}

void ScalePlacement(Scenario& scenario, const std::vector<glm::mat4>& placements, float scale) {
  for (size_t a = 0; a < placements.size(); ++a) {
    scenario.actors[a].placement = placements[a];
    for (int c = 0; c < 3; ++c) scenario.actors[a].placement[c] *= scale;
  }
}

std::vector<glm::mat4> PlacementsOf(const Scenario& scenario) {
  std::vector<glm::mat4> all;
  for (const Actor& actor : scenario.actors) all.push_back(actor.placement);
  return all;
}

SceneStressResult Scaled(float scale, Isa isa) {
  Course course = Plain();
  ScalePlacement(course.scenario, PlacementsOf(course.scenario), scale);
  course.any_scale = true;
  course.scenario.base.skip.cull = false;
  return RunBeside(fmt::format("a character {} times as large", scale), std::move(course), nullptr,
                   isa);
}

// From half its size on, over two seconds; the other scene has its size from the start.
SceneStressResult Growing(Isa isa) {
  Course course = Plain(), grown = Plain();
  const auto placements = PlacementsOf(course.scenario);
  course.before = [placements](Scenario& scenario, int frame) {
    const float share = float(std::clamp((frame + 30) / 120.0, 0.0, 1.0));
    ScalePlacement(scenario, placements, 0.5f + 0.5f * share);
  };
  SceneStressResult result =
      RunBeside("a character that grows to twice its size in 2 s", std::move(course), &grown, isa);
  result.most_apart = result.rigid_apart;
  result.most_at_end = 0.01;
  return result;
}

SceneStressResult Far(double far_m, bool origins, Isa isa) {
  Course course = Plain(), home = Plain();
  course.scenario.place = {far_m, 0.0, -0.7 * far_m};
  course.scenario.origins = origins;
  SceneStressResult result = RunBeside(
      fmt::format("{} km away, {}", 1e-3 * far_m, origins ? "with origins" : "in the world"),
      std::move(course), &home, isa);
  result.promised = origins;
  // What touches something goes another way for the last bit of a float, and rests where it should.
  result.most_apart = 5e-3;
  result.most_at_end = 1e-3;
  return result;
}

// A bar that goes through the whole character and away; the other scene has none.
// `has_velocity`: the frames' input has its velocity.
SceneStressResult Bar(double metres_per_s, bool has_velocity, Isa isa) {
  Course course = Plain(), without = Plain();
  course.change = [=](FrameInput& input, FurScene&, int frame) {
    CapsuleCollider& bar = input.capsule[0];
    input.capsule_count = 1;
    bar = {};
    bar.joint = CapsuleCollider::kFree;
    bar.radius = 0.03f;
    const float x = float(-0.45 + metres_per_s * std::max(frame, 0) / kRate);
    const float from[3] = {x, -0.5f, 0.05f}, to[3] = {x, 2.0f, 0.05f};
    std::copy_n(from, 3, bar.from);
    std::copy_n(to, 3, bar.to);
    if (has_velocity && frame > 0) bar.from_velocity[0] = bar.to_velocity[0] = float(metres_per_s);
  };
  SceneStressResult result =
      RunBeside(fmt::format("a bar that goes through at {} m/s{}", metres_per_s,
                            has_velocity ? ", with its velocity" : ""),
                std::move(course), &without, isa);
  result.most_at_end = 0.01;
  return result;
}

}  // namespace

std::vector<std::string> BrokenPromises(const SceneStressResult& result) {
  std::vector<std::string> broken;
  if (!result.promised) return broken;
  const auto beyond = [](const std::optional<double>& value, const std::optional<double>& most) {
    return value && most && !(*value <= *most);
  };
  if (result.non_finite > 0) broken.push_back("not finite");
  if (double(result.unsettled) > kMostUnsettled * double(result.strands))
    broken.push_back("unsettled");
  if (!(result.worst_stretch <= kMostSceneStretch)) broken.push_back("stretched");
  if (beyond(result.apart, result.most_apart)) broken.push_back("too far off");
  if (beyond(result.apart_at_end, result.most_at_end)) broken.push_back("rests elsewhere");
  return broken;
}

std::vector<SceneStressResult> RunSceneStress(Isa isa) {
  std::vector<SceneStressResult> all;
  for (const double seconds : {0.1, 0.25, 1.0}) all.push_back(Hitch(seconds, isa));
  for (const float scale : {0.01f, 1.0f, 100.0f}) all.push_back(Scaled(scale, isa));
  all.push_back(Growing(isa));
  for (const double far_m : {1.0e3, 1.0e4})
    for (const bool origins : {false, true}) all.push_back(Far(far_m, origins, isa));
  for (const double speed : {1.0, 5.0, 10.0})
    for (const bool has_velocity : {false, true}) all.push_back(Bar(speed, has_velocity, isa));
  return all;
}

}  // namespace pelt::accuracy
