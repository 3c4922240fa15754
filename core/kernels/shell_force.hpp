// The vertices of a layer of shells: where each stands, which way its fur was groomed, and how far
// gravity and wind bend it.
//
//   P(h) = p + h g + h^2 f,  h from 0 at the skin to 1 at the tips
//
// g is the tip of the chain that is groomed at the vertex. The pull (gravity + wind) / 9.81 m/s^2,
// at most 1, less what the stiffness takes, bends the tip by that many of the fur's lengths: h^2 is
// the course of a rod that is clamped at the skin, at first order. Nothing is simulated: the force
// has no state and no delay.
//
// The cone of shame keeps the force from pulling fur through the skin: it leans on the normal by
// a cosine of `cone` at least. Source of both: Furry Scorpion, a student's demonstration of shells;
// its cone has quirks, which are kept under its name and mended in the other.
//
// Invariant: no vertex leaves the skin by more than twice its fur's length: |g| and |f| are at most
// that each (groom/chunk_builder.cpp widens the layer's bounds by as much). A layer that does not
// simulate lies on its groom, as its chunks sleep.
#pragma once

#include <string_view>

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/kernels/strand_look.hpp"
#include "core/kernels/write_looks.hpp"
#include "core/layer.hpp"
#include "core/streams.hpp"

namespace pelt {

namespace shell_force_detail {

inline constexpr float kStandardGravity = 9.80665f;  // m/s^2

// A force that leans away from the normal is turned towards it until the cosine between them is
// `cosine`, and keeps its size. One straight into the skin is turned to some side.
template <class V>
PELT_INLINE Vec3<V> KeepInCone(const Vec3<V>& force, const Vec3<V>& normal, V cosine, V sine) {
  const V size = Sqrt(Dot(force, force));
  const Vec3<V> side = UnitAcross(normal, force);
  const V up = cosine * size, across = sine * size;
  const Vec3<V> raised = normal * up + side * across;
  return Select<V>(Dot(force, normal) < up, raised, force);
}

// As it was published: half of what the cosine lacks is mixed in of the normal, which does not
// reach the cone about 90 degrees and passes it beyond; the unit normal is mixed with a force of any
// size; what was corrected, and that alone, is as long as the fur; straight into the skin there is
// no force at all. (The root's reciprocal is a few units of the last place off: such a cosine is -1
// too.)
template <class V>
PELT_INLINE Vec3<V> ConeOfShame(const Vec3<V>& force, const Vec3<V>& normal, V cosine,
                                V fur_length) {
  const V zero(0.0f), one(1.0f), half(0.5f), straight_in(-0.9999995f);
  const Vec3<V> none = {zero, zero, zero};
  const V lean = Dot(NormalizeOr(force, none), normal);
  const V share = (cosine - lean) * half, left = one - share;
  const Vec3<V> mixed = force * left + normal * share;
  const Vec3<V> raised = NormalizeOr(mixed, none) * fur_length;
  const Vec3<V> corrected = Select<V>(lean <= straight_in, none, raised);
  const auto leans = (lean < cosine) & (Dot(force, force) > zero);
  return Select<V>(leans, corrected, force);
}

// What a vector as long as `a` is multiplied with to be at most 1 long.
template <class V>
PELT_INLINE V ShrinkToUnit(const Vec3<V>& a) {
  return Min(Rsqrt(Dot(a, a)), V(1.0f));
}

}  // namespace shell_force_detail

template <class V>
struct ShellForce {
  static constexpr std::string_view kName = "shell_force";
  struct Ports {
    Shared<&Streams::layers> layer;
    Shared<&Streams::shell_layers> shells;
    In<&Streams::vertex_rest> rest;
    In<&Streams::shell_skin> skin;
    In<&Streams::anchors> anchors;
    In<&Streams::vertex_wind> wind;
    In<&Streams::patch_state> state;
    Out<&Streams::shell_vertices> vertices;
  };

  // What bends the layer: the same all over it, but for the wind.
  struct Pull {
    bool acts, blows, published;
    V cosine, sine;
    V compliance;  // lengths of the fur for each m/s^2
    Vec3<V> gravity;
  };

