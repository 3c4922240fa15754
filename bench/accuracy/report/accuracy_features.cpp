#include <fmt/format.h>

#include <chrono>

#include "bench/accuracy/report/accuracy_report.hpp"
#include "core/error.hpp"
#include "core/groom/layer_params.hpp"

namespace pelt {

using namespace accuracy;

namespace {

constexpr double kMostPenetration = 0.01;  // of the length

std::string_view NameOf(ModalQuality quality) {
  return LayerParamEntryOf(&LayerParams::quality).words[size_t(quality)];
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

ReportTree MakeFeatureTree(const FeatureReport& report) {
  const FeatureOptions& o = report.options;
  ReportTree tree;
  tree.Add(InJson("format"), kFeatureAccuracyFormat);
  tree.Say(fmt::format(
      "Error of the modal solver at 60 Hz where something acts on strands: part of the secondary "
      "motion that is wrong, against the solver at its best with {} times the frames; self: what "
      "that differs by from one with half as many. Penetration: deepest point inside what it may "
      "not enter, over the strand's length; ! marks more than {:g} %. More: per strand and frame "
      "beyond the same strands without the feature. Contact: the error against a reference of its "
      "own, {} steps a second (16 times as many for what is fast) that share nothing with the "
      "solver, and what that differs by from one with half as many. Fastest: where strands overlap "
      "something from the start, the fastest "
      "point; where they should come to rest, that of the last half second.",
      o.reference_scale, 100.0 * kMostPenetration, o.contact_rate));
  ReportTable& rows = tree.AddTable("rows", {InText(" "),
                                             {"links"},
                                             {"feature"},
                                             {"quality"},
                                             {"error", "%", 2, "", 100},
                                             {"penetration", "%", 3, "", 100},
                                             {"more_ns", "ns", 1, "more"},
                                             {"self_error", "%", 3, "self", 100},
                                             {"contact_error", "%", 2, "contact", 100},
                                             {"contact_self_error", "%", 3, "self", 100},
                                             {"fastest", "m/s", 3}});
  const auto or_none = [](const std::optional<double>& value) {
    return value ? Value(*value) : Value();
  };
  for (const FeatureReport::Chain& chain : report.chains)
    for (const FeatureError& row : chain.rows)
      rows.Add({row.penetration > kMostPenetration ? Value("!") : Value{}, chain.links, row.name,
                NameOf(row.quality), row.error, row.penetration, row.nanoseconds, row.self_error,
                or_none(row.contact_error), or_none(row.contact_self_error), or_none(row.fastest)});
  tree.BlankLine();
  AddMachine(report.machine, tree);
  tree.EndLine();
  tree.Add({"isa", "", -1, "one core, kernels"}, IsaName(report.isa));
  tree.Add(InJson("quick"), report.quick).Add(InJson("reference_rate"), o.reference_scale);
  tree.Add(InJson("contact_rate"), o.contact_rate);
  tree.Add({"timed_strands"}, o.timing.strands);
  tree.Add({"rounds", "", -1, "median frame of rounds with and without in turn"}, o.timing.repeats);
  tree.Add({"timed_frames", "", -1, "of frames"}, o.timing.frames).EndLine();
  tree.Add({"motion_s", "s, medium preset", -1, "motion"}, o.seconds);
  tree.Add({"seconds", "s", 1, "took"}, report.seconds);
  return tree;
}

}  // namespace pelt
