#include "bench/accuracy/scene_precision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>

#include "bench/accuracy/scene_points.hpp"
#include "core/error.hpp"
#include "core/modal/modal_quality.hpp"
#include "core/random.hpp"

namespace pelt::accuracy {
namespace {

constexpr uint32_t kBinBits = 18;  // of a float, that a bin leaves out
constexpr float kLeast = 0x1p-20f, kMost = 0x1p4f;
uint32_t BinOf(float share) {
  const auto bits = [](float value) { return std::bit_cast<uint32_t>(value) >> kBinBits; };
  return bits(std::clamp(share, kLeast, kMost)) - bits(kLeast);
}
double EndOf(uint32_t bin) {
  return std::bit_cast<float>((bin + 1 + (std::bit_cast<uint32_t>(kLeast) >> kBinBits))
                              << kBinBits);
}

}  // namespace

void TipErrors::Counts::Add(double share, double bound) {
  bins.resize(BinOf(kMost) + 1);
  ++bins[BinOf(float(share))];
  within += share <= bound;
}

void TipErrors::Counts::Add(const Counts& other) {
  bins.resize(BinOf(kMost) + 1);
  std::transform(other.bins.begin(), other.bins.end(), bins.begin(), bins.begin(), std::plus<>());
  within += other.within;
}

TipErrors::TipErrors(const Scenario& scene, std::span<const SceneWay> ways) {
  for (uint32_t c = 0; c < scene.actors.size(); ++c)
    for (const GroomLayer& layer : scene.grooms[scene.actors[c].groom].layers)
      layers_.push_back({layer.name, c, layer.params.solver == Solver::kModal});
  for (const SceneWay& way : ways) {
    const bool one = way.IsChoice() && way.simulate && !way.halved;
    ways_.push_back(one ? way.name : "");
  }
  counts_.assign(ways.size(), std::vector<Counts>(layers_.size()));
}

void TipErrors::Add(size_t w, const FurScene& scene, const ScenePointsLayout& layout,
                    const ScenePoints& points, const ScenePoints& reference) {
  if (ways_[w].empty()) return;
  for (const auto& piece : layout.pieces()) {
    const uint32_t l = scene.shape().chunk_layer[piece.chunk];
    if (!layers_[l].modal) continue;
    const double length = scene.memory().Of<&Streams::layers>(l)->length_max;
    const ScreenQuality ran = scene.QualityOf(l);
    const double bound = ErrorShare(ran.quality, ran.chain_level);
    const uint32_t live = scene.memory().Of<&Streams::chunk_state>(piece.chunk)->live_strands;
    for (uint32_t lane = 0; lane < live; ++lane) {
      double off2 = 0.0;
      for (uint32_t axis = 0; axis < 3; ++axis) {
        const size_t at = piece.PlaceOfTip(axis, lane);
        const double off = double(points[at]) - double(reference[at]);
        off2 += off * off;
      }
      counts_[w][l].Add(std::sqrt(off2) / length, bound);
    }
  }
}

TipRow TipErrors::RowOf(size_t w, const Counts& counts) const {
  TipRow row;
  row.way = ways_[w];
  row.within = counts.within;
  row.tips = std::accumulate(counts.bins.begin(), counts.bins.end(), uint64_t{0});
  uint64_t below = 0;
  for (uint32_t bin = 0; bin < counts.bins.size() && 100 * below < 99 * row.tips; ++bin) {
    below += counts.bins[bin];
    row.p99 = EndOf(bin);
  }
  return row;
}

std::vector<TipRow> TipErrors::Layers() const {
  std::vector<TipRow> rows;
  for (size_t w = 0; w < ways_.size(); ++w)
    for (uint32_t l = 0; l < layers_.size(); ++l) {
      if (counts_[w][l].bins.empty()) continue;
      TipRow row = RowOf(w, counts_[w][l]);
      row.layer = l;
      row.character = layers_[l].character;
      row.name = layers_[l].name;
      rows.push_back(std::move(row));
    }
  return rows;
}

std::vector<TipRow> TipErrors::Ways() const {
  std::vector<TipRow> rows;
  for (size_t w = 0; w < ways_.size(); ++w) {
    Counts all;
    for (const Counts& layer : counts_[w])
      if (!layer.bins.empty()) all.Add(layer);
    if (!all.bins.empty()) rows.push_back(RowOf(w, all));
  }
  return rows;
}

namespace {

// The way that a sleeping one is compared with.
constexpr std::string_view kAwake = "fine";

// Rods of a scene.
constexpr uint32_t kRods = 192, kQuickRods = 64;

constexpr double kNone = std::numeric_limits<double>::infinity();

// ---- All of them in lockstep ------------------------------------------------------------------

std::vector<SceneWay> WaysOf(const ScenePrecisionOptions& options) {
  std::vector<SceneWay> ways = AllSceneWays();
  if (options.planned) ways.push_back({.name = "plan", .label = "as planned", .planned = true});
  return ways;
}

// What a way cost in every frame: the fastest of the rounds.
struct FrameTimes {
  explicit FrameTimes(size_t frames)
      : simulate_ns(frames, kNone), frame_ns(frames, kNone), simulate_runs(frames, 0) {}
  void Add(uint32_t frame, const SceneRun& run) {
    const SceneRun::Simulation simulated = run.Simulated();
    simulate_ns[frame] = std::min(simulate_ns[frame], simulated.ns);
    simulate_runs[frame] = simulated.runs;
    frame_ns[frame] = std::min(frame_ns[frame], run.frame_ns());
  }

