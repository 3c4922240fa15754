#include "bench/report/report_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "bench/report/embedded_page.hpp"
#include "bench/report/timeline.hpp"

namespace pelt {

std::string ComparisonPage(const ComparedSide& a, const ComparedSide& b, const ReportTree& found) {
  nlohmann::ordered_json data;
  data["comparison"] = nlohmann::ordered_json::parse(found.Json());
  for (const auto& [key, side] : {std::pair("a", &a), std::pair("b", &b)}) {
    auto& frames = data["frame_ms"][key] = nlohmann::ordered_json::array();
    for (const MeasuredRun& run : side->rounds)
      for (const double ms : run.frame_ms) frames.push_back(ms);
  }
  return FillPage(EmbeddedPair(), data.dump());
}

namespace {

// More columns than this cannot be distinguished in a picture.
constexpr size_t kColumns = 600;
// Stages with a colour of their own, the most costly first.
constexpr size_t kColours = 8;

uint64_t FrameTicksOf(const FrameTicks& ticks) { return ticks.end - ticks.begin; }

// Ten-thousandths of a millisecond are enough for a picture.
double Short(double ms) { return std::round(ms * 1e4) * 1e-4; }

}  // namespace

class PageData {
 public:
  PageData(const ReportRecorder& recorder, const RunReport& report, double ns_per_tick)
      : recorder_(recorder),
        scene_(recorder.scene_),
        report_(report),
        ms_per_tick_(ns_per_tick * 1e-6) {}

  std::string Text(const std::function<void(JsonText&)>& add_consoles,
                   const std::function<void(JsonText&)>& add_accuracy) {
    json_.BeginObject();
    AddHead();
    AddStages();
    AddPasses();
    AddCosts();
    AddColumns();
    AddItems();
    json_.BeginArray("timelines");
    AddTimeline("median frame", FindMedianFrame());
    AddTimeline("worst frame", *recorder_.worst_);
    json_.EndArray();
    json_.BeginArray("consoles");
    if (add_consoles) add_consoles(json_);
    json_.EndArray();
    json_.BeginArray("accuracy");
    if (add_accuracy) add_accuracy(json_);
    json_.EndArray();
    AddMemory();
    json_.EndObject();
    return json_.Compact();
  }

 private:
  double Ms(uint64_t ticks) const { return double(ticks) * ms_per_tick_; }

  template <class Value>
  std::vector<double> Series(Value value) const {
    std::vector<double> series;
    for (const ReportRecorder::Row& row : recorder_.rows_) series.push_back(Ms(value(row)));
    return series;
  }

  void AddSpread(std::string_view key, std::vector<double> ms) {
    const Spread spread = SpreadOf(ms);  // sorts
    json_.BeginObject(key);
    json_.Add("median", spread.median);
    json_.Add("p95", spread.p95);
    json_.Add("p99", ms[size_t(0.99 * double(ms.size() - 1) + 0.5)]);
    json_.Add("worst", spread.worst);
    json_.EndObject();
  }

  void AddHead() {
    const RunReport& r = report_;
    json_.Add("scene", r.scene);
    json_.Add("strands", r.strands);
    json_.Add("chunks", r.chunks);
    json_.Add("layers", r.layers);
    json_.Add("characters", r.characters);
    json_.Add("frames", r.frames);
    json_.Add("live_strands", r.live_strands);
    json_.Add("drawn_strands", r.drawn_strands);
    json_.Add("workers", r.workers);
    json_.Add("workers_observed", r.workers_observed);
    json_.Add("disturbances", FindDisturbances(r.use, r.workers));
    json_.Add("executor", r.options.executor->name);
    json_.Add("isa", IsaName(r.options.scene.isa));
    json_.Add("fused", r.options.scene.plan.fuse);
    json_.Add("processor", r.machine.processor);
    json_.Add("cores", r.machine.cores);
    json_.Add("compiler", r.machine.compiler);
    json_.Add("build_type", r.machine.build_type);
    json_.Add("commit", r.machine.commit);
    json_.Add("digest", r.options.digest ? fmt::format("{:016x}", r.digest) : "not taken");
    using Row = ReportRecorder::Row;
    AddSpread("frame_ms", Series([](const Row& row) { return row.frame_ticks; }));
    AddSpread("caller_ms", Series([](const Row& row) { return row.caller_ticks; }));
  }

