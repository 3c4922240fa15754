#include "bench/accuracy/modal_solver.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "bench/accuracy/comparison/chunk_rows.hpp"
#include "bench/accuracy/packing.hpp"
#include "core/error.hpp"
#include "core/exact_math.hpp"
#include "core/modal/modal_block.hpp"

namespace pelt::accuracy {
namespace {

template <uint32_t kPoints>
struct Blocks : ChunkRows<kPoints> {
  Owned<ModalStateBlock<kPoints>> chain;
  Owned<RootRateBlock> rates;
};

// Rounded as shares of `unit`, a power of two.
template <class Row>
void RoundRows(Row& rows, float (*round)(float), float unit = 1.0f) {
  float* first = reinterpret_cast<float*>(&rows);
  for (size_t i = 0; i < sizeof rows / sizeof(float); ++i) first[i] = round(first[i] / unit) * unit;
}

// As if it had been written in that format and read back. Forces, up to 10^6 1/s^2, are stored as
// shares of the layer's hardest spring: binary16 ends at 65504.
template <uint32_t kPoints>
void PackState(StateFormat format, const ModalTable<kPoints - 1>& table,
               ModalStateBlock<kPoints>& chain) {
  if (format == StateFormat::kFloat) return;
  float hardest = 1.0f;
  for (const auto& row : table.bend)
    for (const float k : row) hardest = std::max(hardest, std::abs(k));
  const float force = std::exp2(std::ceil(std::log2(hardest)));
  if (format == StateFormat::kHalf) RoundRows(chain.direction, RoundHalf);
  if (format == StateFormat::kSignedAndHalf) RoundRows(chain.direction, RoundSigned16);
  if (format != StateFormat::kHalfHistory) RoundRows(chain.velocity, RoundHalf);
  RoundRows(chain.multiplier, RoundHalf, force);
  for (auto* rows : {&chain.bend, &chain.bend_step, &chain.bend_turn})
    RoundRows(*rows, RoundHalf, force);
  for (auto* rows : {&chain.root_step, &chain.root_turn, &chain.wind, &chain.normal})
    RoundRows(*rows, RoundHalf);
  RoundRows(chain.quiet_s, RoundHalf);
}

template <uint32_t kPoints>
class ModalSolver final : public StrandSolver {
 public:
  static constexpr int kLinks = kPoints - 1;

  ModalSolver(const KernelDesc& kernel, ModalQuality quality, const ModalFeatures& features,
              const SolverSetup& setup)
      : kernel_(kernel),
        quality_(quality),
        strength_(features.strength),
        shaped_(features.strength < 1.0f || features.clump > 0.0f),
        material_(setup.material),
        layer_params_(MakeModalLayer(ToModal(setup.material))),
        lanes_(setup.lanes) {
    for (uint32_t first = 0; first < lanes_; first += kStrandsPerChunk)
      chunks_.push_back(std::make_unique<Blocks<kPoints>>());
    for (double& dt : times_.dt_s) dt = setup.frame_seconds;
    times_.velocities = features.velocities;
    FillModalTable(layer_params_, quality_, times_, table_.block);
    layer_->flags = kLayerEnabled | kLayerSimulate | kLayerModal;
    if (features.velocities) layer_->flags |= kLayerRates | kLayerRatesGiven;
    layer_->frame_ratio = 1.0f;
    layer_->gravity[0] = float(material_.gravity.x);
    layer_->gravity[1] = float(material_.gravity.y);
    layer_->gravity[2] = float(material_.gravity.z);
    layer_->scale = layer_->shrink = 1.0f;
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
        for (int i = 0; i < kLinks; ++i) {
          c.chain->direction[i][k][at] = start[i][k][lane];
          float pull = 0.0f;
          for (int j = 0; j < kLinks; ++j) pull += table_->bend[i][j] * frame.rest[j][k][lane];
          c.chain->bend[i][k][at] = pull;
        }
      }
    }
  }

