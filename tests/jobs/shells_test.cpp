// Whole frames with a layer of shells: what runs and when, what is drawn at which distance, and that
// nothing leaves its box.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

Scenario ShellScenario() {
  Scenario scenario = TinyScenario();
  AddShells(scenario);
  return scenario;
}

struct ShellRun {
  explicit ShellRun(Scenario drawn, SkipSettings skips = {})
      : skip(skips), scenario(std::move(drawn)) {}

  void Run() {
    FrameInput input = running.Prepare(frame++, skip, scenario.base.lod);
    if (edit) edit(input);
    RunInput(running, input);
  }
  FurScene& scene() { return running.scene(); }
  uint32_t layer() { return scene().shape().layer_count - 1; }
  const LayerDraw* FindDraw() {
    for (const LayerDraw& draw : scene().Draws())
      if (draw.output == Output::kShells) return &draw;
    return nullptr;
  }
  // Patches or chunks that the stage ran on in the last frame.
  uint32_t CountItems(std::string_view kernel) {
    uint32_t count = 0;
    for (const Stage& stage : scene().plan().stages)
      if (stage.kernel.name == kernel)
        for (uint32_t i = 0; i < scene().shape().ItemCount(stage.domain); ++i)
          count += IsWanted(stage, scene().memory(), i);
    return count;
  }

  SkipSettings skip;
  Scenario scenario;
  RunningScenario running{scenario, {}};
  std::function<void(FrameInput&)> edit;
  uint32_t frame = 0;
};

// Among other layers they add stages to passes that are there, and a scene without them has neither
// their stages nor their memory.
TEST(Shells, CostNoBarrierAndOthersNothing) {
  Scenario plain = TinyScenario(), furry = ShellScenario();
  RunningScenario without(plain, {}), with(furry, {});
  EXPECT_EQ(with.scene().plan().passes.size(), without.scene().plan().passes.size());
  EXPECT_EQ(with.scene().plan().stages.size(), without.scene().plan().stages.size() + 3);
  for (const Stream stream : {StreamOf<&Streams::shell_layers>, StreamOf<&Streams::shell_skin>,
                              StreamOf<&Streams::shell_lod>, StreamOf<&Streams::shell_vertices>,
                              StreamOf<&Streams::fin_edges>, StreamOf<&Streams::fins>})
    EXPECT_EQ(without.scene().layout().ranges[size_t(stream)].bytes, 0u);
  // Of strands and chains they have no more than what chunks are cut and woken by.
  const SceneShape& shape = with.scene().shape();
  for (const Stream stream :
       {StreamOf<&Streams::roots>, StreamOf<&Streams::curves>, StreamOf<&Streams::sort_keys>,
        StreamOf<&Streams::order>, StreamOf<&Streams::vertex_points>,
        StreamOf<&Streams::vertex_loads>, StreamOf<&Streams::strand_points4>,
        StreamOf<&Streams::strand_rest4>}) {
    const uint32_t last = shape.ItemCount(DescribeStream(stream).domain) - 1;
    EXPECT_EQ(with.scene().memory().Block(stream, last), nullptr) << DescribeStream(stream).name;
  }
}

// Every triangle of the mesh that fur grows on, once, with the mesh's own corners.
TEST(Shells, AreTheMeshsTriangles) {
  ShellRun run(ShellScenario());
  run.Run();
  const LayerDraw& draw = *run.FindDraw();
  const Mesh& mesh = run.scenario.characters[0].mesh;
  std::vector<uint32_t> indices(WriteShellIndices(draw.shells, {}));
  ASSERT_EQ(WriteShellIndices(draw.shells, indices), indices.size());
  using Corner = std::array<float, 5>;
  std::map<std::array<Corner, 3>, uint32_t> known;
  for (const auto& triangle : mesh.triangles) {
    std::array<Corner, 3> corners;
    for (size_t k = 0; k < 3; ++k) {
      const glm::vec3& p = mesh.position[triangle[k]];
      const glm::vec2& uv = mesh.uv[triangle[k]];
      corners[k] = {p.x, p.y, p.z, uv.x, uv.y};
    }
    known[corners] = 0;
  }
  const uint32_t first = run.scene().shape().layer_first_patch[draw.layer];
  for (size_t t = 0; t < indices.size(); t += 3) {
    std::array<Corner, 3> corners;
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t patch = indices[t + k] / kVerticesPerChunk,
                     v = indices[t + k] % kVerticesPerChunk;
      ASSERT_LT(patch, draw.shells.skin.size());
      const auto& block = *run.scene().memory().Of<&Streams::mesh>(first + patch);
      ASSERT_LT(v, block.vertex_count);
      const auto& uv = draw.shells.skin[patch].uv[v];
      corners[k] = {block.position[0][v], block.position[1][v], block.position[2][v], uv[0], uv[1]};
    }
    const auto found = known.find(corners);
    ASSERT_NE(found, known.end()) << t;
    EXPECT_EQ(found->second++, 0u) << "twice";
  }
  uint32_t covered = 0;
  for (const auto& [corners, count] : known) covered += count;
  EXPECT_GT(covered, 50u);
  EXPECT_LT(covered, known.size()) << "the mask leaves some bare";
}

