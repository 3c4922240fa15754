// One chunk or patch of modal chains driven by hand: what the modal solver's tests share.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "core/exact_math.hpp"
#include "core/kernels/frame_table.hpp"
#include "core/kernels/simulate_modal.hpp"
#include "core/modal/modal_table.hpp"
#include "tests/kernels/run_kernel.hpp"

namespace pelt::test {

inline constexpr double kDt = 1.0 / 60.0;
inline constexpr ModalQuality kQualities[] = {ModalQuality::kFast, ModalQuality::kFine,
                                              ModalQuality::kBest};

// A chain of links of length one, 3 or 4 of them: what motions of known solution are of. `stiffness`: of the joint
// above each link; `mass`: of the point below it.
inline ModalMaterial LinkMaterial(const std::vector<double>& stiffness,
                                  const std::vector<double>& mass, double drag) {
  ModalMaterial m{};
  const uint32_t n = m.nodes = uint32_t(mass.size()), places = PlacesOf(n + 1);
  m.points = n + 1;
  m.drag_per_s = drag;
  for (uint32_t i = n; i-- > 0;) m.pull[i] = mass[i] + (i + 1 < n ? m.pull[i + 1] : 0.0);
  for (uint32_t i = 0; i < n; ++i) {
    for (uint32_t j = 0; j < n; ++j) m.mass[i][j] = m.pull[std::max(i, j)];
    m.stiffness[i][i] += stiffness[i];
    if (i > 0) {
      m.stiffness[i - 1][i - 1] += stiffness[i];
      m.stiffness[i][i - 1] = m.stiffness[i - 1][i] = -stiffness[i];
    }
    m.rest[i][i] = 1.0;
    for (uint32_t q = 0; q < places; ++q)
      m.place[q][i] = std::clamp(double(n) * (q + 1) / places - i, 0.0, 1.0);
  }
  return m;
}
// Of equal links, the first mode at `hz`.
inline ModalMaterial UniformLinks(uint32_t links, double hz, double damping_ratio, double drag) {
  const std::vector<double> mass(links, 1.0 / links);
  const double omega = 2.0 * exact::kPi * hz;
  const ModalMaterial bare = LinkMaterial(std::vector<double>(links, 1.0), mass, drag);
  const double scale = omega * omega / FindModes(bare).omega2[0];
  ModalMaterial m = LinkMaterial(std::vector<double>(links, scale), mass, drag);
  m.bend_damping_s = hz > 0.0 ? 2.0 * damping_ratio / omega : 0.0;
  return m;
}

// The root frame is the world's axes turned by nothing: rest offsets are given in world axes.
template <uint32_t kPoints>
struct ModalScene {
  static constexpr uint32_t kParts = kPoints - 1, kNodes = NodesOf(kPoints);
  LayerBlock layer{};
  ModalTableBlock table;
  ModalLayer material;
  ModalQuality quality = ModalQuality::kFine;
  SimulateParams params{};
  ChunkStateBlock state{};
  RestBlock<kPoints> rest{};
  RootBlock roots{};
  WindBlock wind{};
  StrandBlock strands{};
  ModalStateBlock<kNodes> chain;
  PointBlock<kPoints> position;
  FrameTimes times{};
  uint32_t flags = 0;        // ChunkFlag of frames after the first
  bool at_vertices = false;  // chains of 4 points: a patch's, which are state and no points

