#include "bench/accuracy/recorded_root.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>

#include "bench/accuracy/jet.hpp"
#include "core/error.hpp"
#include "core/file_bytes.hpp"
#include "core/groom/nearest_word.hpp"

namespace pelt::accuracy {
namespace {

constexpr std::string_view kColumns[] = {
    "time",       "x",          "y",      "z",      "qx",     "qy",
    "qz",         "qw",         "wind_x", "wind_y", "wind_z", "velocity_x",
    "velocity_y", "velocity_z", "spin_x", "spin_y", "spin_z"};
// Groups of columns, each from here to the next: wind and velocities may be left out.
constexpr size_t kNeeded = 8, kWindEnd = 11;
constexpr double kMostCoordinate = 1e6;
constexpr double kUnitTolerance = 1e-3;

std::string_view Trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

// Text from outside, for a message: short, and no control characters.
std::string Shown(std::string_view text) {
  std::string shown(text.substr(0, 40));
  for (char& c : shown)
    if (static_cast<unsigned char>(c) < 32 || c == 127) c = '?';
  return shown;
}

std::vector<std::string_view> SplitCells(std::string_view line) {
  std::vector<std::string_view> cells;
  for (size_t at = 0; at <= line.size();) {
    const size_t comma = std::min(line.find(',', at), line.size());
    cells.push_back(Trimmed(line.substr(at, comma - at)));
    at = comma + 1;
  }
  return cells;
}

class RootsParser {
 public:
  RootsParser(std::string_view text, const std::string& path) : text_(text), path_(path) {}

  std::vector<RootSample> Parse() {
    std::string_view line;
    if (!NextLine(line)) Fail("is empty; expected a header row: time,x,y,z,qx,qy,qz,qw");
    ReadHeader(SplitCells(line));
    std::vector<RootSample> samples;
    while (NextLine(line)) {
      if (samples.size() == kMostSamples)
        Fail(fmt::format("more than {} rows; cut the recording", kMostSamples));
      samples.push_back(ReadRow(SplitCells(line)));
      if (samples.size() > 1) CheckTime(samples);
    }
    if (samples.size() < 2)
      Fail(fmt::format("{} pose{}; at least two are needed", samples.size(),
                       samples.size() == 1 ? "" : "s"));
    return samples;
  }

 private:
  [[noreturn]] void Fail(std::string_view reason) const {
    throw Error(fmt::format("{}:{}: {}", path_, std::max<size_t>(line_, 1), reason));
  }

  // The next line that is not blank.
  bool NextLine(std::string_view& line) {
    while (at_ < text_.size()) {
      const size_t end = std::min(text_.find('\n', at_), text_.size());
      line = Trimmed(text_.substr(at_, end - at_));
      at_ = end + 1;
      ++line_;
      if (!line.empty()) return true;
    }
    return false;
  }

  void ReadHeader(const std::vector<std::string_view>& cells) {
    place_.fill(kAbsent);
    for (size_t c = 0; c < cells.size(); ++c) {
      const auto known = std::find(std::begin(kColumns), std::end(kColumns), cells[c]);
      if (known == std::end(kColumns)) {
        const std::string_view nearest = FindNearestWord(cells[c], kColumns);
        Fail(fmt::format("unknown column '{}'; {}", Shown(cells[c]),
                         nearest.empty()
                             ? fmt::format("the columns are {}", fmt::join(kColumns, ","))
                             : fmt::format("did you mean '{}'?", nearest)));
      }
      size_t& place = place_[size_t(known - std::begin(kColumns))];
      if (place != kAbsent) Fail(fmt::format("column '{}' stands there twice", *known));
      place = c;
    }
    Require(0, kNeeded);
    if (HasAny(kNeeded, kWindEnd)) Require(kNeeded, kWindEnd);
    rated_ = HasAny(kWindEnd, place_.size());
    if (rated_) Require(kWindEnd, place_.size());
    columns_ = cells.size();
  }

