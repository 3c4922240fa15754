// `pelt diff`: two files of one kind, and where they first differ.
#include <fmt/format.h>

#include "bench/command/commands.hpp"
#include "bench/command/groom_diff.hpp"
#include "bench/report/report_tree.hpp"
#include "core/error.hpp"
#include "core/file_bytes.hpp"
#include "core/groom/groom_file.hpp"
#include "traces/diff.hpp"

namespace pelt {
namespace {

enum class FileKind { kDigestLog, kInputLog, kGroom };

constexpr std::string_view kKindNames[] = {"digest log", "input log", "groom"};

FileKind KindOf(std::span<const std::byte> bytes, const std::string& path) {
  if (LooksLikeDigestLog(bytes)) return FileKind::kDigestLog;
  if (LooksLikeInputLog(bytes)) return FileKind::kInputLog;
  if (AsText(bytes).starts_with("PELTGRM\n")) return FileKind::kGroom;
  throw Error(fmt::format(
      "'{}': neither a digest log (pelt run --digest-log), an input log (pelt trace record) nor a "
      "groom (pelt bake --out)",
      path));
}

// What a difference of digests leaves open, and which command closes it.
constexpr std::string_view kHowToFindTheLane =
    "a digest says which stage, not which value: `pelt verify` names the chunk, row and lane when "
    "one build disagrees with itself; for two builds, `pelt trace record` on the one and `pelt "
    "trace replay` on the other";

// A difference of grooms inside input logs, by field if both can be read.
std::optional<Difference> NameGroomField(const InputLog& a, const InputLog& b,
                                         const Difference& bytes) {
  if (bytes.place.size() != 2 || bytes.place[1].first != "groom byte") return std::nullopt;
  const auto character = size_t(std::stoul(bytes.place[0].second));
  try {
    auto field =
        FindDifference(ReadGroom(a.grooms[a.character_groom[character]], "left").OrThrow(),
                       ReadGroom(b.grooms[b.character_groom[character]], "right").OrThrow());
    if (!field) return std::nullopt;
    field->place.insert(field->place.begin(), bytes.place[0]);
    field->remark = bytes.remark;
    return field;
  } catch (const Error&) {
    return std::nullopt;  // of another version or capacity: the byte has to do
  }
}

std::optional<Difference> Compare(FileKind kind, std::span<const std::byte> left,
                                  std::span<const std::byte> right, const DiffArgs& args) {
  if (kind == FileKind::kGroom)
    return FindDifference(ReadGroom(left, args.left).OrThrow(),
                          ReadGroom(right, args.right).OrThrow());
  if (kind == FileKind::kInputLog) {
    const InputLog a = ReadInputLog(left, args.left).OrThrow(),
                   b = ReadInputLog(right, args.right).OrThrow();
    auto found = FindDifference(a, b);
    if (!found) return found;
    const auto field = NameGroomField(a, b, *found);
    return field ? field : found;
  }
  auto found = FindDifference(ReadDigestLog(AsText(left), args.left).OrThrow(),
                              ReadDigestLog(AsText(right), args.right).OrThrow());
  if (found && found->place.front().first == "frame") {
    if (!found->remark.empty()) found->remark += "; ";
    found->remark += kHowToFindTheLane;
  }
  return found;
}

ReportTree MakeTree(const std::string& kind, const std::optional<Difference>& found) {
  ReportTree tree;
  tree.Add(InJson("kind"), kind).Add(InJson("same"), !found);
  if (!found) {
    tree.Say("same " + kind);
    return tree;
  }
  tree.Say(kind + "s differ: " + DescribeDifference(*found));
  if (!found->remark.empty()) tree.Say(found->remark);
  ReportTree& place = tree.AddSection("place");
  for (const auto& [key, value] : found->place) place.Add(InJson(key), value);
  tree.Add(InJson("left"), found->left).Add(InJson("right"), found->right);
  tree.Add(InJson("remark"), found->remark);
  return tree;
}

}  // namespace

ExitCode Diff(const DiffArgs& args) {
  const std::vector<std::byte> left = ReadFileBytes("file", args.left).OrThrow();
  const std::vector<std::byte> right = ReadFileBytes("file", args.right).OrThrow();
  const FileKind kind = KindOf(left, args.left), other = KindOf(right, args.right);
  if (kind != other)
    throw Error(fmt::format("'{}' is of kind {}, '{}' of kind {}: nothing to compare", args.left,
                            kKindNames[size_t(kind)], args.right, kKindNames[size_t(other)]));
  const std::optional<Difference> found = Compare(kind, left, right, args);
  MakeTree(std::string(kKindNames[size_t(kind)]), found).Print(args.json);
  return AnswerOf(!found);
}

}  // namespace pelt