  // Also ranks them: a stage's colour is its place among the most costly.
  void AddStages() {
    const Plan& plan = scene_.plan();
    std::vector<double> median_ms;
    for (size_t s = 0; s < plan.stages.size(); ++s) {
      std::vector<double> ms = Series([s](const auto& row) { return row.stage_ticks[s]; });
      median_ms.push_back(SpreadOf(ms).median);
    }
    std::vector<uint32_t> order(plan.stages.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](uint32_t a, uint32_t b) { return median_ms[a] > median_ms[b]; });
    order.resize(std::min(order.size(), kColours));
    coloured_ = order;

    json_.BeginArray("stages");
    for (size_t s = 0; s < plan.stages.size(); ++s) {
      const StageBudget& budget = report_.budget.stages[s];
      const auto colour = std::find(order.begin(), order.end(), uint32_t(s));
      double ran = 0.0;
      for (const ReportRecorder::Row& row : recorder_.rows_) ran += row.ran[s];
      ran /= double(recorder_.rows_.size());
      json_.BeginObject();
      json_.Add("name", budget.name);
      json_.Add("domain", DomainName(budget.domain));
      json_.Add("colour", colour == order.end() ? -1 : int(colour - order.begin()));
      AddSpread("core_ms", Series([s](const auto& row) { return row.stage_ticks[s]; }));
      json_.Add("ran", ran);
      json_.Add("skipped", std::max(0.0, budget.ran + budget.skipped - ran));
      json_.Add("bytes", budget.bytes);
      json_.EndObject();
    }
    json_.EndArray();
  }

  void AddCoreMs(const Spread& ms) {
    json_.BeginObject("core_ms");
    json_.Add("median", ms.median);
    json_.Add("p95", ms.p95);
    json_.Add("worst", ms.worst);
    json_.EndObject();
  }

  void AddQuality(const LayerQuality& layer) {
    json_.Add("solver", layer.solver);
    if (layer.asked.empty()) return;
    json_.Add("ran", std::vector<uint32_t>(layer.frames.begin(), layer.frames.end()));
    json_.Add("error_px", double(layer.error_px));
  }

  void AddCosts() {
    const CostSplit costs = recorder_.costs_.Summarise(ms_per_tick_, report_.layer_strands);
    json_.BeginArray("layer_costs");
    for (size_t l = 0; l < costs.layers.size(); ++l) {
      const LayerCost& layer = costs.layers[l];
      json_.BeginObject();
      json_.Add("name", layer.name);
      json_.Add("character", layer.character);
      json_.Add("strands", layer.strands);
      json_.Add("chunks", layer.chunks);
      AddCoreMs(layer.core_ms);
      json_.Add("most_stage", layer.dearest_stage);
      json_.Add("most_share", layer.dearest_share);
      AddQuality(report_.qualities[l]);
      json_.EndObject();
    }
    json_.EndArray();
    json_.BeginArray("character_costs");
    for (const CharacterCost& character : costs.characters) {
      json_.BeginObject();
      json_.Add("layers", character.layers);
      json_.Add("strands", character.strands);
      AddCoreMs(character.core_ms);
      json_.Add("own_ms", character.own_ms);
      json_.EndObject();
    }
    json_.EndArray();
    json_.BeginObject("scene_cost");
    AddCoreMs(costs.scene_ms);
    json_.EndObject();
    json_.BeginObject("cost");
    AddCoreMs(costs.all_ms);
    json_.EndObject();
  }

  void AddPasses() {
    const Plan& plan = scene_.plan();
    json_.BeginArray("passes");
    for (size_t p = 0; p < plan.passes.size(); ++p) {
      const Pass& pass = plan.passes[p];
      json_.BeginObject();
      json_.Add("name", PassName(plan, uint32_t(p)));
      json_.Add("domain", DomainName(pass.domain));
      json_.Add("items", scene_.shape().ItemCount(pass.domain));
      json_.Add("resident", pass.resident_bytes);
      json_.Add("get", pass.get_bytes);
      json_.Add("put", pass.put_bytes);
      json_.Add("first_stage", pass.first_stage);
      json_.Add("stage_count", pass.stage_count);
      AddSpread("wall_ms", Series([p](const auto& row) { return row.pass_ticks[p]; }));
      json_.EndObject();
    }
    json_.EndArray();
  }

