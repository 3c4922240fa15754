#include "bench/command/groom_diff.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/groom/groom_fields.hpp"

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
    if constexpr (std::is_same_v<T, std::string>) {
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

}  // namespace pelt
