// One round of elimination works on points sorted by grid cell:
//
//   points -> cells of 2 r (one grid for each octave of radius) -> pairs nearer than 2 r
//          -> for each point its neighbours and weight -> buckets by weight -> remove from the top
//
// Cells are kept in (level, z, y, x) order, so the cells next to one lie in five short runs: its
// own row, and four rows that are found by walking along as the cells are walked. A pair of points
// with different radii is found from the smaller one's side, in the grid of the larger; so cost
// does not grow where a density map makes some regions sparse.
#include "core/groom/sample_elimination.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/float_rules.hpp"

namespace pelt {
namespace {

// Octaves of radius with a grid of their own. What is wider than 2^6 times the narrowest (a density
// of 1/4096) is spaced like that.
constexpr uint32_t kLevels = 7;
constexpr uint32_t kCellsAlongAxis = 1u << 18;
// Share of 2 r_max at which a neighbour is given up: its weight is below 3e-6 there, against 1e-4
// and more of those that decide.
constexpr float kReach = 0.8f;
constexpr uint32_t kNone = 0xffffffffu;

struct KeyedIndex {
  uint64_t key;
  uint32_t index;
};

// Stable, by bytes; bytes that are equal everywhere cost nothing.
void RadixSort(std::vector<KeyedIndex>& items, std::vector<KeyedIndex>& other) {
  other.resize(items.size());
  uint64_t differing = 0;
  for (const KeyedIndex& item : items) differing |= item.key ^ items[0].key;
  for (int shift = 0; shift < 64; shift += 8) {
    if (!((differing >> shift) & 255)) continue;
    std::array<uint32_t, 257> first{};
    for (const KeyedIndex& item : items) ++first[((item.key >> shift) & 255) + 1];
    for (int i = 0; i < 256; ++i) first[i + 1] += first[i];
    for (const KeyedIndex& item : items) other[first[(item.key >> shift) & 255]++] = item;
    items.swap(other);
  }
}

struct Tagged {
  SamplePoint point;
  uint32_t tag;
};

struct Cell {
  uint64_t key;
  uint32_t first, last;  // points
};

struct Near {
  uint32_t point;
  float square;  // distance
};

struct Pair {
  uint32_t a, b;
  float weight;
};

struct Neighbour {
  uint32_t point;
  float weight;
};

class Eliminator {
 public:
  // Shrinks `points` to `target`, spacing them for radii of radius * scale; `gone` receives the
  // tags of the removed ones in order of removal.
  void RunRound(std::vector<Tagged>& points, uint32_t target, float scale,
                std::vector<uint32_t>& gone) {
    scale_ = scale;
    // Yuksel's bound on how near a neighbour may count: keeps the candidates' own clumps from
    // steering the order.
    const float share = float(target) / float(points.size());
    nearest_ = (1.0f - share * std::sqrt(share)) * 0.65f;
    LayGrid(points);
    SortIntoCells(points);
    FindPairs(points);
    LinkNeighbours(points.size());
    Remove(points, target, gone);
  }

 private:
  void LayGrid(const std::vector<Tagged>& points) {
    low_ = points[0].point.position;
    glm::vec3 high = low_;
    narrowest_ = points[0].point.radius;
    for (const Tagged& p : points) {
      low_ = glm::min(low_, p.point.position);
      high = glm::max(high, p.point.position);
      narrowest_ = std::min(narrowest_, p.point.radius);
    }
    const glm::vec3 extent = high - low_;
    const float longest = std::max(std::max(extent.x, extent.y), extent.z);
    cell_size_ =
        std::max(2.0f * kReach * scale_ * narrowest_, longest / float(kCellsAlongAxis - 4));
    // Coordinates start at 1, so that the cell before a first one has a key too.
    x_bits_ = std::bit_width(uint32_t(extent.x / cell_size_) + 2);
    y_bits_ = std::bit_width(uint32_t(extent.y / cell_size_) + 2);
    z_bits_ = std::bit_width(uint32_t(extent.z / cell_size_) + 2);
  }