  // What the picture over the frames shows: one column per frame, or, of many frames, the slowest of a
  // few. The coloured stages' core time is divided by the workers; what is left of the frame's wall
  // time is waiting.
  void AddColumns() {
    const auto& rows = recorder_.rows_;
    const size_t group = (rows.size() + kColumns - 1) / kColumns;
    json_.Add("frames_a_column", group);
    json_.BeginArray("columns");
    for (size_t first = 0; first < rows.size(); first += group) {
      size_t at = first;
      for (size_t f = first; f < std::min(first + group, rows.size()); ++f)
        if (rows[f].frame_ticks > rows[at].frame_ticks) at = f;
      AddColumn(at, rows[at]);
    }
    json_.EndArray();
  }
  void AddColumn(size_t frame, const ReportRecorder::Row& row) {
    const double all_ms =
        Ms(std::accumulate(row.stage_ticks.begin(), row.stage_ticks.end(), uint64_t{0})) /
        report_.workers;
    double coloured_ms = 0.0;
    json_.BeginObject();
    json_.Add("frame", frame);
    json_.Add("ms", Short(Ms(row.frame_ticks)));
    json_.Add("caller", Short(Ms(row.caller_ticks)));
    json_.BeginArray("stages");
    for (const uint32_t s : coloured_) {
      const double ms = Ms(row.stage_ticks[s]) / report_.workers;
      coloured_ms += ms;
      json_.Add("", Short(ms));
    }
    json_.EndArray();
    json_.Add("others", Short(all_ms - coloured_ms));
    json_.Add("waiting", Short(std::max(0.0, Ms(row.frame_ticks) - Ms(row.caller_ticks) - all_ms)));
    AddWait(row.wait, Ms(row.frame_ticks));
    json_.EndObject();
  }

  // Of a frame.
  void AddWait(const CoreWait& wait, double frame_ms) {
    json_.Add("disturbed", IsDisturbed(wait, frame_ms, Threads(report_.use, report_.workers)));
    json_.Add("preemptions", wait.preemptions);
    if (wait.waited_ms) json_.Add("waited_ms", Short(*wait.waited_ms));
  }

  void AddItems() {
    json_.BeginObject("items");
    for (const Domain domain :
         {Domain::kScene, Domain::kCharacter, Domain::kLayer, Domain::kPatch, Domain::kChunk}) {
      json_.BeginArray(DomainName(domain));
      for (uint32_t i = 0; i < scene_.shape().ItemCount(domain); ++i)
        json_.Add("", ItemName(scene_, domain, i));
      json_.EndArray();
    }
    json_.EndObject();
  }

  const FrameRecord& FindMedianFrame() const {
    std::vector<uint64_t> ticks;
    for (const ReportRecorder::Row& row : recorder_.rows_) ticks.push_back(row.frame_ticks);
    const auto middle = ticks.begin() + ptrdiff_t(ticks.size() / 2);
    std::nth_element(ticks.begin(), middle, ticks.end());
    const auto distance = [&](const FrameRecord& record) {
      return std::abs(double(FrameTicksOf(record.ticks)) - double(*middle));
    };
    return *std::min_element(
        recorder_.kept_.begin(), recorder_.kept_.end(),
        [&](const FrameRecord& a, const FrameRecord& b) { return distance(a) < distance(b); });
  }

