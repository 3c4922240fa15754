// The groom file: a groom on disk.
//
//      header   magic "PELTGRM\n", version, strands per chunk, section count, file size, hash
//      table    for each section: name, offset, bytes, items, bytes of one item
//      sections general, skeleton, joint_names, layers, layer_joints, mesh, strands, vertex_rest,
//               strand_rest4, strand_rest5, strand_uv, shell_skin, fin_edges, vertex_down,
//               strand_rest9, strand_down, halo, vertex_traits, strand_traits: in this order, back to
//               back, nothing between or after
//
// Everything is little-endian and written field by field from one list (groom_fields.hpp), so the
// bytes depend on the groom alone: not on the machine's byte order, nor on padding. The hash covers
// all that follows the header.
//
// A file is read as hostile input: counts are checked against the file's size before anything is
// allocated, and then every index, range and number against what the frame assumes
// (FindGroomFault). The hash finds damage; it is not what safety rests on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "core/groom/groom.hpp"

namespace pelt {

inline constexpr uint32_t kGroomVersion = 10;
inline constexpr uint32_t kOldestGroomVersion =
    8;  // that is read: without LayerParams::chain_share; 9 has neither a look nor what HasParam names

// The text of every failure is "groom 'name': section 'mesh', byte 1234: reason"; the byte counts
// from the start of the file.
Result<Groom> ReadGroom(std::span<const std::byte> bytes, const std::string& name);
Result<Groom> ReadGroomFile(const std::string& path);

// Fails when the groom is not one that ReadGroom would accept.
Result<std::vector<std::byte>> WriteGroom(const Groom& groom);
// As WriteFileBytes (core/file_bytes.hpp): a file is replaced whole.
Result<> WriteGroomFile(const Groom& groom, const std::string& path);

// What the frame assumes of a groom and the types do not say: the text of the first thing that is
// wrong, or empty.
std::string FindGroomFault(const Groom& groom, const std::string& name);

// The file's hash of `bytes`: equal on every machine. Not for security.
uint64_t HashGroomBytes(std::span<const std::byte> bytes);

}  // namespace pelt
