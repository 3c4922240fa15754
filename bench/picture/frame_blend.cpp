#include "bench/picture/frame_blend.hpp"

#include <algorithm>
#include <cstring>

namespace pelt {
namespace {

constexpr uint32_t kNowhere = ~0u;

template <size_t kCount>
void Mix(const float (&from)[kCount], float share, float (&to)[kCount]) {
  for (size_t i = 0; i < kCount; ++i) to[i] = from[i] + (to[i] - from[i]) * share;
}
void Mix(const glm::vec3& from, float share, glm::vec3& to) { to = from + (to - from) * share; }
void MixUnit(const glm::vec3& from, float share, glm::vec3& to) {
  const glm::vec3 mean = from + (to - from) * share;
  const float length = glm::length(mean);
  if (length > 1e-6f) to = mean / length;
}

void MixVertex(const CurveRecord& from, float share, CurveRecord& to) {
  for (size_t i = 0; i < 4; ++i) Mix(from.curve[i], share, to.curve[i]);
}
void MixVertex(const RibbonVertex& from, float share, RibbonVertex& to) {
  Mix(from.position, share, to.position);
  Mix(from.tangent, share, to.tangent);
}
void MixVertex(const LineVertex& from, float share, LineVertex& to) {
  Mix(from.position, share, to.position);
}
void MixVertex(const ShellVertex& from, float share, ShellVertex& to) {
  Mix(from.position, share, to.position);
  Mix(from.groom, share, to.groom);
  Mix(from.force, share, to.force);
}

// Where a hair was, that may have been drawn with other pieces.
glm::vec3 PlaceOn(const Hair& hair, float t) {
  const float at = t * float(hair.knots - 1);
  const uint32_t k = std::min(uint32_t(at), hair.knots - 2);
  return glm::mix(hair.knot[k].at, hair.knot[k + 1].at, at - float(k));
}

void MixHair(const Hair& from, float share, Hair& to) {
  for (uint32_t k = 0; k < to.knots; ++k)
    Mix(PlaceOn(from, float(k) / float(to.knots - 1)), share, to.knot[k].at);
  Mix(from.root, share, to.root);
  MixUnit(from.normal, share, to.normal);
}

void MixBody(const Body& from, float share, Body& to) {
  if (from.position.size() != to.position.size() || from.eyes.size() != to.eyes.size()) return;
  for (size_t v = 0; v < to.position.size(); ++v) {
    Mix(from.position[v], share, to.position[v]);
    MixUnit(from.normal[v], share, to.normal[v]);
  }
  for (size_t e = 0; e < to.eyes.size(); ++e) {
    Mix(from.eyes[e].centre, share, to.eyes[e].centre);
    MixUnit(from.eyes[e].forward, share, to.eyes[e].forward);
  }
}

// Where the vertices that are at `index` in the one draw are in the other, if this is what they are.
template <class Vertex>
void MixVertices(std::span<const std::byte> from, const LayerDraw& draw, std::span<std::byte> to,
                 float share, auto&& index_before) {
  if (&kVertexType<Vertex> != draw.format().vertex_type) return;
  const size_t before = from.size() / sizeof(Vertex), count = to.size() / sizeof(Vertex);
  for (size_t i = 0; i < count; ++i) {
    const size_t at = index_before(i);
    if (at >= before) continue;
    Vertex a, b;
    std::memcpy(&a, from.data() + at * sizeof(Vertex), sizeof(a));
    std::memcpy(&b, to.data() + i * sizeof(Vertex), sizeof(b));
    MixVertex(a, share, b);
    std::memcpy(to.data() + i * sizeof(Vertex), &b, sizeof(b));
  }
}

}  // namespace

void FrameBlend::Keep(PictureScene shown) {
  Kept kept{shown.camera, std::move(shown.bodies), {}};
  for (size_t i = 0; i < shown.draws.size(); ++i) {
    const LayerDraw& draw = shown.draws[i];
    Draw& to = kept.draws.emplace_back(
        Draw{draw.layer, {draw.vertices.begin(), draw.vertices.end()}, {}, {}});
    for (uint32_t place = 0; place < draw.strand_count; ++place) {
      const uint32_t strand = draw.order[place];
      if (strand >= to.place_of_strand.size()) to.place_of_strand.resize(strand + 1, kNowhere);
      to.place_of_strand[strand] = place;
    }
    to.hairs = std::move(shown.layers[i]);
  }
  kept_ = std::move(kept);
}

void FrameBlend::Blend(float share, PictureScene& shown) const {
  if (!kept_) return;
  Mix(kept_->camera.eye, share, shown.camera.eye);
  Mix(kept_->camera.target, share, shown.camera.target);
  for (size_t b = 0; b < std::min(shown.bodies.size(), kept_->bodies.size()); ++b)
    MixBody(kept_->bodies[b], share, shown.bodies[b]);
  const std::span<std::vector<std::byte>> vertices = OwnVertices(shown);
  for (size_t i = 0; i < shown.draws.size(); ++i) {
    const LayerDraw& draw = shown.draws[i];
    const auto from = std::ranges::find(kept_->draws, draw.layer, &Draw::layer);
    if (from == kept_->draws.end()) continue;
    const auto place_before = [&](size_t strand) {
      return strand < from->place_of_strand.size() ? from->place_of_strand[strand] : kNowhere;
    };
    const size_t per_strand = draw.format().vertices_per_strand;
    const auto index_before = [&](size_t index) -> size_t {
      if (!draw.format().OfStrands()) return index;
      const size_t at = index / per_strand;
      if (shown.order == VertexOrder::kIndexBuffer)
        return place_before(at) == kNowhere ? kNowhere : index;
      if (at >= draw.strand_count) return kNowhere;
      const size_t place = place_before(draw.order[at]);
      return place == kNowhere ? kNowhere : place * per_strand + index % per_strand;
    };
    MixVertices<CurveRecord>(from->vertices, draw, vertices[i], share, index_before);
    MixVertices<RibbonVertex>(from->vertices, draw, vertices[i], share, index_before);
    MixVertices<LineVertex>(from->vertices, draw, vertices[i], share, index_before);
    MixVertices<ShellVertex>(from->vertices, draw, vertices[i], share, index_before);
    for (size_t place = 0; place < shown.layers[i].size(); ++place)
      if (const uint32_t before = place_before(draw.order[place]); before < from->hairs.size())
        MixHair(from->hairs[before], share, shown.layers[i][place]);
  }
}

}  // namespace pelt