  std::vector<double> simulate_ns, frame_ns;
  std::vector<uint32_t> simulate_runs;  // the same in every round
};

struct Errors {
  ErrorSum sum, own;  // against the reference; against a chain for each strand
  double live = 0.0;  // sum over the counted frames of the share that lives
  uint64_t digest = 0;
};

class Lockstep {
 public:
  Lockstep(const Scenario& scene, ScenePrecision& result)
      : options_(result.options), result_(result), base_(scene) {
    const ScenePrecisionOptions& options = options_;
    base_.weather_course = {};
    base_.rest_from_frame = options.frames;
    if (!options.contact) RemoveContact(base_);
    result.layers = 0;
    for (const Actor& actor : base_.actors)
      result.layers += uint32_t(base_.grooms[actor.groom].layers.size());
    result.frames_per_second = 1.0 / base_.dt_s;
    full_ = base_;
    half_ = AtRate(base_, 1, 2);
    rigid_scenario_ = base_;
    for (Groom& groom : rigid_scenario_.grooms) RemoveStrength(groom);
    own_base_ = base_;
    for (Groom& groom : own_base_.grooms) result.has_vertex_chains |= GiveOwnChains(groom);
    own_ = own_base_;
    for (const SceneWay& way : WaysOf(options)) {
      if (way.own_chains && !result.has_vertex_chains) continue;
      if (SetWay(way, base_, full_)) {
        ways_.push_back(way);
      } else {
        result.notes.push_back(fmt::format("no layer of {} can have: {}", base_.name, way.label));
      }
    }
    rods_ = std::make_unique<SceneRods>(base_, options.reference_rate, result.warm_up,
                                        options.quick ? kQuickRods : kRods);
    tips_.emplace(base_, ways_);
    times_.assign(ways_.size(), FrameTimes(options.frames + options.still_frames));
    errors_.resize(ways_.size());
  }

