// From primitives to triangles: surface nets on a grid, each vertex then pulled onto
// the surface along the gradient.
//
// The grid has a plane of samples at x = 0, so the mesh is as symmetric as the shape. Weights fall
// off with the fourth power of the distance to a joint's primitives; the fifth largest is taken off
// the four that stay, so a weight is 0 before it is dropped and nothing jumps.
#include <algorithm>
#include <cmath>

#include "core/character/builtin_shape.hpp"
#include "core/character/mesh_repair.hpp"
#include "core/exact_math.hpp"
#include "core/float_rules.hpp"

namespace pelt::builtin {
namespace {

using glm::dvec3;
using glm::ivec3;

double Length(const dvec3& v) { return std::sqrt(glm::dot(v, v)); }

// Negative inside.
double DistanceTo(const Primitive& p, const dvec3& at) {
  if (p.radius_b < 0.0) {
    const dvec3 d = at - p.a;
    const double k0 = Length(d / p.b);
    const double k1 = Length(d / (p.b * p.b));
    return k1 > 0.0 ? k0 * (k0 - 1.0) / k1 : -std::min(p.b.x, std::min(p.b.y, p.b.z));
  }
  const dvec3 along = p.b - p.a;
  double t = glm::dot(at - p.a, along) / glm::dot(along, along);
  t = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
  return Length(at - p.a - along * t) - (p.radius_a + (p.radius_b - p.radius_a) * t);
}

// All primitives melted together, in their order.
double Field(const Shape& shape, const dvec3& at) {
  double field = 1e3;
  for (const Primitive& p : shape.primitives) {
    // A primitive that is farther than field + blend leaves no trace.
    const dvec3 off = at - p.centre;
    const double reach = p.bound + field + p.blend;
    if (reach > 0.0 && glm::dot(off, off) > reach * reach) continue;
    const double d = DistanceTo(p, at);
    const double overlap = p.blend - std::abs(field - d);
    field = std::min(field, d);
    if (overlap > 0.0) field -= overlap * overlap / (4.0 * p.blend);
  }
  return field;
}

// From the corners of a tetrahedron: four samples instead of six.
dvec3 Gradient(const Shape& shape, const dvec3& at) {
  static constexpr double kCorner[4][3] = {{1, -1, -1}, {-1, -1, 1}, {-1, 1, -1}, {1, 1, 1}};
  dvec3 g(0.0);
  for (const auto& corner : kCorner) {
    const dvec3 k(corner[0], corner[1], corner[2]);
    g += k * Field(shape, at + k * 5e-4);
  }
  const double length = Length(g);
  return length > 1e-12 ? g / length : dvec3(0.0, 1.0, 0.0);
}

struct Surface {
  std::vector<dvec3> position;
  std::vector<std::array<uint32_t, 3>> triangles;
};

class SurfaceNets {
 public:
  SurfaceNets(const Shape& shape, double cell_m) : shape_(shape), cell_(cell_m) {}

  Surface Extract() {
    Sample();
    vertex_.assign(value_.size(), -1);
    for (int z = 0; z + 1 < size_.z; ++z)
      for (int y = 0; y + 1 < size_.y; ++y)
        for (int x = 0; x + 1 < size_.x; ++x) AddVertex({x, y, z});
    for (int z = 1; z + 1 < size_.z; ++z)
      for (int y = 1; y + 1 < size_.y; ++y)
        for (int x = 1; x + 1 < size_.x; ++x)
          for (int axis = 0; axis < 3; ++axis) AddQuad({x, y, z}, axis);
    return std::move(out_);
  }

 private:
  size_t At(const ivec3& i) const {
    return (size_t(i.z) * size_t(size_.y) + size_t(i.y)) * size_t(size_.x) + size_t(i.x);
  }
  dvec3 PointOf(const ivec3& i) const { return dvec3(first_ + i) * cell_; }

  void Sample() {
    dvec3 low(1e9), high(-1e9);
    for (const Primitive& p : shape_.primitives) {
      const bool cone = p.radius_b >= 0.0;
      const dvec3 reach = cone ? dvec3(std::max(p.radius_a, p.radius_b)) : p.b;
      low = glm::min(low, glm::min(p.a, cone ? p.b : p.a) - reach);
      high = glm::max(high, glm::max(p.a, cone ? p.b : p.a) + reach);
    }
    for (int c = 0; c < 3; ++c) {
      first_[c] = int(exact::Floor(low[c] / cell_)) - 2;
      size_[c] = int(exact::Floor(high[c] / cell_)) + 4 - first_[c];
    }
    value_.resize(size_t(size_.x) * size_t(size_.y) * size_t(size_.z));
    for (int z = 0; z < size_.z; z += kBlock)
      for (int y = 0; y < size_.y; y += kBlock)
        for (int x = 0; x < size_.x; x += kBlock) SampleBlock({x, y, z});
  }

