#include "bench/report/run_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/report/budget.hpp"
#include "core/error.hpp"
#include "core/file_bytes.hpp"
#include "core/format.hpp"

namespace pelt {
namespace {

using RunJson = nlohmann::ordered_json;
using Pairs = std::vector<std::pair<double, double>>;

constexpr size_t kLeastBlocks =
    12;  // of 20, those of 150 frames are still alike: see the test of what intervals hold
// Of the whole run, but not what it was of.
constexpr std::string_view kMeasured[] = {"digest", "ns_per_strand", "workers_observed"};

class RunReader {
 public:
  explicit RunReader(std::string_view from) : from_(from) {}

  MeasuredRun Read(std::string_view text) const {
    const RunJson json = Parse(text);
    MeasuredRun run;
    const RunJson& samples = Member(json, "samples", {});
    run.frame_ms = Times(Member(samples, "frame_ms", "samples."), "samples.frame_ms");
    AddTimes(Member(samples, "stages", "samples."), "samples.stages", run.stages_ms);
    for (const char* owners : {"layers", "characters"})
      if (samples.contains(owners))
        AddTimes(samples[owners], fmt::format("samples.{}", owners), run.owners_ms);
    for (const auto& [key, value] : json.items()) {
      const bool is_measured = std::count(std::begin(kMeasured), std::end(kMeasured), key) != 0;
      if (is_measured || value.is_structured()) continue;
      run.settings.emplace_back(
          Printable(key), Printable(value.is_string() ? value.get<std::string>() : value.dump()));
    }
    AddOptions(json, run);
    AddDisturbances(json, run);
    if (const auto digest = json.find("digest"); digest != json.end()) {
      if (!digest->is_string()) Fail("'digest' is not a text");
      run.digest = Printable(digest->get<std::string>());
    }
    return run;
  }

 private:
  // Those that have no key of their own.
  void AddOptions(const RunJson& json, MeasuredRun& run) const {
    const auto options = json.find("options");
    if (options == json.end()) return;  // of a program that did not say
    if (!options->is_object()) Fail("'options' is not an object");
    for (const auto& [option, value] : options->items()) {
      if (!value.is_string()) Fail(fmt::format("'options.{}' is not a text", Printable(option)));
      if (option.starts_with("--") && json.contains(option.substr(2))) continue;
      run.settings.emplace_back(Printable(option), Printable(value.get<std::string>()));
    }
  }

  void AddDisturbances(const RunJson& json, MeasuredRun& run) const {
    const auto use = json.find("machine_use");
    if (use == json.end()) return;  // of a program that did not say
    const RunJson& texts = Member(*use, "disturbances", "machine_use.");
    for (const RunJson& text : texts) {
      if (!text.is_string()) Fail("'machine_use.disturbances' is no list of texts");
      run.disturbances.push_back(Printable(text.get<std::string>()));
    }
  }

  [[noreturn]] void Fail(std::string_view reason) const {
    throw Error(fmt::format("{}: {}; expected what pelt run --json prints", from_, reason));
  }

  RunJson Parse(std::string_view text) const {
    try {
      return RunJson::parse(text);
    } catch (const RunJson::parse_error& error) {
      const size_t at = std::min(error.byte, text.size());
      const auto line = std::count(text.begin(), text.begin() + ptrdiff_t(at), '\n') + 1;
      Fail(fmt::format("not one whole JSON value: line {}, byte {} of {}", line, at, text.size()));
    }
  }
  const RunJson& Member(const RunJson& object, const char* key, std::string_view place) const {
    if (!object.is_object() || !object.contains(key))
      Fail(fmt::format("'{}{}' is missing", place, key));
    return object[key];
  }
  void AddTimes(const RunJson& of, const std::string& place, MeasuredRun::Times& to) const {
    if (!of.is_object()) Fail(fmt::format("'{}' is not an object", place));
    for (const auto& [name, times] : of.items())
      to.emplace_back(Printable(name), Times(times, place + '.' + Printable(name)));
  }
  std::vector<double> Times(const RunJson& list, const std::string& place) const {
    if (!list.is_array() || list.empty()) Fail(fmt::format("'{}' is no list of times", place));
    std::vector<double> times;
    for (const RunJson& value : list) {
      if (!value.is_number() || !(value.get<double>() >= 0.0))
        Fail(fmt::format("'{}[{}]' is no time: {}", place, times.size(), value.dump()));
      times.push_back(value.get<double>());
    }
    return times;
  }

