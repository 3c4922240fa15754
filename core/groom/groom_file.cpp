// Writes and reads the groom file; the layout is described in groom_file.hpp, the fields in
// groom_fields.hpp.
//
// Reading never trusts a count: an item list is allocated only when the section is large enough to
// hold it. A reader keeps its first failure and from then on hands out zeros, so that a list of
// fields needs no check of its own; whoever loops over items looks at ok().
#include "core/groom/groom_file.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <memory>
#include <utility>

#include "core/file_bytes.hpp"
#include "core/format.hpp"
#include "core/groom/groom_fields.hpp"

namespace pelt {
namespace {

using namespace groom_file;

constexpr char kMagic[8] = {'P', 'E', 'L', 'T', 'G', 'R', 'M', '\n'};
constexpr uint64_t kHashAt = 40;
constexpr uint64_t kTextBytesLimit = 4096;

// Appends to one buffer whose size was reckoned before.
class Writer {
 public:
  explicit Writer(uint64_t bytes) { bytes_.reserve(bytes); }

  template <class T>
  void operator()(std::string_view, const T& value) {
    using Element = std::remove_all_extents_t<T>;
    if constexpr (kIsBytes<Element>) {
      Put(uint32_t(value.size()));
      for (const auto c : value) bytes_.push_back(std::byte(c));
    } else if constexpr (std::is_same_v<Element, bool>) {
      bytes_.push_back(std::byte(value ? 1 : 0));
    } else {
      constexpr size_t kCount = sizeof(T) / sizeof(Element);
      const size_t at = bytes_.size();
      bytes_.resize(at + sizeof(T));
      StoreNumbers(bytes_.data() + at, reinterpret_cast<const Element*>(&value), kCount);
    }
  }
  template <class T>
  void Put(const T& value) {
    (*this)("", value);
  }
  // Overwrites a number written before.
  void PutAt(uint64_t at, uint64_t value) { StoreNumbers(bytes_.data() + at, &value, 1); }
  std::span<const std::byte> Written() const { return bytes_; }
  std::vector<std::byte> Take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

template <class T>
T LoadNumber(const std::byte* from) {
  T value;
  LoadNumbers(&value, from, 1);
  return value;
}

struct Section {
  uint64_t offset = 0, bytes = 0;
  uint32_t items = 0, item_bytes = 0;
};

// Reads one section; knows where it is, for messages.
class Reader {
 public:
  Reader(std::span<const std::byte> file, const std::string& name, std::string_view section,
         uint64_t begin, uint64_t end, std::string& error)
      : file_(file), name_(name), section_(section), at_(begin), end_(end), error_(error) {}

  // Of a file whose header was read.
  uint32_t version() const { return LoadNumber<uint32_t>(file_.data() + sizeof kMagic); }
  bool ok() const { return error_.empty(); }
  // Keeps the first reason; returns false, for the caller to return.
  bool Fail(uint64_t at, const std::string& reason) {
    if (ok()) error_ = Format("groom '{}': section '{}', byte {}: {}", name_, section_, at, reason);
    return false;
  }
  // The next `count` bytes; null once anything has failed.
  const std::byte* Take(uint64_t count) {
    if (ok() && count > end_ - at_) {
      Fail(at_, Format("{} more bytes are needed, {} are left", count, end_ - at_));
    }
    if (!ok()) return nullptr;
    const std::byte* from = file_.data() + at_;
    at_ += count;
    return from;
  }
  template <class T>
  void operator()(std::string_view field, T& value) {
    using Element = std::remove_all_extents_t<T>;
    if constexpr (kIsBytes<Element>) {
      const uint64_t start = at_;
      const auto size = Get<uint32_t>();
      constexpr bool kIsText = std::is_same_v<Element, std::string>;
      if (size > (kIsText ? kTextBytesLimit : kStrandTextureBytes))
        Fail(start, Format("{} of {} bytes", field, size));
      if (const std::byte* bytes = Take(size)) {
        const auto* from = reinterpret_cast<const typename T::value_type*>(bytes);
        value.assign(from, from + size);
      }
    } else if constexpr (std::is_same_v<Element, bool>) {
      const uint64_t start = at_;
      const auto byte = Get<uint8_t>();
      if (byte > 1) Fail(start, Format("{} is {}, neither 0 nor 1", field, byte));
      value = byte == 1;
    } else {
      constexpr size_t kCount = sizeof(T) / sizeof(Element);
      if (const std::byte* from = Take(sizeof(T)))
        LoadNumbers(reinterpret_cast<Element*>(&value), from, kCount);
    }
  }
  template <class T>
  T Get() {
    const std::byte* from = Take(sizeof(T));
    return from ? LoadNumber<T>(from) : T{};
  }
  uint64_t At() const { return at_; }
  uint64_t Left() const { return end_ - at_; }