  // Where the surface cannot pass, one sample stands for the block: the field changes by hardly
  // more than the distance walked; twice that is allowed for.
  void SampleBlock(const ivec3& low) {
    const ivec3 high = glm::min(low + kBlock, size_);
    const double middle = Field(shape_, PointOf(low) + dvec3(0.5 * (kBlock - 1) * cell_));
    const bool far = std::abs(middle) > kBlock * 1.7320508 * cell_;
    for (int z = low.z; z < high.z; ++z)
      for (int y = low.y; y < high.y; ++y)
        for (int x = low.x; x < high.x; ++x)
          value_[At({x, y, z})] = far ? middle : Field(shape_, PointOf({x, y, z}));
  }

  // One vertex in every cell the surface passes: the mean of its edge crossings.
  void AddVertex(const ivec3& cell) {
    dvec3 sum(0.0);
    int crossings = 0;
    for (int axis = 0; axis < 3; ++axis) {
      for (int corner = 0; corner < 4; ++corner) {
        ivec3 from = cell;
        from[(axis + 1) % 3] += corner & 1;
        from[(axis + 2) % 3] += corner >> 1;
        ivec3 to = from;
        to[axis] += 1;
        const double a = value_[At(from)], b = value_[At(to)];
        if ((a < 0.0) == (b < 0.0)) continue;
        sum += PointOf(from) + (PointOf(to) - PointOf(from)) * (a / (a - b));
        ++crossings;
      }
    }
    if (crossings == 0) return;
    vertex_[At(cell)] = int32_t(out_.position.size());
    out_.position.push_back(Settle(sum / double(crossings)));
  }

  // Two steps down the field, together at most 0.35 of a cell.
  dvec3 Settle(dvec3 at) const {
    for (int step = 0; step < 2; ++step) {
      const double reach = 0.175 * cell_;
      const double d = Field(shape_, at);
      at -= Gradient(shape_, at) * (d < -reach ? -reach : d > reach ? reach : d);
    }
    return at;
  }

  // The quad across the grid edge from `from` along `axis`, if the surface cuts it.
  void AddQuad(const ivec3& from, int axis) {
    ivec3 to = from;
    to[axis] += 1;
    const bool inside = value_[At(from)] < 0.0;
    if (inside == (value_[At(to)] < 0.0)) return;
    uint32_t corner[4];
    const int du[4] = {-1, 0, 0, -1}, dv[4] = {-1, -1, 0, 0};
    for (int i = 0; i < 4; ++i) {
      ivec3 cell = from;
      cell[(axis + 1) % 3] += du[i];
      cell[(axis + 2) % 3] += dv[i];
      corner[i] = uint32_t(vertex_[At(cell)]);
    }
    if (!inside) std::swap(corner[1], corner[3]);
    auto distance = [&](int i, int k) {
      return Length(out_.position[corner[i]] - out_.position[corner[k]]);
    };
    const int s = distance(0, 2) <= distance(1, 3) ? 0 : 1;
    out_.triangles.push_back({corner[s], corner[s + 1], corner[s + 2]});
    out_.triangles.push_back({corner[s], corner[s + 2], corner[(s + 3) % 4]});
  }

  static constexpr int kBlock = 4;

  const Shape& shape_;
  double cell_;
  ivec3 first_{0}, size_{0};
  std::vector<double> value_;
  std::vector<int32_t> vertex_;
  Surface out_;
};

// Skinning, materials and UVs of a surface.
class Dresser {
 public:
  Dresser(const Shape& shape, const Surface& surface, bool one_chart)
      : shape_(shape), surface_(surface), one_chart_(one_chart) {}

  ShapeMesh Dress() {
    const size_t charts = shape_.charts.size();
    out_.triangles.resize(shape_.materials.size());
    place_.assign(surface_.position.size() * charts * 2, -1);
    for (const auto& t : surface_.triangles) {
      const dvec3 centre =
          (surface_.position[t[0]] + surface_.position[t[1]] + surface_.position[t[2]]) / 3.0;
      const Primitive& nearest = Nearest(centre);
      const size_t chart = one_chart_ ? 0 : nearest.chart;
      double u[3];
      for (size_t c = 0; c < 3; ++c)
        u[c] = AngleShare(shape_.charts[chart], surface_.position[t[c]]);
      // A corner with u just above 0 belongs past 1 when another is just below 1.
      const bool wraps = std::max({u[0], u[1], u[2]}) - std::min({u[0], u[1], u[2]}) > 0.5;
      std::array<uint32_t, 3> triangle;
      for (size_t c = 0; c < 3; ++c) {
        const bool past = wraps && u[c] < 0.5;
        triangle[c] = Emit(t[c], chart, past ? u[c] + 1.0 : u[c], past);
      }
      out_.triangles[nearest.material].push_back(triangle);
    }
    return std::move(out_);
  }

 private:
  const Primitive& Nearest(const dvec3& at) const {
    const Primitive* nearest = &shape_.primitives[0];
    double best = 1e9;
    for (const Primitive& p : shape_.primitives) {
      const double d = DistanceTo(p, at);
      if (d < best) {
        best = d;
        nearest = &p;
      }
    }
    return *nearest;
  }

