// When the stages of a frame of fur run on an item.
#pragma once

#include "core/stage.hpp"
#include "core/streams.hpp"

namespace pelt::frame_gates {

// All of these flags; for the masks below.
template <uint32_t kChunkFlags>
bool HasFlags(const FrameMemory& memory, const ItemPlace& place);
bool IsBlown(const FrameMemory& memory, const ItemPlace& place);
bool IsBrushed(const FrameMemory& memory, const ItemPlace& place);
bool IsLookedAt(const FrameMemory& memory, const ItemPlace& place);
bool HasPoseRates(const FrameMemory& memory, const ItemPlace& place);
bool HasRootRates(const FrameMemory& memory, const ItemPlace& place);
bool IsRelit(const FrameMemory& memory, const ItemPlace& place);
bool IsShifted(const FrameMemory& memory, const ItemPlace& place);
bool IsResorted(const FrameMemory& memory, const ItemPlace& place);
bool IsRedrawn(const FrameMemory& memory, const ItemPlace& place);

template <uint32_t kChunkFlags>
inline constexpr Condition kWithFlags{
    &HasFlags<kChunkFlags>, Domain::kChunk, {StreamOf<&Streams::chunk_state>, Stream::kNone}};

inline constexpr Gate kAlways{};
inline constexpr Gate kPosed{.frame = FrameGate::kNotHeld};
inline constexpr Gate kSkinned{kWithFlags<kChunkSkin>};
// The same of what is told from skinned vertices.
inline constexpr Gate kRooted{kWithFlags<kChunkSkin>, FrameGate::kFollows};
// Skinned or simulated from what the last frame left, and the character's origin moved.
inline constexpr Gate kShifted{
    {&IsShifted,
     Domain::kChunk,
     {StreamOf<&Streams::chunk_state>, StreamOf<&Streams::layer_origins>}}};
inline constexpr Gate kSimulated{kWithFlags<kChunkSimulate>};
// And of what is told from simulated chains.
inline constexpr Gate kLoaded{kWithFlags<kChunkSimulate>, FrameGate::kFollows};
inline constexpr Gate kBlown{
    // simulated, and wind blows
    {&IsBlown, Domain::kChunk, {StreamOf<&Streams::chunk_state>, StreamOf<&Streams::layers>}},
    FrameGate::kFollows};
// The character's pose came with velocities.
inline constexpr Gate kPosedWithRates{
    {&HasPoseRates, Domain::kCharacter, {StreamOf<&Streams::pose_rates>, Stream::kNone}},
    FrameGate::kNotHeld};
inline constexpr Gate kRated{
    // simulated, and so
    {&HasRootRates, Domain::kChunk, {StreamOf<&Streams::chunk_state>, StreamOf<&Streams::layers>}}};
// Lights changed, or some joint of the character moved: otherwise the layer's bounds did not. (The
// bounds themselves are written in the same pass, and so not there to be looked at.)
inline constexpr Gate kRelit{
    {&IsRelit, Domain::kLayer, {StreamOf<&Streams::layers>, StreamOf<&Streams::palette>}}};
inline constexpr Gate kFitted{kWithFlags<kChunkFit>, FrameGate::kFollows};
// Living strands, and brushes somewhere. Asleep or not: paint is no reason to wake.
inline constexpr Gate kBrushed{
    {&IsBrushed, Domain::kChunk, {StreamOf<&Streams::chunk_state>, StreamOf<&Streams::layers>}}};
// Fitted, or painted in this frame.
inline constexpr Gate kFittedOrPainted{
    {&IsLookedAt, Domain::kChunk, {StreamOf<&Streams::chunk_state>, Stream::kNone}},
    FrameGate::kFollows};

// What follows the view goes on when time does not.
inline constexpr Gate kKeyed{kWithFlags<kChunkKeys>, FrameGate::kAlsoPaused};
inline constexpr Gate kCollected{.frame = FrameGate::kAlsoPaused};
inline constexpr Gate kResorted{
    {&IsResorted, Domain::kLayer, {StreamOf<&Streams::layer_sort>, Stream::kNone}},
    FrameGate::kAlsoPaused};
// The piece holds drawn strands, and keys or records of the layer changed.
inline constexpr Gate kRedrawn{
    {&IsRedrawn, Domain::kChunk, {StreamOf<&Streams::layer_sort>, Stream::kNone}},
    FrameGate::kAlsoPaused};

}  // namespace pelt::frame_gates
