// Vertex generation: instances against the plain permutation, ribbons and lines against a double
// reference, index buffers against what they must draw.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/kernels/write_instances.hpp"
#include "core/kernels/write_lines.hpp"
#include "core/kernels/write_ribbons.hpp"
#include "core/ribbon_indices.hpp"
#include "tests/kernels/run_kernel.hpp"

namespace pelt::test {
namespace {

constexpr uint32_t kChunks = 3, kLanes = kChunks * kStrandsPerChunk;
constexpr uint32_t kDrawn = kLanes - kStrandsPerChunk / 2;  // some are culled

// A layer of three chunks with a shuffled order.
struct World {
  Blocks<OrderBlock> order{kChunks};
  Blocks<ChunkStateBlock> state{kChunks, 0};
  Blocks<LayerSortBlock> sort{1, 0};
  Blocks<LayerBlock> layer{1, 0};
  Blocks<CurveBlock> curves{kChunks};
  Blocks<RibbonBlock> ribbons{kChunks};
  Blocks<InstanceBlock> instances{kChunks};
  Blocks<RibbonVertexBlock> vertices{kChunks};
  Blocks<LineVertexBlock> lines{kChunks};
  WriteRibbonsParams params{{0.3f, 1.2f, 4.0f}};

  explicit World(uint32_t seed, uint32_t visible_count = kLanes) {
    std::mt19937 random(seed);
    sort[0].visible_count = visible_count;
    layer[0].tip_width = 0.25f;
    std::vector<uint32_t> shuffled(kLanes);
    for (uint32_t i = 0; i < kLanes; ++i) shuffled[i] = i;
    for (uint32_t i = kLanes - 1; i > 0; --i) std::swap(shuffled[i], shuffled[random() % (i + 1)]);
    for (uint32_t i = 0; i < kLanes; ++i) {
      order[i / kStrandsPerChunk].strand[i % kStrandsPerChunk] = shuffled[i];
      FillCurve(Curve(i), i, random);
      FillRibbon(Ribbon(i), i, random);
    }
    for (uint32_t c = 0; c < kChunks; ++c) {
      state[c].first_place = c * kStrandsPerChunk;
      state[c].live_strands = kStrandsPerChunk;
    }
  }
  CurveRecord& Curve(uint32_t i) {
    return curves[i / kStrandsPerChunk].record[i % kStrandsPerChunk];
  }
  RibbonRecord& Ribbon(uint32_t i) {
    return ribbons[i / kStrandsPerChunk].record[i % kStrandsPerChunk];
  }
  uint32_t Strand(uint32_t place) const {
    return order[place / kStrandsPerChunk].strand[place % kStrandsPerChunk];
  }
  static void FillCurve(CurveRecord& r, uint32_t i, std::mt19937& random) {
    for (auto& c : r.curve)
      for (float& f : c) f = Uniform(random, -1.0f, 1.0f);
    r.base_colour = uint32_t(random());
    r.tip_colour = uint32_t(random());
    r.width = Uniform(random, 1e-4f, 1e-3f);
    r.tag = i;
  }
  static void FillRibbon(RibbonRecord& r, uint32_t i, std::mt19937& random) {
    for (int a = 0; a < 3; ++a) {
      r.point[0][a] = Uniform(random, -1.0f, 1.0f);
      const float step = Uniform(random, -0.01f, 0.01f);
      for (uint32_t p = 1; p < kRibbonPoints; ++p)
        r.point[p][a] = r.point[p - 1][a] + step + Uniform(random, -0.002f, 0.002f);
    }
    r.base_colour = uint32_t(random());
    r.tip_colour = uint32_t(random());
    r.width = Uniform(random, 1e-4f, 1e-3f);
    r.tag = i | (i % 7) << 24;
    r.pad = 0;
  }