// Where chunks meet they draw the same vertices: the layer has each of the mesh's once.
TEST(Shells, OfSeveralChunksMeetInTheSameVertices) {
  Scenario scenario = PatchedScenario();
  AddShells(scenario);
  ShellRun run(std::move(scenario));
  run.Run();
  const LayerDraw& draw = *run.FindDraw();
  ASSERT_EQ(draw.shells.halo.size(), draw.shells.triangles.size());
  ASSERT_GT(draw.shells.halo.size(), 1u);
  ASSERT_GT(draw.shells.skin.size(), 1u);
  std::set<uint32_t> places;
  size_t uses = 0;
  for (size_t c = 0; c < draw.shells.halo.size(); ++c) {
    const uint32_t count = draw.shells.triangles[c].vertex_count;
    places.insert(draw.shells.halo[c].vertex, draw.shells.halo[c].vertex + count);
    uses += count;
  }
  EXPECT_GT(uses, places.size()) << "no chunks meet";
  std::vector<uint32_t> indices(WriteShellIndices(draw.shells, {}));
  WriteShellIndices(draw.shells, indices);
  EXPECT_EQ(std::set<uint32_t>(indices.begin(), indices.end()), places);
  const uint32_t first = run.scene().shape().layer_first_patch[draw.layer];
  std::set<std::array<float, 5>> vertices;
  for (const uint32_t place : places) {
    const uint32_t patch = place / kVerticesPerChunk, v = place % kVerticesPerChunk;
    const auto& position = run.scene().memory().Of<&Streams::mesh>(first + patch)->position;
    const auto& uv = draw.shells.skin[patch].uv[v];
    vertices.insert({position[0][v], position[1][v], position[2][v], uv[0], uv[1]});
  }
  EXPECT_EQ(vertices.size(), places.size());
}

// Where the texture has a seam two vertices stand at one place, with the same bits: shells do not
// part.
TEST(Shells, DoNotPartOnSeams) {
  ShellRun run(ShellScenario());
  for (int f = 0; f < 5; ++f) run.Run();
  const LayerDraw& draw = *run.FindDraw();
  std::map<std::array<float, 3>, ShellVertex> at;
  uint32_t shared = 0;
  std::vector<uint32_t> indices(WriteShellIndices(draw.shells, {}));
  WriteShellIndices(draw.shells, indices);
  for (const uint32_t i : std::set<uint32_t>(indices.begin(), indices.end())) {
    const ShellVertex& vertex = draw.As<ShellVertex>()[i];
    const auto [place, fresh] =
        at.emplace(std::array{vertex.position[0], vertex.position[1], vertex.position[2]}, vertex);
    if (fresh) continue;
    ++shared;
    EXPECT_EQ(std::memcmp(place->second.groom, vertex.groom, sizeof vertex.groom), 0) << i;
    EXPECT_EQ(std::memcmp(place->second.force, vertex.force, sizeof vertex.force), 0) << i;
  }
  EXPECT_GT(shared, 0u);
}