  uint32_t LevelOf(float radius) const {
    uint32_t level = 0;
    while (level + 1 < kLevels && radius > narrowest_ * float(1u << level)) ++level;
    return level;
  }

  uint64_t CellKey(uint32_t level, uint32_t x, uint32_t y, uint32_t z) const {
    return ((uint64_t(level) << z_bits_ | z) << y_bits_ | y) << x_bits_ | x;
  }

  uint64_t KeyOf(const glm::vec3& position, uint32_t level) const {
    const glm::vec3 from_low = (position - low_) / cell_size_;
    return CellKey(level, (uint32_t(from_low.x) >> level) + 1, (uint32_t(from_low.y) >> level) + 1,
                   (uint32_t(from_low.z) >> level) + 1);
  }

  void SortIntoCells(std::vector<Tagged>& points) {
    const uint32_t n = uint32_t(points.size());
    keyed_.resize(n);
    for (uint32_t i = 0; i < n; ++i) {
      points[i].point.radius =
          std::min(points[i].point.radius, narrowest_ * float(1u << (kLevels - 1)));
      keyed_[i] = {KeyOf(points[i].point.position, LevelOf(points[i].point.radius)), i};
    }
    RadixSort(keyed_, keyed_other_);
    sorted_.resize(n);
    cells_.clear();
    for (uint32_t i = 0; i < n; ++i) {
      sorted_[i] = points[keyed_[i].index];
      if (i == 0 || keyed_[i].key != keyed_[i - 1].key) cells_.push_back({keyed_[i].key, i, i});
      cells_.back().last = i + 1;
    }
    points.swap(sorted_);
  }

  uint32_t LevelOfKey(uint64_t key) const { return uint32_t(key >> (x_bits_ + y_bits_ + z_bits_)); }

  void FindPairs(const std::vector<Tagged>& points) {
    weight_.assign(points.size(), 0.0f);
    pairs_.clear();
    uint32_t level_first_cell[kLevels + 1] = {};
    for (const Cell& cell : cells_) ++level_first_cell[LevelOfKey(cell.key) + 1];
    for (uint32_t i = 0; i < kLevels; ++i) level_first_cell[i + 1] += level_first_cell[i];
    // The rows (y + 1, z), (y - 1 .. y + 1, z + 1): with the own row, half of the cells around.
    const uint64_t row = uint64_t(1) << x_bits_, slice = row << y_bits_;
    const uint64_t row_step[4] = {row, slice - row, slice, slice + row};
    uint32_t row_cell[4] = {};
    for (uint32_t c = 0; c < cells_.size(); ++c) {
      const Cell& cell = cells_[c];
      around_.clear();
      AddAround(points, cell);
      if (c + 1 < cells_.size() && cells_[c + 1].key == cell.key + 1) {
        AddAround(points, cells_[c + 1]);
      }
      for (int i = 0; i < 4; ++i) {
        const uint64_t first_key = cell.key + row_step[i] - 1;
        while (row_cell[i] < cells_.size() && cells_[row_cell[i]].key < first_key) ++row_cell[i];
        AddRow(points, row_cell[i], first_key);
      }
      const uint32_t own_count = cell.last - cell.first;
      for (uint32_t i = 0; i < own_count; ++i) AddPairs(points, cell.first + i, i + 1);
      for (uint32_t level = LevelOfKey(cell.key) + 1; level < kLevels; ++level) {
        if (level_first_cell[level] == level_first_cell[level + 1]) continue;
        GatherWider(points, cell, level);
        for (uint32_t i = 0; i < own_count; ++i) AddPairs(points, cell.first + i, 0);
      }
    }
  }

  struct Around {
    float x, y, z, radius;
    uint32_t point;
  };

