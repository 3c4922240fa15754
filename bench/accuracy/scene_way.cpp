#include "bench/accuracy/scene_way.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace pelt::accuracy {

SceneWay RigidWay() {
  return {.name = "rigid", .label = "no simulation", .solver = Solver::kPbd, .simulate = false};
}

std::vector<SceneWay> AllSceneWays() {
  std::vector<SceneWay> ways;
  ways.push_back(RigidWay());
  const struct {
    const char *name, *label;
    Solver solver;
    ModalQuality quality;
  } solvers[] = {{"verlet", "Verlet", Solver::kVerlet, {}},
                 {"pbd", "PBD", Solver::kPbd, {}},
                 {"fast", "modal fast", Solver::kModal, ModalQuality::kFast},
                 {"fine", "modal fine", Solver::kModal, ModalQuality::kFine},
                 {"best", "modal best", Solver::kModal, ModalQuality::kBest}};
  for (const auto& s : solvers) {
    ways.push_back({.name = s.name, .label = s.label, .solver = s.solver, .quality = s.quality});
    ways.push_back({.name = fmt::format("{}-halved", s.name),
                    .label = fmt::format("{}, at half rate", s.label),
                    .solver = s.solver,
                    .quality = s.quality,
                    .halved = true});
  }
  ways.push_back({.name = "fine-sleep", .label = "modal fine, asleep at rest", .sleep = true});
  ways.push_back(
      {.name = "fine-on-screen", .label = "modal fine, fast if unseen", .on_screen = true});
  ways.push_back(
      {.name = "fine-half-chains", .label = "modal fine, half the chains", .strand_share = 0.99});
  for (const int divisor : {2, 4})
    ways.push_back({.name = fmt::format("fine-lod-{}", divisor),
                    .label = fmt::format("modal fine, LOD to 1/{}", divisor),
                    .strand_share = 1.0 / divisor});
  ways.push_back(
      {.name = "fine-own-chains", .label = "modal fine, own chains", .own_chains = true});
  return ways;
}

Scenario AtRate(const Scenario& base, uint32_t multiply, uint32_t divide) {
  Scenario scenario = base;
  scenario.dt_s = base.dt_s * divide / multiply;
  const auto scaled = [&](uint32_t frame) { return (frame * multiply + divide - 1) / divide; };
  scenario.rest_from_frame = scaled(base.rest_from_frame);
  for (Actor& actor : scenario.actors)
    if (actor.teleport_frame >= 0)
      actor.teleport_frame = int32_t(scaled(uint32_t(actor.teleport_frame)));
  return scenario;
}

bool SetWay(const SceneWay& way, const Scenario& base, Scenario& scenario) {
  bool any = false;
  for (size_t g = 0; g < scenario.grooms.size(); ++g)
    for (size_t l = 0; l < scenario.grooms[g].layers.size(); ++l) {
      const LayerParams& own = base.grooms[g].layers[l].params;
      LayerParams params = own;
      if (!way.planned) {
        params.solver = way.solver;
        params.quality = way.quality;
      }
      if (FindBadCombination(params)) params.solver = own.solver;
      any = any || way.planned || params.solver == way.solver;
      scenario.grooms[g].layers[l].params = params;
    }
  return any;
}

void RemoveContact(Scenario& scenario) {
  scenario.spheres.clear();
  scenario.capsules.clear();
  scenario.base.use_ground = false;
  for (Groom& groom : scenario.grooms)
    for (GroomLayer& layer : groom.layers) layer.params.surface_hardness = 0.0f;
}

void RemoveStrength(Groom& groom) {
  const auto clear = [](auto& blocks) {
    for (auto& block : blocks)
      std::fill(std::begin(block.strength), std::end(block.strength), 0.0f);
  };
  clear(groom.vertex_rest);
  clear(groom.strand_rest4);
  clear(groom.strand_rest5);
  clear(groom.strand_rest9);
}