  template <class V = ArrayVec<4>>
  void WriteInstancePieces() {
    for (uint32_t c = 0; c < kChunks; ++c)
      RunKernel<WriteInstances<V>>({order.Bind(c), state.Bind(c), sort.Bind(),
                                    curves.BindList(order[c].strand), instances.Bind(c)});
  }
  template <class V = ArrayVec<4>>
  void WriteRibbonPieces() {
    for (uint32_t c = 0; c < kChunks; ++c)
      RunKernel<WriteRibbons<V>>(params, {order.Bind(c), state.Bind(c), sort.Bind(), layer.Bind(),
                                          ribbons.BindList(order[c].strand), vertices.Bind(c)});
  }
  template <class V = ArrayVec<4>>
  void WriteUnsortedPieces() {
    for (uint32_t c = 0; c < kChunks; ++c)
      RunKernel<WriteRibbonsUnsorted<V>>(
          params, {state.Bind(c), layer.Bind(), ribbons.Bind(c), vertices.Bind(c)});
  }
  template <class V = ArrayVec<4>>
  void WriteLinePieces() {
    for (uint32_t c = 0; c < kChunks; ++c)
      RunKernel<WriteLines<V>>({order.Bind(c), state.Bind(c), sort.Bind(), layer.Bind(),
                                curves.BindList(order[c].strand), lines.Bind(c)});
  }
  template <class V = ArrayVec<4>>
  void WriteUnsortedLinePieces() {
    for (uint32_t c = 0; c < kChunks; ++c)
      RunKernel<WriteLinesUnsorted<V>>(
          {state.Bind(c), layer.Bind(), curves.Bind(c), lines.Bind(c)});
  }
  using Line = LineVertex[kRibbonPoints];
  const Line& LineAt(uint32_t place) const {
    return lines[place / kStrandsPerChunk].vertex[place % kStrandsPerChunk];
  }
  using Hair = RibbonVertex[kRibbonPoints][2];
  const Hair& HairAt(uint32_t place) const {
    return vertices[place / kStrandsPerChunk].vertex[place % kStrandsPerChunk];
  }
};

template <class T>
bool IsZero(const T& value) {
  const unsigned char* bytes = reinterpret_cast<const unsigned char*>(&value);
  return std::all_of(bytes, bytes + sizeof(T), [](unsigned char b) { return b == 0; });
}

TEST(WriteInstances, RecordsInDrawOrderAndNothingBehind) {
  for (uint32_t visible :
       {0u, 1u, kStrandsPerChunk - 1, kStrandsPerChunk, kStrandsPerChunk + 1, kLanes - 9, kLanes}) {
    World w(visible, visible);
    w.WriteInstancePieces();
    for (uint32_t place = 0; place < kLanes; ++place) {
      const CurveRecord& out =
          w.instances[place / kStrandsPerChunk].instance[place % kStrandsPerChunk];
      if (place < visible)
        EXPECT_EQ(std::memcmp(&out, &w.Curve(w.Strand(place)), sizeof out), 0) << place;
      else
        EXPECT_TRUE(IsZero(out)) << place;
    }
  }
}

// A local store has fetched the listed records: they lie in list order and there is no list.
TEST(WriteInstances, FetchedRecordsGiveTheSameBits) {
  World w(3, kDrawn), fetched(3, kDrawn);
  w.WriteInstancePieces();
  for (uint32_t c = 0; c < kChunks; ++c) {
    Blocks<CurveBlock> store(1);
    for (uint32_t i = 0; i < kStrandsPerChunk; ++i)
      store[0].record[i] = fetched.Curve(fetched.order[c].strand[i]);
    RunKernel<WriteInstances<ArrayVec<4>>>({fetched.order.Bind(c), fetched.state.Bind(c),
                                            fetched.sort.Bind(), store.Bind(),
                                            fetched.instances.Bind(c)});
  }
  EXPECT_TRUE(w.instances.SameBits(fetched.instances));
}

void ExpectNear(Double3 expected, const float* actual, double tolerance) {
  EXPECT_NEAR(actual[0], expected.x, tolerance);
  EXPECT_NEAR(actual[1], expected.y, tolerance);
  EXPECT_NEAR(actual[2], expected.z, tolerance);
}

uint32_t MixPlainly(uint32_t base, uint32_t tip, uint32_t i) {
  uint32_t out = 0;
  for (int shift = 0; shift < 32; shift += 8) {
    const double b = (base >> shift) & 255, t = (tip >> shift) & 255;
    out |= uint32_t(std::floor(b + (t - b) * i / 4.0 + 0.5)) << shift;
  }
  return out;
}

void CheckHair(const World& w, const RibbonRecord& r, const World::Hair& hair) {
  for (uint32_t i = 0; i < kRibbonPoints; ++i) {
    const Double3 point = Of(r.point[i]);
    Double3 along =
        Of(r.point[std::min(i + 1, kRibbonPoints - 1)]) - Of(r.point[i > 0 ? i - 1 : 0]);
    // The parabola through three points, at the first of them.
    if (i == 0) along = point * -1.5 + Of(r.point[1]) * 2.0 - Of(r.point[2]) * 0.5;
    const Double3 tangent = along * (1.0 / Length(along));
    const Double3 across = Cross(tangent, Of(w.params.eye) - point);
    const double v = i / 4.0;
    const double half = 0.5 * double(r.width) * (1.0 + (double(w.layer[0].tip_width) - 1.0) * v);
    const Double3 side = across * (half / Length(across));
    ExpectNear(point - side, hair[i][0].position, 5e-7);
    ExpectNear(point + side, hair[i][1].position, 5e-7);
    for (int s = 0; s < 2; ++s) {
      ExpectNear(tangent, hair[i][s].tangent, 5e-6);
      EXPECT_EQ(hair[i][s].colour, MixPlainly(r.base_colour, r.tip_colour, i));
      EXPECT_EQ(hair[i][s].texture & 0xff, s ? 255u : 0u);
      EXPECT_EQ((hair[i][s].texture >> 8) & 0xff, r.tag >> 24);
      EXPECT_EQ(hair[i][s].texture >> 16, uint32_t(std::lround(65535.0 * v)));
    }
  }
}

TEST(WriteRibbons, AgreeWithDoubleReferenceInDrawOrder) {
  for (uint32_t visible : {0u, 1u, 3u, kStrandsPerChunk, kLanes - 9, kLanes}) {
    World w(visible + 1, visible);
    w.WriteRibbonPieces();
    for (uint32_t place = 0; place < kLanes; ++place) {
      if (place < visible)
        CheckHair(w, w.Ribbon(w.Strand(place)), w.HairAt(place));
      else
        EXPECT_TRUE(IsZero(w.HairAt(place))) << place;
    }
  }
}

TEST(WriteRibbons, EndColoursAreTheStrandsOwn) {
  World w(2);
  w.WriteRibbonPieces();
  for (uint32_t place = 0; place < kLanes; ++place) {
    EXPECT_EQ(w.HairAt(place)[0][0].colour, w.Ribbon(w.Strand(place)).base_colour);
    EXPECT_EQ(w.HairAt(place)[4][1].colour, w.Ribbon(w.Strand(place)).tip_colour);
  }
}

TEST(WriteRibbons, DegenerateHairsKeepFiniteVerticesWithWidth) {
  World w(4);
  RibbonRecord& point = w.Ribbon(w.Strand(0));   // all points the same
  RibbonRecord& at_eye = w.Ribbon(w.Strand(1));  // through the eye
  RibbonRecord& away = w.Ribbon(w.Strand(2));    // straight away from the eye
  RibbonRecord& up = w.Ribbon(w.Strand(3));      // a point, and the eye straight above it
  for (uint32_t i = 0; i < kRibbonPoints; ++i)
    for (int a = 0; a < 3; ++a) {
      point.point[i][a] = 0.5f;
      at_eye.point[i][a] = w.params.eye[a] + 0.01f * (float(i) - 2.0f) * float(a == 0);
      away.point[i][a] = w.params.eye[a] - (a == 2 ? 1.0f + 0.01f * float(i) : 0.0f);
      up.point[i][a] = w.params.eye[a] - float(a == 1);
    }
  w.WriteRibbonPieces();
  for (uint32_t place = 0; place < 4; ++place)
    for (const auto& pair : w.HairAt(place)) {
      EXPECT_GT(Length(Of(pair[0].position) - Of(pair[1].position)), 1e-6);
      for (const RibbonVertex& v : pair) {
        for (float f : v.position) EXPECT_TRUE(std::isfinite(f));
        EXPECT_NEAR(Length(Of(v.tangent)), 1.0, 1e-5);
      }
    }
}

TEST(WriteRibbons, UnsortedIsTheSameHairsInStrandOrder) {
  World sorted(5), unsorted(5);
  sorted.WriteRibbonPieces();
  unsorted.WriteUnsortedPieces();
  for (uint32_t place = 0; place < kLanes; ++place)
    EXPECT_EQ(std::memcmp(&sorted.HairAt(place), &unsorted.HairAt(sorted.Strand(place)),
                          sizeof(World::Hair)),
              0);
  unsorted.state[1].live_strands = 21;
  unsorted.WriteUnsortedPieces();
  for (uint32_t place = 0; place < kLanes; ++place) {
    const bool dead = place >= kStrandsPerChunk + 21 && place < 2 * kStrandsPerChunk;
    EXPECT_EQ(IsZero(unsorted.HairAt(place)), dead) << place;
  }
}

// One of the four 16-bit numbers, as a shader reads it.
double Unpack(const LineVertex& vertex, int k) {
  return std::max(int16_t(vertex.tangent_v[k / 2] >> (16 * (k % 2))) / 32767.0, -1.0);
}

void CheckLine(const World& w, const CurveRecord& r, const World::Line& line) {
  const Double3 c[] = {Of(r.curve[0]), Of(r.curve[1]), Of(r.curve[2]), Of(r.curve[3])};
  for (uint32_t i = 0; i < kRibbonPoints; ++i) {
    const double t = i / 4.0;
    ExpectNear(c[0] + c[1] * t + c[2] * (t * t) + c[3] * (t * t * t), line[i].position, 1e-6);
    EXPECT_NEAR(line[i].width, r.width * (1.0 + (double(w.layer[0].tip_width) - 1.0) * t), 1e-9);
    const Double3 along = c[1] + c[2] * (2 * t) + c[3] * (3 * t * t);
    const Double3 found = {Unpack(line[i], 0), Unpack(line[i], 1), Unpack(line[i], 2)};
    EXPECT_LT(Length(along * (1.0 / Length(along)) - found), 0.9 / 32767);
    EXPECT_NEAR(Unpack(line[i], 3), t, 0.51 / 32767);
    EXPECT_EQ(line[i].colour, MixPlainly(r.base_colour, r.tip_colour, i));
    EXPECT_EQ(line[i].tag, r.tag);
  }
}

TEST(WriteLines, AgreeWithDoubleReferenceInDrawOrder) {
  for (uint32_t visible : {0u, 1u, 3u, kStrandsPerChunk, kLanes - 9, kLanes}) {
    World w(visible + 1, visible);
    w.WriteLinePieces();
    for (uint32_t place = 0; place < kLanes; ++place) {
      if (place < visible)
        CheckLine(w, w.Curve(w.Strand(place)), w.LineAt(place));
      else
        EXPECT_TRUE(IsZero(w.LineAt(place))) << place;
    }
  }
}

// Numbers at the ends of their 16 bits, and a curve that stands still.
TEST(WriteLines, TangentsAlongAnAxisAndOfAPoint) {
  World w(8);
  const double along[][3] = {{1, 0, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}, {0, 0, 0}};
  for (uint32_t place = 0; place < std::size(along); ++place) {
    auto& curve = w.Curve(w.Strand(place)).curve;
    for (int a = 0; a < 3; ++a) {
      curve[1][a] = float(along[place][a]);
      curve[2][a] = curve[3][a] = 0.0f;
    }
  }
  w.WriteLinePieces();
  for (uint32_t place = 0; place < std::size(along); ++place)
    for (const LineVertex& vertex : w.LineAt(place))
      for (int a = 0; a < 3; ++a) {
        const bool still = place + 1 == std::size(along);
        EXPECT_EQ(Unpack(vertex, a), still ? double(a == 1) : along[place][a]) << place;
      }
}

TEST(WriteLines, UnsortedIsTheSameStrandsInStrandOrder) {
  World sorted(5), unsorted(5);
  unsorted.state[1].live_strands = 21;
  sorted.WriteLinePieces();
  unsorted.WriteUnsortedLinePieces();
  for (uint32_t place = 0; place < kLanes; ++place) {
    const uint32_t strand = sorted.Strand(place);
    if (strand >= kStrandsPerChunk + 21 && strand < 2 * kStrandsPerChunk)
      EXPECT_TRUE(IsZero(unsorted.LineAt(strand))) << strand;
    else
      EXPECT_EQ(std::memcmp(&sorted.LineAt(place), &unsorted.LineAt(strand), sizeof(World::Line)),
                0);
  }
}

TEST(Output, SameBitsOnEveryVector) {
  ForEveryVector([]<class V>(const char* name) {
    for (uint32_t visible : {1u, kStrandsPerChunk + 2, kLanes - 1, kLanes}) {
      World w(visible, visible), reference(visible, visible);
      w.state[2].live_strands = reference.state[2].live_strands = 1 + visible % 61;
      w.WriteInstancePieces<V>();
      reference.WriteInstancePieces();
      EXPECT_TRUE(w.instances.SameBits(reference.instances)) << name;
      w.WriteRibbonPieces<V>();
      reference.WriteRibbonPieces();
      EXPECT_TRUE(w.vertices.SameBits(reference.vertices)) << name;
      w.WriteUnsortedPieces<V>();
      reference.WriteUnsortedPieces();
      EXPECT_TRUE(w.vertices.SameBits(reference.vertices)) << name;
      w.WriteLinePieces<V>();
      reference.WriteLinePieces();
      EXPECT_TRUE(w.lines.SameBits(reference.lines)) << name;
      w.WriteUnsortedLinePieces<V>();
      reference.WriteUnsortedLinePieces();
      EXPECT_TRUE(w.lines.SameBits(reference.lines)) << name;
    }
  });
}

const RibbonVertex& VertexAt(const World& w, uint32_t index) {
  const uint32_t hair = index / kRibbonVerticesPerHair, rest = index % kRibbonVerticesPerHair;
  return w.HairAt(hair)[rest / 2][rest % 2];
}

TEST(RibbonIndices, FourFacingQuadsAHairThatShareTheirEdges) {
  World w(6);
  w.WriteRibbonPieces();
  std::vector<uint32_t> indices(kLanes * kRibbonIndicesPerHair);
  WriteRibbonIndices(indices);
  for (uint32_t hair = 0; hair < kLanes; ++hair) {
    const uint32_t* first = indices.data() + hair * kRibbonIndicesPerHair;
    std::set<uint32_t> used(first, first + kRibbonIndicesPerHair);
    EXPECT_EQ(used.size(), kRibbonVerticesPerHair);
    EXPECT_EQ(*used.begin(), hair * kRibbonVerticesPerHair);
    EXPECT_EQ(*used.rbegin(), (hair + 1) * kRibbonVerticesPerHair - 1);
  }
  // A straight hair across the line of sight: all eight triangles turn towards the eye.
  RibbonRecord& r = w.Ribbon(w.Strand(0));
  for (uint32_t i = 0; i < kRibbonPoints; ++i) {
    r.point[i][0] = 0.01f * float(i);
    r.point[i][1] = 0.02f * float(i);
    r.point[i][2] = 0.0f;
  }
  w.WriteRibbonPieces();
  for (uint32_t t = 0; t < kRibbonIndicesPerHair; t += 3) {
    const Double3 a = Of(VertexAt(w, indices[t]).position),
                  b = Of(VertexAt(w, indices[t + 1]).position),
                  c = Of(VertexAt(w, indices[t + 2]).position);
    EXPECT_GT(Dot(Cross(b - a, c - a), Of(w.params.eye) - a), 0.0) << t;
  }
}

TEST(RibbonIndices, SortedIndicesOverUnsortedVerticesDrawTheSortedVertices) {
  World sorted(7, kDrawn), unsorted(7, kDrawn);
  sorted.WriteRibbonPieces();
  unsorted.WriteUnsortedPieces();
  std::vector<uint32_t> plain(kDrawn * kRibbonIndicesPerHair), through(plain.size() + 5, 99u);
  WriteRibbonIndices(plain);
  const uint32_t written =
      WriteSortedRibbonIndices({unsorted.order.begin()->strand, kDrawn}, 0, through);
  ASSERT_EQ(written, plain.size());
  EXPECT_EQ(through[written], 99u);
  for (size_t i = 0; i < plain.size(); ++i)
    EXPECT_EQ(std::memcmp(&VertexAt(sorted, plain[i]), &VertexAt(unsorted, through[i]),
                          sizeof(RibbonVertex)),
              0);
  std::vector<uint32_t> moved(plain.size());
  WriteSortedRibbonIndices({unsorted.order.begin()->strand, kDrawn}, 5000, moved);
  for (size_t i = 0; i < plain.size(); ++i) EXPECT_EQ(moved[i], through[i] + 5000);
  std::vector<uint32_t> little(2 * kRibbonIndicesPerHair + 1);
  EXPECT_EQ(WriteSortedRibbonIndices({unsorted.order.begin()->strand, kDrawn}, 0, little),
            2 * kRibbonIndicesPerHair);
}

}  // namespace
}  // namespace pelt::test