  // Times from the frame's begin, in ns.
  void AddTimeline(std::string_view title, const FrameRecord& record) {
    const auto ns = [&](uint64_t ticks) {
      return ticks <= record.ticks.begin ? 0 : int64_t(Ms(ticks - record.ticks.begin) * 1e6 + 0.5);
    };
    json_.BeginObject();
    json_.Add("title", title);
    json_.Add("frame", record.frame);
    json_.Add("ns", ns(record.ticks.end));
    json_.Add("caller_ns", ns(record.ticks.prepared));
    AddWait(record.wait, Ms(FrameTicksOf(record.ticks)));
    const std::vector<PreemptedItem> preempted =
        FindPreempted(record, recorder_.kept_, ms_per_tick_);
    json_.BeginArray("passes");
    for (const Slice& pass : record.passes) {
      json_.Add("", ns(pass.begin_ticks));
      json_.Add("", ns(pass.end_ticks));
    }
    json_.EndArray();
    // For each worker: stage, item, begin, end, one after the other.
    json_.BeginArray("workers");
    for (uint32_t w = 0; w < report_.workers; ++w) {
      json_.BeginObject();
      json_.Add("name", WorkerName(w));
      json_.BeginArray("runs");
      for (const FrameRecord::Item& item : record.items) {
        if (item.worker != w) continue;
        for (uint32_t r = item.first_run; r < item.first_run + item.run_count; ++r) {
          json_.Add("", record.runs[r].stage);
          json_.Add("", item.item);
          json_.Add("", ns(record.runs[r].begin_ticks));
          json_.Add("", ns(record.runs[r].end_ticks));
        }
      }
      json_.EndArray();
      // Items during which others likely had its core: begin, end, how much longer than usual.
      json_.BeginArray("preempted");
      for (const PreemptedItem& found : preempted) {
        const FrameRecord::Item& item = record.items[found.at];
        if (item.worker != w) continue;
        json_.Add("", ns(item.begin_ticks));
        json_.Add("", ns(item.end_ticks));
        json_.Add("", int64_t(Ms(found.over_ticks) * 1e6));
      }
      json_.EndArray();
      json_.EndObject();
    }
    json_.EndArray();
    json_.EndObject();
  }

  void AddMemory() {
    json_.Add("memory_bytes", report_.layout.total_bytes);
    json_.Add("state_bytes_per_strand", report_.layout.StateBytesPerStrand());
    json_.BeginArray("memory");
    for (const MemoryRange& range : report_.layout.ranges) {
      if (!range.bytes) continue;
      json_.BeginObject();
      json_.Add("name", range.name);
      json_.Add("role", RoleName(range.role));
      json_.Add("blocks", range.blocks);
      json_.Add("bytes", range.bytes);
      json_.EndObject();
    }
    json_.EndArray();
  }

  const ReportRecorder& recorder_;
  const FurScene& scene_;
  const RunReport& report_;
  double ms_per_tick_;
  std::vector<uint32_t> coloured_;
  JsonText json_;
};

ReportRecorder::ReportRecorder(const FurScene& scene) : scene_(scene), costs_(scene, 0) {}

void ReportRecorder::Add(const FinishedFrame& frame) {
  const Plan& plan = scene_.plan();
  FrameRecord record = RecordFrame(frame.scene, frame.profile, frame.frame, frame.ticks);
  record.wait = frame.wait;
  Row row{FrameTicksOf(record.ticks),
          record.ticks.prepared - record.ticks.begin,
          std::vector<uint64_t>(plan.stages.size()),
          {},
          std::vector<uint32_t>(plan.stages.size()),
          frame.wait};
  costs_.BeginFrame();
  for (const FrameRecord::Item& item : record.items)
    for (uint32_t r = item.first_run; r < item.first_run + item.run_count; ++r) {
      const FrameRecord::StageRun& run = record.runs[r];
      row.stage_ticks[run.stage] += run.Ticks();
      ++row.ran[run.stage];
      costs_.Add(run.stage, item.item, run.Ticks());
    }
  for (const Slice& pass : record.passes) row.pass_ticks.push_back(pass.Ticks());
  rows_.push_back(std::move(row));
  if (!worst_ || FrameTicksOf(record.ticks) > FrameTicksOf(worst_->ticks)) worst_ = record;
  if (frame.frame % stride_ != 0) return;
  kept_.push_back(std::move(record));
  if (kept_.size() < kKeptFrames) return;
  stride_ *= 2;
  std::erase_if(kept_, [&](const FrameRecord& r) { return r.frame % stride_ != 0; });
}

std::string ReportRecorder::Page(const RunReport& report, double ns_per_tick,
                                 const std::function<void(JsonText&)>& add_consoles,
                                 const std::function<void(JsonText&)>& add_accuracy) const {
  return FillPage(EmbeddedReport(),
                  PageData(*this, report, ns_per_tick).Text(add_consoles, add_accuracy));
}

}  // namespace pelt