namespace {

// Of the strands, from that of their triangles' vertices: their root frames are the same blend.
DownBlock DownOfStrands(const StrandBlock& strands, const HaloBlock& halo,
                        const DownBlock* patches) {
  DownBlock down{};
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    double sum[3] = {}, square = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      for (int k = 0; k < 3; ++k) {
        const uint32_t at = halo.vertex[strands.vertex[k][lane]];
        sum[axis] += double(strands.bary[k][lane]) *
                     double(patches[at / kVerticesPerChunk].down[axis][at % kVerticesPerChunk]);
      }
      square += sum[axis] * sum[axis];
    }
    for (int axis = 0; axis < 3; ++axis)
      down.down[axis][lane] = float(sum[axis] / std::sqrt(std::max(square, 1e-12)));
  }
  return down;
}

}  // namespace

bool GiveOwnChains(Groom& groom) {
  std::vector<RestBlock<4>> kept;  // shells stand on the vertices
  std::vector<DownBlock> down;
  const RestBlock<4>* rest = groom.vertex_rest.data();
  const DownBlock *of_vertices = groom.vertex_down.data(), *of_strands = groom.strand_down.data();
  bool any = false;
  for (GroomLayer& layer : groom.layers) {
    const bool held = layer.params.sag_free;
    if (layer.params.chain != ChainKind::kVertex) {
      for (uint32_t c = 0; held && c < layer.chunk_count; ++c) down.push_back(*of_strands++);
      continue;
    }
    const RestBlock<4>* const first = rest;
    rest += layer.patch_count;
    if (layer.params.output == Output::kShells) {
      kept.insert(kept.end(), first, rest);
      continue;
    }
    layer.params.chain = ChainKind::kStrand;
    for (uint32_t c = layer.first_chunk; held && c < layer.first_chunk + layer.chunk_count; ++c)
      down.push_back(DownOfStrands(groom.strands[c], groom.halo[c], of_vertices));
    if (held) of_vertices += layer.patch_count;
    any = true;
  }
  groom.vertex_rest = std::move(kept);
  groom.vertex_down.clear();
  groom.vertex_traits.clear();  // strands have their own; shells none
  groom.strand_down = std::move(down);
  return any;
}

SceneRun::SceneRun(const SceneWay& way, Scenario& scenario, Isa isa)
    : running_(scenario, SceneOptions{.isa = isa}),
      recording_(running_.scene().plan(), running_.scene().shape()) {
  skip_.cull = false;
  skip_.sleep = way.sleep;
  skip_.lod = way.strand_share < 1.0;
  if (!way.on_screen) lod_.fast_quality_px = 0.0f;
  // The budget alone decides.
  lod_.full_detail_px = lod_.hysteresis = 0.0f;
  lod_.strand_budget = uint32_t(way.strand_share * double(scenario.StrandCount()));
  for (uint32_t s = 0; s < plan().stages.size(); ++s) {
    const std::string_view name = plan().stages[s].kernel.name;
    if (name.starts_with("simulate_") || name.starts_with("wind_")) simulation_.push_back(s);
  }
}

void SceneRun::RunFrame(uint32_t frame) {
  const auto begin = std::chrono::steady_clock::now();
  running_.Begin(frame, skip_, lod_);
  Frame current = scene().CurrentFrame();
  current.profile = recording_.profile();
  executor_.Run(current);
  const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - begin;
  frame_ns_ = time.count();
}

SceneRun::Simulation SceneRun::Simulated() const {
  Simulation simulated;
  uint64_t ticks = 0;
  for (const uint32_t s : simulation_)
    for (uint32_t i = 0; i < scene().shape().ItemCount(plan().stages[s].domain); ++i) {
      const Slice slice = recording_.Stage(s, i);
      if (!slice.Ran()) continue;
      ticks += slice.Ticks();
      ++simulated.runs;
    }
  simulated.ns = double(ticks) * recording_.NsPerTick();
  return simulated;
}

}  // namespace pelt::accuracy
