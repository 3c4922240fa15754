// Shards: which cases one has, where its number comes from, and that a merge gives the verdict of
// the whole run or refuses.
#include "bench/verify/shard.hpp"

#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "bench/verify/verify.hpp"
#include "tests/error_from.hpp"

namespace pelt {
namespace {

using Json = nlohmann::ordered_json;

std::map<std::string, std::string> environment;
const char* ReadVariable(const char* name) {
  const auto at = environment.find(name);
  return at == environment.end() ? nullptr : at->second.c_str();
}
Shard Parse(std::string_view text, std::map<std::string, std::string> variables = {}) {
  environment = std::move(variables);
  return ParseShard(text, ReadVariable);
}

void ExpectError(const auto& call, std::string_view word) {
  const std::string error = test::ErrorFrom(call);
  EXPECT_NE(error.find(word), std::string::npos) << "'" << word << "': " << error;
}

TEST(Shard, EveryPlaceIsTakenOnce) {
  for (const uint32_t count : {1u, 2u, 3u, 7u, 100u})
    for (uint32_t place = 0; place < 3000; ++place) {  // a matrix has some 2,000 cases
      uint32_t taken = 0;
      for (uint32_t i = 0; i < count; ++i) taken += Shard{i, count}.Takes(place);
      EXPECT_EQ(taken, 1u);
    }
}

TEST(Shard, IsReadFromTheCommandLine) {
  EXPECT_EQ(Parse("0/3"), (Shard{0, 3}));
  EXPECT_EQ(Parse("2/3"), (Shard{2, 3}));
  EXPECT_EQ(Parse("99999/100000"), (Shard{99999, 100000}));
  for (const char* bad : {"", "3", "/", "1/", "/3", "1/3/5", "-1/3", "+1/3", " 1/3", "1/3 ", "a/b",
                          "1.0/3", "0x1/3", "4294967296/4294967297"})
    ExpectError([&] { Parse(bad); }, "is neither i/n");
  ExpectError([] { Parse("3/3"); }, "from 0/3 to 2/3");
  ExpectError([] { Parse("0/0"); }, "0 shards");
  ExpectError([] { Parse("0/100001"); }, "100001 shards");
}

TEST(Shard, IsReadFromEveryLaunchersEnvironment) {
  EXPECT_EQ(Parse("env", {{"OMPI_COMM_WORLD_RANK", "2"}, {"OMPI_COMM_WORLD_SIZE", "3"}}),
            (Shard{2, 3}));
  EXPECT_EQ(Parse("env", {{"PMI_RANK", "0"}, {"PMI_SIZE", "4"}}), (Shard{0, 4}));
  EXPECT_EQ(Parse("env", {{"SLURM_PROCID", "5"}, {"SLURM_NTASKS", "8"}}), (Shard{5, 8}));
  EXPECT_EQ(Parse("env", {{"SLURM_ARRAY_TASK_ID", "11"},
                          {"SLURM_ARRAY_TASK_MIN", "10"},
                          {"SLURM_ARRAY_TASK_COUNT", "5"}}),
            (Shard{1, 5}));
  EXPECT_EQ(Parse("env", {{"CI_NODE_INDEX", "1"}, {"CI_NODE_TOTAL", "2"}}), (Shard{0, 2}))
      << "GitLab counts from 1";
  EXPECT_EQ(Parse("env", {{"CIRCLE_NODE_INDEX", "1"}, {"CIRCLE_NODE_TOTAL", "2"}}), (Shard{1, 2}));
  EXPECT_EQ(Parse("env", {{"BUILDKITE_PARALLEL_JOB", "1"}, {"BUILDKITE_PARALLEL_JOB_COUNT", "2"}}),
            (Shard{1, 2}));
}

// mpirun inside an allocation: Slurm's own then count what mpirun started on each node.
TEST(Shard, MpirunComesBeforeTheAllocationItRunsIn) {
  EXPECT_EQ(Parse("env", {{"OMPI_COMM_WORLD_RANK", "2"},
                          {"OMPI_COMM_WORLD_SIZE", "6"},
                          {"SLURM_PROCID", "1"},
                          {"SLURM_NTASKS", "2"}}),
            (Shard{2, 6}));
}

TEST(Shard, AnArrayOfJobsOfSeveralProcessesIsSplitByBoth) {
  std::map<std::pair<int, int>, uint32_t> seen;
  for (int job = 0; job < 2; ++job)
    for (int rank = 0; rank < 3; ++rank) {
      const Shard shard = Parse("env", {{"SLURM_ARRAY_TASK_ID", std::to_string(job + 7)},
                                        {"SLURM_ARRAY_TASK_MIN", "7"},
                                        {"SLURM_ARRAY_TASK_COUNT", "2"},
                                        {"SLURM_PROCID", std::to_string(rank)},
                                        {"SLURM_NTASKS", "3"}});
      EXPECT_EQ(shard.count, 6u);
      for (const auto& [other, index] : seen) EXPECT_NE(index, shard.index);
      seen[{job, rank}] = shard.index;
    }
}

TEST(Shard, AnEnvironmentThatSaysNothingOrTooMuchIsRefused) {
  const std::pair<std::map<std::string, std::string>, const char*> cases[] = {
      {{}, "no launcher"},
      {{{"OMPI_COMM_WORLD_RANK", "1"}}, "OMPI_COMM_WORLD_SIZE is not set"},
      {{{"PMI_RANK", "x"}, {"PMI_SIZE", "2"}}, "PMI_RANK is 'x'"},
      {{{"PMI_RANK", "2"}, {"PMI_SIZE", "2"}}, "PMI_RANK is 2"},
      {{{"CI_NODE_INDEX", "0"}, {"CI_NODE_TOTAL", "2"}}, "CI_NODE_INDEX is 0"},
      // --array=0-8:4
      {{{"SLURM_ARRAY_TASK_ID", "8"},
        {"SLURM_ARRAY_TASK_MIN", "0"},
        {"SLURM_ARRAY_TASK_COUNT", "3"}},
       "SLURM_ARRAY_TASK_ID is 8"},
  };
  for (const auto& c : cases) ExpectError([&] { Parse("env", c.first); }, c.second);
}

// ---- Merging ------------------------------------------------------------------------------------

const Fingerprint kFingerprint = {{"command", "verify"}, {"commit", "abc"}, {"frames", "1"}};

VerifyOptions OneFrame(const Shard& shard) {
  VerifyOptions options;
  options.frames = 1;
  options.shard = shard;
  options.skips = options.checks = false;
  options.filter = [](const VerifyCase& c) {
    return c.isa == Isa::kReference && c.settings == Settings::kSkips && c.fuse;
  };
  return options;
}

std::vector<ShardFile> RunShards(uint32_t count,
                                 const std::function<void(VerifyOptions&)>& change) {
  Scenario tiny = LoadScenario("tiny");
  std::vector<ShardFile> files;
  for (uint32_t i = 0; i < count; ++i) {
    VerifyOptions options = OneFrame({i, count});
    if (change) change(options);
    files.push_back(
        {"shard" + std::to_string(i), ReportAsJson(Verify(tiny, options), kFingerprint)});
  }
  return files;
}

void LeaveOutSkin(Plan& plan) {
  for (Stage& stage : plan.stages)
    if (stage.kernel.name == "skin") stage.kernel.run = [](const void*, const Binding*) {};
}

// Three shards of a run that passes.
const std::vector<ShardFile>& Shards() {
  static const std::vector<ShardFile> kFiles = RunShards(3, {});
  return kFiles;
}

void ExpectRefused(const std::vector<ShardFile>& files, std::string_view word) {
  ExpectError([&] { MergeShards("verify", files); }, word);
}

// The shards with one of them changed.
std::vector<ShardFile> With(size_t which, const std::function<void(Json&)>& change) {
  std::vector<ShardFile> files = Shards();
  Json json = Json::parse(files[which].text);
  change(json);
  files[which].text = json.dump();
  return files;
}

TEST(MergeShards, GivesTheWholeRun) {
  Scenario tiny = LoadScenario("tiny");
  const std::string whole = ReportAsJson(Verify(tiny, OneFrame({})), kFingerprint);
  const MergedShards merged = MergeShards("verify", Shards());
  EXPECT_TRUE(merged.passed);
  EXPECT_EQ(merged.tree.Json(), whole);
  const std::string text = merged.tree.Text(),
                    cases = std::to_string(Json::parse(whole)["cases"].size());
  for (const std::string& part :
       {std::string("3 shards of pelt verify\n"), std::string("\ncommit      abc\n"),
        "\ncases    " + cases + "  " + cases + " ",
        "\nverdict: SAME BITS in all " + cases + " cases\n"})
    EXPECT_NE(text.find(part), std::string::npos) << part << text;
}

TEST(MergeShards, TakesThemInAnyOrderAndAMergeAgain) {
  std::vector<ShardFile> files = Shards();
  std::swap(files[0], files[2]);
  const MergedShards merged = MergeShards("verify", files);
  EXPECT_EQ(merged.tree.Text(), MergeShards("verify", Shards()).tree.Text());
  EXPECT_TRUE(MergeShards("verify", {{"merged", merged.tree.Json()}}).passed);
}

// Nothing has a place that no shard runs: with more shards than cases some have none.
TEST(MergeShards, AShardMayHaveNoCases) {
  const auto none = [](VerifyOptions& options) {
    options.filter = [](const VerifyCase&) { return false; };
  };
  const std::vector<ShardFile> files = RunShards(5, none);
  EXPECT_EQ(Json::parse(files[4].text)["cases"].size(), 0u);
  EXPECT_TRUE(MergeShards("verify", files).passed);
}

TEST(MergeShards, SkipsAreSplitToo) {
  const auto with_skips = [](VerifyOptions& options) {
    options.filter = [](const VerifyCase&) { return false; };
    options.skips = true;
    options.frames = 3;
  };
  size_t skips = 0;
  const std::vector<ShardFile> files = RunShards(4, with_skips);
  for (const ShardFile& file : files) {
    const size_t here = Json::parse(file.text)["skips"].size();
    EXPECT_GT(here, 0u);
    skips += here;
  }
  const MergedShards merged = MergeShards("verify", files);
  EXPECT_TRUE(merged.passed);
  EXPECT_EQ(Json::parse(merged.tree.Json())["skips"].size(), skips);
}

// A section of checks is one case of the list.
TEST(MergeShards, ChecksAreSplitToo) {
  const auto with_checks = [](VerifyOptions& options) {
    options.filter = [](const VerifyCase&) { return false; };
    options.checks = true;
    options.sections = {"culling", "digest"};
  };
  const std::vector<ShardFile> files = RunShards(2, with_checks);
  for (const ShardFile& file : files) EXPECT_EQ(Json::parse(file.text)["checks"].size(), 1u);
  const MergedShards merged = MergeShards("verify", files);
  EXPECT_TRUE(merged.passed);
  EXPECT_EQ(Json::parse(merged.tree.Json())["checks"].size(), 2u);
}

TEST(MergeShards, OneCaseThatFailsFailsTheWhole) {
  const auto plant = [](VerifyOptions& options) {
    options.tamper = [](const VerifyCase& what, Plan& plan) {
      if (what.executor == "permuted" && what.order_seed == 2) LeaveOutSkin(plan);
    };
  };
  const MergedShards merged = MergeShards("verify", RunShards(3, plant));
  EXPECT_FALSE(merged.passed);
  // What was found is in there whole, places in objects of their own too.
  EXPECT_EQ(merged.tree.Json(), RunShards(1, plant)[0].text);
  EXPECT_NE(merged.tree.Json().find("\"mismatch\": {"), std::string::npos);
  EXPECT_EQ(Json::parse(merged.tree.Json())["passed"], false);
  const std::string text = merged.tree.Text();
  EXPECT_NE(text.find("verdict: DIFFERENT BITS"), std::string::npos);
  EXPECT_NE(text.find("FAILED permuted 2"), std::string::npos) << text;
}

// What was not run for that reason is a gap.
TEST(MergeShards, ARunThatStoppedAtItsFailureIsRefused) {
  const auto plant = [](VerifyOptions& options) {
    options.stop_at_failure = true;
    options.tamper = [](const VerifyCase& what, Plan& plan) {
      if (what.executor == "door") LeaveOutSkin(plan);
    };
  };
  const std::vector<ShardFile> files = RunShards(1, plant);
  const Json json = Json::parse(files[0].text);
  EXPECT_LT(json["cases"].size(), json["places"].get<size_t>());
  EXPECT_EQ(json["cases"].back()["passed"], false) << "nothing is run after it";
  ExpectRefused(files, "cases, and shard 0/1");
}

TEST(MergeShards, GapsAndOverlapsAreRefused) {
  const std::vector<ShardFile>& all = Shards();
  ExpectRefused({}, "no shards");
  ExpectRefused({all[0], all[2]}, "1 of 3 shards are missing: 1/3");
  ExpectRefused({all[0], all[1], all[1], all[2]}, "both shard 1/3");
  std::vector<ShardFile> others = RunShards(2, {});
  ExpectRefused({others[0], all[1], all[2]}, "the number of shards is 2 in the one and 3");
}

TEST(MergeShards, OtherBuildsAndOptionsAreRefused) {
  for (const char* key : {"commit", "frames"})
    ExpectRefused(With(1, [&](Json& json) { json["fingerprint"][key] = "other"; }), key);
  ExpectRefused(With(1, [](Json& json) { json["fingerprint"]["more"] = "1"; }), "number of values");
  ExpectRefused(With(1, [](Json& json) { json["fingerprint"].erase("commit"); }),
                "number of values");
  ExpectRefused(With(2, [](Json& json) { json["places"] = 12; }), "places");
  ExpectRefused(With(0, [](Json& json) { json["fingerprint"]["command"] = "golden"; }),
                "printed by pelt golden");
}

TEST(MergeShards, CasesThatWereTakenOutAddedOrChangedAreRefused) {
  ExpectRefused(With(0, [](Json& json) { json["cases"].erase(1); }), "shard 0/3");
  ExpectRefused(With(0, [](Json& json) { json["cases"].push_back(json["cases"][0]); }),
                "case 0 is there twice");
  ExpectRefused(With(1, [](Json& json) { json["cases"][0]["place"] = 2; }),
                "case 2 of 90 is none of shard 1/3");
  ExpectRefused(With(1, [](Json& json) { json["cases"][0].erase("place"); }), "'place' is missing");
  ExpectRefused(With(1, [](Json& json) { json["cases"][0]["passed"] = "yes"; }), "neither true");
  ExpectRefused(With(1, [](Json& json) { json["cases"][0]["passed"] = false; }),
                "not that of its cases");
  ExpectRefused(With(1, [](Json& json) { json["passed"] = false; }), "not that of its cases");
  ExpectRefused(With(1, [](Json& json) { json["shard.index"] = 1; }), "'shard.index' is no name");
  ExpectRefused(With(1, [](Json& json) { json["shard"]["index"] = -1; }), "not a whole number");
  ExpectRefused(With(1, [](Json& json) { json["shard"]["index"] = 4294967297; }),
                "not a whole number");
}

// No prefix of a file passes for a shard, and what is not one says so.
TEST(MergeShards, TruncatedAndForeignFilesAreRefused) {
  const std::vector<ShardFile>& all = Shards();
  const std::string text = all[1].text;
  for (size_t bytes = 0; bytes < text.size(); bytes += 37)
    ExpectRefused({all[0], {"cut", text.substr(0, bytes)}, all[2]}, "not one whole JSON value");
  for (const char* foreign : {"1", "null", "[]", "\"x\"", "{}", "{\"fingerprint\": 3}",
                              "{\"fingerprint\": {\"command\": \"verify\"}}"})
    ExpectRefused({all[0], {"foreign", foreign}, all[2]}, "foreign: '");
  ExpectRefused({all[0], {"two", text + "\n" + text}, all[2]}, "not one whole JSON value");
}

}  // namespace
}  // namespace pelt
