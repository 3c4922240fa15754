// When the stages of a frame of fur run on an item.
#pragma once

#include "core/stage.hpp"
#include "core/streams.hpp"

namespace pelt::frame_gates {

// All of these flags, of an item of the domain; for the masks below.
template <Domain kDomain, uint32_t kFlags>
bool HasFlags(const FrameMemory& memory, const ItemPlace& place);
template <Domain kDomain>
bool IsBlown(const FrameMemory& memory, const ItemPlace& place);
bool IsBrushed(const FrameMemory& memory, const ItemPlace& place);
bool IsLookedAt(const FrameMemory& memory, const ItemPlace& place);
bool HasPoseRates(const FrameMemory& memory, const ItemPlace& place);
template <Domain kDomain, uint32_t kFlags>
bool HasRates(const FrameMemory& memory, const ItemPlace& place);
bool IsRelit(const FrameMemory& memory, const ItemPlace& place);
template <Domain kDomain>
bool IsShifted(const FrameMemory& memory, const ItemPlace& place);
bool IsResorted(const FrameMemory& memory, const ItemPlace& place);
bool IsRedrawn(const FrameMemory& memory, const ItemPlace& place);

// The state of the domain's items.
template <Domain kDomain>
inline constexpr Stream kStateOf =
    kDomain == Domain::kPatch ? StreamOf<&Streams::patch_state> : StreamOf<&Streams::chunk_state>;
template <Domain kDomain, uint32_t kFlags>
inline constexpr Condition kWithFlags{
    &HasFlags<kDomain, kFlags>, kDomain, {kStateOf<kDomain>, Stream::kNone}};
using enum Domain;

inline constexpr Gate kAlways{};
inline constexpr Gate kPosed{.frame = FrameGate::kNotHeld};
inline constexpr Gate kSkinned{kWithFlags<kPatch, kChunkSkin>};
// The same of what is derived from skinned vertices.
template <Domain kDomain>
inline constexpr Gate kRooted{kWithFlags<kDomain, kChunkSkin>, FrameGate::kFollows};
// Skinned or simulated from what the last frame left, and the character's origin moved.
template <Domain kDomain>
inline constexpr Gate kShifted{
    {&IsShifted<kDomain>, kDomain, {kStateOf<kDomain>, StreamOf<&Streams::layer_origins>}}};
template <Domain kDomain>
inline constexpr Gate kSimulated{kWithFlags<kDomain, kChunkSimulate>};
// And of what is derived from simulated chains.
inline constexpr Gate kLoaded{kWithFlags<kPatch, kChunkSimulate>, FrameGate::kFollows};
template <Domain kDomain>
inline constexpr Gate kBlown{
    // simulated, and wind blows
    {&IsBlown<kDomain>, kDomain, {kStateOf<kDomain>, StreamOf<&Streams::layers>}},
    FrameGate::kFollows};
// The character's pose came with velocities.
inline constexpr Gate kPosedWithRates{
    {&HasPoseRates, Domain::kCharacter, {StreamOf<&Streams::pose_rates>, Stream::kNone}},
    FrameGate::kNotHeld};
template <Domain kDomain, uint32_t kFlags = kChunkSimulate>
inline constexpr Gate kRated{
    // simulated, and so
    {&HasRates<kDomain, kFlags>, kDomain, {kStateOf<kDomain>, StreamOf<&Streams::layers>}}};
// For strands with chains of their own, which swing on where the skin rests.
inline constexpr Gate kMeshRated = kRated<kPatch, kChunkVisible>;
// Lights changed, or some joint of the character moved: otherwise the layer's bounds did not. (The
// bounds themselves are written in the same pass, and so not there to be looked at.)
inline constexpr Gate kRelit{
    {&IsRelit, Domain::kLayer, {StreamOf<&Streams::layers>, StreamOf<&Streams::palette>}}};
inline constexpr Gate kFitted{kWithFlags<kChunk, kChunkFit>, FrameGate::kFollows};
// Of shells, which are bent and not simulated.
inline constexpr Gate kBent{kWithFlags<kPatch, kChunkFit>, FrameGate::kFollows};
// Living strands, and brushes somewhere. Asleep or not: paint is no reason to wake.
inline constexpr Gate kBrushed{
    {&IsBrushed, Domain::kChunk, {StreamOf<&Streams::chunk_state>, StreamOf<&Streams::layers>}}};
// Fitted, or painted in this frame.
inline constexpr Gate kFittedOrPainted{
    {&IsLookedAt, Domain::kChunk, {StreamOf<&Streams::chunk_state>, Stream::kNone}},
    FrameGate::kFollows};

// What follows the view goes on when time does not.
inline constexpr Gate kKeyed{kWithFlags<kChunk, kChunkKeys>, FrameGate::kAlsoPaused};
inline constexpr Gate kCollected{.frame = FrameGate::kAlsoPaused};
inline constexpr Gate kResorted{
    {&IsResorted, Domain::kLayer, {StreamOf<&Streams::layer_sort>, Stream::kNone}},
    FrameGate::kAlsoPaused};
// The piece holds drawn strands, and keys or records of the layer changed.
inline constexpr Gate kRedrawn{
    {&IsRedrawn, Domain::kChunk, {StreamOf<&Streams::layer_sort>, Stream::kNone}},
    FrameGate::kAlsoPaused};

}  // namespace pelt::frame_gates