  bool HasAny(size_t begin, size_t end) const {
    return std::any_of(place_.begin() + ptrdiff_t(begin), place_.begin() + ptrdiff_t(end),
                       [](size_t place) { return place != kAbsent; });
  }
  void Require(size_t begin, size_t end) const {
    for (size_t k = begin; k < end; ++k)
      if (place_[k] == kAbsent) Fail(fmt::format("column '{}' is missing", kColumns[k]));
  }

  double ReadCell(std::string_view cell, size_t column) const {
    double value = 0.0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc() || end != cell.data() + cell.size())
      Fail(fmt::format("column '{}': '{}' is not a number", kColumns[column], Shown(cell)));
    if (!std::isfinite(value))
      Fail(fmt::format("column '{}': {} is not finite", kColumns[column], Shown(cell)));
    if (std::abs(value) > kMostCoordinate)
      Fail(fmt::format("column '{}': {} is beyond {}", kColumns[column], value, kMostCoordinate));
    return value;
  }

  RootSample ReadRow(const std::vector<std::string_view>& cells) const {
    if (cells.size() != columns_)
      Fail(fmt::format("{} cells, but the header has {} columns{}", cells.size(), columns_,
                       at_ >= text_.size() ? "; is the file cut off?" : ""));
    std::array<double, std::size(kColumns)> value{};
    for (size_t k = 0; k < value.size(); ++k)
      if (place_[k] != kAbsent) value[k] = ReadCell(cells[place_[k]], k);
    RootSample sample{value[0],
                      {value[1], value[2], value[3]},
                      {value[4], value[5], value[6], value[7]},
                      {value[8], value[9], value[10]},
                      rated_,
                      {value[11], value[12], value[13]},
                      {value[14], value[15], value[16]}};
    double square = 0.0;
    for (const double part : sample.quaternion) square += part * part;
    const double length = std::sqrt(square);
    if (std::abs(length - 1.0) > kUnitTolerance)
      Fail(fmt::format("the quaternion's length is {:.6g}; expected 1", length));
    for (double& part : sample.quaternion) part /= length;
    return sample;
  }

  void CheckTime(const std::vector<RootSample>& samples) const {
    const double now = samples.back().seconds, before = samples[samples.size() - 2].seconds;
    if (!(now > before)) Fail(fmt::format("time {} does not come after {}", now, before));
    if (now - before > kMostFrameSeconds || now - before < kLeastFrameSeconds)
      Fail(fmt::format("a frame of {:.6g} s; allowed are {} to {} s", now - before,
                       kLeastFrameSeconds, kMostFrameSeconds));
  }

  static constexpr size_t kAbsent = ~size_t{0};
  std::string_view text_;
  const std::string& path_;
  size_t at_ = 0, line_ = 0, columns_ = 0;
  bool rated_ = false;
  std::array<size_t, std::size(kColumns)> place_{};
};

// 1 / a.
Jet Reciprocal(Jet a) {
  const double f = 1.0 / a.value;
  return Chain(a, f, -f * f, 2.0 * f * f * f);
}

// The columns of the rotation of a quaternion of any length.
void TurnBy(const Jet (&q)[4], BodyPose& pose) {
  const Jet &x = q[0], &y = q[1], &z = q[2], &w = q[3];
  const Jet square = x * x + y * y + z * z + w * w, two = Jet(2.0) * Reciprocal(square);
  const Jet one = 1.0;
  const Jet column[3][3] = {
      {one - two * (y * y + z * z), two * (x * y + w * z), two * (x * z - w * y)},
      {two * (x * y - w * z), one - two * (x * x + z * z), two * (y * z + w * x)},
      {two * (x * z + w * y), two * (y * z - w * x), one - two * (x * x + y * y)}};
  for (int k = 0; k < 3; ++k) {
    pose.axis[k] = {column[k][0].value, column[k][1].value, column[k][2].value};
    pose.axis_rate[k] = {column[k][0].rate, column[k][1].rate, column[k][2].rate};
    pose.axis_bend[k] = {column[k][0].bend, column[k][1].bend, column[k][2].bend};
  }
}

}  // namespace

