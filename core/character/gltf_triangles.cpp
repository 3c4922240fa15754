// The triangles of a primitive.
#include <algorithm>
#include <numeric>

#include "core/character/gltf_mesh.hpp"
#include "core/format.hpp"

namespace pelt::gltf {
namespace {

struct Corners {
  std::vector<uint32_t> index;
  uint32_t restart = ~0u;             // an index that begins anew where there is no such vertex
  std::span<const uint8_t> unusable;  // of the vertices
};

class Assembler {
 public:
  Assembler(const Corners& corners, int mode) : corners_(corners), mode_(mode) {}

  Triangles Assemble() {
    out_.corners = corners_.index.size();
    for (const uint32_t index : corners_.index) {
      if (index == corners_.restart && index >= corners_.unusable.size())
        Restart();
      else
        Take(index);
    }
    Restart();
    return std::move(out_);
  }

 private:
  void Restart() {
    if (mode_ == kTriangles || taken_ < 3) out_.left_over += taken_;
    taken_ = 0;
  }

  void Take(uint32_t index) {
    if (taken_ < 2) {
      (taken_ == 0 ? first_ : last_) = index;
      ++taken_;
      return;
    }
    const bool turned = mode_ == kTriangleStrip && taken_ % 2 == 1;
    const std::array<uint32_t, 3> triangle = mode_ == kTriangleFan
                                                 ? std::array{last_, index, first_}
                                             : turned ? std::array{first_, index, last_}
                                                      : std::array{first_, last_, index};
    Add(triangle);
    if (mode_ == kTriangles) {
      taken_ = 0;
      return;
    }
    if (mode_ == kTriangleStrip) first_ = last_;
    last_ = index;
    ++taken_;
  }

  void Add(const std::array<uint32_t, 3>& triangle) {
    bool exists = true, usable = true;
    for (const uint32_t index : triangle) {
      if (index >= corners_.unusable.size()) {
        exists = false;
        if (!out_.first_nowhere) out_.first_nowhere = index;
      } else {
        usable &= !corners_.unusable[index];
      }
    }
    const auto [a, b, c] = triangle;
    const bool turns_back = mode_ != kTriangles && (a == b || b == c || c == a);
    if (!exists)
      ++out_.nowhere;
    else if (!usable)
      ++out_.unusable;
    else if (!turns_back)
      out_.of.push_back(triangle);
  }

  const Corners& corners_;
  const int mode_;
  size_t taken_ = 0;  // since the beginning
  uint32_t first_ = 0, last_ = 0;
  Triangles out_;
};

uint32_t LargestOf(int component) {
  return component == int(Component::kU8)    ? 0xffu
         : component == int(Component::kU16) ? 0xffffu
                                             : ~0u;
}

// Where nothing is left, why.
bool IsSomeLeft(const Triangles& triangles, std::span<const uint8_t> unusable,
                const std::string& place, Fault& fault) {
  if (!triangles.of.empty()) return true;
  if (triangles.first_nowhere)
    return fault.Say(place + " indices", Format("index {} is out of range ({} vertices)",
                                                *triangles.first_nowhere, unusable.size()));
  if (triangles.unusable)
    return fault.Say(place + " attribute POSITION",
                     Format("element {} is no finite number or lies beyond 1e15",
                            std::find(unusable.begin(), unusable.end(), 1) - unusable.begin()));
  return true;
}

}  // namespace

Triangles ReadTriangles(const Document& document, const Primitive& primitive,
                        std::span<const uint8_t> unusable, uint64_t limit, const std::string& place,
                        Fault& fault) {
  const std::string where = place + " indices";
  const bool indexed = primitive.indices != -1;
  const uint64_t corners =
      indexed ? CountElements(document, primitive.indices, where, fault) : unusable.size();
  if (fault) return {};
  if ((primitive.mode == kTriangles ? corners / 3 : corners) > limit) {
    fault.Say(where, "brings the file above the triangles that it has bytes for");
    return {};
  }
  Corners read{{}, ~0u, unusable};
  if (indexed) {
    read.index = ReadIntegers(document, primitive.indices, {1, kSetUnsigned, Scaling::kAsFlagged},
                              where, fault);
    if (fault) return {};
    read.restart = LargestOf(document.accessors[size_t(primitive.indices)].component);
  } else {
    read.index.resize(corners);
    std::iota(read.index.begin(), read.index.end(), 0u);
  }
  Triangles triangles = Assembler(read, primitive.mode).Assemble();
  if (!IsSomeLeft(triangles, unusable, place, fault)) return {};
  return triangles;
}

}  // namespace pelt::gltf
