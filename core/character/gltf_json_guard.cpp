// Idea and invariant: see gltf_json_guard.hpp.
#include "core/character/gltf_json_guard.hpp"

#include <string_view>

namespace pelt::gltf {
namespace {

constexpr std::string_view kNotOurs[] = {"images",  "textures",   "samplers",
                                         "cameras", "extensions", "extras"};

class JsonGuard {
 public:
  explicit JsonGuard(std::span<char> json) : json_(json) {}

  std::string Check() {
    for (; at_ < json_.size(); ++at_) {
      const char c = json_[at_];
      if (c == '"') {
        if (!String()) return reason_;
      } else if (c == '{' || c == '[') {
        if (!Open(c)) return reason_;
      } else if (c == '}' || c == ']') {
        if (!Close()) return reason_;
      } else if (c == ':') {
        value_ = true;
      } else if (c == ',') {
        value_ = false;
      }
    }
    return {};
  }

 private:
  // depth_ 1: members of the root; in buffers_, depth_ 3: members of one buffer.
  bool String() {
    const size_t start = at_ + 1;
    bool escaped = false;
    for (at_ = start; at_ < json_.size() && json_[at_] != '"'; ++at_) {
      if (json_[at_] == '\\') {
        escaped = true;
        ++at_;
      }
    }
    if (at_ >= json_.size()) return true;  // unterminated: the parser says so
    const std::string_view text(json_.data() + start, at_ - start);
    const bool key = !value_ && !in_array_;
    if (key && depth_ == 1) {
      if (escaped) return Refuse("an escaped member name");
      in_buffers_ = text == "buffers";
      for (std::string_view name : kNotOurs)
        if (text == name) json_[start] = '~';
    }
    if (in_buffers_ && depth_ == 3) {
      if (key && escaped) return Refuse("an escaped member name");
      if (key) uri_ = text == "uri";
      if (uri_) has_uri_ = !key && !text.empty();  // the last of several wins
    }
    return true;
  }

  bool Open(char c) {
    if (++depth_ > kMaxJsonDepth) return Refuse("values nested too deep");
    in_array_ = c == '[';
    arrays_[depth_] = in_array_;
    value_ = false;
    if (in_buffers_ && depth_ == 3) has_uri_ = uri_ = false;
    return true;
  }

  bool Close() {
    if (in_buffers_ && depth_ == 3) {
      if (++buffers_ > kMaxBuffers) return Refuse("more than 256 buffers");
      if (!has_uri_ && ++without_uri_ > 1)
        return Refuse("a second buffer without a uri (only the first can be the binary chunk)");
    }
    if (depth_ > 0) --depth_;
    in_array_ = arrays_[depth_];
    value_ = false;
    return true;
  }

  bool Refuse(const char* what) {
    reason_ = "JSON byte " + std::to_string(at_) + ": " + what;
    return false;
  }

  std::span<char> json_;
  size_t at_ = 0;
  int depth_ = 0;
  bool arrays_[kMaxJsonDepth + 1] = {};
  bool in_array_ = false;
  bool value_ = false;  // after a colon
  bool in_buffers_ = false, uri_ = false, has_uri_ = false;
  int buffers_ = 0, without_uri_ = 0;
  std::string reason_;
};

}  // namespace

std::string GuardJson(std::span<char> json) { return JsonGuard(json).Check(); }

}  // namespace pelt::gltf