std::vector<RootSample> ParseRoots(std::string_view text, const std::string& path) {
  return RootsParser(text, path).Parse();
}

std::vector<RootSample> ReadRootsFile(const std::string& path) {
  const std::vector<std::byte> bytes = ReadFileBytes("recorded root", path).OrThrow();
  return ParseRoots(AsText(bytes), path);
}

std::string RootsText(const std::vector<RootSample>& samples) {
  const bool rated = !samples.empty() && samples[0].rated;
  const std::span columns = std::span(kColumns).first(rated ? std::size(kColumns) : kWindEnd);
  std::string text = fmt::format("{}\n", fmt::join(columns, ","));
  for (const RootSample& s : samples) {
    std::vector<double> row = {s.seconds,       s.position.x,    s.position.y,    s.position.z,
                               s.quaternion[0], s.quaternion[1], s.quaternion[2], s.quaternion[3],
                               s.wind.x,        s.wind.y,        s.wind.z};
    if (rated)
      row.insert(row.end(),
                 {s.velocity.x, s.velocity.y, s.velocity.z, s.spin.x, s.spin.y, s.spin.z});
    text += fmt::format("{:.9g}\n", fmt::join(row, ","));
  }
  return text;
}

RootSample SampleOf(const BodyPose& pose, double seconds, bool rated) {
  const double m[3][3] = {{pose.axis[0].x, pose.axis[1].x, pose.axis[2].x},
                          {pose.axis[0].y, pose.axis[1].y, pose.axis[2].y},
                          {pose.axis[0].z, pose.axis[1].z, pose.axis[2].z}};
  // Each part's square from the diagonal; the others from the largest, which is at least 1/2.
  const double square[4] = {
      0.25 * (1.0 + m[0][0] - m[1][1] - m[2][2]), 0.25 * (1.0 - m[0][0] + m[1][1] - m[2][2]),
      0.25 * (1.0 - m[0][0] - m[1][1] + m[2][2]), 0.25 * (1.0 + m[0][0] + m[1][1] + m[2][2])};
  const size_t largest = size_t(std::max_element(square, square + 4) - square);
  // Four times the products of two parts: [x y z w][x y z w].
  const double product[4][4] = {{0.0, m[0][1] + m[1][0], m[0][2] + m[2][0], m[2][1] - m[1][2]},
                                {m[0][1] + m[1][0], 0.0, m[1][2] + m[2][1], m[0][2] - m[2][0]},
                                {m[0][2] + m[2][0], m[1][2] + m[2][1], 0.0, m[1][0] - m[0][1]},
                                {m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1], 0.0}};
  RootSample sample{seconds, pose.position, {}, pose.wind};
  const double root = std::sqrt(square[largest]);
  for (size_t k = 0; k < 4; ++k)
    sample.quaternion[k] = k == largest ? root : 0.25 * product[largest][k] / root;
  sample.rated = rated;
  if (!rated) return sample;
  sample.velocity = pose.velocity;
  sample.spin = SpinOf(pose);
  return sample;
}

BodyPose PoseOf(const RootSample& sample) {
  BodyPose pose{};
  pose.position = sample.position;
  pose.wind = sample.wind;
  Jet q[4];
  for (size_t k = 0; k < 4; ++k) q[k] = sample.quaternion[k];
  TurnBy(q, pose);
  pose.velocity = sample.velocity;
  for (int k = 0; k < 3; ++k) pose.axis_rate[k] = Cross(sample.spin, pose.axis[k]);
  return pose;
}

RootSpline::RootSpline(std::vector<RootSample> samples) : samples_(std::move(samples)) {
  for (const RootSample& s : samples_) {
    Row row = {s.position.x,    s.position.y,    s.position.z,   s.quaternion[0],
               s.quaternion[1], s.quaternion[2], s.quaternion[3]};
    // q and -q are one rotation: take the nearer one.
    double along = 0.0;
    for (size_t k = 3; k < 7 && !value_.empty(); ++k) along += row[k] * value_.back()[k];
    if (along < 0.0)
      for (size_t k = 3; k < 7; ++k) row[k] = -row[k];
    value_.push_back(row);
    // q' = spin q / 2, the spin a quaternion without a real part.
    const Double3 v = {row[3], row[4], row[5]};
    const Double3 turn = (s.spin * row[6] + Cross(s.spin, v)) * 0.5;
    rate_.push_back(
        {s.velocity.x, s.velocity.y, s.velocity.z, turn.x, turn.y, turn.z, -0.5 * Dot(s.spin, v)});
  }
  if (!samples_[0].rated) FindBends();
}

