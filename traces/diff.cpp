#include "traces/diff.hpp"

#include <algorithm>
#include <bit>
#include <type_traits>

#include "core/format.hpp"
#include "core/streams.hpp"
#include "traces/digest.hpp"
#include "traces/input_fields.hpp"

namespace pelt {
namespace {

std::string InQuotes(const std::string& text) { return Format("'{}'", text); }

Difference HeadDifference(const char* key, std::string left, std::string right,
                          std::string remark = {}) {
  return {{{"head", key}}, std::move(left), std::move(right), std::move(remark)};
}

// ---- Digest logs --------------------------------------------------------------------------------

std::optional<Difference> CompareHeads(const DigestLog& a, const DigestLog& b) {
  if (a.scene != b.scene)
    return HeadDifference("scene", InQuotes(a.scene), InQuotes(b.scene),
                          "logs of different scenes: nothing else was compared");
  if (a.chunk_strands != b.chunk_strands)
    return HeadDifference("chunk_strands", std::to_string(a.chunk_strands),
                          std::to_string(b.chunk_strands),
                          "builds of another chunk capacity group strands differently and give "
                          "other digests: nothing else was compared");
  if (a.vertex_order != b.vertex_order)
    return HeadDifference("vertex_order", a.vertex_order, b.vertex_order,
                          "the vertices lie in another order: nothing else was compared");
  return std::nullopt;
}

// The stages that write a stream, one line each.
std::vector<std::string_view> WritersOf(const DigestLog& log, std::string_view stream) {
  std::vector<std::string_view> stages;
  for (const auto& column : log.columns)
    if (column.stream == stream) stages.push_back(column.stage);
  return stages;
}

// Pairs of columns that both logs have, in the order of the left one. Where a stream has other
// writers in the other log (small layers sort whole in both, large ones in pieces in one), a stage
// of both stands for other layers in each, and says nothing.
std::vector<std::pair<size_t, size_t>> CommonColumns(const DigestLog& a, const DigestLog& b) {
  std::vector<std::pair<size_t, size_t>> common;
  for (size_t c = 0; c < a.columns.size(); ++c) {
    const auto found = std::find(b.columns.begin(), b.columns.end(), a.columns[c]);
    if (found == b.columns.end()) continue;
    if (WritersOf(a, found->stream) != WritersOf(b, found->stream)) continue;
    common.emplace_back(c, size_t(found - b.columns.begin()));
  }
  return common;
}

// Settings, and lines that only one of them has: the likely reason of a difference.
std::string DescribeSettings(const DigestLog& a, const DigestLog& b, size_t common) {
  std::string out;
  const auto show = [](const std::string& s) { return s.empty() ? "none" : s; };
  if (a.settings != b.settings)
    out = Format("settings differ: {} and {}", show(a.settings), show(b.settings));
  const size_t only = a.columns.size() + b.columns.size() - 2 * common;
  if (only != 0)
    out += Format("{}{} lines of a frame are in one log only and were not compared",
                  out.empty() ? "" : "; ", only);
  return out;
}

// ---- Input logs ---------------------------------------------------------------------------------

struct Field {
  std::string name;
  std::string value;
  uint64_t bits;
};

// An archive that lists the fields of one input.
struct Flatten {
  std::vector<Field> fields;

