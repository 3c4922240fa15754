// What a lane computes depends on that lane: on none of its group's others, on no place in a group,
// on no width of a vector. A kernel may ask what any lane of a group wants, but only to leave out
// work (core/kernels/README.md lists where, and why it cannot be seen).
//
// Scenes of random layers run with all that touches fur. Before a stage runs, now and then the
// lanes of its patch or chunk are put in another order, or each beside copies of itself alone;
// every instruction set's kernel runs on that, and each lane gets the bits that it got in its own
// place.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <sstream>

#include "jobs/pass_loop.hpp"
#include "tests/determinism/lane_call.hpp"
#include "tests/determinism/random_scene.hpp"
#include "tests/source_folder.hpp"
#include "tests/test_folder.hpp"

namespace pelt::testing {
namespace {

constexpr uint32_t kOrders = 6;        // of the lanes, each time a stage is looked at
constexpr uint32_t kAlone = 3;         // and each group made of one of its lanes
constexpr uint32_t kLeastDraws = 100;  // of the neighbours of each lane, for every kernel

// Serial; looks at each stage on one patch or chunk or none of every frame.
class LaneExecutor final : public Executor {
 public:
  explicit LaneExecutor(uint64_t seed, std::string scene)
      : random_(seed), scene_(std::move(scene)) {}
  // Of each kernel, how often every lane got other neighbours.
  static std::map<std::string, uint32_t, std::less<>>& Draws() {
    static std::map<std::string, uint32_t, std::less<>> draws;
    return draws;
  }

 private:
  void RunPasses(const Frame& frame) override {
    ++frame_;
    ForEachPass(frame, [&](uint32_t p, uint32_t count) {
      const Pass& pass = frame.plan->passes[p];
      std::vector<bool> seen(pass.stage_count);
      const uint32_t first = random_.Below(count);
      for (uint32_t i = 0; i < count; ++i)
        for (uint32_t s = 0; s < pass.stage_count; ++s)
          RunStage(frame, pass.first_stage + s, (first + i) % count, seen[s]);
    });
  }
  template <class Bit>
  void RunStage(const Frame& frame, uint32_t number, uint32_t item, Bit&& seen) {
    const Stage& stage = frame.plan->stages[number];
    if (!IsWanted(stage, *frame.memory, item)) return;
    if (!seen && IsInLayer(stage.domain) && IsByLane(stage.kernel) &&
        !::testing::Test::HasFailure())
      seen = Look(frame, stage, item);
    Binding bindings[kMaxPorts];
    for (size_t p = 0; p < stage.kernel.ports.size(); ++p)
      bindings[p] = BindPort(stage.kernel.ports[p], *frame.memory, stage.domain, item);
    const FloatEnvironment float_environment;
    stage.kernel.run(ParamsOf(stage, *frame.memory, item), bindings);
  }
  bool Look(const Frame& frame, const Stage& stage, uint32_t item) {
    Call call(frame, stage, item);
    if (!call.HasLanes()) return false;
    uint32_t& draws = Draws()[std::string(stage.kernel.name)];
    // Every kernel often enough, and what every scene has no oftener than need be.
    if (draws >= kLeastDraws && random_.Below(8) != 0) return true;
    const std::string what = fmt::format("{}, frame {}, {}, {} {}", scene_, frame_ - 1,
                                         stage.kernel.name, DomainName(stage.domain), item);
    Places own(kLanes);
    std::iota(own.begin(), own.end(), 0u);
    call.Try(own, true, what + ", as it is");
    for (uint32_t i = 0; i < kOrders; ++i)
      call.Try(call.Shuffled(random_), true, what + ", shuffled");
    for (uint32_t i = 0; i < kAlone; ++i)
      call.Try(call.Alone(random_.Below(kLaneGroup)), false, what + ", alone");
    draws += kOrders;
    return true;
  }