void RootSpline::FindBends() {
  const size_t count = samples_.size();
  // Second derivatives: tridiagonal, begin at rest (slope 0), end without bend.
  bend_.assign(count, Row{});
  std::vector<double> upper(count, 0.0);
  const auto dt = [&](size_t frame) {
    return samples_[frame].seconds - samples_[frame - 1].seconds;
  };
  const auto slope = [&](size_t frame, size_t k) {
    return (value_[frame][k] - value_[frame - 1][k]) / dt(frame);
  };
  upper[0] = 0.5;
  for (size_t k = 0; k < 7; ++k) bend_[0][k] = 3.0 * slope(1, k) / dt(1);
  for (size_t i = 1; i + 1 < count; ++i) {
    const double left = dt(i), right = dt(i + 1);
    const double pivot = 2.0 * (left + right) - left * upper[i - 1];
    upper[i] = right / pivot;
    for (size_t k = 0; k < 7; ++k)
      bend_[i][k] = (6.0 * (slope(i + 1, k) - slope(i, k)) - left * bend_[i - 1][k]) / pivot;
  }
  for (size_t i = count - 1; i-- > 0;)
    for (size_t k = 0; k < 7; ++k) bend_[i][k] -= upper[i] * bend_[i + 1][k];
}

size_t RootSpline::Frame(double seconds) const {
  const auto after =
      std::upper_bound(samples_.begin(), samples_.end(), seconds,
                       [](double t, const RootSample& sample) { return t < sample.seconds; });
  return std::clamp<size_t>(size_t(after - samples_.begin()), 1, samples_.size() - 1);
}

BodyPose RootSpline::At(double seconds, size_t frame) const {
  const RootSample &before = samples_[frame - 1], &after = samples_[frame];
  if (seconds < samples_.front().seconds) return PoseOf(samples_.front());
  if (seconds > samples_.back().seconds) return PoseOf(samples_.back());
  const double h = after.seconds - before.seconds;
  const double b = (seconds - before.seconds) / h, a = 1.0 - b;
  Jet part[7];
  for (size_t k = 0; k < 7; ++k) {
    const double from = value_[frame - 1][k], to = value_[frame][k];
    if (before.rated) {
      const double out = rate_[frame - 1][k] * h, in = rate_[frame][k] * h, step = to - from;
      const double c2 = 3.0 * step - 2.0 * out - in, c3 = out + in - 2.0 * step;
      part[k].value = from + b * (out + b * (c2 + b * c3));
      part[k].rate = (out + b * (2.0 * c2 + b * 3.0 * c3)) / h;
      part[k].bend = (2.0 * c2 + b * 6.0 * c3) / (h * h);
      continue;
    }
    const double m = bend_[frame - 1][k], n = bend_[frame][k];
    part[k].value = a * from + b * to + ((a * a * a - a) * m + (b * b * b - b) * n) * h * h / 6.0;
    part[k].rate = (to - from) / h + ((1.0 - 3.0 * a * a) * m + (3.0 * b * b - 1.0) * n) * h / 6.0;
    part[k].bend = a * m + b * n;
  }
  BodyPose pose{};
  pose.position = {part[0].value, part[1].value, part[2].value};
  pose.velocity = {part[0].rate, part[1].rate, part[2].rate};
  pose.acceleration = {part[0].bend, part[1].bend, part[2].bend};
  const Jet q[4] = {part[3], part[4], part[5], part[6]};
  TurnBy(q, pose);
  pose.wind = before.wind + (after.wind - before.wind) * b;
  return pose;
}

}  // namespace pelt::accuracy
