// The merge.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "bench/verify/shard.hpp"
#include "core/error.hpp"

namespace pelt {
namespace {

// Ordered: what is merged reads as one process would have printed it.
using Json = nlohmann::ordered_json;

constexpr size_t kFailuresShown = 10;

struct Part {
  std::string name;
  Json json;
  Shard shard;
  uint32_t places = 0;

  [[noreturn]] void Fail(std::string_view reason) const {
    throw Error(fmt::format("{}: {}", name, reason));
  }
  const Json& Member(const Json& object, const char* key) const {
    const auto at = object.is_object() ? object.find(key) : object.end();
    if (at == object.end())
      Fail(fmt::format("'{}' is missing; expected what --shard with --json prints", key));
    return *at;
  }
  uint32_t Number(const Json& object, const char* key) const {
    const Json& value = Member(object, key);
    if (!value.is_number_unsigned() || value.get<uint64_t>() > ~0u)
      Fail(fmt::format("'{}' is not a whole number", key));
    return value.get<uint32_t>();
  }
  std::string Text(const Json& object, const char* key) const {
    const Json& value = Member(object, key);
    if (!value.is_string()) Fail(fmt::format("'{}' is not a text", key));
    return value.get<std::string>();
  }
  bool Flag(const Json& object, const char* key) const {
    const Json& value = Member(object, key);
    if (!value.is_boolean()) Fail(fmt::format("'{}' is neither true nor false", key));
    return value.get<bool>();
  }
};

Part ReadPart(std::string_view command, const ShardFile& file) {
  Part part{file.name, {}, {}, 0};
  try {
    part.json = Json::parse(file.text);
  } catch (const Json::parse_error& error) {
    part.Fail(fmt::format("not one whole JSON value: byte {} of {}", error.byte, file.text.size()));
  }
  const Json& fingerprint = part.Member(part.json, "fingerprint");
  // In a tree such a key would be a path.
  for (const auto& [key, value] : part.json.items())
    if (key.find('.') != key.npos) part.Fail(fmt::format("'{}' is no name of a member", key));
  if (const std::string by = part.Text(fingerprint, "command"); by != command)
    part.Fail(fmt::format("printed by pelt {}, not by pelt {}", by, command));
  const Json& shard = part.Member(part.json, "shard");
  part.shard = {part.Number(shard, "index"), part.Number(shard, "count")};
  part.places = part.Number(part.json, "places");
  if (part.shard.count == 0 || part.shard.index >= part.shard.count)
    part.Fail(fmt::format("shard {} of {}", part.shard.index, part.shard.count));
  return part;
}

// What all shards of a run have in common, the fingerprint first: it says best what differs.
void CheckSameRun(const Part& first, const Part& other) {
  const Json& a = first.json["fingerprint"];
  const Json& b = other.json["fingerprint"];
  const auto differ = [&](const std::string& what, const Json& x, const Json& y) {
    throw Error(fmt::format("{} and {} are not of one run: {} is {} in the one and {} in the other",
                            first.name, other.name, what, x.dump(), y.dump()));
  };
  if (!b.is_object() || a.size() != b.size()) differ("the number of values", a.size(), b.size());
  for (const auto& [key, value] : a.items())
    if (const Json& there = other.Member(b, key.c_str()); there != value)
      differ("'" + key + "'", value, there);
  if (first.shard.count != other.shard.count)
    differ("the number of shards", first.shard.count, other.shard.count);
  if (first.places != other.places) differ("'places'", first.places, other.places);
}

// Every shard once.
void CheckShards(const std::vector<Part>& parts) {
  std::map<uint32_t, const Part*> seen;
  for (const Part& part : parts) {
    const auto [at, fresh] = seen.try_emplace(part.shard.index, &part);
    if (!fresh)
      throw Error(fmt::format("{} and {} are both shard {}/{}", at->second->name, part.name,
                              part.shard.index, part.shard.count));
  }
  const uint32_t count = parts.front().shard.count;
  std::string gaps;
  for (uint32_t i = 0; i < count && gaps.size() < 60; ++i)
    if (!seen.contains(i)) gaps += fmt::format("{}{}/{}", gaps.empty() ? "" : ", ", i, count);
  if (!gaps.empty())
    throw Error(fmt::format("{} of {} shards are missing: {}", count - seen.size(), count, gaps));
}

bool IsCaseList(const Json& value) {
  return value.is_array() &&
         std::all_of(value.begin(), value.end(), [](const Json& e) { return e.is_object(); });
}

// The cases of all parts, by place.
struct Entry {
  const Part* part;
  std::string list;
  const Json* json;
};
using Entries = std::map<uint32_t, Entry>;

void AddEntries(const Part& part, Entries& entries) {
  uint32_t taken = 0;
  for (const auto& [list, value] : part.json.items()) {
    if (!IsCaseList(value)) continue;
    for (const Json& entry : value) {
      const uint32_t place = part.Number(entry, "place");
      if (place >= part.places || !part.shard.Takes(place))
        part.Fail(fmt::format("case {} of {} is none of shard {}/{}", place, part.places,
                              part.shard.index, part.shard.count));
      if (!entries.try_emplace(place, Entry{&part, list, &entry}).second)
        part.Fail(fmt::format("case {} is there twice", place));
      ++taken;
    }
  }
  const uint32_t wanted = part.places > part.shard.index
                              ? (part.places - part.shard.index - 1) / part.shard.count + 1
                              : 0;
  if (taken != wanted)
    part.Fail(fmt::format("{} cases, and shard {}/{} of {} has {}", taken, part.shard.index,
                          part.shard.count, part.places, wanted));
}

void CheckVerdict(const Part& part, const Entries& entries) {
  const bool passed = std::all_of(entries.begin(), entries.end(), [&](const auto& at) {
    return at.second.part != &part || part.Flag(*at.second.json, "passed");
  });
  if (part.Flag(part.json, "passed") != passed) part.Fail("its 'passed' is not that of its cases");
}

// What the parts could not look at; of commands that do not say so, none.
std::vector<std::string> JoinMissing(const std::vector<Part>& parts) {
  std::vector<std::string> all;
  for (const Part& part : parts) {
    const Json& list = part.json.contains("missing") ? part.json["missing"] : Json::array();
    if (!list.is_array()) part.Fail("'missing' is not a list");
    for (const Json& text : list) {
      if (!text.is_string()) part.Fail("'missing' has what is not a text");
      all.push_back(text.get<std::string>());
    }
  }
  return all;
}

// The first part with every part's cases in it, in the order of the list.
Json Join(const std::vector<Part>& parts, const Entries& entries, const MergedShards& merged) {
  Json whole = parts.front().json;
  for (const Part& part : parts)
    for (const auto& [key, value] : part.json.items())
      if (IsCaseList(value)) whole[key] = Json::array();
  for (const auto& [place, entry] : entries) whole[entry.list].push_back(*entry.json);
  whole["shard"] = {{"index", 0}, {"count", 1}};
  whole["passed"] = merged.passed;
  if (whole.contains("missing")) whole["missing"] = merged.missing;
  return whole;
}

// All of a value, as one of a tree that shows it in JSON only.
Value ValueOf(const Json& json) {
  switch (json.type()) {
    case Json::value_t::boolean:
      return json.get<bool>();
    case Json::value_t::number_integer:
      return json.get<int64_t>();
    case Json::value_t::number_unsigned:
      return json.get<uint64_t>();
    case Json::value_t::number_float:
      return json.get<double>();
    case Json::value_t::string:
      return json.get<std::string>();
    case Json::value_t::array: {
      std::vector<Value> list;
      for (const Json& one : json) list.push_back(ValueOf(one));
      return list;
    }
    case Json::value_t::object: {
      ReportTable members{{}, {{"name"}, {"value"}}, true};
      for (const auto& [key, value] : json.items()) members.Add({key, ValueOf(value)});
      return members;
    }
    default:
      return {};
  }
}

void AddMembers(const Json& whole, ReportTree& tree) {
  for (const auto& [key, value] : whole.items()) {
    if (key != "fingerprint") {
      tree.Add(InJson(key), ValueOf(value));
      continue;
    }
    ReportTable& table = tree.AddTable(key, {{"name", "", -1, "of one run"}, {"value"}});
    table.is_map = true;
    for (const auto& [name, of] : value.items())
      table.Add({name, ValueOf(of)}, name == "command" ? Show::kJson : Show::kBoth);
  }
}

struct Count {
  uint32_t same = 0, cases = 0, not_compared = 0;
};

void AddCounts(const Entries& entries, ReportTree& tree) {
  std::map<std::string, Count> counts;
  for (const auto& [place, entry] : entries) {
    Count& count = counts[entry.list];
    ++count.cases;
    count.same += (*entry.json)["passed"].get<bool>();
    count.not_compared += entry.json->value("compared", Json(true)) == false;
  }
  ReportTable& table = tree.AddTable(
      {}, {InText("list"), InText("same"), InText("of"), InText("of them not compared")});
  for (const auto& [list, count] : counts)
    table.Add({list, count.same, count.cases, count.not_compared});
}

// The first ten in full.
void AddFailures(const Entries& entries, MergedShards& merged) {
  ReportTree& tree = merged.tree;
  size_t failed = 0;
  for (const auto& [place, entry] : entries) {
    const Json& json = *entry.json;
    if (json["passed"].get<bool>() || ++failed > kFailuresShown) continue;
    tree.BlankLine();
    tree.Say("FAILED " + entry.part->Text(json, "name"));
    tree.Say("  " + (json.contains("reason") ? entry.part->Text(json, "reason") : ""));
  }
  tree.BlankLine();
  if (failed > kFailuresShown)
    tree.Say(fmt::format("... and {} more failed", failed - kFailuresShown)).BlankLine();
  if (!merged.missing.empty()) tree.AddTexts({}, merged.missing, "could not be looked at");
  tree.Say(failed == 0 ? fmt::format("verdict: SAME BITS in all {} cases{}", entries.size(),
                                     merged.missing.empty() ? "" : ", BUT INCOMPLETE")
                       : fmt::format("verdict: DIFFERENT BITS in {} cases", failed));
}

}  // namespace

MergedShards MergeShards(std::string_view command, const std::vector<ShardFile>& files) {
  if (files.empty()) throw Error("no shards to merge");
  std::vector<Part> parts;
  for (const ShardFile& file : files) parts.push_back(ReadPart(command, file));
  for (const Part& part : parts) CheckSameRun(parts.front(), part);
  CheckShards(parts);
  Entries entries;
  for (const Part& part : parts) AddEntries(part, entries);
  for (const Part& part : parts) CheckVerdict(part, entries);
  MergedShards merged;
  merged.passed = std::all_of(entries.begin(), entries.end(),
                              [](const auto& at) { return (*at.second.json)["passed"] == true; });
  merged.tree.Say(fmt::format("{} shards of pelt {}", parts.front().shard.count, command));
  merged.missing = JoinMissing(parts);
  AddMembers(Join(parts, entries, merged), merged.tree);
  AddCounts(entries, merged.tree);
  AddFailures(entries, merged);
  return merged;
}

}  // namespace pelt