  void RunRound(bool measure_errors, const std::function<void()>& progress) {
    std::vector<std::unique_ptr<SceneRun>> runs;
    for (const SceneWay& way : ways_) runs.push_back(MakeRun(way));
    std::unique_ptr<Reference> reference;
    if (measure_errors) reference = std::make_unique<Reference>(*this);
    for (uint32_t f = 0; f < options_.frames; ++f) {
      if (reference) reference->Advance(f);
      for (size_t w = 0; w < ways_.size(); ++w) {
        const bool carried = ways_[w].halved && f % 2 == 1;
        if (!carried) RunFrame(w, f, *runs[w]);
        if (reference) reference->Compare(w, f, *runs[w], carried);
      }
      progress();
    }
    // Only those that sleep, and what they are compared with, gain or lose by stillness.
    for (uint32_t f = options_.frames; f < options_.frames + options_.still_frames; ++f)
      for (size_t w = 0; w < ways_.size(); ++w) {
        if (!RunsStill(w)) continue;
        RunFrame(w, f, *runs[w]);
        if (reference) reference->AddToDigest(w, *runs[w]);
      }
  }

  void CompareWithRods(const std::function<void()>& progress) {
    result_.rods = rods_->Compare(ways_, options_.isa, progress);
    for (std::string& note : result_.rods.notes) result_.notes.push_back(std::move(note));
  }
  // Calls of `progress`, of all rounds and the rods.
  size_t Steps() const {
    const auto rods = std::count_if(ways_.begin(), ways_.end(), SceneRods::IsComparable);
    return (size_t(options_.rounds) + size_t(rods)) * options_.frames;
  }

  void Summarise() {
    const uint32_t moving = options_.frames - result_.warm_up;
    for (size_t w = 0; w < ways_.size(); ++w) {
      ScenePrecisionRow row{.way = ways_[w]};
      // To those that do not sleep a still frame is a frame like others.
      const uint32_t end = options_.frames + (ways_[w].sleep ? options_.still_frames : 0);
      for (uint32_t f = result_.warm_up; f < end; ++f) AddTimes(w, f, row);
      const double strand_frames = double(result_.strands) * (end - result_.warm_up);
      row.simulate_ns /= strand_frames;
      row.frame_ns /= strand_frames;
      row.simulate_runs /= end - result_.warm_up;
      row.error = errors_[w].sum.Share();
      row.own_error = result_.has_vertex_chains ? errors_[w].own.Share() : row.error;
      row.off_m = errors_[w].sum.OffRms();
      row.rod_error = result_.rods.ways[w];
      row.live_share = errors_[w].live / moving;
      row.points_digest = errors_[w].digest;
      result_.rows.push_back(row);
    }
    result_.tips = tips_->Ways();
    result_.layer_tips = tips_->Layers();
    result_.self_error = self_.Share();
    if (result_.has_vertex_chains) result_.chain_error = chains_.Share();
    result_.secondary_m = self_.MovedRms();
  }

 private:
  void AddTimes(size_t w, uint32_t f, ScenePrecisionRow& row) const {
    const FrameTimes& times = times_[w];
    if (!ways_[w].halved || f % 2 == 0) {
      row.frame_ns += times.frame_ns[f];
      row.simulate_ns += times.simulate_ns[f];
      row.simulate_runs += times.simulate_runs[f];
    } else {  // carried: costs what the frame before it did, but for the simulation
      row.frame_ns += times.frame_ns[f - 1] - times.simulate_ns[f - 1];
    }
  }
  bool RunsStill(size_t w) const { return ways_[w].sleep || ways_[w].name == kAwake; }

  // The rigid run and both references, and what they say about the ways.
  class Reference {
   public:
    explicit Reference(Lockstep& all) : all_(all) {
      const uint32_t rate = all.options_.reference_rate;
      fine_scenario_ = AtRate(all.base_, rate, 1);
      coarse_scenario_ = AtRate(all.base_, rate / 2, 1);
      const SceneWay best{.name = "", .label = "", .quality = ModalQuality::kBest};
      SetWay(best, all.base_, fine_scenario_);
      SetWay(best, all.base_, coarse_scenario_);
      fine_ = std::make_unique<SceneRun>(best, fine_scenario_, all.options_.isa);
      coarse_ = std::make_unique<SceneRun>(best, coarse_scenario_, all.options_.isa);
      if (all.result_.has_vertex_chains) {
        own_scenario_ = AtRate(all.own_base_, rate, 1);
        SetWay(best, all.own_base_, own_scenario_);
        own_ = std::make_unique<SceneRun>(best, own_scenario_, all.options_.isa);
      }
      rigid_ = all.MakeRun(RigidWay());
      carried_.resize(all.ways_.size());
    }

