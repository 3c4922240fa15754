#include "bench/picture/hairs.hpp"

#include <algorithm>

#include "bench/shading/default_look.hpp"
#include "core/ribbon_indices.hpp"

namespace pelt {
namespace {

void ReadCurve(const LayerDraw& draw, uint32_t strand, Hair& hair) {
  const CurveRecord& record = draw.As<CurveRecord>()[strand];
  hair.knots = draw.pieces + 1;
  hair.base_colour = record.base_colour;
  hair.tip_colour = record.tip_colour;
  hair.film_strip = StripOfTag(record.tag);
  const Curve curve{VecOf(record.curve[0]), VecOf(record.curve[1]), VecOf(record.curve[2]),
                    VecOf(record.curve[3])};
  for (uint32_t k = 0; k < hair.knots; ++k) {
    const float t = float(k) / float(draw.pieces);
    hair.knot[k] = {CurvePoint(curve, t), CurveWidth(record.width, draw.tip_width, t)};
  }
}

void ReadRibbon(const LayerDraw& draw, uint32_t strand, Hair& hair) {
  const auto vertex = draw.As<RibbonVertex>().subspan(size_t(strand) * kRibbonVerticesPerHair,
                                                      kRibbonVerticesPerHair);
  hair.knots = kRibbonPoints;
  hair.base_colour = vertex.front().colour;
  hair.tip_colour = vertex.back().colour;
  hair.film_strip = StripOfRibbon(vertex.front().texture);
  for (uint32_t k = 0; k < kRibbonPoints; ++k) {
    const glm::vec3 left = VecOf(vertex[2 * k].position), right = VecOf(vertex[2 * k + 1].position);
    hair.knot[k] = {(left + right) * 0.5f, glm::length(right - left)};
  }
}

void ReadLine(const LayerDraw& draw, uint32_t strand, Hair& hair) {
  const auto vertex = draw.As<LineVertex>().subspan(size_t(strand) * kRibbonPoints, kRibbonPoints);
  hair.knots = kRibbonPoints;
  hair.base_colour = vertex.front().colour;
  hair.tip_colour = vertex.back().colour;
  hair.film_strip = StripOfTag(vertex.front().tag);
  for (uint32_t k = 0; k < kRibbonPoints; ++k)
    hair.knot[k] = {VecOf(vertex[k].position), vertex[k].width};
}

// For each output, how the vertices of one strand of a draw are read.
// Shells have none.
constexpr void (*kReaders[])(const LayerDraw&, uint32_t strand, Hair&) = {ReadCurve, ReadRibbon,
                                                                          ReadLine, nullptr};
static_assert(std::size(kReaders) == kOutputCount);

// How much wider shadow passes draw what they draw (FurScene::ShadowPlaces).
float ShadowWidth(const FurScene& scene, const LayerDraw& draw) {
  const uint32_t casting = scene.ShadowPlaces(draw.layer, {});
  return casting ? float(draw.strand_count) / float(casting) : 1.0f;
}

Hair ReadHair(const FurScene& scene, VertexOrder order, const LayerDraw& draw, uint32_t place,
              float shadow) {
  const SceneShape& shape = scene.shape();
  const uint32_t strand = draw.order[place], lane = strand % kStrandsPerChunk;
  const uint32_t chunk = shape.layer_first_chunk[draw.layer] + strand / kStrandsPerChunk;
  const auto& roots = *scene.memory().Of<&Streams::roots>(chunk);
  Hair hair{};
  hair.actor = shape.layer_character[draw.layer];
  hair.is_card =
      draw.strand_texture || scene.memory().Of<&Streams::strands>(chunk)->width[lane] >= kCardWidth;
  hair.has_texture = draw.strand_texture != nullptr;
  hair.number = chunk * kStrandsPerChunk + lane;
  for (int c = 0; c < 3; ++c) {
    hair.root[c] = roots.position[c][lane];
    hair.normal[c] = roots.normal[c][lane];
  }
  if (!draw.looks.empty()) hair.paint = PaintOf(draw.looks[strand]);
  hair.paint_look = PaintLookOf(draw);
  const bool casts = IsAmongFirst(*scene.memory().Of<&Streams::chunk_state>(chunk), strand,
                                  scene.ShadowShare(draw.layer));
  hair.shadow = casts ? shadow : 0.0f;
  kReaders[size_t(draw.output)](draw, order == VertexOrder::kSorted ? place : strand, hair);
  return hair;
}

}  // namespace

float Hair::DepthOfLight() const {
  float length = 0.0f;
  for (uint32_t k = 1; k < knots; ++k) length += glm::length(knot[k].at - knot[k - 1].at);
  const float height = glm::dot(knot[knots - 1].at - root, normal);
  return std::max({height, 0.35f * length, 1e-4f});
}

glm::vec4 PaintOf(const LookRecord& record) { return Unorm8x4(record.amounts); }

PaintLook PaintLookOf(const LayerDraw& draw) {
  PaintLook look = kDefaultPaint;
  look.wet_darken = draw.wet_darken;
  for (int c = 0; c < 3; ++c) look.mud[c] = draw.mud_colour[c];
  return look;
}

std::vector<std::vector<Hair>> ReadHairs(const FurScene& scene, VertexOrder order) {
  std::vector<std::vector<Hair>> layers;
  for (const LayerDraw& draw : scene.Draws()) {
    std::vector<Hair>& hairs = layers.emplace_back();
    hairs.reserve(draw.strand_count);
    const float shadow = ShadowWidth(scene, draw);
    for (uint32_t place = 0; place < draw.strand_count; ++place)
      hairs.push_back(ReadHair(scene, order, draw, place, shadow));
  }
  return layers;
}

uint32_t CountStrips(const std::vector<std::vector<Hair>>& layers) {
  uint32_t strips = 0;
  for (const std::vector<Hair>& hairs : layers)
    for (const Hair& hair : hairs)
      if (hair.is_card && !hair.has_texture) strips = std::max(strips, hair.film_strip + 1);
  return strips;
}

HairEnd ShadeKnot(const Hair& hair, uint32_t k, const LightSet& light, const HairLook& look,
                  float depth_light, float sun_share, const Projection& projection) {
  const float t = float(k) / float(hair.knots - 1);
  const glm::vec3 at = hair.knot[k].at;
  const glm::vec3 along =
      hair.knot[std::min(k + 1, hair.knots - 1)].at - hair.knot[k ? k - 1 : 0].at;
  HairPoint point{
      .colour = glm::mix(LinearColour(hair.base_colour), LinearColour(hair.tip_colour), t),
      .tangent = along / std::max(glm::length(along), 1e-9f),
      .normal = hair.normal,
      .to_eye = glm::normalize(projection.eye() - at),
      .depth_light = depth_light,
      .sun_share = sun_share,
      .noise = StrandNoise(hair.number, t, kNoiseKnots)};
  point.colour *= look.tint;
  HairLook painted = look;
  if (hair.paint != glm::vec4(0.0f)) {
    const glm::vec4 seen = SeenPaint(hair.paint, hair.normal, point.noise);
    point.colour = PaintedColour(hair.paint_look, point.colour, seen);
    painted = PaintedHair(look, seen);
  }
  const glm::vec3 screen = projection.Project(at);
  HairEnd end{screen, ShadeHair(light, painted, point),
              hair.knot[k].width * projection.SamplesPerMetre(screen.z)};
  if (hair.has_texture) end.highlights = SunHighlights(light, painted, point);
  return end;
}

}  // namespace pelt