  // A layer's table is made once per frame, on the caller's thread: not the kernel's time.
  void Prepare(const FrameRows& frame) override {
    MoveColliders();
    for (auto& c : chunks_) PackState(features_.state, *table_.block, *c->chain.block);
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

  void Points(int i, float* const (&rows)[3]) const override {
    // From the directions: what the solver knows, without the root's place in the world. Where it
    // shapes them further, from the points.
    for (uint32_t lane = 0; lane < lanes_; ++lane) {
      if (shaped_) {
        chunks_[lane / kStrandsPerChunk]->ReadPoint(i, lane, rows);
        continue;
      }
      const ModalStateBlock<kPoints>& chain = *chunks_[lane / kStrandsPerChunk]->chain.block;
      for (int k = 0; k < 3; ++k) {
        float sum = 0.0f;
        for (int j = 0; j <= i; ++j) sum += chain.direction[j][k][lane % kStrandsPerChunk];
        rows[k][lane] = sum * float(material_.length[0]);
      }
    }
  }
  // Modes to links; the root's own speed is in the first link's.
  void Velocities(int i, float* const (&rows)[3]) const override {
    for (uint32_t lane = 0; lane < lanes_; ++lane) {
      const ModalStateBlock<kPoints>& chain = *chunks_[lane / kStrandsPerChunk]->chain.block;
      for (int k = 0; k < 3; ++k) {
        float sum = 0.0f;
        for (int j = 0; j <= i; ++j)
          for (int m = 0; m < kLinks; ++m)
            sum += table_->shape[j][m] * chain.velocity[m][k][lane % kStrandsPerChunk];
        rows[k][lane] = sum * float(material_.length[0]);
      }
    }
  }

 private:
  void SetFeatures(const ModalFeatures& f) {
    if (f.wind) layer_->flags |= kLayerWind;
    layer_->surface_hardness = f.surface_hardness;
    layer_->bounce = f.bounce;
    layer_->friction = f.friction;
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
  Blocks<kPoints>& ChunkOf(uint32_t lane) { return *chunks_[lane / kStrandsPerChunk]; }
  void* Find(Stream stream, Blocks<kPoints>& c) {
    if (stream == StreamOf<&Streams::layers>) return layer_.block;
    if (stream == StreamOf<ChainStreams<kPoints, false>::kTable>) return table_.block;
    if (stream == StreamOf<&Streams::root_rates>) return c.rates.block;
    void* shared = c.Find(stream);
    return shared ? shared : c.chain.block;
  }

  KernelDesc kernel_;
  ModalQuality quality_;
  float strength_;
  bool shaped_;
  ChainMaterial material_;
  ModalLayer layer_params_;
  uint32_t lanes_;
  FrameTimes times_;
  double next_dt_ = 0.0;  // 0: as they were
  ModalFeatures features_;
  int64_t frames_ = 0;
  SimulateParams params_;
  Owned<LayerBlock> layer_;
  Owned<ModalTable<kPoints - 1>> table_;
  std::vector<std::unique_ptr<Blocks<kPoints>>> chunks_;
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
  m.links = uint32_t(material.links);
  double total = 0.0;
  for (int i = 0; i < material.links; ++i) total += material.mass[i];
  for (int i = 0; i < material.links; ++i) {
    m.mass[i] = material.mass[i] / total;
    m.stiffness[i] = material.stiffness[i] / (total * material.length[i] * material.length[i]);
  }
  m.drag_per_s = material.drag;
  m.bend_damping_s = material.bending_damping;
  m.parent_curl = material.curl == CurlModel::kParent;
  return m;
}

ModalKernels ModalKernelsOf(Isa isa) {
  const FrameTable* table = FindKernels(isa);
  if (!table) throw Error("no " + std::string(IsaName(isa)) + " kernels here");
  return {{*table->Find("simulate_modal_4"), *table->Find("simulate_modal_rated_4")},
          {*table->Find("simulate_modal_5"), *table->Find("simulate_modal_rated_5")},
          {*table->Find("simulate_modal_9"), *table->Find("simulate_modal_rated_9")}};
}

SolverFactory ModalFactory(const ModalKernels& kernels, ModalQuality quality,
                           const ModalFeatures& features) {
  return [=](const SolverSetup& setup) -> std::unique_ptr<StrandSolver> {
    const ModalKernels::OfLinks* of = kernels.Of(setup.material.links);
    if (!of || !IsUniform(setup.material)) return nullptr;
    const KernelDesc& kernel = features.velocities ? of->rated : of->plain;
    return WithPoints(uint32_t(setup.material.links) + 1,
                      [&]<uint32_t kPoints>() -> std::unique_ptr<StrandSolver> {
                        return std::make_unique<ModalSolver<kPoints>>(kernel, quality, features,
                                                                      setup);
                      });
  };
}

}  // namespace pelt::accuracy