 private:
  std::span<const std::byte> file_;
  const std::string& name_;
  std::string_view section_;
  uint64_t at_, end_;
  std::string& error_;
};

void CheckCapacity(Reader& reader, std::string_view what, uint32_t expected) {
  const uint64_t at = reader.At();
  const auto found = reader.Get<uint32_t>();
  if (found == expected) return;
  reader.Fail(at, Format("baked for {} {}, this program has {}; bake the character again "
                         "with `pelt bake`",
                         found, what, expected));
}

bool CheckHeader(std::span<const std::byte> file, const std::string& name, std::string& error) {
  Reader header(file, name, "header", 0, file.size(), error);
  const std::byte* magic = header.Take(sizeof(kMagic));
  if (!magic) return false;
  if (std::memcmp(magic, kMagic, sizeof(kMagic)) != 0) return header.Fail(0, "not a groom file");
  const auto version = header.Get<uint32_t>();
  if (version < kOldestGroomVersion || version > kGroomVersion) {
    header.Fail(8, Format("version {}, this program reads {}; bake the character again with "
                          "`pelt bake`",
                          version, kGroomVersion));
  }
  CheckCapacity(header, "strands per chunk", kStrandsPerChunk);
  CheckCapacity(header, "joints a character", kJointsPerCharacter);
  CheckCapacity(header, "weight rows per chunk", kInfluenceRows);
  CheckCapacity(header, "lanes a group", kLaneGroup);
  CheckCapacity(header, "sections", CountSections(version));
  const auto file_bytes = header.Get<uint64_t>();
  if (file_bytes != file.size()) {
    header.Fail(32, Format("the file should have {} bytes and has {}: it was cut or extended",
                           file_bytes, file.size()));
  }
  const auto hash = header.Get<uint64_t>();
  if (header.ok() && hash != HashGroomBytes(file.subspan(kHeaderBytes))) {
    header.Fail(40, "the content does not match its hash: the file is damaged");
  }
  return header.ok();
}

// The table; the sections lie back to back and fill the file.
bool ReadTable(std::span<const std::byte> file, const std::string& name,
               std::span<Section> sections, std::string& error) {
  Reader table(file, name, "table", kHeaderBytes, file.size(), error);
  const uint32_t count = CountSections(table.version());
  uint64_t expected = kHeaderBytes + count * kSectionEntryBytes;
  for (uint32_t i = 0; i < count; ++i) {
    const uint64_t at = table.At();
    char wanted[kSectionNameBytes] = {};
    std::memcpy(wanted, kSectionNames[i].data(), kSectionNames[i].size());
    const std::byte* found = table.Take(kSectionNameBytes);
    if (!found) return false;
    if (std::memcmp(found, wanted, kSectionNameBytes) != 0) {
      return table.Fail(at, Format("section {} is not '{}'", i, kSectionNames[i]));
    }
    Section& s = sections[i];
    s.offset = table.Get<uint64_t>();
    s.bytes = table.Get<uint64_t>();
    s.items = table.Get<uint32_t>();
    s.item_bytes = table.Get<uint32_t>();
    if (s.offset != expected || s.bytes > file.size() - std::min<uint64_t>(expected, file.size())) {
      return table.Fail(at, Format("section '{}' does not lie behind the one before it, in the "
                                   "file",
                                   kSectionNames[i]));
    }
    expected += s.bytes;
  }
  if (expected != file.size()) {
    return table.Fail(table.At(),
                      Format("sections end at {}, the file at {}", expected, file.size()));
  }
  return table.ok();
}

template <class T>
constexpr bool kHasText = std::is_same_v<T, std::string> || std::is_same_v<T, GroomLayer>;

template <class T>
bool ReadSection(std::span<const std::byte> file, const std::string& name, uint32_t index,
                 const Section& section, std::vector<T>& items, std::string& error) {
  Reader reader(file, name, kSectionNames[index], section.offset, section.offset + section.bytes,
                error);
  const uint64_t item_bytes = CountItemBytes(*std::make_unique<T>(), reader.version());
  if (section.item_bytes != item_bytes) {
    return reader.Fail(section.offset, Format("items of {} bytes; this program has {}",
                                              section.item_bytes, item_bytes));
  }
  const uint64_t least = uint64_t(section.items) * item_bytes;
  if (kHasText<T> ? section.bytes < least : section.bytes != least) {
    return reader.Fail(section.offset, Format("{} items do not fit the section's {} bytes",
                                              section.items, section.bytes));
  }
  items.resize(section.items);
  for (T& item : items) {
    ListFields(reader, item);
    if (!reader.ok()) return false;
  }
  if (reader.Left() != 0) {
    return reader.Fail(reader.At(), Format("{} bytes behind the last item", reader.Left()));
  }
  return true;
}

// The section of a thing that a groom has one of.
template <class T>
bool ReadSingle(std::span<const std::byte> file, const std::string& name, uint32_t index,
                const Section& section, std::vector<T>& items, std::string& error) {
  if (!ReadSection(file, name, index, section, items, error)) return false;
  if (items.size() == 1) return true;
  return Reader(file, name, kSectionNames[index], 0, 0, error)
      .Fail(section.offset, Format("{} items instead of one", items.size()));
}

}  // namespace

uint64_t HashGroomBytes(std::span<const std::byte> bytes) {
  constexpr uint64_t kMultiply = 0x9e3779b97f4a7c15u;
  uint64_t hash = uint64_t(bytes.size()) * kMultiply;
  const auto add = [&](uint64_t word) { hash = std::rotl((hash ^ word) * kMultiply, 31); };
  size_t at = 0;
  for (; at + 8 <= bytes.size(); at += 8) add(LoadNumber<uint64_t>(bytes.data() + at));
  std::byte rest[8] = {};
  std::copy(bytes.begin() + ptrdiff_t(at), bytes.end(), rest);
  add(LoadNumber<uint64_t>(rest));
  hash ^= hash >> 32;
  hash *= kMultiply;
  return hash ^ hash >> 29;
}

Result<std::vector<std::byte>> WriteGroom(const Groom& groom) {
  if (std::string fault = FindGroomFault(groom, "to be written"); !fault.empty())
    return Failure{std::move(fault)};
  const std::vector<General> general{{groom.unit_scale, groom.joint_count}};
  const std::vector<SkeletonBlock> skeleton{groom.skeleton};
  const auto for_each_section = [&](auto&& visit) {
    visit(kSectionNames[0], general);
    visit(kSectionNames[1], skeleton);
    ListSections(visit, groom);
  };
  uint64_t file_bytes = kHeaderBytes + kSectionCount * kSectionEntryBytes;
  for_each_section([&](std::string_view, const auto& items) {
    for (const auto& item : items) file_bytes += MeasureItem(item);
  });

  Writer file(file_bytes);
  file.Put(kMagic);
  for (uint32_t value : {kGroomVersion, kStrandsPerChunk, kJointsPerCharacter, kInfluenceRows,
                         kLaneGroup, kSectionCount}) {
    file.Put(value);
  }
  file.Put(file_bytes);
  file.Put(uint64_t{0});  // the hash, once the rest is there
  uint64_t offset = kHeaderBytes + kSectionCount * kSectionEntryBytes;
  for_each_section([&](std::string_view name, const auto& items) {
    using Item = typename std::remove_cvref_t<decltype(items)>::value_type;
    uint64_t bytes = 0;
    for (const auto& item : items) bytes += MeasureItem(item);
    char padded[kSectionNameBytes] = {};
    std::memcpy(padded, name.data(), name.size());
    file.Put(padded);
    file.Put(offset);
    file.Put(bytes);
    file.Put(uint32_t(items.size()));
    file.Put(uint32_t(CountItemBytes(*std::make_unique<Item>())));
    offset += bytes;
  });
  for_each_section([&](std::string_view, const auto& items) {
    for (const auto& item : items) ListFields(file, item);
  });
  file.PutAt(kHashAt, HashGroomBytes(file.Written().subspan(kHeaderBytes)));
  return file.Take();
}

Result<Groom> ReadGroom(std::span<const std::byte> bytes, const std::string& name) {
  std::string error;
  std::vector<Section> sections(kSectionCount);
  std::vector<General> general;
  std::vector<SkeletonBlock> skeleton;
  if (!CheckHeader(bytes, name, error) || !ReadTable(bytes, name, sections, error) ||
      !ReadSingle(bytes, name, 0, sections[0], general, error) ||
      !ReadSingle(bytes, name, 1, sections[1], skeleton, error))
    return Failure{std::move(error)};
  Groom groom;
  groom.unit_scale = general[0].unit_scale;
  groom.joint_count = general[0].joint_count;
  groom.skeleton = skeleton[0];
  uint32_t index = 2;
  ListSections(
      [&](std::string_view, auto& items) {
        if (error.empty() && sections[index].offset > 0)
          ReadSection(bytes, name, index, sections[index], items, error);
        ++index;
      },
      groom);
  if (error.empty()) error = FindGroomFault(groom, name);
  if (!error.empty()) return Failure{std::move(error)};
  return groom;
}

Result<> WriteGroomFile(const Groom& groom, const std::string& path) {
  const Result<std::vector<std::byte>> bytes = WriteGroom(groom);
  if (!bytes) return Failure{bytes.error()};
  return WriteFileBytes("groom", path, *bytes);
}

Result<Groom> ReadGroomFile(const std::string& path) {
  const Result<std::vector<std::byte>> bytes = ReadFileBytes("groom", path);
  if (!bytes) return Failure{bytes.error()};
  return ReadGroom(*bytes, path);
}

}  // namespace pelt
