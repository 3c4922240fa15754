// The document against tinygltf's reading of the same bytes: a whole file means the same to both.
#include <gtest/gtest.h>

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include "core/character/builtin_character.hpp"
#include "core/character/gltf_document.hpp"
#include "core/file_bytes.hpp"
#include "tests/character/gltf_builder.hpp"
#include "tests/character/shared_files.hpp"

namespace pelt::gltf {
namespace {

bool SkipImage(tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*,
               int, void*) {
  return true;
}

tinygltf::Model ReadByPeer(std::span<const std::byte> glb) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(SkipImage, nullptr);
  tinygltf::Model model;
  std::string errors, warnings;
  EXPECT_TRUE(loader.LoadBinaryFromMemory(&model, &errors, &warnings,
                                          reinterpret_cast<const unsigned char*>(glb.data()),
                                          unsigned(glb.size())))
      << errors;
  return model;
}

void ExpectSameBytes(const Document& ours, const tinygltf::Model& theirs) {
  ASSERT_EQ(ours.buffers.size(), theirs.buffers.size());
  for (size_t b = 0; b < ours.buffers.size(); ++b)
    EXPECT_TRUE(std::equal(theirs.buffers[b].data.begin(), theirs.buffers[b].data.end(),
                           ours.buffers[b].begin()));
  ASSERT_EQ(ours.views.size(), theirs.bufferViews.size());
  for (size_t v = 0; v < ours.views.size(); ++v) {
    const auto& [buffer, offset, length, stride, compressed] = ours.views[v];
    const tinygltf::BufferView& view = theirs.bufferViews[v];
    EXPECT_EQ(buffer, view.buffer);
    EXPECT_EQ(std::tie(offset, length, stride),
              std::tuple(view.byteOffset, view.byteLength, view.byteStride));
  }
  ASSERT_EQ(ours.accessors.size(), theirs.accessors.size());
  for (size_t a = 0; a < ours.accessors.size(); ++a) {
    const Accessor& mine = ours.accessors[a];
    const tinygltf::Accessor& its = theirs.accessors[a];
    EXPECT_EQ(mine.view, its.bufferView);
    EXPECT_EQ(mine.offset, its.byteOffset);
    EXPECT_EQ(mine.count, its.count);
    EXPECT_EQ(mine.component, its.componentType);
    EXPECT_EQ(mine.components, tinygltf::GetNumComponentsInType(uint32_t(its.type)));
    EXPECT_EQ(mine.normalised, its.normalized);
    EXPECT_EQ(mine.sparse.used, its.sparse.isSparse);
  }
}

void ExpectSameNodes(const Document& ours, const tinygltf::Model& theirs) {
  ASSERT_EQ(ours.nodes.size(), theirs.nodes.size());
  for (size_t n = 0; n < ours.nodes.size(); ++n) {
    const Node& mine = ours.nodes[n];
    const tinygltf::Node& its = theirs.nodes[n];
    EXPECT_EQ(std::tie(mine.name, mine.children, mine.mesh, mine.skin),
              std::tie(its.name, its.children, its.mesh, its.skin));
    EXPECT_EQ(std::tie(mine.matrix, mine.translation, mine.rotation, mine.scale),
              std::tie(its.matrix, its.translation, its.rotation, its.scale));
  }
  ASSERT_EQ(ours.skins.size(), theirs.skins.size());
  for (size_t s = 0; s < ours.skins.size(); ++s)
    EXPECT_EQ(std::tie(ours.skins[s].joints, ours.skins[s].inverse_bind),
              std::tie(theirs.skins[s].joints, theirs.skins[s].inverseBindMatrices));
  ASSERT_EQ(ours.scenes.size(), theirs.scenes.size());
  for (size_t s = 0; s < ours.scenes.size(); ++s)
    EXPECT_EQ(ours.scenes[s].roots, theirs.scenes[s].nodes);
  EXPECT_EQ(ours.scene, theirs.defaultScene);
}

void ExpectSameMeshesAndClips(const Document& ours, const tinygltf::Model& theirs) {
  ASSERT_EQ(ours.meshes.size(), theirs.meshes.size());
  for (size_t m = 0; m < ours.meshes.size(); ++m) {
    ASSERT_EQ(ours.meshes[m].primitives.size(), theirs.meshes[m].primitives.size());
    for (size_t p = 0; p < ours.meshes[m].primitives.size(); ++p) {
      const Primitive& mine = ours.meshes[m].primitives[p];
      const tinygltf::Primitive& its = theirs.meshes[m].primitives[p];
      EXPECT_EQ(std::tie(mine.attributes, mine.indices, mine.material, mine.mode),
                std::tie(its.attributes, its.indices, its.material, its.mode));
    }
  }
  ASSERT_EQ(ours.animations.size(), theirs.animations.size());
  for (size_t a = 0; a < ours.animations.size(); ++a) {
    const Animation& mine = ours.animations[a];
    const tinygltf::Animation& its = theirs.animations[a];
    ASSERT_EQ(mine.channels.size(), its.channels.size());
    for (size_t c = 0; c < mine.channels.size(); ++c) {
      const Sampler& sampler = mine.samplers[size_t(mine.channels[c].sampler)];
      const tinygltf::AnimationSampler& other = its.samplers[size_t(its.channels[c].sampler)];
      EXPECT_EQ(std::tie(mine.channels[c].node, mine.channels[c].path),
                std::tie(its.channels[c].target_node, its.channels[c].target_path));
      EXPECT_EQ(std::tie(sampler.input, sampler.output), std::tie(other.input, other.output));
      EXPECT_EQ(sampler.interpolation.empty() ? "LINEAR" : sampler.interpolation,
                other.interpolation);
    }
  }
}

void ExpectSame(std::span<const std::byte> glb) {
  const Document ours = ParseDocument(glb, "ours.glb", "");
  const tinygltf::Model theirs = ReadByPeer(glb);
  ExpectSameBytes(ours, theirs);
  ExpectSameNodes(ours, theirs);
  ExpectSameMeshesAndClips(ours, theirs);
}

TEST(GltfPeer, ReadsTheBuiltInCharactersAlike) {
  for (const BuiltinBody body : {BuiltinBody::kMonster, BuiltinBody::kScorpion})
    ExpectSame(MakeBuiltinCharacterGlb({.body = body}));
}

TEST(GltfPeer, ReadsSmallFilesAlike) { ExpectSame(test::MakeQuad().Glb()); }

TEST(GltfPeer, ReadsCharactersOfOthersAlike) {
  int read = 0;
  for (const char* file : {"Fox.glb", "Wolf.glb", "RiggedFigure.glb"}) {
    const std::string path = test::FindShared(file);
    if (path.empty()) continue;
    SCOPED_TRACE(file);
    ExpectSame(*ReadWhole(path, 1u << 30));
    ++read;
  }
  if (!read) GTEST_SKIP() << "no shared characters (set PELT_SHARED)";
}

}  // namespace
}  // namespace pelt::gltf