// Each edge once, over the seams of texture and chunks, and as much of it as its formula says: from
// the vertices that are drawn, in double.
TEST(Shells, HaveFinsOnTheEdgesThatAreSeenFromTheSide) {
  ShellRun run(ShellScenario());
  float eye[3] = {};
  run.edit = [&](FrameInput& input) { std::copy_n(input.camera.eye, 3, eye); };
  for (int f = 0; f < 3; ++f) run.Run();
  const LayerDraw& draw = *run.FindDraw();
  const auto vertices = draw.As<ShellVertex>();
  const auto place = [&](uint32_t i) {
    const float(&p)[3] = vertices[i].position;
    return glm::dvec3(p[0], p[1], p[2]);
  };
  const auto hair = [&](uint32_t i) {
    const ShellVertex& v = vertices[i];
    return glm::dvec3(v.groom[0], v.groom[1], v.groom[2]) +
           glm::dvec3(v.force[0], v.force[1], v.force[2]);
  };
  using Edge = std::set<std::array<double, 3>>;
  const auto edge_of = [&](uint32_t a, uint32_t b) {
    const glm::dvec3 p = place(a), q = place(b);
    return Edge{{p.x, p.y, p.z}, {q.x, q.y, q.z}};
  };
  std::map<Edge, uint32_t> wanted;
  std::vector<uint32_t> indices(WriteShellIndices(draw.shells, {}));
  WriteShellIndices(draw.shells, indices);
  for (size_t i = 0; i < indices.size(); ++i) {
    const uint32_t a = indices[i], b = indices[i % 3 == 2 ? i - 2 : i + 1];
    const glm::dvec3 across = glm::cross(place(b) - place(a), hair(a) + hair(b));
    const glm::dvec3 to_eye = glm::dvec3(eye[0], eye[1], eye[2]) - 0.5 * (place(a) + place(b));
    const double size = glm::length(across) * glm::length(to_eye);
    const double facing = size > 0.0 ? std::abs(glm::dot(across, to_eye)) / size : 0.0;
    wanted[edge_of(a, b)] = uint32_t(255.0 * std::max(0.0, 2.0 * facing - 1.0) + 0.5);
  }
  std::vector<Fin> fins(WriteFins(draw.shells, {}));
  ASSERT_EQ(WriteFins(draw.shells, fins), fins.size());
  for (const Fin& fin : fins) {
    const auto found = wanted.find(edge_of(fin.from, fin.to));
    ASSERT_NE(found, wanted.end()) << "twice, or no edge";
    EXPECT_NEAR(double(fin.fade), double(found->second), 1.0);
    EXPECT_GT(fin.fade, 0u);
    wanted.erase(found);
  }
  for (const auto& [edge, fade] : wanted) EXPECT_LE(fade, 1u) << "left out";
  EXPECT_GT(fins.size(), wanted.size() / 2);
  EXPECT_GT(wanted.size(), fins.size() / 4);
}

// Nothing moves but the eye: the fins alone are worked out again, in a paused frame too.
TEST(Shells, FinsFollowTheEye) {
  Scenario rest = ShellScenario();
  rest.actors[0].teleport_frame = -1;
  rest.weather_course.from_frame = ~0u;
  rest.rest_from_frame = 3;
  ShellRun run(rest);
  const auto look_from = [&](float x, float z, bool paused) {
    run.edit = [=](FrameInput& input) {
      if (paused) input.dt_s = 0.0;
      std::fill_n(input.wind.velocity, 3, 0.0f);
      input.camera = {};
      input.camera.eye[0] = x;
      input.camera.eye[2] = z;
    };
    run.Run();
    const LayerDraw* draw = run.FindDraw();
    std::vector<uint32_t> fades;
    if (draw)
      for (const FinBlock& block : draw->shells.fins)
        fades.insert(fades.end(), std::begin(block.fade), std::end(block.fade));
    return fades;
  };
  for (int f = 0; f < 8; ++f) look_from(0.0f, 3.0f, false);
  EXPECT_EQ(run.CountItems("select_fins"), 0u) << "asleep";
  const std::vector<uint32_t> front = look_from(0.0f, 3.0f, false);
  ASSERT_FALSE(front.empty());
  const std::vector<uint32_t> side = look_from(3.0f, 0.0f, false);
  EXPECT_NE(side, front);
  EXPECT_GT(run.CountItems("select_fins"), 0u);
  EXPECT_EQ(run.CountItems("shell_force"), 0u);
  EXPECT_EQ(look_from(0.0f, 3.0f, true), front);
  EXPECT_GT(run.CountItems("select_fins"), 0u) << "paused";
}

TEST(Shells, StayInTheirBox) {
  for (const ConeKind kind : {ConeKind::kExact, ConeKind::kPublished}) {
    Scenario scenario = ShellScenario();
    LayerParams& params = scenario.grooms[0].layers.back().params;
    params.cone_kind = kind;
    params.cone = kind == ConeKind::kExact ? -1.0f : 0.9f;
    params.stiffness = 0.0f;
    ShellRun run(std::move(scenario));
    run.edit = [](FrameInput& input) { input.wind.velocity[0] = 60.0f; };
    double farthest = 0.0;
    for (int f = 0; f < 25; ++f) {
      run.Run();
      const LayerDraw* draw = run.FindDraw();
      if (!draw) continue;
      const uint32_t first = run.scene().shape().layer_first_patch[draw->layer];
      const float reach = run.scene().memory().Of<&Streams::layers>(draw->layer)->length_max;
      for (size_t i = 0; i < draw->As<ShellVertex>().size(); ++i) {
        const uint32_t patch = first + uint32_t(i) / kVerticesPerChunk;
        if (i % kVerticesPerChunk >=
            run.scene().memory().Of<&Streams::patch_state>(patch)->live_vertices)
          continue;
        const ShellVertex& vertex = draw->As<ShellVertex>()[i];
        double off = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
          const float tip = vertex.position[axis] + vertex.groom[axis] + vertex.force[axis];
          ASSERT_GE(tip, draw->low[axis]);
          ASSERT_LE(tip, draw->high[axis]);
          off += std::pow(double(vertex.groom[axis]) + double(vertex.force[axis]), 2.0);
        }
        farthest = std::max(farthest, std::sqrt(off) / double(reach));
      }
    }
    EXPECT_LE(farthest, 1.0);
    EXPECT_GT(farthest, 0.5) << "the wind is no test of the box";
  }
}