  static PELT_INLINE Pull MakePull(const LayerBlock& layer, const ShellLayerBlock& shells) {
    const V one(1.0f), cosine(shells.cone), squared = cosine * cosine;
    Pull pull;
    pull.acts = (layer.flags & kLayerSimulate) != 0;
    pull.blows = (layer.flags & kLayerWind) != 0;
    pull.published = shells.cone_kind == uint32_t(ConeKind::kPublished);
    pull.cosine = cosine;
    pull.sine = Sqrt(Max(one - squared, V(0.0f)));
    pull.compliance = V((1.0f - layer.link.stiffness) / shell_force_detail::kStandardGravity);
    pull.gravity = {V(layer.gravity[0]), V(layer.gravity[1]), V(layer.gravity[2])};
    return pull;
  }

  // In lengths of the fur.
  static PELT_INLINE Vec3<V> ForceOn(const Pull& pull, const WindBlock& wind, uint32_t lane,
                                     const Vec3<V>& normal) {
    using namespace shell_force_detail;
    Vec3<V> acceleration = pull.gravity;
    if (pull.blows) acceleration = acceleration + Load3<V>(wind.acceleration, lane);
    const Vec3<V> force = acceleration * pull.compliance;
    const V shrink = ShrinkToUnit(force);
    // The exact cone keeps the size, so that it need not wait for it.
    if (!pull.published) return KeepInCone(force, normal, pull.cosine, pull.sine) * shrink;
    return ConeOfShame(force * shrink, normal, pull.cosine, V(1.0f));
  }

  static PELT_INLINE void WriteGroom(const Ports& ports, const look::LayerTint<V>& tint,
                                     uint32_t lane) {
    using I = typename V::Int;
    const Vec3<V> normal = Load3<V>(ports.anchors->normal, lane);
    const Vec3<V> tangent = Load3<V>(ports.anchors->tangent, lane);
    const Vec3<V> bitangent = Cross(normal, tangent);
    Vec3<V> tip = Load3<V>(ports.rest->offset[2], lane);
    if (ports.layer->scale != 1.0f) tip = tip * V(ports.layer->scale);
    const Vec3<V> groom = Combine(tangent, tip.x, bitangent, tip.y, normal, tip.z);
    const I base = look::Tinted(tint, I::Load(ports.skin->base_colour + lane));
    const I tip_colour = look::Tinted(tint, I::Load(ports.skin->tip_colour + lane));
    Store(*ports.vertices, lane, 0, Load3<V>(ports.anchors->position, lane), base);
    Store(*ports.vertices, lane, 1, groom, tip_colour);
  }

  static PELT_INLINE void WriteForce(const Ports& ports, const Pull& pull, uint32_t lane) {
    const V zero(0.0f);
    const Vec3<V> normal = Load3<V>(ports.anchors->normal, lane);
    Vec3<V> force = {zero, zero, zero};
    if (pull.acts) {
      V length = V::Load(ports.rest->segment_length + lane) * V(3.0f);
      if (ports.layer->scale != 1.0f) length = length * V(ports.layer->scale);
      const V yields = length * V::Load(ports.rest->strength + lane);
      force = ForceOn(pull, *ports.wind, lane, normal) * yields;
    }
    Store(*ports.vertices, lane, 2, force, write_looks_detail::PackOctahedral(normal));
  }

  static void Run(const Ports& ports) {
    const uint32_t lanes = RoundUpToLaneGroups(ports.state->live_vertices);
    const Pull pull = MakePull(*ports.layer, *ports.shells);
    const look::LayerTint<V> tint = look::MakeTint<V>(*ports.layer);
    for (uint32_t lane = 0; lane < lanes; lane += V::kLanes) WriteGroom(ports, tint, lane);
    // A loop of its own: its roots are long chains, and only short bodies overlap them.
    for (uint32_t lane = 0; lane < lanes; lane += V::kLanes) WriteForce(ports, pull, lane);
  }

 private:
  static PELT_INLINE void Store(ShellVertexBlock& out, uint32_t lane, uint32_t quad,
                                const Vec3<V>& a, typename V::Int word) {
    ScatterRecords<V>(
        [&](int l) __attribute__((always_inline)) {
          return reinterpret_cast<float*>(&out.vertex[lane + uint32_t(l)]) + 4 * quad;
        },
        a.x, a.y, a.z, FromBits(word));
  }
};

}  // namespace pelt