  std::string_view from_;
};

double MedianOf(std::span<const double> values) {
  std::vector<double> sorted(values.begin(), values.end());
  return SpreadOf(sorted).median;
}

// How many of the lowest and of the highest ratios lie outside an interval. By the sign test: each
// pair is above the median or below it. Of so many rows each may miss its median in an equal part of
// the samples in which any may, so that they hold together, however they hang together.
size_t CountOutside(size_t pairs, size_t rows) {
  size_t count = 0;
  // The binomial's terms as shares of 2^pairs, from k = 0; of over 1,022 pairs the first would be 0.
  double term = std::exp2(-double(pairs)), sum = 0.0;
  for (size_t k = 0; 2 * (k + 1) <= pairs; ++k) {
    sum += term;
    if (2.0 * sum * double(rows) > 1.0 - kConfidence) break;
    count = k + 1;
    term *= double(pairs - k) / double(k + 1);
  }
  return count;
}

const std::vector<double>* FindTimes(const MeasuredRun::Times& of, std::string_view wanted) {
  for (const auto& [name, times] : of)
    if (name == wanted) return &times;
  return nullptr;
}
const std::string* FindSetting(const MeasuredRun& run, std::string_view key) {
  for (const auto& [name, value] : run.settings)
    if (name == key) return &value;
  return nullptr;
}

// Rounds of a side repeat one run.
void CheckRounds(const ComparedSide& side) {
  const MeasuredRun& first = side.rounds.front();
  for (size_t r = 1; r < side.rounds.size(); ++r)
    for (const auto& [key, value] : first.settings) {
      const std::string* other = FindSetting(side.rounds[r], key);
      if (!other || *other != value)
        throw Error(fmt::format(
            "'{}' does not run the same in every round: '{}' is {} in round 1 and {} in round {}",
            side.name, key, value, other ? *other : "missing", r + 1));
    }
}

// All times of one thing, a list for each round; empty where a round has none.
using Series = std::vector<std::vector<double>>;
template <class Find>
Series SeriesOf(const ComparedSide& side, const Find& find) {
  Series series;
  for (const MeasuredRun& run : side.rounds) {
    const std::vector<double>* times = find(run);
    if (!times) return {};
    series.push_back(*times);
  }
  return series;
}

double MedianOfAll(const Series& series) {
  std::vector<double> all;
  for (const std::vector<double>& times : series) all.insert(all.end(), times.begin(), times.end());
  return MedianOf(all);
}

Pairs PairSeries(const Series& a, const Series& b, size_t rows) {
  if (a.size() == 1) return PairBlocks(a.front(), b.front(), rows);
  Pairs pairs;
  for (size_t r = 0; r < a.size(); ++r) pairs.emplace_back(MedianOf(a[r]), MedianOf(b[r]));
  return pairs;
}

// A row of the comparison.
struct Cost {
  std::string of;
  Series a, b;
  bool of_owner = false;  // a layer or character

  bool InBoth() const { return !a.empty() && !b.empty(); }
};

// A row for each name that one of the two has.
void ListTimes(const ComparedSide& a, const ComparedSide& b, MeasuredRun::Times MeasuredRun::*of,
               bool of_owners, std::vector<Cost>& costs) {
  const auto add = [&](const std::string& name) {
    const auto find = [&](const MeasuredRun& run) { return FindTimes(run.*of, name); };
    costs.push_back({name, SeriesOf(a, find), SeriesOf(b, find), of_owners});
  };
  for (const auto& [name, times] : a.rounds.front().*of) add(name);
  for (const auto& [name, times] : b.rounds.front().*of)
    if (!FindTimes(a.rounds.front().*of, name)) add(name);
}

std::vector<Cost> ListCosts(const ComparedSide& a, const ComparedSide& b) {
  const auto frame = [](const MeasuredRun& run) { return &run.frame_ms; };
  std::vector<Cost> costs = {{"whole frame", SeriesOf(a, frame), SeriesOf(b, frame)}};
  ListTimes(a, b, &MeasuredRun::stages_ms, false, costs);
  if (!a.rounds.front().owners_ms.empty() && !b.rounds.front().owners_ms.empty())
    ListTimes(a, b, &MeasuredRun::owners_ms, true, costs);
  return costs;
}

// Adds the rows; of layers and characters, text has those that differ.
class CostTable {
 public:
  CostTable(ReportTable& table, size_t rows, bool unsure)
      : table_(table), rows_(rows), unsure_(unsure) {}

