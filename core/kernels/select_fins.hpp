// Which edges of a layer of shells are seen from the side, and how much: there one looks between the
// shells, and a fin along the hairs on the edge fills the gap.
//
//   fade = max(0, 2 |e . n| - 1),  n = unit of (edge x hair),  e = unit of (eye - middle)
//
// so a fin is drawn that faces the eye by less than 60 degrees. The hair is the straight line from
// skin to tip, groom and force together, the mean of the edge's two ends: a fin is a strip about the
// plane of edge and hair, and the bend in between is small against its height. On a skin that is
// seen from above, hair and sight are one direction, which n is square to: no fin.
// Source: Lengyel, Praun, Finkelstein, Hoppe, Real-Time Fur over Arbitrary Surfaces, I3D 2001.
//
// Invariant: one of the triangles that share an edge owns it (groom/shell_skin.hpp), so no fin is
// drawn twice. A fin whose plane is lost, its edge or its hair without length or its hair along the
// edge, is not drawn, nor one that the eye is on. All lanes of the block are written: zero
// behind the triangles that live.
#pragma once

#include <string_view>

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/streams.hpp"

namespace pelt {

struct SelectFinsParams {
  float eye[3];  // m
};

namespace fin_detail {

// Of 255, rounded; 0 where the squares leave the range of floats.
template <class V>
PELT_INLINE typename V::Int FadeOf(const Vec3<V>& across, const Vec3<V>& to_eye) {
  const V zero(0.0f), one(1.0f), two(2.0f), half(0.5f), full(255.0f);
  const V least(1.0e-30f), most(1.0e38f);
  const V plane = Dot(across, across), sight = Dot(to_eye, to_eye);
  const V squares = plane * sight;
  const V facing = Abs(Dot(across, to_eye)) * Rsqrt(squares);
  const V fade = Clamp(two * facing - one, zero, one);
  const auto usual = (squares > least) & (squares < most);
  return Truncate(Select(usual, fade, zero) * full + half);
}

}  // namespace fin_detail

template <class V>
struct SelectFins {
  static constexpr std::string_view kName = "select_fins";
  using Params = SelectFinsParams;
  using Vertices = Gather<&Streams::shell_vertices, &Streams::halo>;
  struct Ports {
    In<&Streams::chunk_state> state;
    In<&Streams::strands> triangles;
    In<&Streams::fin_edges> edges;
    Vertices vertices;
    Out<&Streams::fins> fins;
  };

  static void Run(const Params& p, const Ports& ports) {
    using I = typename V::Int;
    const Vec3<V> eye = {V(p.eye[0]), V(p.eye[1]), V(p.eye[2])};
    const uint32_t live = ports.state->live_strands;
    uint32_t* fade = ports.fins->fade;
    uint32_t lane = 0;
    for (; lane < live; lane += V::kLanes) {
      const I owned = I::Load(ports.edges->owned + lane);
      const auto lives = I::Iota(int32_t(lane)) < I(int32_t(live));
      const I fades = FadesOf(ports, eye, lane);
      Select(lives, fades & owned, I(0)).Store(fade + lane);
    }
    for (; lane < kStrandsPerChunk; lane += V::kLanes) I(0).Store(fade + lane);
  }

 private:
  struct Corner {
    Vec3<V> position, hair;
  };

  static PELT_INLINE Vec3<V> GatherPart(const Vertices& vertices, const uint8_t* index,
                                        uint32_t quad) {
    Vec3<V> part;
    V word;
    GatherColumns<V>(
        [&](int lane) __attribute__((always_inline)) {
          return reinterpret_cast<const float*>(&vertices[index[lane]]) + 4 * quad;
        },
        part.x, part.y, part.z, word);
    return part;
  }

  static PELT_INLINE Corner GatherCorner(const Ports& ports, uint32_t corner, uint32_t lane) {
    const uint8_t* index = ports.triangles->vertex[corner] + lane;
    const Vec3<V> position = GatherPart(ports.vertices, index, 0);
    const Vec3<V> groom = GatherPart(ports.vertices, index, 1);
    const Vec3<V> force = GatherPart(ports.vertices, index, 2);
    return {position, groom + force};
  }

  static PELT_INLINE typename V::Int EdgeFade(const Corner& a, const Corner& b,
                                              const Vec3<V>& eye) {
    const V half(0.5f);
    const Vec3<V> edge = b.position - a.position, hair = a.hair + b.hair;
    const Vec3<V> middle = (a.position + b.position) * half;
    const Vec3<V> across = Cross(edge, hair);
    return fin_detail::FadeOf<V>(across, eye - middle);
  }

  static PELT_INLINE typename V::Int FadesOf(const Ports& ports, const Vec3<V>& eye,
                                             uint32_t lane) {
    using I = typename V::Int;
    const Corner a = GatherCorner(ports, 0, lane);
    const Corner b = GatherCorner(ports, 1, lane);
    const Corner c = GatherCorner(ports, 2, lane);
    const I ab = EdgeFade(a, b, eye), bc = EdgeFade(b, c, eye), ca = EdgeFade(c, a, eye);
    const I bc_byte = bc << 8, ca_byte = ca << 16;
    return ab | bc_byte | ca_byte;
  }
};

}  // namespace pelt
