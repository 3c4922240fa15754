// Idea and invariants: see mesh_repair.hpp.
#include "core/character/mesh_repair.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "core/exact_math.hpp"
#include "core/float_rules.hpp"

namespace pelt {
namespace {

// Everything a vertex has, as bits that compare as the values do.
struct VertexKey {
  uint32_t word[21];
};

uint32_t KeyBits(float f) {
  f = f == 0.0f ? 0.0f : f;  // -0 is 0
  uint32_t bits;
  std::memcpy(&bits, &f, sizeof bits);
  return bits;
}

VertexKey MakeKey(const Mesh& mesh, size_t v) {
  VertexKey key{};
  size_t w = 0;
  for (int c = 0; c < 3; ++c) key.word[w++] = KeyBits(mesh.position[v][c]);
  for (int c = 0; c < 3; ++c) key.word[w++] = KeyBits(mesh.normal[v][c]);
  for (int c = 0; c < 4; ++c) key.word[w++] = KeyBits(mesh.tangent[v][c]);
  for (int c = 0; c < 2 && !mesh.uv.empty(); ++c) key.word[w++] = KeyBits(mesh.uv[v][c]);
  for (int c = 0; c < 4; ++c) key.word[w++] = KeyBits(mesh.weights[v][c]);
  for (uint8_t joint : mesh.joints[v]) key.word[w++] = joint;
  return key;
}

int Compare(const VertexKey& a, const VertexKey& b) {
  return std::memcmp(a.word, b.word, sizeof a.word);
}

// For each vertex the first vertex whose position is the same.
std::vector<uint32_t> FindSamePositions(const std::vector<glm::vec3>& position) {
  std::vector<uint32_t> order(position.size());
  std::iota(order.begin(), order.end(), 0u);
  auto key = [&](uint32_t v, int c) { return KeyBits(position[v][c]); };
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    for (int c = 0; c < 3; ++c)
      if (key(a, c) != key(b, c)) return key(a, c) < key(b, c);
    return a < b;
  });
  std::vector<uint32_t> first(position.size());
  for (size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && position[order[i]] == position[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

glm::dvec3 CrossOf(const Mesh& mesh, const std::array<uint32_t, 3>& t) {
  const glm::dvec3 a(mesh.position[t[0]]), b(mesh.position[t[1]]), c(mesh.position[t[2]]);
  return glm::cross(b - a, c - a);
}

bool IsZero(const glm::vec3& v) { return v.x == 0.0f && v.y == 0.0f && v.z == 0.0f; }

// v / |v|, or `otherwise` where |v| is 0 or not finite.
glm::dvec3 NormalizeOr(const glm::dvec3& v, const glm::dvec3& otherwise) {
  // Scaled first: the squares of very small and very large numbers leave double's range.
  const double largest = std::max(std::abs(v.x), std::max(std::abs(v.y), std::abs(v.z)));
  if (!(largest > 0.0) || !std::isfinite(largest)) return otherwise;
  const glm::dvec3 scaled = v / largest;
  return scaled / std::sqrt(glm::dot(scaled, scaled));
}

template <class T>
void KeepRows(std::vector<T>* rows, const std::vector<uint32_t>& kept) {
  if (rows->empty()) return;
  std::vector<T> out;
  out.reserve(kept.size());
  for (uint32_t k : kept) out.push_back((*rows)[k]);
  rows->swap(out);
}

// Sum over triangles of the direction of increasing u (and of v), weighted by area.
struct UvFrame {
  glm::dvec3 along_u{0.0}, along_v{0.0};
};

std::vector<UvFrame> SumUvFrames(const Mesh& mesh) {
  std::vector<UvFrame> sum(mesh.position.size());
  if (mesh.uv.empty()) return sum;
  for (const auto& t : mesh.triangles) {
    const glm::dvec3 p0(mesh.position[t[0]]);
    const glm::dvec3 e1 = glm::dvec3(mesh.position[t[1]]) - p0;
    const glm::dvec3 e2 = glm::dvec3(mesh.position[t[2]]) - p0;
    const glm::dvec2 d1 = glm::dvec2(mesh.uv[t[1]]) - glm::dvec2(mesh.uv[t[0]]);
    const glm::dvec2 d2 = glm::dvec2(mesh.uv[t[2]]) - glm::dvec2(mesh.uv[t[0]]);
    const double area = d1.x * d2.y - d2.x * d1.y;
    if (area == 0.0) continue;
    const double sign = area < 0.0 ? -1.0 : 1.0;
    const glm::dvec3 cross = glm::cross(e1, e2);
    const double weight = std::sqrt(glm::dot(cross, cross));
    const glm::dvec3 zero(0.0);
    const glm::dvec3 u = NormalizeOr((e1 * d2.y - e2 * d1.y) * sign, zero) * weight;
    const glm::dvec3 v = NormalizeOr((e2 * d1.x - e1 * d2.x) * sign, zero) * weight;
    for (uint32_t corner : t) {
      sum[corner].along_u += u;
      sum[corner].along_v += v;
    }
  }
  return sum;
}

}  // namespace

std::vector<uint32_t> OrderByUse(const std::vector<size_t>& part_ends, Mesh* mesh) {
  std::vector<uint32_t> user(mesh->position.size(), ~0u), was(user.size()), now(user.size());
  size_t t = 0;
  for (uint32_t part = 0; part < part_ends.size(); ++part)
    for (; t < part_ends[part]; ++t)
      for (const uint32_t corner : mesh->triangles[t]) user[corner] = std::min(user[corner], part);
  std::iota(was.begin(), was.end(), 0u);
  std::stable_sort(was.begin(), was.end(),
                   [&](uint32_t a, uint32_t b) { return user[a] < user[b]; });
  for (uint32_t v = 0; v < was.size(); ++v) now[was[v]] = v;
  for (auto& triangle : mesh->triangles)
    for (uint32_t& corner : triangle) corner = now[corner];
  KeepRows(&mesh->position, was);
  KeepRows(&mesh->normal, was);
  KeepRows(&mesh->tangent, was);
  KeepRows(&mesh->uv, was);
  KeepRows(&mesh->joints, was);
  KeepRows(&mesh->weights, was);
  return was;
}

size_t WeldVertices(Mesh* mesh) {
  const size_t count = mesh->position.size();
  std::vector<uint8_t> used(count, 0);
  for (const auto& t : mesh->triangles)
    for (uint32_t corner : t) used[corner] = 1;

  std::vector<VertexKey> key(count);
  std::vector<uint32_t> order;
  for (size_t v = 0; v < count; ++v) {
    if (!used[v]) continue;
    key[v] = MakeKey(*mesh, v);
    order.push_back(uint32_t(v));
  }
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    const int c = Compare(key[a], key[b]);
    return c != 0 ? c < 0 : a < b;
  });
  std::vector<uint32_t> first(count, 0);
  for (size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && Compare(key[order[i]], key[order[i - 1]]) == 0;
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }

