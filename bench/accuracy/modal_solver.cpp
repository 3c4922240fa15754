#include "bench/accuracy/modal_solver.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "bench/accuracy/comparison/chunk_rows.hpp"
#include "core/error.hpp"
#include "core/exact_math.hpp"
#include "core/modal/modal_block.hpp"

namespace pelt::accuracy {
namespace {

template <uint32_t kPoints>
struct Blocks : ChunkRows<kPoints> {
  Owned<ModalStateBlock<NodesOf(kPoints)>> chain;
  Owned<RootRateBlock> rates;
};

template <uint32_t kPoints>
class ModalSolver final : public ChunkedSolver<Blocks<kPoints>> {
  using Base = ChunkedSolver<Blocks<kPoints>>;
  using Base::ChunkOf, Base::chunks_, Base::lanes_;

 public:
  static constexpr int kParts = kPoints - 1, kNodes = NodesOf(kPoints);

  ModalSolver(const KernelDesc& kernel, ModalQuality quality, const ModalFeatures& features,
              const ModalMaterial& strand, const SolverSetup& setup)
      : Base(setup.lanes),
        kernel_(kernel),
        quality_(quality),
        strength_(features.strength),
        material_(setup.material),
        layer_params_(MakeModalLayer(strand)) {
    for (double& dt : times_.dt_s) dt = setup.frame_seconds;
    times_.velocities = features.velocities;
    FillModalTable(layer_params_, quality_, times_, table_.block);
    layer_->flags = kLayerEnabled | kLayerSimulate | kLayerModal;
    if (features.velocities) layer_->flags |= kLayerRates | kLayerRatesGiven;
    layer_->frame_ratio = 1.0f;
    layer_->gravity[0] = float(material_.gravity.x);
    layer_->gravity[1] = float(material_.gravity.y);
    layer_->gravity[2] = float(material_.gravity.z);
    layer_->scale = layer_->modal.shrink = 1.0f;
    features_ = features;
    params_ = {};
    params_.dt = float(setup.frame_seconds);
    SetFeatures(features);
  }

  // Takes effect at the next frame, whose history keeps the lengths its frames had.
  void SetFrameTime(double seconds) override { next_dt_ = seconds; }

  void Start(const FrameRows& frame, const float* const (*start)[3]) override {
    for (uint32_t lane = 0; lane < lanes_; ++lane) {
      Blocks<kPoints>& c = ChunkOf(lane);
      const uint32_t at = lane % kStrandsPerChunk;
      c.Start(frame, lane, float(material_.length[0]), start);
      c.rest->strength[at] = strength_;
      for (int k = 0; k < 3; ++k) {
        c.chain->wind[k][at] = frame.wind[k][lane] * float(material_.drag);
        for (int i = 0; i < kNodes; ++i) {
          c.chain->direction[i][k][at] = start[i][k][lane];
          float pull = 0.0f;
          for (int j = 0; j < kNodes; ++j)
            pull += table_->bend[i][j] * Component(RestTangent(j, frame, lane), k);
          c.chain->bend[i][k][at] = pull;
        }
      }
    }
  }

  // A layer's table is made once per frame, on the caller's thread: not the kernel's time.
  void Prepare(const FrameRows& frame) override {
    MoveColliders();
    if (next_dt_ > 0.0) {
      times_ = NextTimes(times_, next_dt_);
      params_.dt = float(next_dt_);
      layer_->frame_ratio = float(times_.dt_s[0] / times_.dt_s[1]);
      FillModalTable(layer_params_, quality_, times_, table_.block);
    }
    for (uint32_t lane = 0; lane < lanes_; ++lane) {
      Blocks<kPoints>& c = ChunkOf(lane);
      c.LoadRoots(frame, lane, float(material_.drag));
      for (int k = 0; k < 3; ++k) {
        c.rates->velocity[k][lane % kStrandsPerChunk] = frame.velocity[k][lane];
        c.rates->spin[k][lane % kStrandsPerChunk] = frame.spin[k][lane];
      }
    }
  }
  void Step(const FrameRows&) override {
    for (auto& c : chunks_)
      RunOnChunk(kernel_, params_, [&](Stream stream) { return Find(stream, *c); });
  }

  // Modes to nodes to points. What turns with the root alone is left out: of links nothing.
  void Velocities(int i, float* const (&rows)[3]) const override {
    for (uint32_t lane = 0; lane < lanes_; ++lane) {
      const auto& chain = *ChunkOf(lane).chain.block;
      const auto& place = table_->place[(i + 1) * int(PlacesOf(kPoints)) / kParts - 1];
      for (int k = 0; k < 3; ++k) {
        float sum = 0.0f;
        for (int j = 0; j < kNodes; ++j)
          for (int m = 0; m < kNodes; ++m)
            sum += place[j] * table_->shape[j][m] * chain.velocity[m][k][lane % kStrandsPerChunk];
        rows[k][lane] = sum * float(material_.length[0]);
      }
    }
  }

