#include <algorithm>
#include <vector>

#include "bench/picture/gl_objects.hpp"
#include "bench/picture/gl_parts.hpp"
#include "bench/picture/strip_texture.hpp"

namespace pelt {
namespace {

// Of strips that lie side by side, one behind the other; `width`: bytes.
std::vector<uint8_t> StripByStrip(const std::vector<uint8_t>& texels, uint32_t strips,
                                  uint32_t width, uint32_t height) {
  std::vector<uint8_t> apart;
  apart.reserve(texels.size());
  for (uint32_t strip = 0; strip < strips; ++strip)
    for (uint32_t y = 0; y < height; ++y) {
      const auto row = texels.begin() + ptrdiff_t((size_t(y) * strips + strip) * width);
      apart.insert(apart.end(), row, row + ptrdiff_t(width));
    }
  return apart;
}

GlTexture Upload(const GlApi& gl, const StripTexture& made) {
  gl.ActiveTexture(GL_TEXTURE0 + kMakingUnit);
  GlTexture texture(gl);
  gl.BindTexture(GL_TEXTURE_2D_ARRAY, texture);
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  const bool four = made.channels() == 4;
  for (uint32_t level = 0; level < made.levels(); ++level) {
    const uint32_t width = made.width(level), height = made.height(level);
    gl.TexImage3D(
        GL_TEXTURE_2D_ARRAY, GLint(level), four ? GL_RGBA8 : GL_R8, GLsizei(width), GLsizei(height),
        GLsizei(made.strips()), 0, four ? GL_RGBA : GL_RED, GL_UNSIGNED_BYTE,
        StripByStrip(made.texels(level), made.strips(), width * made.channels(), height).data());
  }
  const auto set = [&](GLenum what, GLint to) { gl.TexParameteri(GL_TEXTURE_2D_ARRAY, what, to); };
  set(GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  set(GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  set(GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  set(GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  set(GL_TEXTURE_MAX_LEVEL, GLint(made.levels()) - 1);  // two texels high: there is one level less
  return texture;
}

}  // namespace

void GlStrips::Make(uint32_t strips) {
  if (strips <= strips_) return;
  texture_ = Upload(*gl_, StripTexture(strips));
  strips_ = strips;
}

namespace {

// Two texels of strand.glsl's `roots`.
struct RootTexels {
  glm::vec3 root;
  float depth;  // Hair::DepthOfLight
  glm::vec3 normal;
  uint32_t strand;  // of the layer, with kCard; in shadow maps the place among the vertices
};
constexpr uint32_t kCard = 1u << 31;
static_assert(sizeof(RootTexels) == 32);

RootTexels RootOf(const Hair& hair, uint32_t strand) {
  return {hair.root, hair.DepthOfLight(), hair.normal, strand | (hair.is_card ? kCard : 0u)};
}

std::vector<RootTexels> RootsOf(const LayerDraw& draw, const std::vector<Hair>& hairs) {
  std::vector<RootTexels> roots;
  roots.reserve(hairs.size());
  for (size_t place = 0; place < hairs.size(); ++place)
    roots.push_back(RootOf(hairs[place], draw.order[place]));
  return roots;
}

std::vector<RootTexels> ShadowRootsOf(const LayerDraw& draw, const std::vector<Hair>& hairs,
                                      bool in_strand_order) {
  std::vector<RootTexels> roots;
  for (uint32_t place = 0; place < hairs.size(); ++place)
    if (hairs[place].shadow > 0.0f)
      roots.push_back(RootOf(hairs[place], in_strand_order ? draw.order[place] : place));
  return roots;
}

std::shared_ptr<const GlTexture> UploadOrNull(const GlApi& gl, const StripTexture* made) {
  return made ? std::make_shared<const GlTexture>(Upload(gl, *made)) : nullptr;
}

// Its place among the outputs of strands; of a layer with cards, behind all of them.
size_t ProgramOf(Output output, const std::vector<Hair>& hairs) {
  const auto of_strands = [](const OutputEntry& entry) { return entry.OfStrands(); };
  const auto place = std::count_if(kOutputs, kOutputs + size_t(output), of_strands);
  const bool cards = std::ranges::any_of(hairs, &Hair::is_card);
  return size_t(place + (cards ? std::ranges::count_if(kOutputs, of_strands) : 0));
}

}  // namespace

GlStrands::GlStrands(const GlApi& gl, const PictureScene& scene, GLuint strips)
    : gl_(gl), in_strand_order_(scene.order == VertexOrder::kIndexBuffer), strips_(strips) {
  gl_.ActiveTexture(GL_TEXTURE0 + kMakingUnit);
  for (size_t i = 0; i < scene.draws.size(); ++i)
    layers_.push_back(Upload(scene.draws[i], scene.layers[i], scene.strips[i].get()));
}

GlStrands::Layer GlStrands::Upload(const LayerDraw& draw, const std::vector<Hair>& hairs,
                                   const StripTexture* strips) const {
  if (hairs.empty())
    return {.vertices = GlTexture(gl_),
            .roots = GlTexture(gl_),
            .looks = GlTexture(gl_),
            .shadow_roots = GlTexture(gl_)};
  const std::vector<RootTexels> roots = RootsOf(draw, hairs);
  const std::vector<RootTexels> casting = ShadowRootsOf(draw, hairs, in_strand_order_);
  return {.vertices = UploadTexels(gl_, draw.vertices),
          .roots = UploadTexels(gl_, std::as_bytes(std::span(roots))),
          .looks = UploadTexels(gl_, std::as_bytes(draw.looks)),
          .shadow_roots = UploadTexels(gl_, std::as_bytes(std::span(casting))),
          .output = ProgramOf(draw.output, hairs),
          .strands = GLsizei(draw.strand_count),
          .casting = GLsizei(casting.size()),
          .knots = GLsizei(hairs.front().knots),
          .actor = hairs.front().actor,
          .first_strand = hairs.front().number - draw.order.front(),
          .tip_width = draw.tip_width,
          .shadow_width = casting.empty() ? 1.0f : float(hairs.size()) / float(casting.size()),
          .is_lit = !draw.looks.empty(),
          .paint = PaintLookOf(draw),
          .strips = UploadOrNull(gl_, strips),
          .strip_meaning = strips ? strips->meaning() : 0,
          .strand_tint = TintOfStrands(draw),
          .shadow_alpha = draw.look->shadow_alpha};
}

void GlStrands::Bind(const std::vector<GlProgram>& programs, const Layer& layer) const {
  const GlProgram& program = programs[layer.output];
  program.Use();
  BindTexture(gl_, kVerticesUnit, GL_TEXTURE_2D, layer.vertices);
  BindTexture(gl_, kRootsUnit, GL_TEXTURE_2D, layer.roots);
  BindTexture(gl_, kLooksUnit, GL_TEXTURE_2D, layer.looks);
  program.Set("knots", layer.knots);
  program.Set("is_lit", int(layer.is_lit));
  program.Set("in_strand_order", int(in_strand_order_));
  program.Set("first_strand", layer.first_strand);
  program.Set("tip_width", layer.tip_width);
  program.Set("character", layer.actor);
  BindTexture(gl_, kStripsUnit, GL_TEXTURE_2D_ARRAY,
              layer.strips ? GLuint(*layer.strips) : strips_);
  program.Set("strip_meaning", layer.strip_meaning);
  program.Set("strand_tint", layer.strand_tint);
  program.Set("shadow_alpha", layer.shadow_alpha);
  SetPaint(program, layer.paint);
}

void GlStrands::DrawStrips(const std::vector<GlProgram>& programs, size_t layer) const {
  if (!layers_[layer].strands) return;
  Bind(programs, layers_[layer]);
  gl_.DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 2 * layers_[layer].knots, layers_[layer].strands);
}

void GlStrands::DrawShadows(const std::vector<GlProgram>& programs, size_t layer) const {
  const Layer& cast = layers_[layer];
  if (!cast.casting) return;
  Bind(programs, cast);
  const GlProgram& program = programs[cast.output];
  BindTexture(gl_, kRootsUnit, GL_TEXTURE_2D, cast.shadow_roots);
  program.Set("in_strand_order", 1);
  program.Set("is_lit", 0);
  program.Set("shadow_width", cast.shadow_width);
  gl_.DrawArraysInstanced(GL_LINE_STRIP, 0, cast.knots, cast.casting);
}

}  // namespace pelt