  void AddAround(const std::vector<Tagged>& points, const Cell& cell) {
    for (uint32_t i = cell.first; i < cell.last; ++i) {
      const SamplePoint& p = points[i].point;
      around_.push_back({p.position.x, p.position.y, p.position.z, p.radius, i});
    }
  }

  // The cells with keys first_key .. first_key + 2, found from `cell` on.
  void AddRow(const std::vector<Tagged>& points, uint32_t cell, uint64_t first_key) {
    for (; cell < cells_.size() && cells_[cell].key <= first_key + 2; ++cell) {
      AddAround(points, cells_[cell]);
    }
  }

  // All 27 cells around in the grid of a wider level. Grids are nested: the whole cell lies in one.
  void GatherWider(const std::vector<Tagged>& points, const Cell& cell, uint32_t level) {
    around_.clear();
    const uint64_t key = KeyOf(points[cell.first].point.position, level);
    const uint64_t row = uint64_t(1) << x_bits_, slice = row << y_bits_;
    for (int i = 0; i < 9; ++i) {
      const uint64_t first_key =
          key + slice * uint64_t(i / 3) + row * uint64_t(i % 3) - slice - row - 1;
      const auto found = std::lower_bound(cells_.begin(), cells_.end(), first_key,
                                          [](const Cell& c, uint64_t k) { return c.key < k; });
      AddRow(points, uint32_t(found - cells_.begin()), first_key);
    }
  }

  // Pairs `a` with around_[first ..]. Two loops: which are near is a coin toss that the processor
  // cannot guess, so the first does not branch on it.
  void AddPairs(const std::vector<Tagged>& points, uint32_t a, uint32_t first) {
    const SamplePoint& p = points[a].point;
    const uint32_t count = uint32_t(around_.size());
    if (near_.size() < count) near_.resize(count);
    uint32_t near_count = 0;
    for (uint32_t i = first; i < count; ++i) {
      const Around& q = around_[i];
      const float x = q.x - p.position.x, y = q.y - p.position.y, z = q.z - p.position.z;
      const float reach = kReach * scale_ * (p.radius + q.radius);
      const float square = x * x + y * y + z * z;
      near_[near_count] = {q.point, square};
      near_count += square < reach * reach;
    }
    for (uint32_t i = 0; i < near_count; ++i) {
      const SamplePoint& q = points[near_[i].point].point;
      // Full up to a right angle, so that hard edges stay even; none between opposite sides.
      const float facing =
          p.normal.x * q.normal.x + p.normal.y * q.normal.y + p.normal.z * q.normal.z;
      const float agreement = 1.0f + 2.0f * facing;
      if (agreement <= 0.0f) continue;
      const float reach = scale_ * (p.radius + q.radius);
      const float t = 1.0f - std::max(std::sqrt(near_[i].square) / reach, nearest_);
      const float t2 = t * t, t4 = t2 * t2;
      const float weight = t4 * t4 * std::min(agreement, 1.0f);
      pairs_.push_back({a, near_[i].point, weight});
      weight_[a] += weight;
      weight_[near_[i].point] += weight;
    }
  }

  void LinkNeighbours(size_t count) {
    first_neighbour_.assign(count + 1, 0);
    for (const Pair& pair : pairs_) {
      ++first_neighbour_[pair.a + 1];
      ++first_neighbour_[pair.b + 1];
    }
    for (size_t i = 0; i < count; ++i) first_neighbour_[i + 1] += first_neighbour_[i];
    neighbours_.resize(pairs_.size() * 2);
    next_.assign(first_neighbour_.begin(), first_neighbour_.end() - 1);
    for (const Pair& pair : pairs_) {
      neighbours_[next_[pair.a]++] = {pair.b, pair.weight};
      neighbours_[next_[pair.b]++] = {pair.a, pair.weight};
    }
  }