  // Returns whether they differ.
  bool Add(const Cost& cost) {
    if (!cost.InBoth()) {
      const Value of_a = cost.a.empty() ? Value() : Value(MedianOfAll(cost.a));
      const Value of_b = cost.b.empty() ? Value() : Value(MedianOfAll(cost.b));
      table_.Add({cost.of, of_a, of_b, {}, {}, {}, cost.b.empty() ? "only in A" : "only in B"});
      return true;
    }
    const auto found = RatioOf(PairSeries(cost.a, cost.b, rows_), rows_);
    const std::string_view verdict = found ? VerdictOf(*found) : "";
    const Show show = !verdict.empty() || !cost.of_owner ? Show::kBoth : Show::kJson;
    const Value of_a = MedianOfAll(cost.a), of_b = MedianOfAll(cost.b);
    if (!found)
      table_.Add({cost.of, of_a, of_b}, show);
    else
      table_.Add({cost.of, of_a, of_b, found->ratio, found->low, found->high, verdict}, show);
    return !verdict.empty();
  }

 private:
  std::string_view VerdictOf(const RatioInterval& interval) const {
    if (interval.low <= 1.0 && interval.high >= 1.0) return "";
    return unsure_ ? "UNSURE" : interval.low > 1.0 ? "slower" : "faster";
  }

