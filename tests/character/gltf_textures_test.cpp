// Which image a texture leads to, and what is said of those that cannot be read.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/character/gltf_import.hpp"
#include "core/character/picture_kind.hpp"
#include "tests/character/gltf_builder.hpp"
#include "tests/groom/png.hpp"

namespace pelt::test {
namespace {

using namespace std::string_view_literals;

std::vector<uint8_t> BytesOf(std::string_view text) { return {text.begin(), text.end()}; }

constexpr std::string_view kWebP = "RIFF\x10\0\0\0WEBPVP8 "sv, kKtx2 = "\xabKTX 20\xbb\r\n\x1a\n"sv,
                           kAvif =
                               "\0\0\0\x1c"
                               "ftypavif\0\0\0\0"sv;

// A quad whose texture is `texture`; image i lies in `pictures`[i].
Character ImportTexture(const std::string& texture,
                        const std::vector<std::vector<uint8_t>>& pictures,
                        const std::string& more = "") {
  GltfBuilder b = MakeQuad();
  b.Attribute("TEXCOORD_0", b.Floats("VEC2", {0, 0, 1, 0, 1, 1, 0, 1}));
  b.primitive_more += ",\"material\":0";
  b.materials = R"({"name":"coat","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})";
  std::string images;
  for (const std::vector<uint8_t>& picture : pictures)
    images += std::string(images.empty() ? "" : ",") + R"({"bufferView":)" +
              std::to_string(b.View(picture)) + "}";
  b.more = R"(,"textures":[)" + texture + R"(],"images":[)" + images + "]" + more;
  return ImportGltf(b.Glb(), "quad.glb");
}

const std::vector<uint8_t> kPng = MakePng(1, 1, 3, {10, 20, 30});

TEST(GltfTextures, AnImageThatIsReadIsFoundAmongSeveral) {
  const struct {
    std::string texture;
    std::vector<std::vector<uint8_t>> pictures;
  } kCases[] = {
      {R"({"source":0,"extensions":{"EXT_texture_webp":{"source":1}}})", {kPng, BytesOf(kWebP)}},
      {R"({"source":0,"extensions":{"KHR_texture_basisu":{"source":1}}})", {kPng, BytesOf(kKtx2)}},
      // A PNG by an extension's name, or the other way round.
      {R"({"source":1,"extensions":{"ACME_texture":{"source":0}}})", {kPng, BytesOf(kWebP)}},
      {R"({"extensions":{"ACME_texture":{"source":0}}})", {kPng}},
      {R"({"extensions":{"A":7,"EXT_texture_webp":{"source":1},"Z":{"source":0}}})",
       {kPng, BytesOf(kWebP)}},
  };
  for (const auto& test : kCases) {
    const Character c = ImportTexture(test.texture, test.pictures);
    ASSERT_EQ(c.images.size(), 1u) << test.texture;
    EXPECT_EQ(c.images[0].size(), kPng.size()) << test.texture;
    EXPECT_EQ(c.mesh.looks.at(0).image, 0) << test.texture;
  }
}

TEST(GltfTextures, WhatIsNotReadIsNamed) {
  const struct {
    std::string texture;
    std::string_view bytes, reason;
  } kCases[] = {
      {R"({"source":0})", kWebP, "a WebP picture, not of a type that is read (PNG, JPEG)"},
      {R"({"source":0})", kKtx2, "a KTX2 picture"},
      {R"({"source":0})", kAvif, "an AVIF picture"},
      {R"({"source":0})", "DDS |", "a DDS picture"},
      {R"({"source":0})", "version https://git-lfs.github.com/spec/v1\n", "Git LFS"},
      {R"({"source":0})", "<!DOCTYPE html>", "an HTML page"},
      {R"({"source":0})", "what is this", "left out: not of a type that is read"},
      {R"({"source":0})", "", "it is empty"},
      {R"({"extensions":{"EXT_texture_webp":{"source":0}}})", kWebP,
       "EXT_texture_webp: a WebP picture"},
      {R"({"extensions":{"KHR_texture_basisu":{"source":0}}})", kKtx2,
       "KHR_texture_basisu: a KTX2 picture"},
      {R"({"extensions":{"EXT_texture_webp":{"source":7}}})", kWebP, "there is no such image"},
      {R"({"extensions":{}})", kWebP, "there is no such image"},
  };
  for (const auto& test : kCases) {
    const Character c = ImportTexture(test.texture, {BytesOf(test.bytes)});
    EXPECT_TRUE(c.images.empty()) << test.texture;
    EXPECT_TRUE(std::ranges::any_of(c.notes, [&](const std::string& note) {
      return note.find(test.reason) != note.npos && note.find("material 0 'coat'") != note.npos &&
             note.size() < 300;
    })) << test.reason;
  }
}

TEST(GltfTextures, ImagesTakeNoMoreThanTheFile) {
  std::string textures, images, materials;
  GltfBuilder b = MakeQuad();
  std::vector<uint8_t> picture = kPng;
  picture.resize(100000);
  const int view = b.View(picture);
  std::string primitives;
  for (int i = 0; i < 100; ++i) {
    const std::string comma = i ? "," : "", n = std::to_string(i);
    textures += comma + R"({"source":)" + n + "}";
    images += comma + R"({"bufferView":)" + std::to_string(view) + "}";
    materials += comma + R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":)" + n + "}}}";
  }
  b.materials = materials;
  b.more = R"(,"textures":[)" + textures + R"(],"images":[)" + images + "]";
  const Character c = ImportGltf(b.Glb(), "quad.glb");
  size_t bytes = 0;
  for (const auto& image : c.images) bytes += image.size();
  EXPECT_GE(c.images.size(), 1u);
  EXPECT_LT(bytes, 300000u);
}

TEST(GltfTextures, SamplersSayHowImagesGoOn) {
  const std::string samplers =
      R"(,"samplers":[{"wrapS":33071,"wrapT":33648},{"wrapT":10497},{"wrapS":"x"},7])";
  const auto wrap = [&](const std::string& sampler) {
    return ImportTexture(R"({"source":0)" + sampler + "}", {kPng}, samplers).mesh.looks.at(0).wrap;
  };
  using Wraps = std::array<Wrap, 2>;
  EXPECT_EQ(wrap(R"(,"sampler":0)"), (Wraps{Wrap::kClamp, Wrap::kMirror}));
  for (const char* sampler : {"", R"(,"sampler":1)", R"(,"sampler":2)", R"(,"sampler":3)",
                              R"(,"sampler":9)", R"(,"sampler":-1)"})
    EXPECT_EQ(wrap(sampler), Wraps{}) << sampler;
}

}  // namespace
}  // namespace pelt::test