  std::vector<uint32_t> kept, place(count, 0);
  for (uint32_t v = 0; v < count; ++v) {
    if (!used[v] || first[v] != v) continue;
    place[v] = uint32_t(kept.size());
    kept.push_back(v);
  }
  for (auto& t : mesh->triangles)
    for (uint32_t& corner : t) corner = place[first[corner]];
  KeepRows(&mesh->position, kept);
  KeepRows(&mesh->normal, kept);
  KeepRows(&mesh->tangent, kept);
  KeepRows(&mesh->uv, kept);
  KeepRows(&mesh->joints, kept);
  KeepRows(&mesh->weights, kept);
  return count - kept.size();
}

size_t DropDegenerateTriangles(Mesh* mesh) {
  size_t kept = 0;
  for (size_t i = 0; i < mesh->triangles.size(); ++i) {
    const auto t = mesh->triangles[i];
    const bool repeats = t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
    const glm::dvec3 cross = repeats ? glm::dvec3(0.0) : CrossOf(*mesh, t);
    if (cross.x == 0.0 && cross.y == 0.0 && cross.z == 0.0) continue;
    mesh->triangles[kept] = t;
    mesh->triangle_material[kept] = mesh->triangle_material[i];
    if (!mesh->corner_colour.empty()) mesh->corner_colour[kept] = mesh->corner_colour[i];
    ++kept;
  }
  const size_t dropped = mesh->triangles.size() - kept;
  mesh->triangles.resize(kept);
  mesh->triangle_material.resize(kept);
  if (!mesh->corner_colour.empty()) mesh->corner_colour.resize(kept);
  return dropped;
}

size_t GenerateNormals(Mesh* mesh) {
  const size_t count = mesh->position.size();
  if (std::none_of(mesh->normal.begin(), mesh->normal.end(), IsZero)) return 0;
  const std::vector<uint32_t> first = FindSamePositions(mesh->position);
  std::vector<glm::dvec3> sum(count, glm::dvec3(0.0)), largest(count, glm::dvec3(0.0));
  for (const auto& t : mesh->triangles) {
    const glm::dvec3 cross = CrossOf(*mesh, t);  // its length is twice the area
    for (uint32_t corner : t) {
      sum[first[corner]] += cross;
      glm::dvec3& best = largest[first[corner]];
      if (glm::dot(cross, cross) > glm::dot(best, best)) best = cross;
    }
  }
  size_t filled = 0;
  for (size_t v = 0; v < count; ++v) {
    if (!IsZero(mesh->normal[v])) continue;
    const glm::dvec3& all = sum[first[v]];
    const glm::dvec3& one = largest[first[v]];
    const glm::dvec3 single = NormalizeOr(one, glm::dvec3(0.0, 1.0, 0.0));
    // What is left of an exact cancellation is rounding, not a direction.
    const bool cancelled = glm::dot(all, all) < 1e-20 * glm::dot(one, one);
    mesh->normal[v] = glm::vec3(cancelled ? single : NormalizeOr(all, single));
    ++filled;
  }
  return filled;
}