  Random random_;
  std::string scene_;
  uint32_t frame_ = 0;
};

void RunScene(uint32_t number, uint32_t frames) {
  Random random(MixSeed(20261126, number));
  Scenario scenario = RandomScene(random);
  scenario.velocities = number % 4 == 1 || number % 4 == 2;
  scenario.origins = number % 2 == 1;
  SceneOptions options = OptionsFor(Isa::kReference);
  if (number % 4 >= 2) options.vertex_order = VertexOrder::kIndexBuffer;
  RunningScenario running(scenario, options);
  RandomColliders colliders(random);
  LaneExecutor executor(random.U64(), fmt::format("scene {}", number));
  for (uint32_t f = 0; f < frames && !::testing::Test::HasFailure(); ++f) {
    SkipSettings skip;
    skip.sleep = f % 4 != 3;
    skip.lod = number % 4 == 3;
    LodSettings lod;
    lod.hysteresis = 0.0f;
    lod.strand_budget = uint32_t(scenario.StrandCount()) / (1 + f % 3);
    FrameInput in = running.Prepare(f, skip, lod);
    if (f % 6 == 4) in.dt_s = 1.0 / 240.0;
    if (f == 8) in.dt_s = 0.3;
    colliders.Fill(f, number % 2 == 1, in);
    ASSERT_TRUE(running.TryBegin(in)) << running.RefusalText(f);
    executor.Run(running.scene().CurrentFrame());
  }
}

// Strands on vertices' chains that their weight presses into the skin, some of them: what they keep out
// of is asked of a group only where no collider is about.
TEST(Lanes, DependOnThemselvesAloneInTheSkin) {
  Scenario scenario = LoadScenario(ScenarioRequest{
      .scene = "tiny",
      .setup_texts = {
          "[[layer]]\nname = 'lying'\nsolver = 'modal'\nchain = 'vertex'\nfrequency = 1\n"
          "density = 60_000\nmax_strands = 600\nlength = { value = 0.05, randomise = 0.5 }\n"
          "elevation = { value = 20, randomise = 1.0 }\nsurface_hardness = 1\nweight = 2\n"}});
  scenario.spheres.clear();
  scenario.base.use_ground = false;
  RunningScenario running(scenario, OptionsFor(Isa::kReference));
  LaneExecutor executor(5, "in the skin");
  for (uint32_t f = 0; f < 6 && !HasFailure(); ++f) {
    running.Begin(f);
    executor.Run(running.scene().CurrentFrame());
  }
  EXPECT_GT(LaneExecutor::Draws()["interpolate_modal"], 0u);
  LaneExecutor::Draws().clear();  // the next test counts its own
}

TEST(Lanes, DependOnThemselvesAlone) {
#ifdef NDEBUG
  for (uint32_t scene = 0; scene < 6; ++scene) RunScene(scene, 13);
#else
  RunScene(0, 2);
  GTEST_SKIP() << "two frames alone: kernels that are not optimised take minutes";
#endif
  if (HasFailure()) return;
  for (const FrameEntry& entry : FindKernels(Isa::kReference)->entries) {
    // The three that activate write no lanes.
    if (!IsInLayer(entry.domain) || !IsByLane(entry.kernel) ||
        entry.kernel.name.starts_with("activate"))
      continue;
    EXPECT_GE(LaneExecutor::Draws()[std::string(entry.kernel.name)], kLeastDraws)
        << entry.kernel.name;
  }
}

// ---- The list ----------------------------------------------------------------------------------

// Calls of what asks a whole group, as "file: text", spaces as one.
std::vector<std::string> FindQuestions() {
  std::vector<std::string> found;
  for (const char* folder : {"core/kernels", "core/simd"})
    for (const auto& entry :
         std::filesystem::directory_iterator(test::SourceFolder() + "/" + folder)) {
      std::string text, name = entry.path().filename().string();
      if (entry.path().extension() != ".hpp") continue;
      std::istringstream lines(test::ReadText(entry.path().string()));
      for (std::string line; std::getline(lines, line);)
        if (line.find("friend bool") == line.npos) text += line.substr(0, line.find("//")) + ' ';
      for (const std::string_view word : {"Any(", "AllSet(", "HasColliders()", "colliders.moves"})
        for (size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1)) {
          if (at > 0 && (std::isalnum(text[at - 1]) || text[at - 1] == '_')) continue;
          std::string site;
          for (const char c : text.substr(at, 200))
            if (c != ' ' || (!site.empty() && site.back() != ' ')) site += c;
          found.push_back(name + ": " + site);
        }
    }
  return found;
}

TEST(Lanes, EveryQuestionToAGroupIsListed) {
  std::vector<std::string> found = FindQuestions();
  std::istringstream lines(test::ReadText(test::SourceFolder() + "/core/kernels/README.md"));
  for (std::string line; std::getline(lines, line);) {
    // - file.hpp: `Any(what)` why it cannot be seen
    const size_t open = line.find(": `"), close = line.find("` ");
    if (!line.starts_with("- ") || open == line.npos || close == line.npos) continue;
    const std::string listed =
        line.substr(2, open - 2) + ": " + line.substr(open + 3, close - open - 3);
    const auto at = std::ranges::find_if(
        found, [&](const std::string& site) { return site.starts_with(listed); });
    EXPECT_TRUE(at != found.end()) << "listed, and not in the sources: " << listed;
    if (at != found.end()) found.erase(at);
  }
  for (const std::string& site : found)
    ADD_FAILURE() << "not in core/kernels/README.md, with why no lane can see it: " << site;
}

}  // namespace
}  // namespace pelt::testing
