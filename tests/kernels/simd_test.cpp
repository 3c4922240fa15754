// Every operation of every vector type against plain scalar C++, bit for bit, edge values included;
// and the accuracy that core/simd/maths.hpp promises. Over 400 lines because it is one list, an
// operation after the other.
#include "core/simd.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/kernels/run_kernel.hpp"

namespace pelt::test {
namespace {

std::vector<float> EdgeFloats() {
  using Limits = std::numeric_limits<float>;
  std::vector<float> a = {0.0f,
                          1.0f,
                          0.5f,
                          1.5f,
                          2.0f,
                          3.14159265f,
                          1e-3f,
                          0.99999994f,
                          16777216.0f,
                          2147483520.0f,
                          1e-30f,
                          1e30f,
                          Limits::min(),
                          Limits::denorm_min(),
                          1.1e-39f,
                          Limits::max(),
                          Limits::infinity()};
  const size_t count = a.size();
  for (size_t i = 0; i < count; ++i) a.push_back(-a[i]);
  a.push_back(Limits::quiet_NaN());
  std::mt19937 random(7);
  for (int i = 0; i < 29; ++i) a.push_back(Uniform(random, -10.0f, 10.0f));
  return a;
}

std::vector<int32_t> EdgeInts() {
  std::vector<int32_t> a = {0,  1,  -1, 2,   255,       256,       65535,
                            -2, 31, 32, 127, INT32_MAX, INT32_MIN, INT32_MIN + 1};
  std::mt19937 random(8);
  while (a.size() < 32) a.push_back(int32_t(uint32_t(random()) * 2654435761u));
  return a;
}

bool SameFloat(float a, float b) { return BitsOf(a) == BitsOf(b) || (a != a && b != b); }

// The value pairs of all edges, kLanes at a time, are put through `wide` and `narrow`. Function
// pointers, not templates: one instance for each V is quick to compile under sanitizers.
template <class V>
void CheckBinary(const char* name, V (*wide)(const V&, const V&), float (*narrow)(float, float)) {
  const std::vector<float> edges = EdgeFloats();
  for (float first : edges) {
    for (size_t i = 0; i < edges.size(); i += V::kLanes) {
      float a[V::kLanes], b[V::kLanes], out[V::kLanes];
      for (int l = 0; l < V::kLanes; ++l) {
        a[l] = first;
        b[l] = edges[(i + size_t(l)) % edges.size()];
      }
      wide(V::Load(a), V::Load(b)).Store(out);
      for (int l = 0; l < V::kLanes; ++l) {
        const float expected = narrow(a[l], b[l]);
        ASSERT_TRUE(SameFloat(out[l], expected)) << name << "(" << a[l] << ", " << b[l] << ") is "
                                                 << out[l] << ", expected " << expected;
      }
    }
  }
}

template <class V>
void CheckIntBinary(const char* name,
                    typename V::Int (*wide)(const typename V::Int&, const typename V::Int&),
                    uint32_t (*narrow)(uint32_t, uint32_t)) {
  const std::vector<int32_t> edges = EdgeInts();
  for (int32_t first : edges) {
    for (size_t i = 0; i < edges.size(); i += V::kLanes) {
      int32_t a[V::kLanes], b[V::kLanes], out[V::kLanes];
      for (int l = 0; l < V::kLanes; ++l) {
        a[l] = first;
        b[l] = edges[(i + size_t(l)) % edges.size()];
      }
      wide(V::Int::Load(a), V::Int::Load(b)).Store(out);
      for (int l = 0; l < V::kLanes; ++l) {
        ASSERT_EQ(out[l], int32_t(narrow(uint32_t(a[l]), uint32_t(b[l]))))
            << name << "(" << a[l] << ", " << b[l] << ")";
      }
    }
  }
}

TEST(Simd, FloatOperationsAreScalarOperations) {
  ForEveryVector([]<class V>(const char* name) {
    SCOPED_TRACE(name);
    using A = const V&;
    CheckBinary<V>(
        "+", [](A a, A b) { return a + b; }, [](float a, float b) { return a + b; });
    CheckBinary<V>(
        "-", [](A a, A b) { return a - b; }, [](float a, float b) { return a - b; });
    CheckBinary<V>(
        "*", [](A a, A b) { return a * b; }, [](float a, float b) { return a * b; });
    CheckBinary<V>(
        "/", [](A a, A b) { return a / b; }, [](float a, float b) { return a / b; });
    CheckBinary<V>(
        "negate", [](A a, A) { return -a; }, [](float a, float) { return -a; });
    CheckBinary<V>(
        "Abs", [](A a, A) { return Abs(a); }, [](float a, float) { return std::fabs(a); });
    CheckBinary<V>(
        "Min", [](A a, A b) { return Min(a, b); }, [](float a, float b) { return a < b ? a : b; });
    CheckBinary<V>(
        "Max", [](A a, A b) { return Max(a, b); }, [](float a, float b) { return a > b ? a : b; });
    CheckBinary<V>(
        "Clamp", [](A a, A) { return Clamp(a, V(-1.0f), V(2.0f)); },
        [](float a, float) {
          return (a > -1.0f ? a : -1.0f) < 2.0f ? (a > -1.0f ? a : -1.0f) : 2.0f;
        });
  });
}

TEST(Simd, ComparisonsMasksAndSelect) {
  ForEveryVector([]<class V>(const char* name) {
    SCOPED_TRACE(name);
    using A = const V&;
    CheckBinary<V>(
        "<", [](A a, A b) { return Select(a < b, V(1.0f), V(0.0f)); },
        [](float a, float b) { return a < b ? 1.0f : 0.0f; });
    CheckBinary<V>(
        ">", [](A a, A b) { return Select(a > b, V(1.0f), V(0.0f)); },
        [](float a, float b) { return a > b ? 1.0f : 0.0f; });
    CheckBinary<V>(
        "<=", [](A a, A b) { return Select(a <= b, V(1.0f), V(0.0f)); },
        [](float a, float b) { return a <= b ? 1.0f : 0.0f; });
    CheckBinary<V>(
        ">=", [](A a, A b) { return Select(a >= b, V(1.0f), V(0.0f)); },
        [](float a, float b) { return a >= b ? 1.0f : 0.0f; });
    CheckBinary<V>(
        "==", [](A a, A b) { return Select(a == b, V(1.0f), V(0.0f)); },
        [](float a, float b) { return a == b ? 1.0f : 0.0f; });
    CheckBinary<V>(
        "& | !",
        [](A a, A b) {
          return Select(((a < b) & !(a == V(1.0f))) | (b > V(2.0f)), V(1.0f), V(0.0f));
        },
        [](float a, float b) { return (a < b && !(a == 1.0f)) || b > 2.0f ? 1.0f : 0.0f; });
    CheckBinary<V>(
        "Select", [](A a, A b) { return Select(a < b, -a, b); },
        [](float a, float b) { return a < b ? -a : b; });
    for (int lane = 0; lane < V::kLanes; ++lane) {
      float one[V::kLanes] = {};
      one[lane] = 1.0f;
      const V v = V::Load(one);
      EXPECT_TRUE(Any(v > V(0.5f)));
      EXPECT_FALSE(AllSet(v > V(0.5f)));
      EXPECT_FALSE(AllSet(v < V(0.5f)));
      EXPECT_EQ(v[lane], 1.0f);
    }
    EXPECT_FALSE(Any(V(0.0f) > V(0.5f)));
    EXPECT_TRUE(AllSet(V(1.0f) > V(0.5f)));
  });
}

TEST(Simd, IntegerOperationsWrap) {
  ForEveryVector([]<class V>(const char* name) {
    SCOPED_TRACE(name);
    using I = typename V::Int;
    using A = const I&;
    CheckIntBinary<V>(
        "+", [](A a, A b) { return a + b; }, [](uint32_t a, uint32_t b) { return a + b; });
    CheckIntBinary<V>(
        "-", [](A a, A b) { return a - b; }, [](uint32_t a, uint32_t b) { return a - b; });
    CheckIntBinary<V>(
        "*", [](A a, A b) { return a * b; }, [](uint32_t a, uint32_t b) { return a * b; });
    CheckIntBinary<V>(
        "&", [](A a, A b) { return a & b; }, [](uint32_t a, uint32_t b) { return a & b; });
    CheckIntBinary<V>(
        "|", [](A a, A b) { return a | b; }, [](uint32_t a, uint32_t b) { return a | b; });
    CheckIntBinary<V>(
        "^", [](A a, A b) { return a ^ b; }, [](uint32_t a, uint32_t b) { return a ^ b; });
    CheckIntBinary<V>(
        "<<", [](A a, A) { return a << 7; }, [](uint32_t a, uint32_t) { return a << 7; });
    CheckIntBinary<V>(
        ">>", [](A a, A) { return a >> 7; }, [](uint32_t a, uint32_t) { return a >> 7; });
    CheckIntBinary<V>(
        "==", [](A a, A b) { return Select(a == b, I(1), I(0)); },
        [](uint32_t a, uint32_t b) { return a == b ? 1u : 0u; });
    CheckIntBinary<V>(
        "<", [](A a, A b) { return Select(a < b, I(1), I(0)); },
        [](uint32_t a, uint32_t b) { return int32_t(a) < int32_t(b) ? 1u : 0u; });
    CheckIntBinary<V>(
        ">", [](A a, A b) { return Select(a > b, I(1), I(0)); },
        [](uint32_t a, uint32_t b) { return int32_t(a) > int32_t(b) ? 1u : 0u; });
  });
}

TEST(Simd, BroadcastKeepsEveryBit) {
  ForEveryVector([]<class V>(const char* name) {
    SCOPED_TRACE(name);
    for (float edge : EdgeFloats()) {
      const V v(edge);
      for (int l = 0; l < V::kLanes; ++l)
        ASSERT_TRUE(SameFloat(v[l], edge)) << edge << " became " << v[l];
    }
    for (int32_t edge : EdgeInts())
      for (int l = 0; l < V::kLanes; ++l) ASSERT_EQ(typename V::Int(edge)[l], edge);
  });
}

TEST(Simd, ConversionsAndLoads) {
  ForEveryVector([]<class V>(const char* name) {
    SCOPED_TRACE(name);
    using I = typename V::Int;
    const float values[] = {0.0f,       -0.0f,       0.7f,          -0.7f,         1.0f,   -1.0f,
                            2.5f,       -2.5f,       3.0f,          -3.0f,         1e-20f, -1e-20f,
                            8388607.5f, -8388607.5f, 2147483520.0f, -2147483648.0f};
    for (float value : values) {
      ASSERT_EQ(Truncate(V(value))[0], int32_t(value)) << value;
      ASSERT_EQ(Floor(V(value))[0], std::floor(value)) << value;
      ASSERT_EQ(uint32_t(Bits(V(value))[0]), BitsOf(value));
      ASSERT_TRUE(SameFloat(FromBits(Bits(V(value)))[0], value));
    }
    for (int32_t edge : EdgeInts()) ASSERT_EQ(ToFloat(I(edge))[0], float(edge)) << edge;
    uint8_t bytes[V::kLanes];
    uint32_t words[V::kLanes];
    for (int l = 0; l < V::kLanes; ++l) {
      bytes[l] = uint8_t(255 - 37 * l);
      words[l] = 0xfffffff0u + uint32_t(l);
    }
    for (int l = 0; l < V::kLanes; ++l) {
      ASSERT_EQ(I::LoadBytes(bytes)[l], int32_t(bytes[l]));
      ASSERT_EQ(I::Load(words)[l], int32_t(words[l]));
      ASSERT_EQ(I::Iota(100)[l], 100 + l);
    }
  });
}

TEST(Simd, RecordsTransposeLoadAndStore) {
  ForEveryVector([]<class V>(const char* name) {
    SCOPED_TRACE(name);
    constexpr int kLanes = V::kLanes;
    // Records at scattered places; value = 100 * lane + component, and one negative zero.
    float memory[kLanes * 3][4], out[kLanes * 3][4];
    const auto place = [](int lane) { return (lane * 7 + 3) % (kLanes * 3); };
    for (auto& record : memory)
      for (float& value : record) value = -1.0f;
    for (int l = 0; l < kLanes; ++l)
      for (int c = 0; c < 4; ++c) memory[place(l)][c] = float(100 * l + c);
    memory[place(0)][0] = -0.0f;
    const auto address = [&](int lane) { return memory[place(lane)]; };

    V x, y, z, w;
    GatherColumns<V>(address, x, y, z, w);
    V a = LoadRecords<V, 0>(address), b = LoadRecords<V, 1>(address);
    V c = LoadRecords<V, 2>(address), d = LoadRecords<V, 3>(address);
    const V splat = SplatInFours<2>(x);
    for (int l = 0; l < kLanes; ++l) {
      ASSERT_EQ(b[l], memory[place(l / 4 * 4 + 1)][l % 4]);
      ASSERT_EQ(splat[l], x[l / 4 * 4 + 2]);
    }
    TransposeFours(a, b, c, d);
    for (int l = 0; l < kLanes; ++l) {
      const float* record = memory[place(l)];
      ASSERT_EQ(BitsOf(x[l]), BitsOf(record[0]));
      ASSERT_TRUE(y[l] == record[1] && z[l] == record[2] && w[l] == record[3]);
      ASSERT_TRUE(a[l] == x[l] && b[l] == y[l] && c[l] == z[l] && d[l] == w[l]);
    }
    std::memset(out, 0, sizeof out);
    ScatterRecords([&](int lane) { return out[place(lane)]; }, x, y, z, w);
    for (int l = 0; l < kLanes; ++l)
      ASSERT_EQ(std::memcmp(out[place(l)], memory[place(l)], 16), 0) << l;
  });
}

// The last lane stands twice, as where a group is not full.
TEST(Simd, PickedLanesLoadAndStore) {
  ForEveryVector([]<class V>(const char* name) {
    SCOPED_TRACE(name);
    constexpr int kLanes = V::kLanes, kRow = 3 * kLanes;
    PickedLanes<V> at;
    for (int l = 0; l < kLanes; ++l) at.lane[l] = (l * 7 + 3) % kRow;
    at.lane[kLanes - 1] = at.lane[kLanes - 2];
    alignas(64) float rows[3][kRow], out[kRow];
    for (int k = 0; k < 3; ++k)
      for (int l = 0; l < kRow; ++l) rows[k][l] = float(100 * k - l);
    const Vec3<V> a = Load3<V>(rows, at);
    for (int l = 0; l < kLanes; ++l) {
      ASSERT_EQ(BitsOf(a.x[l]), BitsOf(rows[0][at.lane[l]])) << l;
      ASSERT_TRUE(a.y[l] == rows[1][at.lane[l]] && a.z[l] == rows[2][at.lane[l]]) << l;
      ASSERT_EQ(NumberLanes<V>(at)[l], at.lane[l]);
    }
    for (float& value : out) value = -1.0f;
    StoreLanes(a.y, out, at);
    for (int l = 0; l < kRow; ++l) {
      const bool picked = std::find(at.lane, at.lane + kLanes, l) != at.lane + kLanes;
      ASSERT_EQ(out[l], picked ? rows[1][l] : -1.0f) << l;
    }
  });
}

TEST(Simd, ReciprocalRootIsAccurateOverTheWholeRange) {
  ForEveryVector([]<class V>(const char* name) {
    SCOPED_TRACE(name);
    double worst = 0.0, worst_root = 0.0;
    for (uint32_t bits = 0x00800000u; bits < 0x7f800000u; bits += 9973 * V::kLanes) {
      int32_t lanes[V::kLanes];
      for (int l = 0; l < V::kLanes; ++l)
        lanes[l] = int32_t(std::min(bits + 9973u * uint32_t(l), 0x7f7fffffu));
      const V a = FromBits(V::Int::Load(lanes));
      const V r = Rsqrt(a), root = Sqrt(a);
      for (int l = 0; l < V::kLanes; ++l) {
        worst = std::max(worst, std::fabs(double(r[l]) * std::sqrt(double(a[l])) - 1.0));
        worst_root =
            std::max(worst_root, std::fabs(double(root[l]) / std::sqrt(double(a[l])) - 1.0));
      }
    }
    EXPECT_LT(worst, 2e-7);
    EXPECT_LT(worst_root, 3e-7);
  });
}

TEST(Simd, ReciprocalRootEdges) {
  ForEveryVector([]<class V>(const char* name) {
    SCOPED_TRACE(name);
    EXPECT_EQ(Sqrt(V(0.0f))[0], 0.0f);
    for (float a : {0.0f, 1e-45f, 1e-40f, 1.17549435e-38f, 3.4028235e38f}) {
      EXPECT_TRUE(std::isfinite(Rsqrt(V(a))[0])) << a;
      EXPECT_GT(Rsqrt(V(a))[0], 0.0f) << a;
    }
    // The same bits as the reference, on values of every size.
    std::mt19937 random(5);
    for (int i = 0; i < 1000; ++i) {
      const uint32_t bits = uint32_t(random()) % 0x7f800000u;
      float a;
      std::memcpy(&a, &bits, 4);
      ASSERT_EQ(BitsOf(Rsqrt(V(a))[0]), BitsOf(Rsqrt(ArrayVec<4>(a))[0])) << a;
    }
  });
}

// ---- Unit frames --------------------------------------------------------------------------------

struct FrameCase {
  float normal[3], tangent[3];
};

std::vector<FrameCase> FrameCases() {
  std::vector<FrameCase> cases = {
      {{0, 0, 0}, {0, 0, 0}},
      {{0, 0, 0}, {1, 0, 0}},
      {{0, 1, 0}, {0, 1, 0}},
      {{0, 1, 0}, {0, -3, 0}},
      {{1, 0, 0}, {2, 0, 0}},
      {{0, 0, 1}, {0, 0, 0}},
      {{1e-25f, 0, 0}, {0, 1e-25f, 0}},
      {{1e-36f, 2e-36f, 0}, {0, 0, 3e-37f}},
      {{1e25f, 1e25f, 0}, {0, 1e30f, 1}},
      {{3e38f, -3e38f, 3e38f}, {3e38f, 3e38f, 3e38f}},
      {{0.6f, 0.8f, 0}, {0.6f, 0.8f, 1e-4f}},
      {{0.6f, 0.8f, 0}, {0.6f, 0.8f, 1e-7f}},
      {{-0.0f, -0.0f, -0.0f}, {-0.0f, 0.0f, -0.0f}},
      {{1e-45f, 0, 0}, {0, 1e-45f, 0}},
  };
  std::mt19937 random(11);
  for (int i = 0; i < 200; ++i) {
    FrameCase c;
    const float n_size = std::pow(10.0f, Uniform(random, -20.0f, 20.0f));
    const float t_size = std::pow(10.0f, Uniform(random, -20.0f, 20.0f));
    for (int k = 0; k < 3; ++k) {
      c.normal[k] = Uniform(random, -1.0f, 1.0f) * n_size;
      c.tangent[k] = Uniform(random, -1.0f, 1.0f) * t_size;
    }
    cases.push_back(c);
  }
  return cases;
}

// Rows 0..2 normal, 3..5 tangent.
template <class V>
void MakeFrames(const float (&in)[6][V::kLanes], float (&out)[6][V::kLanes]) {
  const Vec3<V> up = {V(0.0f), V(1.0f), V(0.0f)};
  const Vec3<V> n = NormalizeOr(Vec3<V>{V::Load(in[0]), V::Load(in[1]), V::Load(in[2])}, up);
  const Vec3<V> t = UnitAcross(n, Vec3<V>{V::Load(in[3]), V::Load(in[4]), V::Load(in[5])});
  n.x.Store(out[0]);
  n.y.Store(out[1]);
  n.z.Store(out[2]);
  t.x.Store(out[3]);
  t.y.Store(out[4]);
  t.z.Store(out[5]);
}

template <class V>
void RunFrame(const FrameCase& c, float (&n)[3], float (&t)[3]) {
  float in[6][V::kLanes], out[6][V::kLanes];
  for (int l = 0; l < V::kLanes; ++l) {
    for (int k = 0; k < 3; ++k) {
      in[k][l] = c.normal[k];
      in[3 + k][l] = c.tangent[k];
    }
  }
  MakeFrames<V>(in, out);
  for (int k = 0; k < 3; ++k) {
    n[k] = out[k][0];
    t[k] = out[3 + k][0];
  }
}

TEST(UnitFrame, IsAlwaysUnitSquareAndNearestToItsInput) {
  for (const FrameCase& c : FrameCases()) {
    SCOPED_TRACE(testing::Message()
                 << c.normal[0] << " " << c.normal[1] << " " << c.normal[2] << ", " << c.tangent[0]
                 << " " << c.tangent[1] << " " << c.tangent[2]);
    float n[3], t[3];
    RunFrame<ArrayVec<4>>(c, n, t);
    double nn = 0, tt = 0, nt = 0;
    for (int k = 0; k < 3; ++k) {
      nn += double(n[k]) * n[k];
      tt += double(t[k]) * t[k];
      nt += double(n[k]) * t[k];
    }
    EXPECT_NEAR(nn, 1.0, 1e-6);
    EXPECT_NEAR(tt, 1.0, 1e-6);
    EXPECT_NEAR(nt, 0.0, 3e-6);
    // The double reference, where the input has a direction.
    double length = 0, along = 0, across[3], across_length = 0, t_length = 0;
    for (float v : c.normal) length += double(v) * v;
    for (int k = 0; k < 3 && length > 1e-70; ++k) {
      EXPECT_NEAR(n[k], c.normal[k] / std::sqrt(length), 1e-6);
    }
    for (int k = 0; k < 3; ++k) along += double(n[k]) * c.tangent[k] / std::sqrt(nn);
    for (int k = 0; k < 3; ++k) {
      across[k] = c.tangent[k] - n[k] * along / std::sqrt(nn);
      across_length += across[k] * across[k];
      t_length += double(c.tangent[k]) * c.tangent[k];
    }
    const bool has_direction = t_length > 1e-70 && across_length > 1e-4 * t_length;
    for (int k = 0; k < 3 && has_direction; ++k) {
      EXPECT_NEAR(t[k], across[k] / std::sqrt(across_length), 1e-4);
    }
  }
}

TEST(UnitFrame, SameBitsOnEveryVectorAndBesideAnyNeighbour) {
  const std::vector<FrameCase> cases = FrameCases();
  ForEveryVector([&]<class V>(const char* name) {
    SCOPED_TRACE(name);
    for (size_t i = 0; i < cases.size(); ++i) {
      float rows[6][V::kLanes], out[6][V::kLanes], n[3], t[3];
      for (int l = 0; l < V::kLanes; ++l) {
        const FrameCase& neighbour = cases[(i + size_t(l) * 5) % cases.size()];
        for (int k = 0; k < 3; ++k) {
          rows[k][l] = neighbour.normal[k];
          rows[3 + k][l] = neighbour.tangent[k];
        }
      }
      MakeFrames<V>(rows, out);
      RunFrame<ArrayVec<4>>(cases[i], n, t);
      for (int k = 0; k < 3; ++k) {
        ASSERT_EQ(BitsOf(out[k][0]), BitsOf(n[k])) << i;
        ASSERT_EQ(BitsOf(out[3 + k][0]), BitsOf(t[k])) << i;
      }
    }
  });
}

}  // namespace
}  // namespace pelt::test
