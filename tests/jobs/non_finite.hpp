// Whether everything a scene's last frame computed is finite, and where it belongs: for tests that give it
// hostile input.
#pragma once

#include <cmath>
#include <cstring>
#include <string>

#include "jobs/scene.hpp"

namespace pelt::testing {

// The first value that a frame computed and that is not finite, by name; empty when there is none.
inline std::string FindNonFinite(const FurScene& scene) {
  const SceneShape& shape = scene.shape();
  for (uint32_t s = 0; s < kStreamCount; ++s) {
    const StreamDesc& desc = DescribeStream(Stream(s));
    if (desc.role != Role::kValue) continue;
    for (uint32_t i = 0; i < shape.ItemCount(desc.domain); ++i) {
      const std::byte* block = scene.memory().Block(Stream(s), i);
      if (!block) continue;
      const uint32_t lanes = scene.LiveLanes(Stream(s), i);
      for (const RowDesc& row : desc.rows) {
        const size_t per_record = row.element_count / row.lane_count;
        for (uint32_t e = 0; e < row.element_count; ++e) {
          const size_t lane = row.lane_major ? e / per_record : e % row.lane_count;
          if (IsInLayer(desc.domain) && lane >= lanes) continue;
          // Words of records: those that hold a float.
          bool is_float = row.type == ElementType::kFloat;
          const size_t word = e % per_record;
          if (Stream(s) == StreamOf<&Streams::skinned> ||
              Stream(s) == StreamOf<&Streams::vertex_rates> ||
              Stream(s) == StreamOf<&Streams::vertex_loads>)
            is_float = true;
          if (Stream(s) == StreamOf<&Streams::curves> || Stream(s) == StreamOf<&Streams::instances>)
            is_float = word < 12 || word == 14;
          if (Stream(s) == StreamOf<&Streams::ribbons>) is_float = word < 15 || word == 17;
          if (Stream(s) == StreamOf<&Streams::ribbon_vertices>) is_float = word % 8 < 6;
          if (Stream(s) == StreamOf<&Streams::line_vertices>) is_float = word % 8 < 4;
          if (Stream(s) == StreamOf<&Streams::shell_vertices>) is_float = word % 4 < 3;
          if (Stream(s) == StreamOf<&Streams::shell_lod>) is_float = row.name == "shell";
          if (!is_float) continue;
          float value;
          std::memcpy(&value, block + row.offset_bytes + 4 * size_t(e), 4);
          if (!std::isfinite(value))
            return std::string(desc.name) + " " + std::string(row.name) + " of item " +
                   std::to_string(i) + ", element " + std::to_string(e);
        }
      }
    }
  }
  return {};
}

}  // namespace pelt::testing