  template <class T>
  void operator()(const std::string& name, const T& value) {
    if constexpr (std::is_same_v<T, double>) {
      const auto bits = std::bit_cast<uint64_t>(value);
      fields.push_back({name, ShowDouble(bits), bits});
    } else if constexpr (std::is_same_v<T, float>) {
      const auto bits = std::bit_cast<uint32_t>(value);
      fields.push_back({name, ShowFloat(bits), bits});
    } else if constexpr (std::is_array_v<T>) {
      for (size_t i = 0; i < std::extent_v<T>; ++i) (*this)(Format("{}[{}]", name, i), value[i]);
    } else {
      fields.push_back({name, ShowWhole(value, 2 * sizeof(T)), value});
    }
  }
};

std::vector<Field> FieldsOf(const FrameInput& input) {
  Flatten flatten;
  ListInputFields(flatten, input);
  const auto counted = [&](const char* what, uint32_t i, const char* field, const auto& value) {
    flatten(Format("{}[{}]{}{}", what, i, *field ? "." : "", field), value);
  };
  ListCountedFields(counted, input);
  ListColliderVelocities(counted, input);
  flatten("weather.count", uint32_t(input.weather.size()));
  for (size_t w = 0; w < input.weather.size(); ++w) {
    flatten(Format("weather[{}].wetness", w), input.weather[w].wetness);
    flatten(Format("weather[{}].dirt", w), input.weather[w].dirt);
  }
  ListLayerLists(
      [&](const char* list, const auto& elements) {
        flatten(Format("{}.count", list), uint32_t(elements.size()));
        for (size_t i = 0; i < elements.size(); ++i)
          ListElement(
              [&](const char* field, const auto& value) {
                flatten(Format("{}[{}]{}{}", list, i, *field ? "." : "", field), value);
              },
              elements[i]);
      },
      input);
  return std::move(flatten.fields);
}

std::optional<Difference> CompareInputs(const FrameInput& a, const FrameInput& b, uint32_t frame) {
  const std::vector<Field> left = FieldsOf(a), right = FieldsOf(b);
  // Lists of different length differ before the shorter one ends: in a count.
  for (size_t i = 0; i < std::min(left.size(), right.size()); ++i)
    if (left[i].bits != right[i].bits)
      return Difference{{{"frame", std::to_string(frame)}, {"input", left[i].name}},
                        left[i].value,
                        right[i].value,
                        {}};
  return std::nullopt;
}

Difference PlaceOf(uint32_t frame, uint32_t character) {
  Difference out;
  out.place = {{"frame", std::to_string(frame)}, {"character", std::to_string(character)}};
  return out;
}

// The first difference of two blocks of a character's joints; `what` names the block.
template <auto kRow>
std::optional<Difference> CompareRows(const BlockOf<kRow>& a, const BlockOf<kRow>& b,
                                      const char* what, Difference out) {
  const BlockDifference found =
      FindDifference(DescribeStream(StreamOf<kRow>), &a, &b, kJointsPerCharacter);
  if (!found.differs) return std::nullopt;
  const RowDesc& row = *found.row;
  out.place.emplace_back(what, row.name);
  if (row.lane_count == kJointsPerCharacter) {
    // Keyed rows are [key][component][joint].
    out.place.emplace_back("row", std::to_string(found.component));
    out.place.emplace_back("joint", std::to_string(found.lane));
  } else {
    out.place.emplace_back("element", std::to_string(found.lane));
  }
  const bool is_float = row.type == ElementType::kFloat;
  out.left = is_float ? ShowFloat(found.left) : ShowWhole(found.left, 8);
  out.right = is_float ? ShowFloat(found.right) : ShowWhole(found.right, 8);
  return out;
}

std::optional<Difference> ComparePoses(const PoseBlock& a, const PoseBlock& b, uint32_t frame,
                                       uint32_t character) {
  Difference out = PlaceOf(frame, character);
  if (a.joint_count != b.joint_count) {
    out.place.emplace_back("pose", "joint_count");
    out.left = ShowWhole(a.joint_count, 8);
    out.right = ShowWhole(b.joint_count, 8);
    return out;
  }
  return CompareRows<&Streams::pose>(a, b, "pose", std::move(out));
}

std::optional<Difference> CompareGrooms(const InputLog& a, const InputLog& b) {
  for (uint32_t c = 0; c < a.CharacterCount(); ++c) {
    const std::vector<std::byte>& left = a.grooms[a.character_groom[c]];
    const std::vector<std::byte>& right = b.grooms[b.character_groom[c]];
    const auto [l, r] = std::mismatch(left.begin(), left.end(), right.begin(), right.end());
    if (l == left.end() && r == right.end()) continue;
    const auto show = [](auto at, auto end) {
      return at == end ? std::string("the end") : Format("0x{:02x}", uint32_t(*at));
    };
    return Difference{
        {{"character", std::to_string(c)}, {"groom byte", std::to_string(l - left.begin())}},
        show(l, left.end()),
        show(r, right.end()),
        "the grooms differ: nothing else was compared"};
  }
  return std::nullopt;
}

std::optional<Difference> CompareHeads(const InputLog& a, const InputLog& b) {
  if (a.CharacterCount() != b.CharacterCount())
    return HeadDifference("characters", std::to_string(a.CharacterCount()),
                          std::to_string(b.CharacterCount()),
                          "logs of different scenes: nothing else was compared");
  if (a.chunk_strands != b.chunk_strands)
    return HeadDifference(
        "chunk_strands", std::to_string(a.chunk_strands), std::to_string(b.chunk_strands),
        "recorded by builds of another chunk capacity: nothing else was compared");
  if (a.about.index_buffer != b.about.index_buffer) {
    const auto name = [](bool index) { return index ? "index-buffer" : "sorted"; };
    return HeadDifference("vertex_order", name(a.about.index_buffer), name(b.about.index_buffer));
  }
  if (a.about.velocities != b.about.velocities) {
    const auto name = [](bool velocities) { return velocities ? "with" : "without"; };
    return HeadDifference("velocities", name(a.about.velocities), name(b.about.velocities));
  }
  if (a.about.origins != b.about.origins) {
    const auto name = [](bool origins) { return origins ? "with" : "without"; };
    return HeadDifference("origins", name(a.about.origins), name(b.about.origins));
  }
  if (auto found = CompareGrooms(a, b)) return found;
  if (a.snapshot == b.snapshot) return std::nullopt;
  const auto name = [](const InputLog& log) {
    if (log.snapshot.empty()) return std::string("none");
    Digest digest;
    for (const std::byte byte : log.snapshot) digest.Add(uint32_t(byte));
    return Format("{:016x}", digest.Value());
  };
  return HeadDifference("snapshot", name(a), name(b),
                        "recordings that begin with other states: nothing else was compared");
}

// Of the frame and its characters.
std::optional<Difference> CompareOrigins(const InputLog& a, const InputLog& b, uint32_t frame) {
  const auto differ = [&](const double* left, const double* right, Difference out) {
    for (int k = 0; k < 3; ++k) {
      const auto l = std::bit_cast<uint64_t>(left[k]), r = std::bit_cast<uint64_t>(right[k]);
      if (l == r) continue;
      out.place.emplace_back("origin", std::to_string(k));
      out.left = ShowDouble(l), out.right = ShowDouble(r);
      return std::optional(out);
    }
    return std::optional<Difference>();
  };
  if (auto found = differ(a.frames[frame].input.origin, b.frames[frame].input.origin,
                          Difference{{{"frame", std::to_string(frame)}}, {}, {}, {}}))
    return found;
  for (uint32_t c = 0; c < a.CharacterCount(); ++c) {
    double left[3], right[3];
    a.FillOrigin(frame, c, left);
    b.FillOrigin(frame, c, right);
    if (auto found = differ(left, right, PlaceOf(frame, c))) return found;
  }
  return std::nullopt;
}

std::optional<Difference> CompareFrame(const InputLog& a, const InputLog& b, uint32_t frame) {
  if (auto found = CompareInputs(a.Input(frame), b.Input(frame), frame)) return found;
  if (auto found = CompareOrigins(a, b, frame)) return found;
  PoseBlock left, right;
  PoseRateBlock left_rates, right_rates;
  for (uint32_t c = 0; c < a.CharacterCount(); ++c) {
    a.FillPose(frame, c, &left);
    b.FillPose(frame, c, &right);
    if (auto found = ComparePoses(left, right, frame, c)) return found;
    a.FillPoseRates(frame, c, &left_rates);
    b.FillPoseRates(frame, c, &right_rates);
    if (auto found = CompareRows<&Streams::pose_rates>(left_rates, right_rates, "velocities",
                                                       PlaceOf(frame, c)))
      return found;
  }
  if (a.frames[frame].digest == b.frames[frame].digest) return std::nullopt;
  return Difference{{{"frame", std::to_string(frame)}, {"recorded", "digest"}},
                    Format("{:016x}", a.frames[frame].digest),
                    Format("{:016x}", b.frames[frame].digest),
                    "all input up to here is the same, and what was computed from it is not"};
}

std::optional<Difference> CompareLengths(uint32_t left, uint32_t right, const std::string& remark) {
  if (left == right) return std::nullopt;
  const std::string same = Format("the first {} are the same", std::min(left, right));
  return HeadDifference("frames", std::to_string(left), std::to_string(right),
                        remark.empty() ? same : same + "; " + remark);
}

}  // namespace

std::string ShowFloat(uint32_t bits) {
  return Format("0x{:08x} ({:.9g})", bits, std::bit_cast<float>(bits));
}
std::string ShowDouble(uint64_t bits) {
  return Format("0x{:016x} ({:.17g})", bits, std::bit_cast<double>(bits));
}
std::string ShowWhole(uint64_t value, int hex_digits) {
  return Format("0x{:0{}x} ({})", value, hex_digits, value);
}

std::string DescribeDifference(const Difference& difference) {
  std::string out;
  for (const auto& [key, value] : difference.place)
    out += Format("{}{} {}", out.empty() ? "" : ", ", key, value);
  return out + Format(": {} and {}", difference.left, difference.right);
}

std::optional<Difference> FindDifference(const DigestLog& left, const DigestLog& right) {
  if (auto found = CompareHeads(left, right)) return found;
  const auto common = CommonColumns(left, right);
  const std::string remark = DescribeSettings(left, right, common.size());
  for (uint32_t f = 0; f < std::min(left.FrameCount(), right.FrameCount()); ++f)
    for (const auto& [l, r] : common) {
      const uint64_t left_digest = left.Frame(f)[l], right_digest = right.Frame(f)[r];
      if (left_digest == right_digest) continue;
      return Difference{{{"frame", std::to_string(f)},
                         {"stage", left.columns[l].stage},
                         {"stream", left.columns[l].stream}},
                        Format("{:016x}", left_digest),
                        Format("{:016x}", right_digest),
                        remark};
    }
  return CompareLengths(left.FrameCount(), right.FrameCount(), remark);
}

std::optional<Difference> FindDifference(const InputLog& left, const InputLog& right) {
  if (auto found = CompareHeads(left, right)) return found;
  for (uint32_t f = 0; f < std::min(left.FrameCount(), right.FrameCount()); ++f)
    if (auto found = CompareFrame(left, right, f)) return found;
  return CompareLengths(left.FrameCount(), right.FrameCount(), {});
}

}  // namespace pelt
