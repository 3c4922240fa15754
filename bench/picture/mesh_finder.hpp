// A mesh's vertices and triangles, known again by where they are: patches hold copies of them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "core/character/character.hpp"
#include "core/frame_memory.hpp"
#include "core/streams.hpp"

namespace pelt {

class MeshFinder {
 public:
  using Triangle = std::array<uint32_t, 3>;

  explicit MeshFinder(const Mesh& mesh) {
    for (const glm::vec3& p : mesh.position)
      place_.push_back(
          number_.emplace(Place{p.x, p.y, p.z}, uint32_t(number_.size())).first->second);
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      Triangle places;
      for (size_t k = 0; k < 3; ++k) places[k] = place_[mesh.triangles[t][k]];
      std::sort(places.begin(), places.end());
      triangle_.emplace(places, t);
    }
  }

  size_t size() const { return number_.size(); }
  const std::vector<uint32_t>& places() const { return place_; }  // of the mesh's vertices
  // Those of a chunk's halo; of vertices that the mesh lacks, size().
  std::vector<uint32_t> Places(const FrameMemory& memory, uint32_t chunk) const {
    std::vector<uint32_t> places;
    for (uint32_t v = 0; v < memory.Of<&Streams::strands>(chunk)->vertex_count; ++v) {
      const auto [patch, lane] = FindVertex(memory, chunk, v);
      const auto& [x, y, z] = memory.Of<&Streams::mesh>(patch)->position;
      const auto found = number_.find({x[lane], y[lane], z[lane]});
      places.push_back(found == number_.end() ? uint32_t(size()) : found->second);
    }
    return places;
  }
  // The mesh's first triangle between these places, in any order; null: none.
  const uint32_t* FindTriangle(Triangle places) const {
    std::sort(places.begin(), places.end());
    const auto found = triangle_.find(places);
    return found == triangle_.end() ? nullptr : &found->second;
  }

 private:
  using Place = std::array<float, 3>;

  std::map<Place, uint32_t> number_;
  std::vector<uint32_t> place_;
  std::map<Triangle, uint32_t> triangle_;
};

}  // namespace pelt
