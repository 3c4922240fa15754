// What strands have of their own (TraitBlock), as kernels take it: a layer's terms in each lane. Where a layer has no
// traits they are the layer's own numbers, and a kernel is the same code as if there were none.
//
// Invariants:
//  - Traits of a strand like any other (factors of 1, no drag, no limit) leave the bits that it has without.
//  - Shares stay shares: a factor takes none of them above 1.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "core/kernel.hpp"
#include "core/layer.hpp"
#include "core/simd.hpp"
#include "core/streams.hpp"

namespace pelt {

namespace traits {

PELT_INLINE float LeftOf(float share) { return 1.0f - share; }
template <class W>
PELT_INLINE W LeftOf(W share) {
  return W(1.0f) - share;
}

// A share of the layer's times a lane's factor on it.
template <class W, class At>
PELT_INLINE W ShareOf(float share, const float (&factor)[kStrandsPerChunk], const At& at) {
  return Min(W(share) * LoadLanes<W>(factor, at), W(1.0f));
}

// `amount` in lanes that weigh more or less than the layer; as it is where there are no traits.
template <class W, class At>
PELT_INLINE W Weigh(const TraitBlock* traits, const At& at, W amount) {
  return traits ? amount * LoadLanes<W>(traits->weight, at) : amount;
}

// exp(x); 1 for 0. Up to |x| = 3 a relative error of 1e-5, to 8 of 1e-3; beyond 32 it stays what it is there.
template <class W>
PELT_INLINE W Exp(W x) {
  const W r = Clamp(x, W(-32.0f), W(32.0f)) * W(1.0f / 16.0f);
  const W even = W(1.0f) + r * r * W(1.0f / 12.0f), odd = r * W(0.5f);
  W power = (even + odd) / (even - odd);
  for (int i = 0; i < 4; ++i) power = power * power;
  return power;
}

// Turns links, root to tip, until none leans further from where it would be carried by the link above it than its
// lane's limit: as that one has turned from the groom, the first as the root has. What is below a link moves along,
// and no length changes, so that none exceeds its limit when the last is done.
template <class W, uint32_t kFree>
PELT_INLINE void LimitBends(W least_cosine, const Vec3<W> (&rest)[kFree], Vec3<W> (&point)[kFree]) {
  const typename W::Mask limited = least_cosine > W(-1.0f);
  if (!Any(limited)) return;
  const W least_square = W(1.0e-24f);
  const Vec3<W> none = {W(0.0f), W(0.0f), W(0.0f)};
  Vec3<W> groomed = none, turned = none;  // the link above
  Vec3<W> last_rest = none, before = none, at = none;
  for (uint32_t i = 0; i < kFree; ++i) {
    const Vec3<W> link = rest[i] - last_rest, part = point[i] - before;
    last_rest = rest[i], before = point[i];
    const Vec3<W> straight = link * Rsqrt(Max(Dot(link, link), least_square));
    const W square = Max(Dot(part, part), least_square), inverse = Rsqrt(square);
    Vec3<W> carried = straight;
    if (i > 0) carried = NormalizeOr(TurnLeast(groomed, turned, straight), straight);
    Vec3<W> d = part * inverse;
    LeanAlong(carried, least_cosine, 1.0f, W(0.0f), d);
    const Vec3<W> end = at + d * (square * inverse);
    point[i] = Select<W>(limited, end, point[i]);
    at = point[i], groomed = straight, turned = d;
  }
}

// Terms of PBD and Verlet: the layer's,
struct LayerTerms {
  static constexpr bool kOfLanes = false;
  const LayerBlock& layer;
  PELT_INLINE static float Hardness(float hardness, uint32_t) { return hardness; }
  PELT_INLINE float Keep(float) const { return layer.link.velocity_keep; }
  PELT_INLINE static float Weight(float amount) { return amount; }
  PELT_INLINE float Bounce() const { return layer.bounce; }
  PELT_INLINE float Clump() const { return layer.clump; }
  template <class Points>
  PELT_INLINE void Limit(const Points&, Points&) const {}
};

// or each lane's, from `lane` on.
template <class W>
struct LaneTerms {
  static constexpr bool kOfLanes = true;
  const LayerBlock& layer;
  const TraitBlock& block;
  uint32_t lane;
  PELT_INLINE W Hardness(float hardness, uint32_t link) const {
    return ShareOf<W>(hardness, block.stiffness[link], lane);
  }
  PELT_INLINE W Keep(float dt) const {
    const W drag = W::Load(block.drag + lane) * W(dt);
    return Min(W(layer.link.velocity_keep) * Exp(-drag), W(1.0f));
  }
  PELT_INLINE W Weight(float amount) const { return Weigh(&block, lane, W(amount)); }
  PELT_INLINE W Bounce() const { return ShareOf<W>(layer.bounce, block.bounce, lane); }
  PELT_INLINE W Clump() const { return ShareOf<W>(layer.clump, block.clump, lane); }
  template <class Points>
  PELT_INLINE void Limit(const Points& rest, Points& point) const {
    LimitBends(W::Load(block.least_cosine + lane), rest, point);
  }
};

// Which of them a chunk's groups take.
struct NoTraits {
  template <class W>
  PELT_INLINE LayerTerms Terms(const LayerBlock& layer, uint32_t) const {
    return {layer};
  }
};
struct OwnTraits {
  const TraitBlock* block;
  template <class W>
  PELT_INLINE LaneTerms<W> Terms(const LayerBlock& layer, uint32_t lane) const {
    return {layer, *block, lane};
  }
};

inline constexpr std::string_view kSuffix = "_traits";
template <class K>
inline constexpr auto kNameOf = [] {
  std::array<char, K::kName.size() + kSuffix.size()> text{};
  std::copy(kSuffix.begin(), kSuffix.end(),
            std::copy(K::kName.begin(), K::kName.end(), text.begin()));
  return text;
}();
template <class K>
struct ParamsOf {};
template <class K>
requires requires { typename K::Params; }
struct ParamsOf<K> {
  using Params = typename K::Params;
};

}  // namespace traits

// Kernel K of layers whose strands have traits: K::Run with their block, of K::kTraits, besides.
template <class K>
struct WithTraits : traits::ParamsOf<K> {
  static constexpr std::string_view kName{traits::kNameOf<K>.data(), traits::kNameOf<K>.size()};
  struct Ports {
    typename K::Ports plain;
    In<K::kTraits> traits;
  };
  static void Run(const auto& params, const Ports& ports) {
    K::Run(params, ports.plain, ports.traits.block);
  }
  static void Run(const Ports& ports) { K::Run(ports.plain, ports.traits.block); }
};

}  // namespace pelt