  static double AngleShare(const Chart& chart, const dvec3& at) {
    const dvec3 d = at - chart.origin;
    const dvec3 side = glm::cross(chart.axis, chart.front);
    return exact::Atan2(glm::dot(d, side), glm::dot(d, chart.front)) / (2.0 * exact::kPi) + 0.5;
  }

  uint32_t Emit(uint32_t vertex, size_t chart_index, double u, bool wrapped) {
    int64_t& place = place_[(vertex * shape_.charts.size() + chart_index) * 2 + wrapped];
    if (place >= 0) return uint32_t(place);
    place = int64_t(out_.position.size());
    const Chart& chart = shape_.charts[chart_index];
    const dvec3 at = surface_.position[vertex];
    const dvec3 normal = Gradient(shape_, at);
    const dvec3 around = glm::cross(chart.axis, normal);
    const double length = Length(around);
    const dvec3 tangent = length > 1e-3 ? around / length : PickTangent(normal);
    out_.position.push_back(glm::vec3(at));
    out_.normal.push_back(glm::vec3(normal));
    out_.tangent.push_back(glm::vec4(glm::vec3(tangent), 1.0f));
    const double v = glm::dot(at - chart.origin, chart.axis) / chart.length;
    out_.uv.push_back(glm::vec2(glm::dvec2(u, v)));
    AddWeights(at);
    return uint32_t(place);
  }

  void AddWeights(const dvec3& at) {
    struct Share {
      double weight = 0.0;
      uint8_t joint = 0;
    };
    std::vector<Share> share(shape_.joints.size());
    for (size_t j = 0; j < share.size(); ++j) share[j].joint = uint8_t(j);
    for (const Primitive& p : shape_.primitives) {
      const double d = std::max(DistanceTo(p, at), 0.0) + 0.02;
      share[p.joint].weight = std::max(share[p.joint].weight, 1.0 / (d * d * d * d));
    }
    std::stable_sort(share.begin(), share.end(),
                     [](const Share& a, const Share& b) { return a.weight > b.weight; });
    const double fifth = share[4].weight;
    double sum = 0.0;
    for (int i = 0; i < 4; ++i) sum += share[size_t(i)].weight - fifth;
    std::array<uint8_t, 4> joints{};
    glm::vec4 weights(1.0f, 0.0f, 0.0f, 0.0f);
    joints[0] = share[0].joint;
    for (int i = 0; i < 4 && sum > 0.0; ++i) {
      const double weight = (share[size_t(i)].weight - fifth) / sum;
      weights[i] = float(weight);
      joints[size_t(i)] = weight > 0.0 ? share[size_t(i)].joint : 0;
    }
    out_.joints.push_back(joints);
    out_.weights.push_back(weights);
  }

  const Shape& shape_;
  const Surface& surface_;
  bool one_chart_;
  std::vector<int64_t> place_;  // vertex x chart x wrapped -> output vertex
  ShapeMesh out_;
};

constexpr size_t kTinyVertices = 200;

// With a sphere around it, so that a primitive that is too far away need not be evaluated.
Primitive Bounded(Primitive p) {
  if (p.radius_b < 0.0) {
    p.centre = p.a;
    p.bound = std::max({p.b.x, p.b.y, p.b.z});
    return p;
  }
  const dvec3 half = (p.b - p.a) * 0.5;
  p.centre = p.a + half;
  p.bound = std::sqrt(glm::dot(half, half)) + std::max(p.radius_a, p.radius_b);
  return p;
}

}  // namespace

Primitive MakeEllipsoid(const dvec3& centre, const dvec3& radii, uint8_t joint, uint8_t material,
                        uint8_t chart, double blend) {
  return Bounded({centre, radii, 0.0, -1.0, joint, material, chart, blend});
}

Primitive MakeCone(const dvec3& a, const dvec3& b, double radius_a, double radius_b, uint8_t joint,
                   uint8_t material, uint8_t chart, double blend) {
  return Bounded({a, b, radius_a, radius_b, joint, material, chart, blend});
}

Chart MakeChart(const dvec3& from, const dvec3& to, const dvec3& front) {
  const dvec3 along = to - from;
  const double length = std::sqrt(glm::dot(along, along));
  const dvec3 axis = along / length;
  const dvec3 across = front - axis * glm::dot(axis, front);
  return {from, axis, across / std::sqrt(glm::dot(across, across)), length};
}

ShapeMesh MeshShape(const Shape& shape, const BuiltinCharacterOptions& options) {
  if (!options.tiny) {
    const double detail = std::min(std::max(double(options.detail), 0.25), 4.0);
    return Dresser(shape, SurfaceNets(shape, shape.cell_m / detail).Extract(), false).Dress();
  }
  for (double cell = 0.09;; cell *= 1.06) {
    ShapeMesh mesh = Dresser(shape, SurfaceNets(shape, cell).Extract(), true).Dress();
    if (mesh.position.size() <= kTinyVertices) return mesh;
  }
}

}  // namespace pelt::builtin