size_t SmoothCreases(double degrees, Mesh* mesh) {
  const size_t count = mesh->position.size();
  const std::vector<uint32_t> first = FindSamePositions(mesh->position);
  std::vector<std::vector<uint32_t>> at(count);  // the vertices at each first one's position
  for (uint32_t v = 0; v < count; ++v) at[first[v]].push_back(v);
  std::vector<glm::dvec3> pull(count);  // normal by area
  for (const auto& t : mesh->triangles) {
    const glm::dvec3 cross = CrossOf(*mesh, t);
    const double area = std::sqrt(glm::dot(cross, cross));
    for (const uint32_t corner : t) pull[corner] += glm::dvec3(mesh->normal[corner]) * area;
  }
  const double least = exact::Cos(degrees * exact::kRadiansPerDegree) - 1e-6;
  size_t changed = 0;
  std::vector<glm::vec3> smooth = mesh->normal;
  for (uint32_t v = 0; v < count; ++v) {
    const glm::dvec3 own(mesh->normal[v]);
    glm::dvec3 sum(0.0);
    for (const uint32_t other : at[first[v]])
      if (glm::dot(own, glm::dvec3(mesh->normal[other])) >= least) sum += pull[other];
    smooth[v] = glm::vec3(NormalizeOr(sum, own));
    changed += smooth[v] != mesh->normal[v];
  }
  mesh->normal = std::move(smooth);
  GenerateTangents(mesh);
  return changed;
}

size_t BorrowWeights(Mesh* mesh, std::vector<uint8_t> lost) {
  if (std::none_of(lost.begin(), lost.end(), [](uint8_t l) { return l != 0; })) return 0;
  constexpr uint32_t kNobody = ~0u;
  const std::vector<uint32_t> first = FindSamePositions(mesh->position);
  std::vector<uint32_t> last = first;  // of those at one position, one that has weights
  std::vector<uint32_t> nearest(lost.size());
  const auto offer = [&](uint32_t to, uint32_t from) {
    if (!lost[to] || lost[from]) return;
    const auto distance = [&](uint32_t other) {
      const glm::dvec3 d = glm::dvec3(mesh->position[to]) - glm::dvec3(mesh->position[other]);
      return glm::dot(d, d);
    };
    uint32_t& best = nearest[to];
    if (best == kNobody || distance(from) < distance(best)) best = from;
  };
  size_t borrowed = 0;
  for (bool more = true; more;) {
    std::fill(nearest.begin(), nearest.end(), kNobody);
    for (uint32_t v = 0; v < lost.size(); ++v)
      if (!lost[v]) last[first[v]] = v;
    for (uint32_t v = 0; v < lost.size(); ++v) offer(v, last[first[v]]);
    for (const auto& t : mesh->triangles)
      for (const uint32_t to : t)
        for (const uint32_t from : t) offer(to, from);
    more = false;
    for (uint32_t v = 0; v < lost.size(); ++v) {
      if (nearest[v] == kNobody) continue;
      mesh->joints[v] = mesh->joints[nearest[v]];
      mesh->weights[v] = mesh->weights[nearest[v]];
      lost[v] = 0;
      ++borrowed;
      more = true;
    }
  }
  return borrowed;
}

glm::dvec3 PickTangent(const glm::dvec3& n) {
  const glm::dvec3 up =
      std::abs(n.y) < 0.98 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(0.0, 0.0, -1.0);
  return NormalizeOr(glm::cross(up, n), glm::dvec3(1.0, 0.0, 0.0));
}

size_t GenerateTangents(Mesh* mesh) {
  size_t filled = 0;
  std::vector<UvFrame> frames;
  for (size_t v = 0; v < mesh->position.size(); ++v) {
    const glm::dvec3 n = NormalizeOr(glm::dvec3(mesh->normal[v]), glm::dvec3(0.0, 1.0, 0.0));
    glm::dvec3 t(mesh->tangent[v]);
    double w = mesh->tangent[v].w < 0.0f ? -1.0 : 1.0;
    const bool missing = IsZero(glm::vec3(mesh->tangent[v]));
    if (missing) {
      if (frames.empty()) frames = SumUvFrames(*mesh);
      t = frames[v].along_u;
      w = glm::dot(glm::cross(n, t), frames[v].along_v) < 0.0 ? -1.0 : 1.0;
      ++filled;
    }
    const double length = std::sqrt(glm::dot(t, t));
    const glm::dvec3 across = t - n * glm::dot(n, t);
    const bool usable = glm::dot(across, across) > 1e-6 * length * length && length > 0.0;
    const glm::dvec3 unit = usable ? NormalizeOr(across, PickTangent(n)) : PickTangent(n);
    if (!usable) w = 1.0;
    mesh->tangent[v] = glm::vec4(glm::vec3(unit), float(w));
  }
  return filled;
}

}  // namespace pelt