    // All three to frame `f`.
    void Advance(uint32_t f) {
      rigid_->RunFrame(f);
      RunTo(*fine_, f, all_.options_.reference_rate, all_.rods_.get());
      RunTo(*coarse_, f, all_.options_.reference_rate / 2);
      if (own_) RunTo(*own_, f, all_.options_.reference_rate);
      if (!layout_) layout_ = std::make_unique<ScenePointsLayout>(rigid_->scene());
      all_.result_.strands = layout_->strands();
      layout_->Read(rigid_->scene(), rigid_points_);
      layout_->Read(fine_->scene(), points_of_reference_);
      layout_->Read(coarse_->scene(), points_);
      if (Counts(f)) all_.self_.Add(points_, points_of_reference_, rigid_points_);
      if (!own_) return;
      layout_->Read(own_->scene(), own_points_);
      if (Counts(f)) all_.chains_.Add(points_of_reference_, own_points_, rigid_points_);
    }

    void Compare(size_t w, uint32_t f, const SceneRun& run, bool carried) {
      Errors& errors = all_.errors_[w];
      if (carried) {
        points_.resize(rigid_points_.size());
        for (size_t i = 0; i < points_.size(); ++i) points_[i] = rigid_points_[i] + carried_[w][i];
      } else {
        layout_->Read(run.scene(), rigid_->scene(), rigid_points_, points_);
        if (all_.ways_[w].halved) {
          carried_[w].resize(points_.size());
          for (size_t i = 0; i < points_.size(); ++i)
            carried_[w][i] = points_[i] - rigid_points_[i];
        }
      }
      Fold(errors.digest);
      if (!Counts(f)) return;
      const ScenePoints& same_chains =
          all_.ways_[w].own_chains ? own_points_ : points_of_reference_;
      errors.sum.Add(points_, same_chains, rigid_points_);
      all_.tips_->Add(w, run.scene(), *layout_, points_, points_of_reference_);
      if (own_) errors.own.Add(points_, own_points_, rigid_points_);
      errors.live += double(run.scene().LiveStrands()) / double(layout_->strands());
    }

    // Of a frame without reference, in which every strand lives.
    void AddToDigest(size_t w, const SceneRun& run) {
      layout_->Read(run.scene(), points_);
      Fold(all_.errors_[w].digest);
    }

   private:
    void Fold(uint64_t& digest) const {
      for (const float value : points_) digest = MixSeed(digest, std::bit_cast<uint32_t>(value));
    }
    bool Counts(uint32_t f) const { return f >= all_.result_.warm_up; }
    static void RunTo(SceneRun& run, uint32_t f, uint32_t rate, SceneRods* rods = nullptr) {
      for (uint32_t sub = f == 0 ? 0 : (f - 1) * rate + 1; sub <= f * rate; ++sub) {
        run.RunFrame(sub);
        if (rods) rods->Record(run.scene());
      }
    }

    Lockstep& all_;
    Scenario fine_scenario_, coarse_scenario_, own_scenario_;
    std::unique_ptr<SceneRun> fine_, coarse_, own_, rigid_;
    std::unique_ptr<ScenePointsLayout> layout_;
    ScenePoints rigid_points_, points_of_reference_, own_points_, points_;
    std::vector<ScenePoints> carried_;  // [way], secondary motion of the last frame simulated
  };

  // A run keeps nothing of the layers of its scenario, so that all of a rate share one.
  std::unique_ptr<SceneRun> MakeRun(const SceneWay& way) {
    Scenario& scenario = !way.simulate    ? rigid_scenario_
                         : way.halved     ? half_
                         : way.own_chains ? own_
                                          : full_;
    SetWay(way, way.own_chains ? own_base_ : base_, scenario);
    return std::make_unique<SceneRun>(way, scenario, options_.isa);
  }

