// Pelt's own PBD and Verlet kernels as StrandSolvers: chunks of strands with their blocks, no frame
// around them.
//
// The layer has gravity, drag and hardness only: no contact, clump, sleep or strength.
#include <memory>

#include "bench/accuracy/comparison/chunk_rows.hpp"
#include "bench/accuracy/comparison/comparison.hpp"
#include "core/exact_math.hpp"

namespace pelt::accuracy {
namespace {

template <uint32_t kPoints>
struct Blocks : ChunkRows<kPoints> {
  Owned<PointBlock<kPoints>> previous;
};

template <uint32_t kPoints>
class ChunkSolver final : public ChunkedSolver<Blocks<kPoints>> {
  using Base = ChunkedSolver<Blocks<kPoints>>;
  using Base::ChunkOf, Base::chunks_, Base::lanes_;

 public:
  static constexpr int kLinks = kPoints - 1;

  ChunkSolver(const KernelDesc& kernel, const CoreSettings& settings, const SolverSetup& setup)
      : Base(setup.lanes), kernel_(kernel), settings_(settings), material_(setup.material) {
    params_ = {};
    SetFrameTime(setup.frame_seconds);
  }

  void SetFrameTime(double seconds) override {
    LayerBlock& layer = *layer_.block;
    layer.flags = kLayerEnabled | kLayerSimulate | kLayerWind;
    layer.gravity[0] = float(material_.gravity.x);
    layer.gravity[1] = float(material_.gravity.y);
    layer.gravity[2] = float(material_.gravity.z);
    layer.link.velocity_keep = float(exact::Exp(-material_.drag * seconds));
    layer.link.segment_hardness = 1.0f;
    layer.link.angular_middle = Hardness(0, seconds);
    layer.link.angular_end = Hardness(kLinks - 1, seconds);
    layer.link.stiffness = Hardness(kLinks - 1, seconds);
    layer.link.iterations = settings_.iterations;
    layer.scale = 1.0f;
    params_.dt = float(seconds);
    // Towards the wind: v <- u + (v - u) keep, as an acceleration.
    wind_response_ = float((1.0 - exact::Exp(-material_.drag * seconds)) / seconds);
  }

  void Start(const FrameRows& frame, const float* const (*start)[3]) override {
    for (uint32_t lane = 0; lane < lanes_; ++lane) {
      Blocks<kPoints>& c = ChunkOf(lane);
      const uint32_t at = lane % kStrandsPerChunk;
      c.Start(frame, lane, float(material_.length[0]), start);
      for (int i = 0; i < kLinks; ++i)
        for (int k = 0; k < 3; ++k) c.previous->position[i][k][at] = c.position->position[i][k][at];
    }
  }

  void Prepare(const FrameRows& frame) override {
    for (uint32_t lane = 0; lane < lanes_; ++lane)
      ChunkOf(lane).LoadRoots(frame, lane, wind_response_);
  }
  void Step(const FrameRows&) override {
    for (auto& c : chunks_)
      RunOnChunk(kernel_, params_, [&](Stream stream) { return Find(stream, *c); });
  }

  void Velocities(int i, float* const (&rows)[3]) const override {
    for (uint32_t lane = 0; lane < lanes_; ++lane) {
      const Blocks<kPoints>& c = ChunkOf(lane);
      const uint32_t at = lane % kStrandsPerChunk;
      for (int k = 0; k < 3; ++k)
        rows[k][lane] =
            (c.position->position[i][k][at] - c.previous->position[i][k][at]) / params_.dt;
    }
  }

 private:
  // As the share of PBD's sweeps: see tables.cpp.
  float Hardness(int link, double seconds) const {
    const double l = material_.length[link];
    const double a = settings_.stiffness_scale * material_.stiffness[link] * seconds * seconds /
                     (l * l * material_.mass[link]);
    return float(1.0 - exact::Pow(1.0 + a, -1.0 / settings_.iterations));
  }
  void* Find(Stream stream, Blocks<kPoints>& c) {
    if (stream == StreamOf<&Streams::layers>) return layer_.block;
    void* shared = c.Find(stream);
    return shared ? shared : c.previous.block;
  }

  const KernelDesc& kernel_;
  CoreSettings settings_;
  ChainMaterial material_;
  float wind_response_ = 0.0f;
  SimulateParams params_;
  Owned<LayerBlock> layer_;
};

}  // namespace

std::unique_ptr<StrandSolver> MakeCoreSolver(Isa isa, const CoreSettings& settings,
                                             const SolverSetup& setup) {
  const FrameTable* table = FindKernels(isa);
  if (!table) return nullptr;
  const bool pbd = settings.method == CoreMethod::kPbd;
  if (setup.material.links == 3)
    return std::make_unique<ChunkSolver<4>>(
        *table->Find(pbd ? "simulate_pbd_4" : "simulate_verlet_4"), settings, setup);
  if (setup.material.links == 4)
    return std::make_unique<ChunkSolver<5>>(
        *table->Find(pbd ? "simulate_pbd_5" : "simulate_verlet_5"), settings, setup);
  return nullptr;
}

SolverFactory CoreFactory(Isa isa, const CoreSettings& settings) {
  return [=](const SolverSetup& setup) { return MakeCoreSolver(isa, settings, setup); };
}

}  // namespace pelt::accuracy
