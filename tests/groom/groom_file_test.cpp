// The groom file: the same bytes back, the same bytes everywhere, and no way to harm the reader.
// Over 400 lines because a hundred rules are broken one by one, in one list beside their messages.
#include "core/groom/groom_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numeric>
#include <random>
#include <span>

#include "core/error.hpp"
#include "core/file_bytes.hpp"
#include "core/groom/groom_fields.hpp"
#include "tests/source_folder.hpp"

namespace pelt {
namespace {

constexpr size_t kHashAt = 40;

float DrawFloat(std::mt19937& random, float low, float high) {
  return low + (high - low) * float(random() % 65536) / 65536.0f;
}

void FillMesh(MeshBlock& mesh, uint32_t vertices, uint32_t joints, std::mt19937& random) {
  mesh.vertex_count = uint16_t(vertices);
  for (uint32_t v = 0; v < kVerticesPerChunk; ++v) {
    for (int axis = 0; axis < 3; ++axis) {
      mesh.position[axis][v] =
          v < vertices ? DrawFloat(random, -1.0f, 1.0f) : mesh.position[axis][vertices - 1];
      mesh.normal[axis][v] = axis == 2 ? 1.0f : 0.0f;
      mesh.tangent[axis][v] = axis == 0 ? 1.0f : 0.0f;
    }
  }
  uint32_t row = 0;
  for (uint32_t g = 0; g < kVertexGroups; ++g) {
    mesh.group_first_row[g] = uint16_t(row);
    if (g * kLaneGroup < vertices) {
      const uint8_t first = uint8_t(random() % (joints - 1));
      for (uint32_t lane = 0; lane < kLaneGroup; ++lane) {
        const float share = DrawFloat(random, 0.0f, 1.0f);
        mesh.weight[row][lane] = share;
        mesh.weight[row + 1][lane] = 1.0f - share;
      }
      mesh.row_joint[row] = first;
      mesh.row_joint[row + 1] = uint8_t(first + 1);
      row += 2;
    }
  }
  mesh.group_first_row[kVertexGroups] = uint16_t(row);
}

// The first chunk of a layer uses the vertices of its first patch; the second those of the last
// patch backwards, and some of the first one.
void FillHalo(HaloBlock& halo, uint32_t chunk, uint32_t patches) {
  std::fill(std::begin(halo.vertex), std::end(halo.vertex), ~0u);
  if (chunk == 0) {
    std::iota(halo.vertex, halo.vertex + 40, 0u);
  } else {
    for (uint32_t i = 0; i < 16; ++i) halo.vertex[i] = (patches - 1) * kVerticesPerChunk + 15 - i;
    for (uint32_t i = 16; i < 24; ++i) halo.vertex[i] = i;
  }
}

// `patches`: of the layer.
void FillStrands(StrandBlock& block, uint32_t strands, uint32_t vertices, uint32_t place,
                 const HaloBlock& halo, const MeshBlock* patches, std::mt19937& random) {
  block.strand_count = strands;
  block.vertex_count = vertices;
  block.control_count = strands >= kLaneGroup ? kLaneGroup : 0;
  block.first_strand = place * kStrandsPerChunk;
  for (uint32_t i = 0; i < kStrandsPerChunk; ++i) {
    const float u = DrawFloat(random, 0.0f, 0.5f), v = DrawFloat(random, 0.0f, 0.5f);
    block.bary[0][i] = u;
    block.bary[1][i] = v;
    block.bary[2][i] = 1.0f - u - v;
    block.length[i] = DrawFloat(random, 0.01f, 0.05f);
    block.width[i] = 0.001f;
    block.base_colour[i] = uint32_t(random());
    block.tip_colour[i] = uint32_t(random());
    for (int corner = 0; corner < 3; ++corner)
      block.vertex[corner][i] = uint8_t(random() % vertices);
    block.control[i] = uint8_t(block.control_count ? random() % block.control_count : 0);
    block.film_strip[i] = uint8_t(random());
  }
  for (uint32_t i = 0; i < vertices; ++i) {
    const MeshBlock& mesh = patches[halo.vertex[i] / kVerticesPerChunk];
    const uint32_t group = halo.vertex[i] % kVerticesPerChunk / kLaneGroup;
    for (uint32_t row = mesh.group_first_row[group]; row < mesh.group_first_row[group + 1]; ++row)
      block.joint_mask[mesh.row_joint[row] / 32] |= 1u << mesh.row_joint[row] % 32;
  }
}

void FillDown(DownBlock& block) {
  for (uint32_t i = 0; i < kStrandsPerChunk; ++i) block.down[i % 3][i] = i % 2 ? 1.0f : -1.0f;
}

template <class T>
void FillRest(T& rest, std::mt19937& random) {
  for (auto& point : rest.offset) {
    for (auto& axis : point) {
      for (float& value : axis) value = DrawFloat(random, -0.05f, 0.05f);
    }
  }
  for (float& value : rest.segment_length) value = DrawFloat(random, 0.001f, 0.02f);
  for (float& value : rest.strength) value = DrawFloat(random, 0.0f, 1.0f);
}

// Four layers: chains at vertices (2 patches, 2 chunks), chains of 4 points (1, 1), of 5 (1, 2) and
// of 9 (2, 2).
Groom MakeGroom() {
  std::mt19937 random(20);
  Groom groom;
  groom.unit_scale = 0.01f;
  groom.joint_count = 7;
  for (uint32_t j = 0; j < groom.joint_count; ++j) {
    groom.skeleton.parent[j] = int32_t(j) - 1;
    groom.joint_names.push_back("joint " + std::to_string(j));
    for (float& value : groom.skeleton.inverse_bind[j]) value = DrawFloat(random, -1.0f, 1.0f);
  }
  const uint32_t patches[] = {2, 1, 1, 2}, chunks[] = {2, 1, 2, 2};
  for (uint32_t l = 0; l < 4; ++l) {
    GroomLayer layer;
    layer.name = "layer " + std::to_string(l);
    layer.params.chain = l == 0 ? ChainKind::kVertex : ChainKind::kStrand;
    layer.params.points = l == 3 ? 9 : l == 2 ? 5 : 4;
    layer.params.solver = l == 2 ? Solver::kVerlet : l == 1 ? Solver::kPbd : Solver::kModal;
    layer.params.sag_free = l == 0 || l == 3;
    layer.params.output = l == 0 ? Output::kInstances : Output::kRibbons;
    layer.params.sort_bias = float(l) - 1.0f;
    layer.first_patch = uint32_t(groom.mesh.size());
    layer.patch_count = patches[l];
    layer.first_chunk = uint32_t(groom.strands.size());
    layer.chunk_count = chunks[l];
    layer.length_max = 0.05f;
    LayerJointBlock joints{};
    joints.count = groom.joint_count;
    for (uint32_t j = 0; j < joints.count; ++j) {
      joints.joint[j] = j;
      for (int axis = 0; axis < 3; ++axis) {
        joints.low[axis][j] = -1.0f;
        joints.high[axis][j] = 1.0f;
      }
    }
    groom.layer_joints.push_back(joints);
    for (uint32_t p = 0; p < patches[l]; ++p) {
      FillMesh(groom.mesh.emplace_back(), p == 0 ? 40 : 16, groom.joint_count, random);
      if (l == 0) FillRest(groom.vertex_rest.emplace_back(), random);
      if (l == 0) FillDown(groom.vertex_down.emplace_back());
    }
    for (uint32_t c = 0; c < chunks[l]; ++c) {
      const uint32_t strands = c == 0 ? kStrandsPerChunk : 21;
      FillHalo(groom.halo.emplace_back(), c, patches[l]);
      FillStrands(groom.strands.emplace_back(), strands, c == 0 ? 40 : 24, c, groom.halo.back(),
                  &groom.mesh[layer.first_patch], random);
      for (uint32_t& uv : groom.strand_uv.emplace_back().uv) uv = uint32_t(random());
      if (l == 3) FillDown(groom.strand_down.emplace_back());
      if (l == 3) {
        FillRest(groom.strand_rest9.emplace_back(), random);
      } else if (l == 2) {
        FillRest(groom.strand_rest5.emplace_back(), random);
      } else {
        FillRest(groom.strand_rest4.emplace_back(), random);
      }
      layer.strand_count += strands;
    }
    groom.layers.push_back(layer);
  }
  return groom;
}

std::string ErrorOf(std::span<const std::byte> bytes) {
  return ReadGroom(bytes, "g.groom").error();
}

std::string CheckErrorOf(const Groom& groom) { return FindGroomFault(groom, "g.groom"); }

void FixHash(std::vector<std::byte>& bytes) {
  const uint64_t hash = HashGroomBytes(std::span(bytes).subspan(kHashAt + 8));
  for (size_t i = 0; i < 8; ++i) bytes[kHashAt + i] = std::byte(hash >> 8 * i & 255);
}

uint32_t LoadU32(const std::vector<std::byte>& bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = 0; i < 4; ++i) value |= uint32_t(bytes[at + i]) << 8 * i;
  return value;
}

TEST(GroomFile, RoundTripKeepsEveryField) {
  const Groom groom = MakeGroom();
  const auto bytes = WriteGroom(groom).OrThrow();
  const Groom back = ReadGroom(bytes, "g.groom").OrThrow();
  EXPECT_EQ(WriteGroom(back).OrThrow(), bytes);
  // Blocks have no padding that holds values, so they compare as memory once padding is zero on
  // both sides: MakeGroom starts from zeros and so does the reader.
  EXPECT_EQ(back.unit_scale, groom.unit_scale);
  EXPECT_EQ(back.joint_names, groom.joint_names);
  EXPECT_EQ(std::memcmp(&back.skeleton, &groom.skeleton, sizeof(groom.skeleton)), 0);
  const auto expect_same = [](const auto& a, const auto& b) {
    EXPECT_TRUE(std::ranges::equal(std::as_bytes(std::span(a)), std::as_bytes(std::span(b))));
  };
  expect_same(back.layer_joints, groom.layer_joints);
  expect_same(back.mesh, groom.mesh);
  expect_same(back.strands, groom.strands);
  expect_same(back.strand_uv, groom.strand_uv);
  expect_same(back.halo, groom.halo);
  expect_same(back.vertex_down, groom.vertex_down);
  expect_same(back.strand_down, groom.strand_down);
  expect_same(back.vertex_rest, groom.vertex_rest);
  expect_same(back.strand_rest4, groom.strand_rest4);
  expect_same(back.strand_rest5, groom.strand_rest5);
  expect_same(back.strand_rest9, groom.strand_rest9);
  ASSERT_EQ(back.layers.size(), 4u);
  for (size_t i = 0; i < 4; ++i) {
    const GroomLayer &a = back.layers[i], &b = groom.layers[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.first_patch, b.first_patch);
    EXPECT_EQ(a.patch_count, b.patch_count);
    EXPECT_EQ(a.first_chunk, b.first_chunk);
    EXPECT_EQ(a.chunk_count, b.chunk_count);
    EXPECT_EQ(a.strand_count, b.strand_count);
    EXPECT_EQ(a.params.points, b.params.points);
    EXPECT_EQ(a.params.solver, b.params.solver);
    EXPECT_EQ(a.params.sag_free, b.params.sag_free);
    EXPECT_EQ(a.params.sort_bias, b.params.sort_bias);
    EXPECT_EQ(a.params.dirt_colour, b.params.dirt_colour);
  }
}

// Each layer parameter, by the list of fields, survives with a value of its own.
TEST(GroomFile, RoundTripKeepsEveryLayerParameter) {
  Groom groom = MakeGroom();
  LayerParams& p = groom.layers[1].params;
  uint32_t fields = 0;
  groom_file::ListFields(
      [&](std::string_view name, auto& field) {
        using T = std::remove_reference_t<decltype(field)>;
        ++fields;
        if (name == "points" || name == "max_distance" || name == "fins" || name == "sag_free")
          return;
        if (name == "chain_share") return;  // of another kind of chain
        if (name.starts_with("inertia") || name == "friction") return;
        if constexpr (std::is_same_v<T, float>) field = float(fields) / 64.0f;
        if constexpr (std::is_same_v<T, bool>) field = !field;
        if constexpr (std::is_same_v<T, uint32_t>) field = 7;
        if constexpr (std::is_enum_v<T>) field = T(1);
      },
      p);
  EXPECT_EQ(fields, kMemberCount<LayerParams> + 2);  // a colour is three
  const Groom back = ReadGroom(WriteGroom(groom).OrThrow(), "g.groom").OrThrow();
  std::vector<double> wrote, read;
  const auto collect = [](std::vector<double>& to) {
    return [&to](std::string_view, const auto& field) { to.push_back(double(field)); };
  };
  groom_file::ListFields(collect(wrote), std::as_const(p));
  groom_file::ListFields(collect(read), back.layers[1].params);
  EXPECT_EQ(wrote, read);
  // Goes with one solver only.
  p.solver = Solver::kModal;
  p.max_distance = 0.25f;
  p.friction = 0.625f;
  p.inertia = 0.5f, p.inertia_turn = 0.375f, p.inertia_speed = 3.0f;
  const LayerParams modal =
      ReadGroom(WriteGroom(groom).OrThrow(), "g.groom").OrThrow().layers[1].params;
  EXPECT_EQ(modal.max_distance, 0.25f);
  EXPECT_EQ(modal.friction, 0.625f);
  EXPECT_EQ(modal.inertia, 0.5f);
  EXPECT_EQ(modal.inertia_turn, 0.375f);
  EXPECT_EQ(modal.inertia_speed, 3.0f);
}

// A field that is missing from the list would be lost in silence: listed bytes and padding make up
// the block.
TEST(GroomFile, EveryFieldOfEveryBlockIsListed) {
  EXPECT_EQ(groom_file::CountItemBytes(SkeletonBlock{}), sizeof(SkeletonBlock));
  EXPECT_EQ(groom_file::CountItemBytes(LayerJointBlock{}),
            sizeof(LayerJointBlock) - sizeof(LayerJointBlock::pad));
  EXPECT_EQ(groom_file::CountItemBytes(MeshBlock{}), sizeof(MeshBlock) - sizeof(MeshBlock::pad));
  EXPECT_EQ(groom_file::CountItemBytes(StrandBlock{}),
            sizeof(StrandBlock) - sizeof(StrandBlock::pad));
  EXPECT_EQ(groom_file::CountItemBytes(HaloBlock{}), sizeof(HaloBlock));
  EXPECT_EQ(groom_file::CountItemBytes(DownBlock{}), sizeof(DownBlock));
  EXPECT_EQ(groom_file::CountItemBytes(RestBlock<4>{}), sizeof(RestBlock<4>));
  EXPECT_EQ(groom_file::CountItemBytes(RestBlock<5>{}), sizeof(RestBlock<5>));
}

TEST(GroomFile, PaddingNeverReachesTheFile) {
  Groom groom = MakeGroom();
  const auto bytes = WriteGroom(groom).OrThrow();
  for (auto& block : groom.mesh) std::memset(block.pad, 0xab, sizeof(block.pad));
  for (auto& block : groom.strands) std::memset(block.pad, 0xcd, sizeof(block.pad));
  for (auto& block : groom.layer_joints) std::memset(block.pad, 0xef, sizeof(block.pad));
  EXPECT_EQ(WriteGroom(groom).OrThrow(), bytes);
}

// The layout as documented, byte by byte: what a big-endian machine must produce as well.
TEST(GroomFile, BytesAreLittleEndian) {
  Groom groom = MakeGroom();
  groom.unit_scale = 0.15625f;  // 0x3e200000
  const auto bytes = WriteGroom(groom).OrThrow();
  EXPECT_EQ(std::memcmp(bytes.data(), "PELTGRM\n", 8), 0);
  EXPECT_EQ(LoadU32(bytes, 8), kGroomVersion);
  EXPECT_EQ(LoadU32(bytes, 12), kStrandsPerChunk);
  EXPECT_EQ(LoadU32(bytes, 28), 17u);
  EXPECT_EQ(LoadU32(bytes, 32), bytes.size());
  EXPECT_EQ(std::memcmp(bytes.data() + 48, "general\0\0\0\0\0\0\0\0\0", 16), 0);
  const size_t general = 48 + 17 * 40;
  EXPECT_EQ(LoadU32(bytes, 48 + 16), general);
  EXPECT_EQ(bytes[general + 0], std::byte{0x00});
  EXPECT_EQ(bytes[general + 2], std::byte{0x20});
  EXPECT_EQ(bytes[general + 3], std::byte{0x3e});
  EXPECT_EQ(LoadU32(bytes, general + 4), 7u);
  EXPECT_EQ(LoadU32(bytes, general + 8), 0xffffffffu) << "parent -1";
}

// What a big-endian host runs gives the bytes that this host copies.
template <class T>
void ExpectSameBytes(const std::vector<T>& numbers) {
  std::vector<std::byte> little(numbers.size() * sizeof(T)), big(little);
  groom_file::StoreNumbers<std::endian::little>(little.data(), numbers.data(), numbers.size());
  groom_file::StoreNumbers<std::endian::big>(big.data(), numbers.data(), numbers.size());
  EXPECT_EQ(little, big);
  std::vector<T> back(numbers.size());
  groom_file::LoadNumbers<std::endian::big>(back.data(), big.data(), numbers.size());
  EXPECT_EQ(std::memcmp(back.data(), numbers.data(), little.size()), 0);
}

TEST(GroomFile, BigEndianHostsWriteTheSameBytes) {
  if (std::endian::native != std::endian::little) GTEST_SKIP() << "compares with a plain copy";
  ExpectSameBytes<float>({1.0f, -0.0f, 3.14159f, 1e-40f, NAN, INFINITY});
  ExpectSameBytes<uint32_t>({1, 0x12345678u, 0xffffffffu});
  ExpectSameBytes<int32_t>({-1, 5, -70000});
  ExpectSameBytes<uint16_t>({1, 0x1234, 0xffff});
  ExpectSameBytes<uint8_t>({1, 2, 255});
  ExpectSameBytes<uint64_t>({0x0123456789abcdefull});
}

TEST(GroomFile, HashIsFixed) {
  // Computed apart from this code, from the definition, so that no machine and no rewrite changes
  // it unseen.
  std::vector<std::byte> bytes(19);
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = std::byte(i * 37 + 1);
  EXPECT_EQ(HashGroomBytes(bytes), 0x6c41131627b0b96full);
  bytes[18] ^= std::byte{1};
  EXPECT_NE(HashGroomBytes(bytes), 0x6c41131627b0b96full);
}

// Files of before layers had a share of their chains: of all of them.
TEST(GroomFile, OlderFilesAreRead) {
  const std::string path = test::SourceFolder() + "/tests/fuzz/corpus/groom/version_8.groom";
  const auto older = ReadFileBytes("groom", path).OrThrow();
  ASSERT_EQ(LoadU32(older, 8), kOldestGroomVersion);
  Groom groom = ReadGroom(older, path).OrThrow();
  const auto now = WriteGroom(groom).OrThrow();
  EXPECT_EQ(now.size(), older.size() + sizeof(float) * groom.layers.size());
  for (const GroomLayer& layer : groom.layers) EXPECT_EQ(layer.params.chain_share, 1.0f);
  EXPECT_EQ(WriteGroom(ReadGroom(now, "now").OrThrow()).OrThrow(), now);
  groom.layers[0].params.chain_share = 0.25f;
  const Groom back = ReadGroom(WriteGroom(groom).OrThrow(), "g.groom").OrThrow();
  EXPECT_EQ(back.layers[0].params.chain_share, 0.25f);
}

TEST(GroomFile, WrongFilesAreTold) {
  const auto good = WriteGroom(MakeGroom()).OrThrow();
  EXPECT_EQ(ErrorOf({}),
            "groom 'g.groom': section 'header', byte 0: 8 more bytes are needed, 0 are left");
  auto bad = good;
  bad[0] = std::byte{'X'};
  EXPECT_EQ(ErrorOf(bad), "groom 'g.groom': section 'header', byte 0: not a groom file");
  bad = good;
  bad[8] = std::byte{10};
  EXPECT_EQ(ErrorOf(bad),
            "groom 'g.groom': section 'header', byte 8: version 10, this program reads 9; bake the "
            "character again with `pelt bake`");
  bad = good;
  bad[12] = std::byte{0};
  bad[13] = std::byte{2};
  EXPECT_EQ(ErrorOf(bad),
            "groom 'g.groom': section 'header', byte 12: baked for 512 strands per "
            "chunk, this program has " +
                std::to_string(kStrandsPerChunk) + "; bake the character again with `pelt bake`");
  bad = good;
  bad.pop_back();
  EXPECT_NE(ErrorOf(bad).find("it was cut or extended"), std::string::npos);
  bad = good;
  bad.push_back(std::byte{0});
  EXPECT_NE(ErrorOf(bad).find("it was cut or extended"), std::string::npos);
  bad = good;
  bad[bad.size() / 2] ^= std::byte{1};
  EXPECT_EQ(ErrorOf(bad),
            "groom 'g.groom': section 'header', byte 40: the content does not match "
            "its hash: the file is damaged");
  // A count that would ask for 4 billion blocks is refused before anything is allocated.
  bad = good;
  for (size_t i = 0; i < 4; ++i) bad[48 + 5 * 40 + 32 + i] = std::byte{0xff};
  FixHash(bad);
  EXPECT_NE(ErrorOf(bad).find("section 'mesh'"), std::string::npos);
  EXPECT_NE(ErrorOf(bad).find("4294967295 items do not fit"), std::string::npos);
}

// Every rule of FindGroomFault: break it in memory, and see section and reason.
TEST(GroomFile, EveryRuleHolds) {
  struct Case {
    const char* section;
    const char* reason;
    std::function<void(Groom&)> spoil;
  };
  const Case cases[] = {
      {"general", "unit scale", [](Groom& g) { g.unit_scale = 0.0f; }},
      {"general", "unit scale", [](Groom& g) { g.unit_scale = NAN; }},
      {"general", "joints", [](Groom& g) { g.joint_count = 0; }},
      {"general", "joints", [](Groom& g) { g.joint_count = 257; }},
      {"joint_names", "names for", [](Groom& g) { g.joint_names.pop_back(); }},
      {"joint_names", "control characters", [](Groom& g) { g.joint_names[1] = "\x1b[2J"; }},
      {"layers", "control characters", [](Groom& g) { g.layers[0].name = "coat\xc2\x9b"; }},
      {"skeleton", "does not come before", [](Groom& g) { g.skeleton.parent[3] = 3; }},
      {"skeleton", "does not come before", [](Groom& g) { g.skeleton.parent[3] = -2; }},
      {"skeleton", "does not come before", [](Groom& g) { g.skeleton.parent[7] = 7; }},
      {"skeleton", "does not come before", [](Groom& g) { g.skeleton.parent[7] = -2; }},
      {"skeleton", "does not come before", [](Groom& g) { g.skeleton.parent[255] = 1 << 30; }},
      {"skeleton", "not finite", [](Groom& g) { g.skeleton.inverse_bind[255][0] = INFINITY; }},
      {"skeleton", "not finite", [](Groom& g) { g.skeleton.inverse_bind[6][11] = NAN; }},
      {"layers", "0 layers", [](Groom& g) { g.layers.clear(); }},
      {"layers", "name", [](Groom& g) { g.layers[1].name = ""; }},
      {"layers", "solver", [](Groom& g) { g.layers[1].params.solver = Solver(3); }},
      {"layers", "bounce", [](Groom& g) { g.layers[1].params.bounce = NAN; }},
      {"layers", "points", [](Groom& g) { g.layers[0].params.points = 5; }},
      {"layers", "points: 4, 5 or 9", [](Groom& g) { g.layers[3].params.points = 6; }},
      {"layers", "points is not between", [](Groom& g) { g.layers[3].params.points = 10; }},
      {"layers", "only solver = \"modal\" has chains of 9",
       [](Groom& g) { g.layers[3].params.solver = Solver::kPbd; }},
      {"layers", "patches begin at", [](Groom& g) { g.layers[1].first_patch = 1; }},
      {"layers", "patches", [](Groom& g) { g.layers[2].patch_count = 0xffffffffu; }},
      {"layers", "chunks begin at", [](Groom& g) { g.layers[1].first_chunk = 1; }},
      {"layers", "chunks", [](Groom& g) { g.layers[2].chunk_count = 0xffffffffu; }},
      {"layers", "strands", [](Groom& g) { g.layers[2].strand_count++; }},
      {"layers", "its longest strand", [](Groom& g) { g.layers[2].length_max = 0.01f; }},
      {"layers", "its longest strand", [](Groom& g) { g.layers[2].length_max = NAN; }},
      {"layer_joints", "where the layers need", [](Groom& g) { g.layer_joints.pop_back(); }},
      {"mesh", "where the layers need", [](Groom& g) { g.mesh.pop_back(); }},
      {"mesh", "where the layers need", [](Groom& g) { g.layers[3].patch_count = 1; }},
      {"halo", "where the layers need", [](Groom& g) { g.halo.pop_back(); }},
      {"vertex_down", "where the layers need", [](Groom& g) { g.vertex_down.pop_back(); }},
      {"vertex_down", "where the layers need",
       [](Groom& g) { g.layers[0].params.sag_free = false; }},
      {"strand_down", "where the layers need", [](Groom& g) { g.strand_down.pop_back(); }},
      {"strand_down", "where the layers need",
       [](Groom& g) { g.layers[3].params.sag_free = false; }},
      {"strands", "where the layers need", [](Groom& g) { g.strands.pop_back(); }},
      {"vertex_rest", "where the layers need", [](Groom& g) { g.vertex_rest.pop_back(); }},
      {"strand_rest4", "where the layers need", [](Groom& g) { g.strand_rest4.pop_back(); }},
      {"strand_rest5", "where the layers need", [](Groom& g) { g.strand_rest5.pop_back(); }},
      {"strand_rest9", "where the layers need", [](Groom& g) { g.strand_rest9.pop_back(); }},
      {"strand_uv", "where the layers need", [](Groom& g) { g.strand_uv.pop_back(); }},
      {"layer_joints", "joints", [](Groom& g) { g.layer_joints[1].count = 257; }},
      {"layer_joints", "unknown or named twice", [](Groom& g) { g.layer_joints[1].joint[2] = 7; }},
      {"layer_joints", "unknown or named twice", [](Groom& g) { g.layer_joints[1].joint[2] = 1; }},
      {"layer_joints", "unknown or named twice",
       [](Groom& g) { g.layer_joints[1].joint[255] = 256; }},
      {"layer_joints", "inside out", [](Groom& g) { g.layer_joints[2].low[1][255] = 2.0f; }},
      {"layer_joints", "is missing", [](Groom& g) { g.layer_joints[1].count = 0; }},
      {"layer_joints", "inside out", [](Groom& g) { g.layer_joints[2].low[1][3] = 2.0f; }},
      {"layer_joints", "not a number", [](Groom& g) { g.layer_joints[2].high[1][3] = INFINITY; }},
      {"mesh", "0 vertices", [](Groom& g) { g.mesh[0].vertex_count = 0; }},
      {"mesh", "vertices", [](Groom& g) { g.mesh[0].vertex_count = kVerticesPerChunk + 1; }},
      {"mesh", "not a number", [](Groom& g) { g.mesh[3].position[2][5] = NAN; }},
      {"mesh", "not a number",
       [](Groom& g) { g.mesh[3].position[2][kVerticesPerChunk - 1] = 1e9f; }},
      {"mesh", "not a unit vector", [](Groom& g) { g.mesh[3].normal[2][5] = 0.0f; }},
      {"mesh", "not a unit vector", [](Groom& g) { g.mesh[3].tangent[0][5] = 1.5f; }},
      {"mesh", "not a number", [](Groom& g) { g.mesh[4].weight[0][3] = -0.5f; }},
      {"mesh", "sum to", [](Groom& g) { g.mesh[4].weight[0][3] *= 0.5f; }},
      {"mesh", "rows must ascend",
       [](Groom& g) { g.mesh[4].group_first_row[kVertexGroups] = 999; }},
      {"mesh", "rows must ascend", [](Groom& g) { g.mesh[0].group_first_row[1] = 0xffff; }},
      {"mesh", "sum to", [](Groom& g) { g.mesh[0].group_first_row[1] = 0; }},
      {"mesh", "unknown or out of order", [](Groom& g) { g.mesh[0].row_joint[1] = 7; }},
      {"mesh", "unknown or out of order",
       [](Groom& g) { g.mesh[0].row_joint[1] = g.mesh[0].row_joint[0]; }},
      {"mesh", "unknown or out of order",
       [](Groom& g) { g.mesh[1].row_joint[kInfluenceRows - 1] = 255; }},
      {"strands", "0 strands", [](Groom& g) { g.strands[1].strand_count = 0; }},
      {"strands", "strands", [](Groom& g) { g.strands[1].strand_count = kStrandsPerChunk + 1; }},
      {"strands", "0 vertices", [](Groom& g) { g.strands[1].vertex_count = 0; }},
      {"strands", "vertices", [](Groom& g) { g.strands[1].vertex_count = kVerticesPerChunk + 1; }},
      {"halo", "behind the 23 in use", [](Groom& g) { g.strands[1].vertex_count = 23; }},
      {"halo", "no vertex of the layer", [](Groom& g) { g.strands[1].vertex_count = 25; }},
      // The groom has such a patch, but the layer has not.
      {"halo", "no vertex of the layer",
       [](Groom& g) { g.halo[1].vertex[3] = 2 * kVerticesPerChunk; }},
      {"halo", "no vertex of the layer", [](Groom& g) { g.halo[1].vertex[3] = 0xfffffff0u; }},
      {"halo", "no vertex of the layer", [](Groom& g) { g.halo[1].vertex[3] = ~0u; }},
      // A lane behind those of the patch.
      {"halo", "no vertex of the layer",
       [](Groom& g) { g.halo[1].vertex[3] = kVerticesPerChunk + 16; }},
      {"halo", "no vertex of the layer", [](Groom& g) { g.halo[4].vertex[3] = 40; }},
      {"halo", "behind the 24 in use", [](Groom& g) { g.halo[1].vertex[24] = 7; }},
      {"halo", "behind the 40 in use",
       [](Groom& g) { g.halo[0].vertex[kVerticesPerChunk - 1] = ~0u - 1; }},
      {"strands", "control strands", [](Groom& g) { g.strands[1].control_count = 8; }},
      {"strands", "control strands", [](Groom& g) { g.strands[1].control_count = 48; }},
      {"strands", "is no control strand", [](Groom& g) { g.strands[1].control[4] = 16; }},
      {"strands", "is no control strand",
       [](Groom& g) { g.strands[1].control[kStrandsPerChunk - 1] = 255; }},
      {"strands", "expected", [](Groom& g) { g.strands[1].first_strand = 0; }},
      {"strands", "barycentrics sum", [](Groom& g) { g.strands[1].bary[2][20] += 0.1f; }},
      {"strands", "not a number", [](Groom& g) { g.strands[1].bary[0][3] = -0.5f; }},
      {"strands", "not above 0", [](Groom& g) { g.strands[1].length[20] = 0.0f; }},
      {"strands", "not a number", [](Groom& g) { g.strands[1].length[3] = NAN; }},
      {"strands", "not a number", [](Groom& g) { g.strands[1].width[3] = -1.0f; }},
      {"strands", "no vertex 200", [](Groom& g) { g.strands[1].vertex[2][31] = 200; }},
      {"strands", "no vertex 24", [](Groom& g) { g.strands[1].vertex[1][20] = 24; }},
      {"strands", "no vertex 24",
       [](Groom& g) { g.strands[1].vertex[0][kStrandsPerChunk - 1] = 24; }},
      {"strands", "no joint 31", [](Groom& g) { g.strands[1].joint_mask[0] |= 1u << 31; }},
      {"strands", "is missing", [](Groom& g) { g.strands[1].joint_mask[0] = 0; }},
      // Joints of the second of the patches that the chunk's vertices lie in.
      {"strands", "is missing",
       [](Groom& g) {
         for (MeshBlock* mesh : {&g.mesh[0], &g.mesh[1]})
           for (uint32_t row = 0; row < mesh->group_first_row[kVertexGroups]; ++row)
             mesh->row_joint[row] = uint8_t(row % 2 + (mesh == &g.mesh[0] ? 0 : 5));
         g.strands[0].joint_mask[0] = 3;
         g.strands[1].joint_mask[0] = 3;
       }},
      {"vertex_down", "not a direction of length 1",
       [](Groom& g) { g.vertex_down[1].down[0][15] = 0.5f; }},
      {"vertex_down", "not a number", [](Groom& g) { g.vertex_down[1].down[2][15] = NAN; }},
      {"strand_down", "not a direction of length 1",
       [](Groom& g) { g.strand_down[1].down[1][21] = 0.5f; }},
      {"strand_down", "not a number", [](Groom& g) { g.strand_down[1].down[1][21] = NAN; }},
      {"vertex_rest", "not above 0", [](Groom& g) { g.vertex_rest[1].segment_length[3] = 0.0f; }},
      {"strand_rest4", "not a number", [](Groom& g) { g.strand_rest4[2].strength[3] = 1.5f; }},
      {"strand_rest5", "not a number", [](Groom& g) { g.strand_rest5[1].offset[3][2][1] = NAN; }},
      {"strand_rest9", "not a number", [](Groom& g) { g.strand_rest9[1].offset[7][2][1] = NAN; }},
  };
  const Groom good = MakeGroom();
  ASSERT_EQ(CheckErrorOf(good), "");
  for (const Case& c : cases) {
    Groom bad = good;
    c.spoil(bad);
    const std::string message = CheckErrorOf(bad);
    EXPECT_EQ(message.rfind(std::string("groom 'g.groom': section '") + c.section + "', byte ", 0),
              0u)
        << c.section << ", " << c.reason << ": " << message;
    EXPECT_NE(message.find(c.reason), std::string::npos) << c.section << ": " << message;
    EXPECT_THROW(WriteGroom(bad).OrThrow(), Error);
  }
}

// The byte that a message names is the byte that is wrong.
TEST(GroomFile, MessagesNameTheByte) {
  const Groom good = MakeGroom();
  const auto bytes = WriteGroom(good).OrThrow();
  const std::function<float&(Groom&)> fields[] = {
      [](Groom& g) -> float& { return g.skeleton.inverse_bind[4][7]; },
      [](Groom& g) -> float& { return g.layers[1].length_max; },
      [](Groom& g) -> float& { return g.layers[2].length_max; },
      [](Groom& g) -> float& { return g.layer_joints[2].high[1][3]; },
      [](Groom& g) -> float& { return g.mesh[3].weight[2][5]; },
      [](Groom& g) -> float& { return g.strands[4].width[9]; },
      [](Groom& g) -> float& { return g.vertex_rest[1].offset[2][1][4]; },
      [](Groom& g) -> float& { return g.strand_rest4[0].segment_length[0]; },
      [](Groom& g) -> float& { return g.strand_rest5[1].strength[1]; },
      [](Groom& g) -> float& { return g.strand_rest9[1].offset[7][0][2]; },
      [](Groom& g) -> float& { return g.vertex_down[1].down[2][5]; },
      [](Groom& g) -> float& { return g.strand_down[1].down[2][5]; },
  };
  for (const auto& field : fields) {
    Groom bad = good;
    const float kept = field(bad);
    field(bad) = NAN;
    const std::string message = CheckErrorOf(bad);
    size_t at = 0;
    ASSERT_EQ(std::sscanf(message.c_str() + message.find("byte "), "byte %zu", &at), 1) << message;
    ASSERT_LE(at + 4, bytes.size());
    EXPECT_EQ(std::bit_cast<float>(LoadU32(bytes, at)), kept) << message;
    auto spoiled = bytes;
    const uint32_t nan = std::bit_cast<uint32_t>(NAN);
    for (size_t i = 0; i < 4; ++i) spoiled[at + i] = std::byte(nan >> 8 * i & 255);
    FixHash(spoiled);
    EXPECT_EQ(ErrorOf(spoiled), message);
  }
}

// Thousands of damaged files: an error or a groom that is sound, never a crash.
TEST(GroomFile, DamagedFilesNeverCrash) {
  const auto good = WriteGroom(MakeGroom()).OrThrow();
  std::mt19937 random(99);
  const size_t table_end = 48 + 17 * 40;
  int refused = 0, accepted = 0;
  for (int i = 0; i < 4000; ++i) {
    auto bad = good;
    if (i % 16 == 0) bad.resize(random() % bad.size());
    const size_t flips = 1 + random() % 3;
    for (size_t n = 0; n < flips && !bad.empty(); ++n) {
      // The header and table, the small sections behind them, and anywhere.
      const size_t kind = random() % 3;
      const size_t reach = kind == 0 ? table_end : kind == 1 ? table_end + 20000 : bad.size();
      std::byte& byte = bad[random() % std::min(reach, bad.size())];
      switch (random() % 4) {
        case 0:
          byte ^= std::byte(1u << random() % 8);
          break;
        case 1:
          byte = std::byte{0xff};
          break;
        case 2:
          byte = std::byte{0};
          break;
        default:
          byte = std::byte(random() & 255);
      }
    }
    const bool hash_fixed = i % 4 != 0 && bad.size() >= kHashAt + 8;
    if (hash_fixed) {
      if (i % 5 == 0) {  // a cut file that says so
        for (size_t b = 0; b < 8; ++b) bad[32 + b] = std::byte(uint64_t(bad.size()) >> 8 * b & 255);
      }
      FixHash(bad);
    }
    try {
      const Groom groom = ReadGroom(bad, "g.groom").OrThrow();
      ++accepted;
      EXPECT_EQ(WriteGroom(groom).OrThrow(), bad) << "what is accepted is kept";
      EXPECT_TRUE(hash_fixed || bad == good);
    } catch (const Error& error) {
      ++refused;
      EXPECT_EQ(std::string(error.what()).rfind("groom 'g.groom': section '", 0), 0u)
          << error.what();
    }
  }
  EXPECT_GT(refused, 2000);
  EXPECT_GT(accepted, 50) << "mutations must get past the hash to try the rest";
}

TEST(GroomFile, FilesAreReplacedWhole) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "pelt_groom_file_test";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const std::string path = (folder / "a.groom").string();
  const Groom groom = MakeGroom();
  std::ofstream(path) << "old";
  WriteGroomFile(groom, path).OrThrow();
  EXPECT_EQ(WriteGroom(ReadGroomFile(path).OrThrow()).OrThrow(), WriteGroom(groom).OrThrow());
  size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files += entry.exists();
  EXPECT_EQ(files, 1u) << "the partial file is gone";
  EXPECT_THROW(ReadGroomFile((folder / "none.groom").string()).OrThrow(), Error);
  EXPECT_THROW(ReadGroomFile(folder.string()).OrThrow(), Error);
  EXPECT_THROW(WriteGroomFile(groom, (folder / "no" / "b.groom").string()).OrThrow(), Error);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace pelt