  void RunFrame(size_t w, uint32_t f, SceneRun& run) {
    run.RunFrame(ways_[w].halved ? f / 2 : f);
    times_[w].Add(f, run);
  }

  const ScenePrecisionOptions& options_;
  ScenePrecision& result_;
  Scenario base_, full_, half_, rigid_scenario_, own_base_, own_;
  std::vector<SceneWay> ways_;
  std::vector<FrameTimes> times_;
  std::vector<Errors> errors_;
  ErrorSum self_, chains_;
  std::unique_ptr<SceneRods> rods_;
  std::optional<TipErrors> tips_;
};

uint32_t Even(double frames) { return 2 * uint32_t(frames / 2.0); }

uint64_t DigestOf(const ScenePrecision& result) {
  uint64_t digest = std::bit_cast<uint64_t>(result.self_error);
  // In an order that times have no part in.
  for (const SceneWay& way : WaysOf(result.options))
    if (const ScenePrecisionRow* row = result.Find(way.name)) {
      for (const double error : {row->error, row->own_error, row->rod_error.value_or(0.0)})
        digest = MixSeed(digest, std::bit_cast<uint64_t>(error));
      digest = MixSeed(digest, row->points_digest);
    }
  return digest;
}

}  // namespace

bool ScenePrecision::IsParetoOptimal(const ScenePrecisionRow& row, SceneTime time) const {
  if (!row.way.IsChoice()) return false;
  return std::none_of(rows.begin(), rows.end(), [&](const ScenePrecisionRow& other) {
    return other.way.IsChoice() && other.*time <= row.*time && other.error <= row.error &&
           (other.*time < row.*time || other.error < row.error);
  });
}

const ScenePrecisionRow* ScenePrecision::Find(std::string_view way) const {
  const auto found = std::find_if(rows.begin(), rows.end(),
                                  [&](const ScenePrecisionRow& r) { return r.way.name == way; });
  return found == rows.end() ? nullptr : &*found;
}

ScenePrecision MeasureScenePrecision(const Scenario& scene, const ScenePrecisionOptions& wanted) {
  if (scene.StrandCount() == 0)
    throw Error(fmt::format("{} has no strands, whose errors these would be", scene.name));
  ScenePrecision result;
  result.options = wanted;
  result.scene = scene.name;
  ScenePrecisionOptions& o = result.options;
  if (o.frames == 0) o.frames = o.quick ? 120 : 240;
  if (o.quick) o.rounds = 1;
  o.frames = std::max(12u, Even(o.frames));
  result.warm_up = Even(o.warm_up_share * o.frames);
  Lockstep lockstep(scene, result);
  size_t done = 0;
  const auto progress = [&] {
    if (o.progress) o.progress(++done, lockstep.Steps());
  };
  for (int round = 0; round < o.rounds; ++round) lockstep.RunRound(round == 0, progress);
  lockstep.CompareWithRods(progress);
  if (scene.more)
    result.notes.push_back(
        "the scene's events are given by frame, and come at other times in the reference: errors "
        "are of that");
  lockstep.Summarise();
  if (const ScenePrecisionRow* pbd = result.Find("pbd")) {
    const double simulate_ns = pbd->simulate_ns, frame_ns = pbd->frame_ns;
    for (ScenePrecisionRow& row : result.rows) {
      row.of_pbd = row.simulate_ns / simulate_ns;
      row.frame_of_pbd = row.frame_ns / frame_ns;
    }
  }
  std::stable_sort(result.rows.begin(), result.rows.end(),
                   [](const ScenePrecisionRow& a, const ScenePrecisionRow& b) {
                     return a.frame_ns < b.frame_ns;
                   });
  result.error_digest = DigestOf(result);
  o.progress = {};
  return result;
}

}  // namespace pelt::accuracy
