// The groom file: the same bytes back, the same bytes everywhere, and no way to harm the reader.
#include "core/groom/groom_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <memory>
#include <random>
#include <span>

#include "core/error.hpp"
#include "core/file_bytes.hpp"
#include "core/groom/groom_fields.hpp"
#include "tests/groom/made_groom.hpp"
#include "tests/source_folder.hpp"
#include "tests/test_folder.hpp"

namespace pelt::test {
namespace {

constexpr size_t kHashAt = 40;

std::string ErrorOf(std::span<const std::byte> bytes) {
  return ReadGroom(bytes, "g.groom").error();
}

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
  expect_same(back.strand_traits, groom.strand_traits);
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
    EXPECT_EQ(a.params.traits, b.params.traits);
    EXPECT_EQ(a.params.sort_bias, b.params.sort_bias);
    EXPECT_EQ(a.params.dirt_colour, b.params.dirt_colour);
    ASSERT_EQ(bool(a.strand_texture), i == 1);
  }
  EXPECT_TRUE(*back.layers[1].strand_texture == *groom.layers[1].strand_texture);
}

// A strand texture is read as hostile input, too.
TEST(GroomFile, StrandTexturesAreChecked) {
  const auto fault_of = [](const std::function<void(StrandTexture&)>& change,
                           bool painted = false) {
    Groom groom = MakeGroom();
    StrandTexture texture = *groom.layers[1].strand_texture;
    change(texture);
    groom.layers[1].params.lit = groom.layers[1].params.painted = painted;
    groom.layers[1].strand_texture = std::make_shared<const StrandTexture>(texture);
    return FindGroomFault(groom, "g.groom");
  };
  const auto expect = [&](const char* words, const std::function<void(StrandTexture&)>& change) {
    EXPECT_NE(fault_of(change).find(words), std::string::npos) << fault_of(change);
  };
  EXPECT_EQ(fault_of([](StrandTexture&) {}), "");
  expect("6 texels wide: no multiple of film_strips, 4", [](StrandTexture& t) { t.strips = 4; });
  expect("no multiple", [](StrandTexture& t) { t.strips = 0; });
  expect("72 bytes for 6 x 4 texels", [](StrandTexture& t) { t.height = 4; });
  expect("at most 4194304 are allowed", [](StrandTexture& t) { t.height = 4000000000u; });
  expect("no known meaning", [](StrandTexture& t) { t.channels = StrandChannels(2); });
  const auto weather = [](StrandTexture& t) { t.channels = StrandChannels::kWeather; };
  expect("painted = true", weather);
  EXPECT_EQ(fault_of(weather, true), "");
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
        if (name == "chain_share" || name == "traits") return;  // of another kind of chain
        if constexpr (std::is_same_v<T, float>)
          if (name.starts_with("look_")) {
            field = float(fields) / 128.0f + (name.ends_with("exponent") ? 1.0f : 0.0f);
            return;
          }
        if (name.starts_with("inertia") || name == "friction") return;
        if constexpr (std::is_same_v<T, float>) field = float(fields) / 64.0f;
        if constexpr (std::is_same_v<T, bool>) field = !field;
        if constexpr (std::is_same_v<T, uint32_t>) field = 7;
        if constexpr (std::is_enum_v<T>) field = T(1);
      },
      p);
  // Colours are three.
  EXPECT_EQ(fields, kMemberCount<LayerParams> + 2 + kMemberCount<LayerLook> + 3);
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
  EXPECT_EQ(groom_file::CountItemBytes(TraitBlock{}), sizeof(TraitBlock));
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
  EXPECT_EQ(LoadU32(bytes, 28), 19u);
  EXPECT_EQ(LoadU32(bytes, 32), bytes.size());
  EXPECT_EQ(std::memcmp(bytes.data() + 48, "general\0\0\0\0\0\0\0\0\0", 16), 0);
  const size_t general = 48 + 19 * 40;
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

// Files of before layers had a share of their chains, and a look: of all of them, and the default one.
TEST(GroomFile, OlderFilesAreRead) {
  const std::string path = SourceFolder() + "/tests/fuzz/corpus/groom/version_8.groom";
  const auto older = ReadFileBytes("groom", path).OrThrow();
  ASSERT_EQ(LoadU32(older, 8), kOldestGroomVersion);
  Groom groom = ReadGroom(older, path).OrThrow();
  const auto now = WriteGroom(groom).OrThrow();
  constexpr size_t kSectionsSince = 2 * 40;  // empty
  constexpr size_t kNoTexture = 3 * sizeof(uint32_t) + 1 + 4;  // three numbers, channels, no bytes
  EXPECT_EQ(now.size(),
            older.size() + kSectionsSince +
                (5 * sizeof(float) + 1 + sizeof(LayerLook) + kNoTexture) * groom.layers.size());
  for (const GroomLayer& layer : groom.layers) EXPECT_EQ(layer.params.chain_share, 1.0f);
  EXPECT_EQ(WriteGroom(ReadGroom(now, "now").OrThrow()).OrThrow(), now);
  groom.layers[0].params.chain_share = 0.25f;
  groom.layers[0].params.look.tint[2] = 0.5f;
  groom.layers[0].params.look.scatter_depth = 2.0f;
  const Groom back = ReadGroom(WriteGroom(groom).OrThrow(), "g.groom").OrThrow();
  EXPECT_EQ(back.layers[0].params.chain_share, 0.25f);
  EXPECT_EQ(back.layers[0].params.look.tint[2], 0.5f);
  EXPECT_EQ(back.layers[0].params.look.scatter_depth, 2.0f);
}

TEST(GroomFile, WrongFilesAreTold) {
  const auto good = WriteGroom(MakeGroom()).OrThrow();
  EXPECT_EQ(ErrorOf({}),
            "groom 'g.groom': section 'header', byte 0: 8 more bytes are needed, 0 are left");
  auto bad = good;
  bad[0] = std::byte{'X'};
  EXPECT_EQ(ErrorOf(bad), "groom 'g.groom': section 'header', byte 0: not a groom file");
  bad = good;
  bad[8] = std::byte{11};
  EXPECT_EQ(
      ErrorOf(bad),
      "groom 'g.groom': section 'header', byte 8: version 11, this program reads 10; bake the "
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
      [](Groom& g) -> float& { return g.strand_traits[2].weight[7]; },
  };
  for (const auto& field : fields) {
    Groom bad = good;
    const float kept = field(bad);
    field(bad) = NAN;
    const std::string message = FindGroomFault(bad, "g.groom");
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
  const size_t table_end = 48 + 19 * 40;
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
  const TestFolder folder;
  const std::string path = folder.Save("a.groom", "old");
  const Groom groom = MakeGroom();
  WriteGroomFile(groom, path).OrThrow();
  EXPECT_EQ(WriteGroom(ReadGroomFile(path).OrThrow()).OrThrow(), WriteGroom(groom).OrThrow());
  size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    files += entry.exists();
  EXPECT_EQ(files, 1u) << "the partial file is gone";
  EXPECT_THROW(ReadGroomFile(folder / "none.groom").OrThrow(), Error);
  EXPECT_THROW(ReadGroomFile(folder.path().string()).OrThrow(), Error);
  EXPECT_THROW(WriteGroomFile(groom, folder / "no/b.groom").OrThrow(), Error);
}

}  // namespace
}  // namespace pelt::test
