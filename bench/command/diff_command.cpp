// `pelt diff`: two files of one kind, and where they first differ.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "bench/command/commands.hpp"
#include "bench/report/report_tree.hpp"
#include "core/error.hpp"
#include "core/file_bytes.hpp"
#include "core/groom/groom_fields.hpp"
#include "core/groom/groom_file.hpp"
#include "traces/diff.hpp"

namespace pelt {
namespace {

using namespace groom_file;

// One field of one item, as it lies in memory.
struct FieldView {
  std::string_view section, name;
  size_t item = 0;
  const std::byte* data = nullptr;
  size_t count = 0, element_bytes = 0;
  bool is_float = false;
  std::vector<size_t> extents;
};

// An archive that lists the fields of an item. Texts count as their bytes.
struct Lister {
  std::string_view section;
  size_t item;
  std::vector<FieldView>& fields;

  template <class T>
  void operator()(std::string_view name, const T& value) {
    using Element = std::remove_all_extents_t<T>;
    FieldView field{section,
                    name,
                    item,
                    reinterpret_cast<const std::byte*>(&value),
                    1,
                    sizeof(Element),
                    std::is_same_v<Element, float>,
                    {}};
    if constexpr (kIsBytes<T>) {
      field.data = reinterpret_cast<const std::byte*>(value.data());
      field.count = value.size();
      field.element_bytes = 1;
      field.extents = {value.size()};
    } else {
      AddExtents<T>(field);
    }
    fields.push_back(field);
  }
  template <class T>
  static void AddExtents(FieldView& field) {
    if constexpr (std::is_array_v<T>) {
      field.extents.push_back(std::extent_v<T>);
      field.count *= std::extent_v<T>;
      AddExtents<std::remove_extent_t<T>>(field);
    }
  }
};

// Sections in file order, as the writer goes through them; `counts` holds the items of each.
std::vector<FieldView> FieldsOf(const Groom& groom, const General& general,
                                std::vector<size_t>& counts) {
  std::vector<FieldView> fields;
  const auto list = [&](std::string_view section, size_t index, const auto& item) {
    Lister lister{section, index, fields};
    ListFields(lister, item);
  };
  list(kSectionNames[0], 0, general);
  list(kSectionNames[1], 0, groom.skeleton);
  ListSections(
      [&](std::string_view section, const auto& items) {
        counts.push_back(items.size());
        for (size_t i = 0; i < items.size(); ++i) list(section, i, items[i]);
      },
      groom);
  return fields;
}

uint64_t ElementOf(const FieldView& field, size_t index) {
  const std::byte* at = field.data + index * field.element_bytes;
  const auto read = [at](auto value) {
    std::memcpy(&value, at, sizeof value);
    return uint64_t(value);
  };
  if (field.element_bytes == 1) return read(uint8_t{});
  if (field.element_bytes == 2) return read(uint16_t{});
  if (field.element_bytes == 4) return read(uint32_t{});
  return read(uint64_t{});
}

std::string ShowElement(const FieldView& field, size_t index) {
  const uint64_t value = ElementOf(field, index);
  if (field.is_float) return ShowFloat(uint32_t(value));
  return ShowWhole(value, int(2 * field.element_bytes));
}

// "[2][1]" of all extents but the last, which is given on its own as the lane.
void NameElement(const FieldView& field, size_t index, Difference& out) {
  std::string name(field.name);
  size_t stride = field.count;
  for (size_t e = 0; e + 1 < field.extents.size(); ++e) {
    stride /= field.extents[e];
    name += fmt::format("[{}]", index / stride);
    index %= stride;
  }
  out.place.emplace_back("field", name);
  if (!field.extents.empty()) out.place.emplace_back("lane", std::to_string(index));
}

std::optional<Difference> CompareFields(const FieldView& a, const FieldView& b) {
  Difference out;
  out.place = {{"section", std::string(a.section)}, {"item", std::to_string(a.item)}};
  for (size_t i = 0; i < std::min(a.count, b.count); ++i) {
    if (ElementOf(a, i) == ElementOf(b, i)) continue;
    NameElement(a, i, out);
    out.left = ShowElement(a, i);
    out.right = ShowElement(b, i);
    return out;
  }
  if (a.count == b.count) return std::nullopt;  // of a text: one is longer
  out.place.emplace_back("field", std::string(a.name));
  out.left = fmt::format("{} bytes", a.count);
  out.right = fmt::format("{} bytes", b.count);
  return out;
}

}  // namespace

std::optional<Difference> FindDifference(const Groom& left, const Groom& right) {
  const General a_general{left.unit_scale, left.joint_count};
  const General b_general{right.unit_scale, right.joint_count};
  std::vector<size_t> a_counts, b_counts;
  const std::vector<FieldView> a = FieldsOf(left, a_general, a_counts);
  const std::vector<FieldView> b = FieldsOf(right, b_general, b_counts);
  for (size_t s = 0; s < a_counts.size(); ++s)
    if (a_counts[s] != b_counts[s])
      return Difference{{{"section", std::string(kSectionNames[s + 2])}},
                        fmt::format("{} items", a_counts[s]),
                        fmt::format("{} items", b_counts[s]),
                        "grooms of different shape: nothing else was compared"};
  for (size_t f = 0; f < a.size(); ++f)
    if (auto found = CompareFields(a[f], b[f])) return found;
  return std::nullopt;
}

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
