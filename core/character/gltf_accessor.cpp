// Idea and invariant: see gltf_accessor.hpp. Numbers are assembled from bytes, so the host's byte
// order and alignment do not matter.
#include "core/character/gltf_accessor.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <tuple>

#include "core/error.hpp"
#include "core/float_rules.hpp"

namespace pelt::gltf {
namespace {

uint32_t SetOf(int component) {
  switch (Component(component)) {
    case Component::kF32:
      return kSetF32;
    case Component::kU8:
      return kSetU8;
    case Component::kU16:
      return kSetU16;
    case Component::kU32:
      return kSetU32;
    case Component::kI8:
      return kSetI8;
    case Component::kI16:
      return kSetI16;
  }
  return 0;
}

std::string NameOf(int component) {
  switch (Component(component)) {
    case Component::kF32:
      return "float";
    case Component::kU8:
      return "unsigned byte";
    case Component::kU16:
      return "unsigned short";
    case Component::kU32:
      return "unsigned int";
    case Component::kI8:
      return "byte";
    case Component::kI16:
      return "short";
  }
  return "component type " + std::to_string(component);
}

std::string TypeName(int components) {
  if (components == 1) return "SCALAR";
  if (components == 16) return "MAT4";
  return "VEC" + std::to_string(components);
}

uint64_t SizeOf(int component) {
  switch (Component(component)) {
    case Component::kU8:
    case Component::kI8:
      return 1;
    case Component::kU16:
    case Component::kI16:
      return 2;
    default:
      return 4;
  }
}

uint32_t ReadLittle(const unsigned char* p, uint64_t bytes) {
  uint32_t v = 0;
  for (uint64_t i = 0; i < bytes; ++i) v |= uint32_t(p[i]) << (8 * i);
  return v;
}

float ReadNumber(const unsigned char* p, int component, bool normalised) {
  switch (Component(component)) {
    case Component::kU8:
      return normalised ? float(p[0]) / 255.0f : float(p[0]);
    case Component::kU16: {
      const float v = float(ReadLittle(p, 2));
      return normalised ? v / 65535.0f : v;
    }
    case Component::kI8: {
      const float v = float(int8_t(p[0]));
      return normalised ? (v < -127.0f ? -1.0f : v / 127.0f) : v;
    }
    case Component::kI16: {
      const float v = float(int16_t(uint16_t(ReadLittle(p, 2))));
      return normalised ? (v < -32767.0f ? -1.0f : v / 32767.0f) : v;
    }
    case Component::kU32:
      return float(ReadLittle(p, 4));
    case Component::kF32:
      break;
  }
  const uint32_t bits = ReadLittle(p, 4);
  float v;
  std::memcpy(&v, &bits, sizeof v);
  return v;
}

// `count` elements of `element_bytes`, `stride` apart, known to lie inside view and buffer.
struct Range {
  const unsigned char* data = nullptr;  // null: zeros
  uint64_t stride = 0;
  const unsigned char* At(uint64_t i) const { return data + i * stride; }
};

class AccessorReader {
 public:
  AccessorReader(const Document& document, int accessor, const std::string& place, Fault& fault)
      : document_(document), place_(place), fault_(fault) {
    if (accessor < 0 || size_t(accessor) >= document.accessors.size()) {
      Refuse("accessor " + std::to_string(accessor) + " does not exist (the file has " +
             std::to_string(document.accessors.size()) + ")");
      return;
    }
    accessor_ = &document.accessors[size_t(accessor)];
    place_ += ": accessor " + std::to_string(accessor);
  }

  const Accessor& accessor() const { return *accessor_; }
  bool Refuse(const std::string& what) const { return fault_.Say(place_, what); }

  bool CheckType(const Wanted& wanted) const {
    if (!accessor_) return false;
    const bool matrix = wanted.components == 16;
    if (accessor_->components != wanted.components || accessor_->matrix != matrix)
      return Refuse("is not " + TypeName(wanted.components));
    if (!(SetOf(accessor_->component) & wanted.allowed))
      return Refuse("must not be of " + NameOf(accessor_->component));
    return true;
  }

  // Whether the accessor's elements, and its sparse ones, lie inside their buffers.
  bool CheckRange() {
    if (!accessor_) return false;
    const uint64_t element = SizeOf(accessor_->component) * uint64_t(accessor_->components);
    if (element == 0) return Refuse("is of no type that is known");
    if (accessor_->view >= 0) {
      if (!Locate(accessor_->view, accessor_->offset, accessor_->count, element, true, base_))
        return false;
    } else if (accessor_->count > document_.file_bytes) {
      // Elements without bytes: a count beyond the file's size can only be a mistake.
      return Refuse("has a count of " + std::to_string(accessor_->count) + " but no data");
    }
    return !accessor_->sparse.used || CheckSparse(element);
  }

  bool CheckSparse(uint64_t element) {
    const Sparse& sparse = accessor_->sparse;
    if (sparse.count < 0 || uint64_t(sparse.count) > accessor_->count)
      return Refuse("has " + std::to_string(sparse.count) + " sparse elements of " +
                    std::to_string(accessor_->count));
    if (sparse.index_offset < 0 || sparse.value_offset < 0)
      return Refuse("has a negative sparse byteOffset");
    if (!(SetOf(sparse.index_component) & (kSetU8 | kSetU16 | kSetU32)))
      return Refuse("sparse indices must not be of " + NameOf(sparse.index_component));
    return Locate(sparse.index_view, uint64_t(sparse.index_offset), uint64_t(sparse.count),
                  SizeOf(sparse.index_component), false, sparse_index_) &&
           Locate(sparse.value_view, uint64_t(sparse.value_offset), uint64_t(sparse.count), element,
                  false, sparse_value_);
  }

