#include "bench/accuracy/report/accuracy_features.hpp"

#include <fmt/format.h>

#include <chrono>

#include "bench/report/json_text.hpp"
#include "core/error.hpp"

namespace pelt {

using namespace accuracy;

namespace {

constexpr std::string_view kQualityNames[] = {"fast", "default", "best"};
constexpr double kMostPenetration = 0.01;  // of the length

std::string_view NameOf(ModalQuality quality) { return kQualityNames[size_t(quality)]; }

void AddChain(const FeatureReport::Chain& chain, std::string& text) {
  text += fmt::format("\n{} links\n  {:<14} {:<8} {:>9} {:>14} {:>12} {:>9}\n", chain.links,
                      "feature", "quality", "error, %", "penetration, %", "more, ns", "self, %");
  for (const FeatureError& row : chain.rows)
    text += fmt::format("{} {:<14} {:<8} {:>9.2f} {:>14.3f} {:>12.1f} {:>9.3f}\n",
                        row.penetration > kMostPenetration ? '!' : ' ', row.name,
                        NameOf(row.quality), 100.0 * row.error, 100.0 * row.penetration,
                        row.nanoseconds, 100.0 * row.self_error);
}

}  // namespace

FeatureReport MeasureFeatureReport(Isa isa, const std::vector<int>& links, bool quick) {
  const ModalKernels kernels = ModalKernelsOf(isa);
  FeatureReport report;
  report.isa = isa;
  report.quick = quick;
  if (quick) {
    report.options.seconds = 1.0;
    report.options.timing.repeats = 2;
  }
  const auto begin = std::chrono::steady_clock::now();
  for (const int count : links.empty() ? std::vector<int>{3, 4} : links) {
    FeatureOptions options = report.options;
    options.links = count;
    report.chains.push_back({count, MeasureFeatures(kernels, options)});
  }
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return report;
}

std::string FeatureText(const FeatureReport& report) {
  const FeatureOptions& o = report.options;
  std::string text = fmt::format(
      "Error of the modal solver at 60 Hz where something acts on strands: part of the secondary "
      "motion that is wrong,\nagainst the solver at its best with {} times the frames; self: what "
      "that differs by from one with half as many.\nPenetration: deepest point inside what it may "
      "not enter, over the strand's length; ! marks more than {:g} %.\nMore, ns: a strand and "
      "frame "
      "beyond the same strands without the feature.\n",
      o.reference_scale, 100.0 * kMostPenetration);
  for (const FeatureReport::Chain& chain : report.chains) AddChain(chain, text);
  text += fmt::format(
      "\nmachine   {} ({} cores), {}, {}\ncommit    {}\ntimes     {} kernels, one core, {} "
      "strands; fastest of {} rounds with and without in turn, {} frames each\nmotion    {:g} s, "
      "medium preset\ntook      {:.1f} s\n",
      report.machine.processor, report.machine.cores, report.machine.compiler,
      report.machine.build_type, report.machine.commit, IsaName(report.isa), o.timing.strands,
      o.timing.repeats, o.timing.frames, o.seconds, report.seconds);
  return text;
}

std::string FeatureJson(const FeatureReport& report) {
  JsonText json;
  json.BeginObject();
  json.Add("format", kFeatureAccuracyFormat);
  AddMachine(report.machine, json);
  json.Add("isa", IsaName(report.isa));
  json.Add("quick", report.quick);
  json.Add("motion_s", report.options.seconds);
  json.Add("reference_rate", report.options.reference_scale);
  json.Add("timed_strands", report.options.timing.strands);
  json.Add("timed_frames", report.options.timing.frames);
  json.Add("rounds", report.options.timing.repeats);
  json.Add("seconds", report.seconds);
  json.BeginArray("rows");
  for (const FeatureReport::Chain& chain : report.chains)
    for (const FeatureError& row : chain.rows) {
      json.BeginObject();
      json.Add("links", chain.links);
      json.Add("feature", row.name);
      json.Add("quality", NameOf(row.quality));
      json.Add("error", row.error);
      json.Add("penetration", row.penetration);
      json.Add("more_ns", row.nanoseconds);
      json.Add("self_error", row.self_error);
      json.EndObject();
    }
  json.EndArray();
  json.EndObject();
  return json.text();
}

}  // namespace pelt
