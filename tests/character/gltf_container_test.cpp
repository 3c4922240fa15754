// What a glTF stands in: its frame as GLB, its buffers as files or in its text, and files that only
// look like one.
#include <gtest/gtest.h>

#include <filesystem>

#include "core/character/gltf_import.hpp"
#include "tests/character/gltf_builder.hpp"
#include "tests/error_from.hpp"
#include "tests/test_folder.hpp"

namespace pelt::test {
namespace {

Character ImportText(const std::string& text) {
  return ImportGltf(std::as_bytes(std::span(text)), "quad");
}
std::string ErrorOf(const std::string& text) {
  return ErrorFrom([&] { ImportText(text); });
}

TEST(GltfContainer, DataUrisOfEveryKind) {
  const GltfBuilder b = MakeQuad();
  std::string percent;
  for (const uint8_t byte : b.binary) {
    constexpr const char* kHex = "0123456789abcdef";
    percent += std::string("%") + kHex[byte >> 4] + kHex[byte & 15];
  }
  const std::string base64 = Base64(b.binary);
  std::string broken = base64;
  for (size_t i = 64; i < broken.size(); i += 66) broken.insert(i, "\\r\\n");
  for (const std::string& uri :
       {"data:;base64," + base64, "data:application/octet-stream;base64," + base64,
        "data:model/x-anything;charset=utf-8;base64," + base64, "DATA:;BASE64," + base64,
        "data:application/gltf-buffer;base64," + Base64(b.binary, "-_"),
        "data:;base64," + base64.substr(0, base64.find('=')), "data:;base64," + broken,
        "data:application/octet-stream," + percent}) {
    EXPECT_EQ(ImportText(b.Json(true, uri)).mesh.triangles.size(), 2u) << uri.substr(0, 60);
  }
  for (const std::string& uri :
       {std::string("data:;base64,") + std::string(100000, '!'), std::string("data:oops"),
        std::string("data:;base64,AAAA"), std::string(100000, 'x')}) {
    const std::string error = ErrorOf(b.Json(true, uri));
    EXPECT_NE(error, "") << uri.substr(0, 60);
    EXPECT_LE(error.size(), 300u) << error;
  }
}

TEST(GltfContainer, BufferNamesMayBeEncoded) {
  const TestFolder folder;
  const GltfBuilder b = MakeQuad();
  for (const auto& [uri, file] :
       std::vector<std::pair<std::string, std::string>>{{"a%20b/my%20quad.bin", "a b/my quad.bin"},
                                                        {"a b/my quad.bin", "a b/my quad.bin"},
                                                        {"./100%25.bin", "100%.bin"},
                                                        {"100%.bin", "100%.bin"},
                                                        {"caf%C3%A9.bin", "caf\xc3\xa9.bin"}}) {
    const std::string gltf = folder.Save("quad.gltf", b.Json(true, uri));
    const std::string beside = folder.Save(file, b.binary);
    EXPECT_EQ(ImportGltfFile(gltf).mesh.triangles.size(), 2u) << uri;
    std::filesystem::remove(beside);
  }
  for (const auto& [uri, why] : std::vector<std::pair<std::string, std::string>>{
           {"..%2fquad.bin", "not below the file's folder"},
           {"../quad.bin", "not below the file's folder"},
           {"%2fetc%2fpasswd", "not below the file's folder"},
           {"pointer.bin", "a Git LFS pointer"}}) {
    folder.Save("pointer.bin", "version https://git-lfs.github.com/spec/v1\noid x\n");
    const std::string gltf = folder.Save("quad.gltf", b.Json(true, uri));
    const std::string error = ErrorFrom([&] { ImportGltfFile(gltf); });
    EXPECT_NE(error.find(why), std::string::npos) << uri << ": " << error;
  }
}

// What is no glTF is named for what it is.
TEST(GltfContainer, Lookalikes) {
  using namespace std::string_literals;
  const std::pair<std::string, const char*> files[] = {
      {"", "empty"},
      {"version https://git-lfs.github.com/spec/v1\noid sha256:00\n", "Git LFS"},
      {"\n<!DOCTYPE html><html>", "HTML"},
      {"<HTML><head>", "HTML"},
      {"<?xml version=\"1.0\"?><html>", "HTML"},
      {"<?xml version=\"1.0\"?>\n<COLLADA>", "COLLADA"},
      {"Kaydara FBX Binary  \0\x1a\0"s, "FBX"},
      {"; FBX 7.3.0 project file\n", "FBX"},
      {"# Blender v2.79\nmtllib a.mtl\no Cube\nv 1 1 1\n", "OBJ"},
      {"# exported\r\n\r\nv 0 0 0\r\n", "OBJ"},
      {"PK\3\4\24", "zip"},
      {"\x1f\x8b\x08", "gzip"},
      {"\x89PNG\r\n\x1a\n", "PNG"},
      {"\xff\xd8\xff\xe0", "JPEG"},
      {"BLENDER-v300", "Blender"},
      {"solid cube\n", "STL"},
      {"ply\nformat ascii", "PLY"},
      {"PXR-USDC", "USD"},
      {"\xff\xfe{\0"s, "UTF-16"},
      {std::string(100, '\0'), "zeros"},
      {"{\"a\":1}", "asset"},
      {"glTF\1\0\0\0"s + std::string(20, '\0'), "version 1"}};
  for (const auto& [text, name] : files) {
    const std::string error = ErrorOf(text);
    EXPECT_NE(error.find(name), std::string::npos) << name << ": " << error;
  }
  // A byte order mark, and text that is not UTF-8, are no reason to refuse one.
  const GltfBuilder b = MakeQuad();
  const std::string json = b.Json(true, "data:;base64," + Base64(b.binary));
  EXPECT_EQ(ImportText("\xef\xbb\xbf" + json).mesh.triangles.size(), 2u);
  std::string latin = json;
  latin.replace(latin.find("base"), 4, "b\xe9se");
  EXPECT_EQ(ImportText(latin).skeleton.name[0], "b?se");
}

// The frame of a GLB says more than there is, or less; other chunks stand beside ours.
TEST(GltfContainer, GlbFrames) {
  const auto put = [](std::vector<std::byte>& file, size_t at, uint32_t value) {
    for (size_t i = 0; i < 4; ++i) file[at + i] = std::byte(value >> (8 * i) & 255);
  };
  const std::vector<std::byte> good = MakeQuad().Glb();
  for (const uint32_t length : {0u, uint32_t(good.size()) + 100, 0xffffffffu}) {
    std::vector<std::byte> file = good;
    put(file, 8, length);
    EXPECT_EQ(ImportGltf(file, "quad").mesh.triangles.size(), 2u) << length;
  }
  std::vector<std::byte> trailing = good;
  trailing.resize(good.size() + 37, std::byte(7));
  EXPECT_EQ(ImportGltf(trailing, "quad").mesh.triangles.size(), 2u);
  // Buffers that say another length than they have.
  for (const char* said : {"byteLength\":9", "byteLength\":1"}) {
    GltfBuilder b = MakeQuad();
    std::string text = b.Json();
    text.replace(text.rfind("byteLength\":"), 12, said);
    EXPECT_EQ(ImportGltf(b.Frame(text), "quad").mesh.triangles.size(), 2u) << said;
  }
}

}  // namespace
}  // namespace pelt::test