TEST(Shells, SleepWhileNothingMovesAndWakeForTheWind) {
  constexpr uint32_t kRest = 3;
  Scenario rest = ShellScenario();
  rest.actors[0].teleport_frame = -1;
  rest.weather_course.from_frame = ~0u;
  rest.rest_from_frame = kRest;
  ShellRun lazy(rest), eager(rest, {.sleep = false, .unmoved = false, .sort = false});
  float wind = 0.0f;
  lazy.edit = eager.edit = [&wind](FrameInput& input) { input.wind.velocity[2] = wind; };
  const uint32_t all = [&] {
    lazy.Run(), eager.Run();
    return lazy.CountItems("shell_force");
  }();
  ASSERT_GT(all, 0u);
  for (uint32_t f = 1; f < 14; ++f) {
    wind = f >= 9 && f < 11 ? 3.0f : 0.0f;
    lazy.Run(), eager.Run();
    ASSERT_EQ(lazy.scene().DigestFrame(), eager.scene().DigestFrame()) << f;
    EXPECT_EQ(eager.CountItems("shell_force"), all) << f;
    if ((f > kRest + 2 && f < 9) || f > 12) {
      EXPECT_EQ(lazy.CountItems("shell_force"), 0u) << f;
    }
    if (f == 9 || f == 10 || f == 11) {
      EXPECT_EQ(lazy.CountItems("shell_force"), all) << f;
    }
    ASSERT_NE(lazy.FindDraw(), nullptr) << "asleep, it is drawn all the same";
  }
}

// Farther than the last shell nothing of the layer runs; strands' level of detail and budget leave it
// whole.
TEST(Shells, FollowTheDistance) {
  Scenario scenario = ShellScenario();
  scenario.grooms[0].layers.back().params.shells = kMaxShells;
  scenario.base.lod.strand_budget = 50;
  ShellRun run(std::move(scenario), {.lod = true});
  for (const float metres : {0.5f, 3.0f, 11.0f, 30.0f, 60.0f, 5.0f}) {
    run.edit = [metres](FrameInput& input) {
      for (int axis = 0; axis < 3; ++axis) input.camera.eye[axis] = input.camera.target[axis];
      input.camera.eye[2] += metres;
      input.camera.vertical_fov_rad = 2.5f;
    };
    run.Run();
    const auto& lod = *run.scene().memory().Of<&Streams::shell_lod>(run.layer());
    const uint32_t first = run.scene().shape().layer_first_chunk[run.layer()];
    const auto& state = *run.scene().memory().Of<&Streams::chunk_state>(first);
    if (metres > 45.0f) {
      EXPECT_EQ(lod.count, 0u);
      EXPECT_EQ(state.flags, 0u);
      EXPECT_EQ(run.FindDraw(), nullptr);
    } else {
      ASSERT_NE(run.FindDraw(), nullptr) << metres;
      EXPECT_EQ(run.FindDraw()->shells.shell.size(), lod.count);
      EXPECT_NEAR(double(lod.count), std::min(40.0, 40.0 / double(metres)), 12.0 / double(metres));
      EXPECT_EQ(state.live_strands,
                run.scene().memory().Of<&Streams::strands>(first)->strand_count);
    }
  }
}

TEST(Shells, HaveTheirTexture) {
  ShellRun run(ShellScenario());
  uint32_t side = 1;
  EXPECT_TRUE(run.scene().FurTexture(0, side).empty());
  EXPECT_EQ(side, 0u);
  EXPECT_EQ(run.scene().FurTexture(run.layer(), side).size(), 32u * 32u);
  EXPECT_EQ(side, 32u);
  EXPECT_TRUE(run.scene().FurTexture(run.layer() + 1, side).empty());
  EXPECT_TRUE(FindShells(run.scene().memory(), 0).skin.empty());
  EXPECT_TRUE(FindShells(run.scene().memory(), run.layer() + 1).skin.empty());
  EXPECT_FALSE(FindShells(run.scene().memory(), run.layer()).skin.empty()) << "before any frame";
}

}  // namespace
}  // namespace pelt::testing
