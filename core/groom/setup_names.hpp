// What the keys of a layer name on a character, and the error when it is not there: the part of
// reading a setup that needs the character.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/character/character.hpp"
#include "core/groom/fur_setup.hpp"

namespace pelt {

class SurfaceColour;

// "path: layer 'x': key 'y': reason", thrown as pelt::Error.
[[noreturn]] void FailLayerKey(const FurSetup&, const LayerSetup&, const std::string& key,
                               const std::string& reason);

// Throws when a map of the layer needs texture coordinates and the mesh has none.
void CheckMapsHaveUvs(const Mesh&, const FurSetup&, const LayerSetup&);

// Throws when mask.colours asks for colours and the character's file says none.
void CheckColoursAreKnown(const SurfaceColour*, const Mesh&, const FurSetup&, const LayerSetup&);

// Node of that name and, with `subtree`, all its descendants. Throws for a name that is unknown.
std::vector<uint8_t> FindJoints(const Skeleton&, const FurSetup&, const LayerSetup&,
                                const std::string& key, const std::string& joint, bool subtree);

// 1 for each of the mesh's materials that mask.materials names; if it names none, that is not bare. Throws for a name
// that is unknown.
std::vector<uint8_t> FindMaterials(const Mesh&, const FurSetup&, const LayerSetup&);

// 1 for each of the mesh's materials that has one of these names. Throws for a name that is unknown.
std::vector<uint8_t> FindNamedMaterials(const Mesh&, const FurSetup&, const LayerSetup&,
                                        const std::string& key,
                                        const std::vector<std::string>& names);

// What the setup's layers leave bare although they name no materials, as a sentence; empty: nothing.
std::string DescribeBare(const Mesh&, const FurSetup&);

}  // namespace pelt