  static constexpr uint32_t kBucketShift = 17;          // 64 buckets an octave
  static constexpr uint32_t kLowestBits = 0x2d800000u;  // 2^-36: below counts as no crowd at all
  static uint32_t BucketOf(float weight) {
    uint32_t bits;
    std::memcpy(&bits, &weight, sizeof bits);
    if (!(weight > 0.0f) || bits < kLowestBits) return 0;
    return ((bits - kLowestBits) >> kBucketShift) + 1;
  }

  void Push(uint32_t point) {
    const uint32_t bucket = BucketOf(weight_[point]);
    if (bucket >= head_.size()) head_.resize(bucket + 1, kNone);
    next_[point] = head_[bucket];
    head_[bucket] = point;
  }

  // Where weights tie, points go in golden-ratio steps through the cell order: evenly.
  void PushAll(uint32_t n) {
    uint64_t step = uint64_t(double(n) * 0.61803398874989485) | 1;
    auto shares_factor = [&](uint64_t a) {
      uint64_t b = n;
      while (b) std::swap(a %= b, b);
      return a != 1;
    };
    while (shares_factor(step)) ++step;
    uint64_t at = 0;
    for (uint32_t i = 0; i < n; ++i, at = (at + step) % n) Push(uint32_t(at));
  }

  void Remove(std::vector<Tagged>& points, uint32_t target, std::vector<uint32_t>& gone) {
    const uint32_t n = uint32_t(points.size());
    next_.assign(n, kNone);
    head_.clear();
    PushAll(n);
    removed_.assign(n, 0);
    uint32_t bucket = uint32_t(head_.size()) - 1;
    for (uint32_t left = n; left > target;) {
      while (head_[bucket] == kNone) --bucket;
      const uint32_t point = head_[bucket];
      head_[bucket] = next_[point];
      if (BucketOf(weight_[point]) < bucket) {  // it has fallen since it was queued
        Push(point);
        continue;
      }
      removed_[point] = 1;
      gone.push_back(points[point].tag);
      --left;
      for (uint32_t k = first_neighbour_[point]; k < first_neighbour_[point + 1]; ++k) {
        weight_[neighbours_[k].point] -= neighbours_[k].weight;
      }
    }
    uint32_t kept = 0;
    for (uint32_t i = 0; i < n; ++i) {
      if (!removed_[i]) points[kept++] = points[i];
    }
    points.resize(kept);
  }

  float scale_, nearest_, narrowest_, cell_size_;
  glm::vec3 low_;
  int x_bits_, y_bits_, z_bits_;
  std::vector<KeyedIndex> keyed_, keyed_other_;
  std::vector<Tagged> sorted_;
  std::vector<Cell> cells_;
  std::vector<Around> around_;
  std::vector<Near> near_;
  std::vector<Pair> pairs_;
  std::vector<float> weight_;
  std::vector<uint32_t> first_neighbour_, next_, head_;
  std::vector<Neighbour> neighbours_;
  std::vector<uint8_t> removed_;
};

}  // namespace

float DensestPackingRadius(double density) {
  return float(std::sqrt(1.0 / (2.0 * 1.7320508075688772 * density)));
}

std::vector<uint32_t> EliminateSamples(std::span<const SamplePoint> points, uint32_t keep) {
  std::vector<uint32_t> order(keep);
  if (keep == 0) return order;
  std::vector<Tagged> left(points.size());
  for (uint32_t i = 0; i < points.size(); ++i) left[i] = {points[i], i};
  Eliminator eliminator;
  std::vector<uint32_t> gone;
  if (keep < points.size()) eliminator.RunRound(left, keep, 1.0f, gone);
  while (left.size() > 1) {
    const uint32_t before = uint32_t(left.size());
    const uint32_t target = before / 2;
    gone.clear();
    eliminator.RunRound(left, target, std::sqrt(float(keep) / float(target)), gone);
    for (uint32_t i = 0; i < gone.size(); ++i) order[before - 1 - i] = gone[i];
  }
  order[0] = left[0].tag;
  return order;
}

}  // namespace pelt
