// The groom file: a groom on disk.
//
//      header   magic "PELTGRM\n", version, strands a chunk, section count, file size, hash
//      table    for each section: name, offset, bytes, items, bytes of one item
//      sections general, skeleton, joint_names, layers, layer_joints, mesh, strands, vertex_rest,
//               strand_rest4, strand_rest5: in this order, back to back, nothing between or after
//
// Everything is little-endian and written field by field from one list (groom_fields.hpp), so the
// bytes depend on the groom alone: not on the machine's byte order, nor on padding. The hash covers
// all that follows the header.
//
// A file is read as hostile input: counts are held against the file's size before anything is
// allocated, and then every index, range and number against what the frame assumes (CheckGroom).
// The hash finds damage; it is not what safety rests on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/groom/groom.hpp"

namespace pelt {

inline constexpr uint32_t kGroomVersion = 1;

// Throws pelt::Error when the groom is not one that ReadGroom would accept.
std::vector<std::byte> WriteGroom(const Groom& groom);

// Throws pelt::Error "groom 'name': section 'mesh', byte 1234: reason"; the byte counts from the
// start of the file.
Groom ReadGroom(std::span<const std::byte> bytes, const std::string& name);

// Written beside the target first and renamed onto it, so that a reader never sees half a file.
void WriteGroomFile(const Groom& groom, const std::string& path);
Groom ReadGroomFile(const std::string& path);

// The file's hash of `bytes`: equal on every machine. Not for security.
uint64_t HashGroomBytes(std::span<const std::byte> bytes);

// What the frame assumes of a groom and the types do not say. Throws pelt::Error as ReadGroom does.
void CheckGroom(const Groom& groom, const std::string& name);

}  // namespace pelt