  ReportTable& table_;
  size_t rows_;
  bool unsure_;
};

void AddCosts(const std::vector<Cost>& costs, size_t rows, bool unsure, ReportTree& tree) {
  CostTable table(tree.AddTable("costs", {{"of", "", -1, "median ms"},
                                          {"a_ms", "", 4, "A"},
                                          {"b_ms", "", 4, "B"},
                                          {"ratio", "", 3, "B/A"},
                                          {"low", "", 3, "from"},
                                          {"high", "", 3, "to"},
                                          {"verdict", "", -1, "B is"}}),
                  rows, unsure);
  size_t owners = 0, differ = 0;
  for (const Cost& cost : costs) {
    const bool differs = table.Add(cost);
    owners += cost.of_owner;
    differ += cost.of_owner && differs;
  }
  if (owners > 0)
    tree.Say(fmt::format("Of {} layers and characters, {} {}differ{}.", owners, differ,
                         unsure ? "may " : "",
                         differ == owners ? "" : ": the others are in --json"));
}

void AddIntervals(size_t rounds, size_t pairs, size_t rows, ReportTree& tree) {
  const size_t needed = PairsNeeded(rows);
  if (pairs < needed)
    return void(tree.Say(
        fmt::format("No intervals: of {} pairs, and {} are needed for all {} rows together.", pairs,
                    needed, rows)));
  tree.Say(fmt::format(
      "Intervals: {:.0f} % for all {} rows together, by ranks of {} {}", 100.0 * kConfidence, rows,
      pairs,
      rounds > 1 ? "alternate rounds."
                 : "parts of the runs. What changed on the machine between the two runs is not in "
                   "them: --commands alternates."));
}

std::string WhyUnsure(std::string_view name, const ComparedSide& side) {
  size_t disturbed = 0;
  const std::string* first = nullptr;
  for (const MeasuredRun& run : side.rounds) {
    if (run.disturbances.empty()) continue;
    ++disturbed;
    if (!first) first = &run.disturbances.front();
  }
  return first ? fmt::format("the machine was not {}'s own in {} of {} runs: {}", name, disturbed,
                             side.rounds.size(), *first)
               : "";
}

void AddSettings(const MeasuredRun& a, const MeasuredRun& b, ReportTree& tree) {
  ReportTable table{.key = "settings",
                    .columns = {{"differs"}, {"a", "", -1, "A"}, {"b", "", -1, "B"}}};
  for (const auto& [key, value] : a.settings) {
    const std::string* other = FindSetting(b, key);
    if (!other || *other != value) table.Add({key, value, other ? Value(*other) : Value()});
  }
  for (const auto& [key, value] : b.settings)
    if (!FindSetting(a, key)) table.Add({key, {}, value});
  if (table.rows.empty())
    tree.Add(InJson("settings"), std::move(table))
        .Say("What the runs say of themselves does not differ.");
  else
    tree.AddTable(table.key, table.columns).rows = std::move(table.rows);
}

// Empty: the rounds have several.
std::string DigestOf(const ComparedSide& side) {
  for (const MeasuredRun& run : side.rounds)
    if (run.digest != side.rounds.front().digest) return {};
  return side.rounds.front().digest;
}

void AddDigests(const ComparedSide& a, const ComparedSide& b, ReportTree& tree) {
  for (const ComparedSide* side : {&a, &b})
    if (side->rounds.front().digest.empty()) {
      tree.Say(fmt::format("digest not taken by {}: not compared", side == &a ? "A" : "B"));
      return;
    }
  const std::string of_a = DigestOf(a), of_b = DigestOf(b);
  const bool same = !of_a.empty() && of_a == of_b;
  tree.Add(InJson("digest.same"), same);
  tree.Add(InJson("digest.a"), of_a).Add(InJson("digest.b"), of_b);
  if (of_a.empty() || of_b.empty())
    tree.Say(fmt::format("DIGEST OF {} CHANGES FROM ROUND TO ROUND", of_a.empty() ? "A" : "B"));
  else if (same)
    tree.Say("digest same: " + of_a);
  else
    tree.Say(fmt::format("digest differs: A {}, B {}", of_a, of_b));
}

}  // namespace

MeasuredRun ReadMeasuredRun(std::string_view from, std::string_view json) {
  return RunReader(from).Read(json);
}

MeasuredRun ReadRunFile(const std::string& path) {
  const std::vector<std::byte> bytes = ReadFileBytes("run", path, kRunBytesLimit).OrThrow();
  return ReadMeasuredRun(fmt::format("run '{}'", path), AsText(bytes));
}

size_t PairsNeeded(size_t rows) {
  size_t pairs = 1;
  while (CountOutside(pairs, rows) == 0) ++pairs;
  return pairs;
}

std::optional<RatioInterval> RatioOf(std::span<const std::pair<double, double>> pairs,
                                     size_t rows) {
  const size_t outside = CountOutside(pairs.size(), rows);
  if (outside == 0) return std::nullopt;
  std::vector<double> ratios;
  for (const auto& [a, b] : pairs) {
    if (!(a > 0.0) || !(b > 0.0)) return std::nullopt;
    ratios.push_back(b / a);
  }
  std::sort(ratios.begin(), ratios.end());
  const size_t middle = ratios.size() / 2;
  const double median =
      ratios.size() % 2 ? ratios[middle] : 0.5 * (ratios[middle - 1] + ratios[middle]);
  return RatioInterval{median, ratios[outside - 1], ratios[ratios.size() - outside]};
}

Pairs PairBlocks(std::span<const double> a, std::span<const double> b, size_t rows) {
  // One more than are needed: blocks beside each other are a little alike, which the sign test does not know.
  const size_t wanted = std::max(kLeastBlocks, PairsNeeded(rows) + 1);
  const size_t count = std::min({wanted, a.size(), b.size()});
  const auto block = [count](std::span<const double> of, size_t i) {
    const size_t first = of.size() * i / count;
    return of.subspan(first, of.size() * (i + 1) / count - first);
  };
  Pairs pairs;
  for (size_t i = 0; i < count; ++i)
    pairs.emplace_back(MedianOf(block(a, i)), MedianOf(block(b, i)));
  return pairs;
}

std::vector<std::string> WhyUnsure(const ComparedSide& a, const ComparedSide& b) {
  std::vector<std::string> found = {WhyUnsure("A", a), WhyUnsure("B", b)};
  std::erase(found, "");
  return found;
}

ReportTree CompareRuns(const ComparedSide& a, const ComparedSide& b) {
  CheckRounds(a);
  CheckRounds(b);
  const std::vector<Cost> costs = ListCosts(a, b);
  const size_t rows = size_t(std::ranges::count_if(costs, &Cost::InBoth));
  const size_t rounds = a.rounds.size();
  const size_t pairs = PairSeries(costs.front().a, costs.front().b, rows).size();
  const std::vector<std::string> why_unsure = WhyUnsure(a, b);
  ReportTree tree;
  tree.Add({"a", "", -1, "A"}, Printable(a.name)).EndLine();
  tree.Add({"b", "", -1, "B"}, Printable(b.name)).EndLine();
  tree.Add(InJson("rounds"), rounds).Add(InJson("pairs"), pairs).Add(InJson("rows"), rows);
  tree.Add(InJson("confidence"), pairs < PairsNeeded(rows) ? 0.0 : kConfidence).BlankLine();
  AddSettings(a.rounds.front(), b.rounds.front(), tree);
  AddCosts(costs, rows, !why_unsure.empty(), tree);
  for (const ComparedSide* side : {&a, &b})
    if (side->rounds.front().owners_ms.empty())
      tree.Say(fmt::format("{} does not say what its layers cost.", side == &a ? "A" : "B"));
  AddIntervals(rounds, pairs, rows, tree);
  AddDigests(a, b, tree);
  tree.AddTexts("unsure", why_unsure, "UNSURE");
  return tree;
}

}  // namespace pelt