 private:
  Vec3<float> RestTangent(int node, const FrameRows& frame, uint32_t lane) const {
    Vec3<float> sum = {0.0f, 0.0f, 0.0f};
    for (int part = 0; part < kParts; ++part) {
      const auto& row = frame.rest[part];
      sum = sum + Vec3<float>{row[0][lane], row[1][lane], row[2][lane]} * table_->rest[node][part];
    }
    return sum * (1.0f / std::sqrt(Dot(sum, sum)));
  }
  static float Component(Vec3<float> v, int axis) {
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
  }
  void SetFeatures(const ModalFeatures& f) {
    if (f.wind) layer_->flags |= kLayerWind;
    layer_->surface_hardness = f.surface_hardness;
    layer_->bounce = f.bounce;
    layer_->modal.friction = f.friction;
    layer_->max_distance = f.max_distance;
    layer_->clump = f.clump;
    if (f.clump > 0.0f) {
      layer_->flags |= kLayerClump;
      for (auto& c : chunks_) {
        c->strands->control_count = kLaneGroup;
        for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
          c->strands->control[lane] = uint8_t(lane % kLaneGroup);
      }
    }
    params_.use_ground = f.use_ground ? 1 : 0;
    const double ground[4] = {f.ground_normal.x, f.ground_normal.y, f.ground_normal.z,
                              f.ground_offset};
    for (int k = 0; k < 4; ++k) params_.ground[k] = float(ground[k]);
    params_.sphere_count = f.sphere_radius > 0.0 ? 1 : 0;
    params_.sphere[0][3] = float(f.sphere_radius);
    params_.capsule_count = f.capsule_radius > 0.0 ? 1 : 0;
    CapsuleParams& capsule = params_.capsule[0];
    const Double3 axis = f.capsule_to - f.capsule_from;
    const double length = Length(axis);
    capsule.radius = float(f.capsule_radius);
    capsule.length = float(length);
    if (length > 0.0) Put(axis * (1.0 / length), capsule.axis);
    PlaceColliders(kZero3);
  }
  static void Put(Double3 v, float (&to)[3]) {
    to[0] = float(v.x), to[1] = float(v.y), to[2] = float(v.z);
  }
  void PlaceColliders(Double3 way) {
    const Double3 centre = features_.sphere_centre + way;
    const double at[3] = {centre.x, centre.y, centre.z};
    for (int k = 0; k < 3; ++k) params_.sphere[0][k] = float(at[k]);
    Put(features_.capsule_from + way, params_.capsule[0].from);
  }
  // Frames of this run are as long as the first.
  void MoveColliders() {
    if (Length(features_.swing) + Length(features_.going) == 0.0) return;
    const double dt = double(params_.dt);
    const Double3 before = ColliderWay(features_, frames_ * dt);
    const Double3 now = ColliderWay(features_, ++frames_ * dt), way = now - before;
    PlaceColliders(now);
    for (ColliderStep* moved : {&params_.sphere_step[0], &params_.capsule_step[0]}) {
      Put(way, moved->from), Put(way, moved->to);
      moved->moves = 1;
    }
  }
  void* Find(Stream stream, Blocks<kPoints>& c) {
    if (stream == StreamOf<&Streams::layers>) return layer_.block;
    if (stream == StreamOf<&Streams::modal_tables>) return table_.block;
    if (stream == StreamOf<&Streams::root_rates>) return c.rates.block;
    void* shared = c.Find(stream);
    return shared ? shared : c.chain.block;
  }