  explicit ModalScene(const ModalMaterial& m, uint32_t lanes = kStrandsPerChunk)
      : material(MakeModalLayer(m)) {
    Poison(chain);
    Poison(position);
    layer.flags = kLayerEnabled | kLayerSimulate;
    layer.gravity[1] = -9.81f;
    layer.scale = layer.modal.shrink = layer.frame_ratio = 1.0f;
    state.flags = kChunkRestart;
    state.live_strands = state.first_new_strand = lanes;
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
      roots.normal[2][lane] = roots.tangent[0][lane] = 1.0f;
      rest.strength[lane] = 1.0f;
    }
    SetRest(0.01, {1, 0, 0});
  }
  void SetRest(uint32_t lane, double link, const std::vector<Double3>& d) {
    Double3 at{};
    rest.segment_length[lane] = float(link);
    for (uint32_t i = 0; i < kParts; ++i) SetAt(rest.offset[i], lane, at = at + d[i] * link);
  }
  void SetRest(uint32_t lane, double link, Double3 straight) {
    SetRest(lane, link, std::vector<Double3>(kParts, straight));
  }
  void SetRest(double link, Double3 straight) {
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) SetRest(lane, link, straight);
  }
  void SetDirection(uint32_t lane, uint32_t link, Double3 d) {
    SetAt(chain.direction[link], lane, d);
  }
  void SetFrame(uint32_t lane, Double3 normal, Double3 tangent) {
    SetAt(roots.normal, lane, normal);
    SetAt(roots.tangent, lane, tangent);
  }
  void AddGround() {
    params.use_ground = 1;
    params.ground[1] = 1.0f;
  }
  void AddSphere(float radius) {
    params.sphere_count = 1;
    params.sphere[0][3] = radius;
  }
  void PullDown() {  // along z, into the skin
    layer.gravity[1] = 0.0f;
    layer.gravity[2] = -9.81f;
  }
  void MoveRoot(uint32_t lane, Double3 to) {
    const float p[3] = {float(to.x), float(to.y), float(to.z)};
    for (int k = 0; k < 3; ++k) {
      roots.motion[k][lane] = (state.flags & kChunkRestart) ? 0 : p[k] - roots.position[k][lane];
      roots.position[k][lane] = p[k];
    }
  }
  void HoldRoots() { std::memset(roots.motion, 0, sizeof roots.motion); }
  Double3 Tip(uint32_t lane) const { return At(position.position[kParts - 1], lane); }
  void ForEachPoint(auto visit) const {  // visit(lane, place)
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
      for (const auto& rows : position.position) visit(lane, At(rows, lane));
  }
  void Step(double dt, Isa isa = BestIsa()) {
    times = times.dt_s[0] > 0 ? NextTimes(times, dt) : FrameTimes{{dt, dt, dt}};
    FillModalTable(material, quality, times, &table);
    params.dt = float(dt);
    Run(isa);
    state.flags = flags;
  }
  void Run(Isa isa) {
    const FrameTable& kernels = *FindKernels(isa);
    if (!at_vertices) {
      RunOnBlocks(*kernels.Find(ByPoints<kPoints>("simulate_modal_4", "simulate_modal_5",
                                                  "simulate_modal_9")),
                  &params, layer, table, state, rest, roots, wind, strands, chain, position);
      return;
    }
    state.live_chains = state.live_strands;
    state.first_new_chain = state.first_new_strand;
    RunOnBlocks(*kernels.Find("simulate_modal_vertex"), &params, layer, table, state, rest, roots,
                wind, chain);
  }
  // Largest error of a tangent's length; infinite for anything not finite.
  double Stretch() const {
    double worst = 0.0;
    for (uint32_t lane = 0; lane < state.live_strands; ++lane)
      for (uint32_t i = 0; i < kNodes; ++i) {
        double square = 0.0;
        for (int k = 0; k < 3; ++k)
          square += double(chain.direction[i][k][lane]) * chain.direction[i][k][lane];
        const double velocity = double(chain.velocity[i][0][lane]) + chain.velocity[i][1][lane] +
                                chain.velocity[i][2][lane];
        const double place = at_vertices ? 0.0 : double(position.position[i][0][lane]);
        if (!std::isfinite(velocity + place)) return INFINITY;
        worst = std::max(worst, std::fabs(std::sqrt(square) - 1.0));
      }
    return worst;
  }
};

// Whether a lane's links point and turn the same way.
template <uint32_t kNodes>
bool SameLinks(const ModalStateBlock<kNodes>& a, const ModalStateBlock<kNodes>& b, uint32_t lane) {
  bool same = true;
  for (uint32_t i = 0; i < kNodes; ++i)
    for (int k = 0; k < 3; ++k)
      same &= a.direction[i][k][lane] == b.direction[i][k][lane] &&
              a.velocity[i][k][lane] == b.velocity[i][k][lane];
  return same;
}

// A scene of `make` for each instruction set that this machine has, more than one.
template <class Make>
auto OnEverySet(Make make) {
  std::vector<std::pair<Isa, decltype(make())>> sets;
  for (const Isa isa : kAllIsas)
    if (FindKernels(isa)) sets.emplace_back(isa, make());
  EXPECT_GT(sets.size(), 1u);
  return sets;
}

}  // namespace pelt::test
