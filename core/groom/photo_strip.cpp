#include "core/groom/photo_strip.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/error.hpp"
#include "core/float_rules.hpp"
#include "core/format.hpp"

namespace pelt {
namespace {

constexpr uint32_t kMostSide = 8192;  // of a picture that can be read
constexpr uint8_t kSeen = 8;          // of 255: fainter alpha is noise

// Columns of the photograph, and its hairs there.
struct Tuft {
  uint32_t left, right;             // the last one not included
  uint32_t top = 0;                 // row of the roots
  std::vector<double> middle = {};  // of each row from there to the tips
  double half = 0.0;                // how far hairs reach from it
};

uint8_t AlphaAt(const ControlMap& photo, uint32_t x, uint32_t y) {
  const uint8_t alpha = photo.rgba[(size_t(y) * photo.width + x) * 4 + 3];
  return alpha < kSeen ? uint8_t(0) : alpha;
}

Tuft FindTuft(const ControlMap& photo, uint32_t left, uint32_t right) {
  Tuft tuft{left, right};
  size_t rows = 0;  // down to the last that has hairs
  for (uint32_t y = 0; y < photo.height; ++y) {
    double sum = 0.0, moment = 0.0;
    for (uint32_t x = left; x < right; ++x) {
      sum += AlphaAt(photo, x, y);
      moment += AlphaAt(photo, x, y) * (double(x) + 0.5);
    }
    if (sum == 0.0 && tuft.middle.empty()) continue;
    if (tuft.middle.empty()) tuft.top = y;
    tuft.middle.push_back(sum > 0.0 ? moment / sum : tuft.middle.back());
    if (sum > 0.0) rows = tuft.middle.size();
    for (uint32_t x = left; x < right; ++x)
      if (AlphaAt(photo, x, y))
        tuft.half = std::max(tuft.half, std::abs(double(x) + 0.5 - tuft.middle.back()) + 0.5);
  }
  tuft.middle.resize(rows);
  return tuft;
}

// Of a texel of its strip, at these shares of it.
uint8_t Straighten(const ControlMap& photo, const Tuft& tuft, double across, double along) {
  const size_t line = size_t(along * double(tuft.middle.size()));
  const double x = tuft.middle[line] + 2.0 * tuft.half * (across - 0.5);
  if (x < tuft.left || x >= tuft.right) return 0;
  const glm::vec2 place(x / photo.width, (double(tuft.top + line) + 0.5) / photo.height);
  return uint8_t(255.0f * photo.Sample(place, 3, {Wrap::kClamp, Wrap::kClamp}) + 0.5f);
}

}  // namespace

StrandTexture CutStrips(const ControlMap& photo, uint32_t strips, const std::string& name) {
  if (strips < 1 || strips > 256 || strips > photo.width)
    throw Error(Format("'{}': {} strips; 1 to 256 are allowed, of a pixel or more", name, strips));
  std::vector<Tuft> tufts;
  double wide = 1.0;
  size_t rows = 1;
  for (uint32_t s = 0; s < strips; ++s) {
    tufts.push_back(FindTuft(photo, photo.width * s / strips, photo.width * (s + 1) / strips));
    const Tuft& tuft = tufts.back();
    if (tuft.middle.empty())
      throw Error(
          Format("'{}': nothing in piece {} of {}, columns {} to {}: alpha is below {} of "
                 "255 there",
                 name, s + 1, strips, tuft.left, tuft.right - 1, kSeen));
    wide = std::max(wide, 2.0 * tuft.half);
    rows = std::max(rows, tuft.middle.size());
  }
  uint32_t width = std::bit_ceil(uint32_t(std::ceil(wide))), height = std::bit_ceil(uint32_t(rows));
  while (strips * width > kMostSide ||
         uint64_t(strips) * width * height * 4 > kStrandTextureBytes) {
    width = std::max(width / 2, 1u);
    height = std::max(height / 2, 1u);
  }
  StrandTexture made;
  made.width = strips * width;
  made.height = height;
  made.strips = strips;
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < made.width; ++x) {
      const double across = (x % width + 0.5) / width, along = (y + 0.5) / height;
      made.rgba.insert(made.rgba.end(),
                       {0, 0, 0, Straighten(photo, tufts[x / width], across, along)});
    }
  return made;
}

}  // namespace pelt