  // Calls use(element, first byte) for every element that has bytes, later ones replacing earlier,
  // until one is refused.
  template <class Use>
  bool ForEach(Use use) const {
    if (base_.data)
      for (uint64_t i = 0; i < accessor_->count; ++i)
        if (!use(i, base_.At(i))) return false;
    const Sparse& sparse = accessor_->sparse;
    for (int64_t s = 0; sparse.used && s < sparse.count; ++s) {
      const uint32_t i = ReadLittle(sparse_index_.At(uint64_t(s)), SizeOf(sparse.index_component));
      if (i >= accessor_->count)
        return Refuse("sparse index " + std::to_string(i) + " is out of range (count " +
                      std::to_string(accessor_->count) + ")");
      if (!use(i, sparse_value_.At(uint64_t(s)))) return false;
    }
    return true;
  }

  // Every component as take(accessor, element, first byte, component) makes it; 0 where there are no bytes, and
  // none at all once one is refused.
  template <class T, class Take>
  std::vector<T> Read(const Wanted& wanted, Take take) {
    if (!CheckType(wanted) || !CheckRange()) return {};
    const auto n = uint64_t(wanted.components), size = SizeOf(accessor_->component);
    std::vector<T> out(accessor_->count * n, T(0));
    const bool whole = ForEach([&](uint64_t element, const unsigned char* p) {
      for (uint64_t c = 0; c < n; ++c)
        if (!take(*accessor_, element, p + size * c, out[element * n + c])) return false;
      return true;
    });
    if (!whole) out.clear();
    return out;
  }

 private:
  bool Locate(int view_index, uint64_t offset, uint64_t count, uint64_t element, bool strided,
              Range& range) const {
    if (view_index < 0 || size_t(view_index) >= document_.views.size())
      return Refuse("bufferView " + std::to_string(view_index) + " does not exist");
    const View& view = document_.views[size_t(view_index)];
    const std::string where = "bufferView " + std::to_string(view_index);
    if (view.buffer < 0 || size_t(view.buffer) >= document_.buffers.size())
      return Refuse(where + ": buffer " + std::to_string(view.buffer) + " does not exist");
    if (const std::string& fault = document_.buffer_faults[size_t(view.buffer)]; !fault.empty())
      return Refuse("buffer " + std::to_string(view.buffer) + ": " + fault);
    const std::vector<unsigned char>& buffer = document_.buffers[size_t(view.buffer)];
    if (view.offset > buffer.size())
      return Refuse(where + " reaches past the end of buffer " + std::to_string(view.buffer) +
                    " (" + std::to_string(buffer.size()) + " bytes)");
    // As far as there is something: some say more than they have.
    const uint64_t length = std::min<uint64_t>(view.length, buffer.size() - view.offset);
    const uint64_t stride = strided && view.stride ? view.stride : element;
    if (stride > 0x7fffffff) return Refuse(where + ": byteStride is no size");
    if (stride < element)
      return Refuse(where + ": byteStride " + std::to_string(stride) +
                    " is smaller than an element (" + std::to_string(element) + " bytes)");
    range = {buffer.data(), stride};
    if (count == 0) return true;
    // Last byte at offset + stride * (count - 1) + element, without overflow.
    const bool fits = offset <= length && element <= length - offset &&
                      count - 1 <= (length - offset - element) / stride;
    if (!fits)
      return Refuse(std::to_string(count) + " elements from byte " + std::to_string(offset) +
                    " reach past the end of " + where + " (" + std::to_string(length) + " bytes)");
    range.data += view.offset + offset;
    return true;
  }

  const Document& document_;
  std::string place_;
  Fault& fault_;
  const Accessor* accessor_ = nullptr;
  Range base_, sparse_index_, sparse_value_;
};

}  // namespace

void Fail(const Document& document, const std::string& place, const std::string& what) {
  throw Error(document.name + ": " + place + ": " + what);
}

uint64_t CountElements(const Document& document, int accessor, const std::string& place,
                       Fault& fault) {
  AccessorReader reader(document, accessor, place, fault);
  return reader.CheckRange() ? reader.accessor().count : 0;
}

std::vector<int> FindSameAccessors(const Document& document) {
  std::map<std::tuple<int, uint64_t, uint64_t, int, int, bool, bool>, int> first;
  std::vector<int> same;
  for (int a = 0; const Accessor& of : document.accessors) {
    const auto [known, is_new] = first.try_emplace(
        {of.view, of.offset, of.count, of.component, of.components, of.matrix, of.normalised}, a);
    same.push_back(of.sparse.used ? a : known->second);
    if (is_new && of.sparse.used) first.erase(known);
    ++a;
  }
  return same;
}

std::vector<float> ReadFloats(const Document& document, int accessor, const Wanted& wanted,
                              const std::string& place, Fault& fault) {
  AccessorReader reader(document, accessor, place, fault);
  return reader.Read<float>(
      wanted, [&](const Accessor& from, uint64_t element, const unsigned char* p, float& out) {
        const bool normalised = wanted.scaling == Scaling::kNormalised || from.normalised;
        out = ReadNumber(p, from.component, normalised);
        return !wanted.finite || std::isfinite(out) ||
               reader.Refuse("element " + std::to_string(element) + " is not a finite number");
      });
}

std::vector<uint32_t> ReadIntegers(const Document& document, int accessor, const Wanted& wanted,
                                   const std::string& place, Fault& fault) {
  return AccessorReader(document, accessor, place, fault)
      .Read<uint32_t>(wanted,
                      [](const Accessor& from, uint64_t, const unsigned char* p, uint32_t& out) {
                        out = ReadLittle(p, SizeOf(from.component));
                        return true;
                      });
}

}  // namespace pelt::gltf