  KernelDesc kernel_;
  ModalQuality quality_;
  float strength_;
  ChainMaterial material_;
  ModalLayer layer_params_;
  FrameTimes times_;
  double next_dt_ = 0.0;  // 0: as they were
  ModalFeatures features_;
  int64_t frames_ = 0;
  SimulateParams params_;
  Owned<LayerBlock> layer_;
  Owned<ModalTableBlock> table_;
};

}  // namespace

Double3 ColliderWay(const ModalFeatures& f, double seconds) {
  return f.going * seconds + f.swing * exact::Sin(2.0 * exact::kPi * seconds / f.swing_period);
}
Double3 ColliderSpeed(const ModalFeatures& f, double seconds) {
  const double rate = 2.0 * exact::kPi / f.swing_period;
  return f.going + f.swing * (rate * exact::Cos(rate * seconds));
}

namespace {

bool IsUniform(const ChainMaterial& material) {
  for (int i = 1; i < material.links; ++i)
    if (material.length[i] != material.length[0]) return false;
  return true;
}

}  // namespace

ModalMaterial ToModal(const ChainMaterial& material) {
  ModalMaterial m{};
  const int n = material.links;
  m.nodes = uint32_t(n);
  m.points = m.nodes + 1;
  double total = 0.0, below[kMaxLinks + 1] = {};
  for (int i = 0; i < n; ++i) total += material.mass[size_t(i)];
  for (int i = n - 1; i >= 0; --i) below[i] = below[i + 1] + material.mass[size_t(i)] / total;
  for (int i = 0; i < n; ++i) {
    const double length = material.length[size_t(i)];
    const double k = material.stiffness[size_t(i)] / (total * length * length);
    m.pull[i] = below[i];
    m.rest[i][i] = 1.0;
    for (int j = 0; j < n; ++j) m.mass[i][j] = below[std::max(i, j)];
    m.stiffness[i][i] += k;
    if (i > 0) {
      m.stiffness[i - 1][i - 1] += k;
      m.stiffness[i][i - 1] -= k;
      m.stiffness[i - 1][i] -= k;
    }
    const int places = int(PlacesOf(m.points));
    for (int q = 0; q < places; ++q)
      m.place[q][i] = std::clamp(double(n * (q + 1)) / places - i, 0.0, 1.0);
  }
  m.drag_per_s = material.drag;
  m.bend_damping_s = material.bending_damping;
  return m;
}

ModalKernels ModalKernelsOf(Isa isa) {
  const FrameTable* table = FindKernels(isa);
  if (!table) throw Error("no " + std::string(IsaName(isa)) + " kernels here");
  return {{*table->Find("simulate_modal_4"), *table->Find("simulate_modal_rated_4")},
          {*table->Find("simulate_modal_5"), *table->Find("simulate_modal_rated_5")},
          {*table->Find("simulate_modal_9"), *table->Find("simulate_modal_rated_9")}};
}

namespace {

const KernelDesc* KernelOf(const ModalKernels& kernels, const ModalFeatures& features, int parts) {
  const ModalKernels::OfLinks* of = kernels.Of(parts);
  return !of ? nullptr : features.velocities ? &of->rated : &of->plain;
}

std::unique_ptr<StrandSolver> MakeSolver(const KernelDesc& kernel, ModalQuality quality,
                                         const ModalFeatures& features, const ModalMaterial& strand,
                                         const SolverSetup& setup) {
  return WithPoints(strand.points, [&]<uint32_t kPoints>() -> std::unique_ptr<StrandSolver> {
    return std::make_unique<ModalSolver<kPoints>>(kernel, quality, features, strand, setup);
  });
}

}  // namespace

SolverFactory ModalFactory(const ModalKernels& kernels, ModalQuality quality,
                           const ModalFeatures& features) {
  return [=](const SolverSetup& setup) -> std::unique_ptr<StrandSolver> {
    const int links = setup.material.links;
    const KernelDesc* kernel = KernelOf(kernels, features, links);
    if (!kernel || links > int(kMaxNodes) || !IsUniform(setup.material)) return nullptr;
    return MakeSolver(*kernel, quality, features, ToModal(setup.material), setup);
  };
}

SolverFactory StrandFactory(const ModalKernels& kernels, ModalQuality quality,
                            const ModalMaterial& strand, const ModalFeatures& features) {
  return [=](const SolverSetup& setup) -> std::unique_ptr<StrandSolver> {
    const KernelDesc* kernel = KernelOf(kernels, features, setup.material.links);
    if (!kernel) return nullptr;
    return MakeSolver(*kernel, quality, features, strand, setup);
  };
}

SolverFactory LayerFactory(const ModalKernels& kernels, ModalQuality quality,
                           const ModalFeatures& features) {
  return [=](const SolverSetup& setup) -> std::unique_ptr<StrandSolver> {
    const ChainMaterial& m = setup.material;
    const double omega = MatricesOf(m).omega[0], hz = omega / (2.0 * exact::kPi);
    const bool stiff = GammaOf(hz, m.TotalLength(), Length(m.gravity)) < kStiffGamma;
    ModalMaterial strand =
        StrandMaterial(uint32_t(m.links) + 1, hz, 0.5 * m.bending_damping * omega, m.drag, stiff);
    strand.parent_curl = m.curl == CurlModel::kParent;
    return StrandFactory(kernels, quality, strand, features)(setup);
  };
}

}  // namespace pelt::accuracy
