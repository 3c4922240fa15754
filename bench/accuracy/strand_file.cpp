#include "bench/accuracy/strand_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "core/file_bytes.hpp"
#include "core/groom/nearest_word.hpp"
#include "core/groom/setup_schema.hpp"

namespace pelt::accuracy {
namespace {

constexpr std::string_view kKeys[] = {"length",  "links", "frequency_hz",  "stiffness",
                                      "rod",     "mass",  "damping_ratio", "drag",
                                      "gravity", "root",  "rest",          "start"};
constexpr size_t kMostBytes = 1u << 20;
constexpr double kMostFrequency = 2000.0;    // Hz
constexpr double kMostFastFrequency = 60e3;  // of the last mode: the exact motion has to follow it

struct Bounds {
  double low, high;
  std::string_view unit;
};

class StrandParser {
 public:
  StrandParser(std::string_view text, const std::string& path)
      : path_(path), table_(ParseToml(text, path)) {}

  StrandFile Parse() {
    CheckKeys();
    StrandFile file;
    ChainMaterial& m = file.material;
    m.links = int(Number("links", 3.0, {3.0, 8.0, ""}));
    if (const toml::node* links = table_.get("links"))
      if (!links->is_integer() || (m.links > 4 && m.links != 8))
        Fail(*links, "links", "expected 3, 4 or 8");
    if (!table_.contains("length")) Fail(table_, "length", "is needed and missing");
    const double length = Number("length", 0.0, {1e-4, 10.0, "m"});
    m.drag = Number("drag", 0.0, {0.0, 1000.0, "1/s"});
    m.gravity = Vector("gravity", m.gravity, 1000.0);
    file.strand.root = Vector("root", kZero3, 100.0);
    file.rod = ReadStiffness(length, m);
    ReadDamping(m);
    file.strand.rest.fill({0.0, 1.0, 0.0});
    if (const toml::node* rest = table_.get("rest"))
      file.strand.rest = Directions(*rest, "rest", m.links);
    ReadStart(file);
    return file;
  }

 private:
  [[noreturn]] void Fail(const toml::node& node, std::string_view key,
                         std::string_view reason) const {
    throw Error(fmt::format("{}:{}: key '{}': {}", path_,
                            std::max<uint32_t>(node.source().begin.line, 1), key, reason));
  }

  // In file order, so that the first mistake is told.
  void CheckKeys() const {
    const toml::key* wrong = nullptr;
    for (auto&& [key, node] : table_) {
      const bool known =
          std::find(std::begin(kKeys), std::end(kKeys), key.str()) != std::end(kKeys);
      if (!known && (!wrong || key.source().begin < wrong->source().begin)) wrong = &key;
    }
    if (!wrong) return;
    const std::string_view nearest = FindNearestWord(wrong->str(), kKeys);
    throw Error(fmt::format("{}:{}: unknown key '{}'; {}", path_,
                            std::max<uint32_t>(wrong->source().begin.line, 1),
                            wrong->str().substr(0, 64),
                            nearest.empty() ? fmt::format("the keys are {}", fmt::join(kKeys, ", "))
                                            : fmt::format("did you mean '{}'?", nearest)));
  }

  double ReadNumber(const toml::node& node, std::string_view key, const Bounds& bounds) const {
    if (!node.is_number()) Fail(node, key, "expected a number");
    const double value =
        node.is_integer() ? double(node.as_integer()->get()) : node.as_floating_point()->get();
    if (!std::isfinite(value)) Fail(node, key, "is not a finite number");
    if (value < bounds.low || value > bounds.high)
      Fail(node, key,
           fmt::format("{} is out of bounds; allowed are {} to {}{}{}", value, bounds.low,
                       bounds.high, bounds.unit.empty() ? "" : " ", bounds.unit));
    return value;
  }
  double Number(std::string_view key, double otherwise, const Bounds& bounds) const {
    const toml::node* node = table_.get(key);
    return node ? ReadNumber(*node, key, bounds) : otherwise;
  }

  const toml::array& List(const toml::node& node, std::string_view key, size_t count) const {
    if (!node.is_array()) Fail(node, key, fmt::format("expected a list of {}", count));
    const toml::array& array = *node.as_array();
    if (array.size() != count)
      Fail(node, key, fmt::format("has {} entries; {} are needed", array.size(), count));
    return array;
  }
  Double3 ReadVector(const toml::node& node, std::string_view key, double most) const {
    const toml::array& array = List(node, key, 3);
    const Bounds bounds = {-most, most, ""};
    return {ReadNumber(array[0], key, bounds), ReadNumber(array[1], key, bounds),
            ReadNumber(array[2], key, bounds)};
  }
  Double3 Vector(std::string_view key, Double3 otherwise, double most) const {
    const toml::node* node = table_.get(key);
    return node ? ReadVector(*node, key, most) : otherwise;
  }
  std::array<Double3, kMaxLinks> Directions(const toml::node& node, std::string_view key,
                                            int links) const {
    const toml::array& array = List(node, key, size_t(links));
    std::array<Double3, kMaxLinks> directions{};
    for (int i = 0; i < links; ++i) {
      const Double3 d = ReadVector(array[size_t(i)], key, 1e3);
      if (Length(d) < 1e-6) Fail(array[size_t(i)], key, "a direction is zero");
      directions[size_t(i)] = Unit(d);
    }
    return directions;
  }
  void ReadList(std::string_view key, int links, const Bounds& bounds,
                std::array<double, kMaxLinks>& values) const {
    const toml::array& array = List(*table_.get(key), key, size_t(links));
    for (int i = 0; i < links; ++i) values[size_t(i)] = ReadNumber(array[size_t(i)], key, bounds);
  }
  std::string_view Word(const toml::node& node, std::string_view key,
                        std::initializer_list<std::string_view> words) const {
    if (node.is_string())
      for (const std::string_view word : words)
        if (node.as_string()->get() == word) return word;
    Fail(node, key, fmt::format("expected one of \"{}\"", fmt::join(words, "\", \"")));
  }

  // Whether it is a rod.
  bool ReadStiffness(double length, ChainMaterial& m) const {
    const int links = m.links;
    const toml::node *frequency = table_.get("frequency_hz"), *stiffness = table_.get("stiffness");
    if (!frequency && !stiffness)
      Fail(table_, "frequency_hz", "is needed and missing; or give stiffness");
    if (frequency && stiffness)
      Fail(*stiffness, "stiffness", "stands beside frequency_hz; one of them, please");
    for (const std::string_view key : {"mass", "rod"})
      if (table_.contains(key) && (key == "mass") != (stiffness != nullptr))
        Fail(*table_.get(key), key,
             key == "mass" ? "goes with stiffness" : "goes with frequency_hz");
    if (frequency) {
      const toml::node* rod = table_.get("rod");
      const bool uniform = rod && Word(*rod, "rod", {"calibrated", "uniform"}) == "uniform";
      const double hz = ReadNumber(*frequency, "frequency_hz", {0.0, kMostFrequency, "Hz"});
      m = WithMaterial(uniform ? NaiveRod(links, length, length, 1.0 / length)
                               : CalibratedRod(links, length, length, 1.0 / length),
                       m);
      if (hz > 0.0)
        ScaleToFrequency(hz, m);
      else
        m.stiffness = {};
      return hz > 0.0 && !uniform;
    }
    for (int i = 0; i < links; ++i) {
      m.length[size_t(i)] = length / links;
      m.mass[size_t(i)] = 1.0 / links;
    }
    ReadList("stiffness", links, {0.0, 1e6, "N m"}, m.stiffness);
    if (table_.contains("mass")) ReadList("mass", links, {1e-9, 1e3, "kg"}, m.mass);
    const double fastest = MatricesOf(m).omega[size_t(links) - 1] / (2.0 * std::numbers::pi);
    if (!(fastest <= kMostFastFrequency))
      Fail(*stiffness, "stiffness",
           fmt::format("its fastest mode has {:.4g} Hz; allowed are {:g}", fastest,
                       kMostFastFrequency));
    return false;
  }
  // The rod, with what has been read already.
  static ChainMaterial WithMaterial(ChainMaterial rod, const ChainMaterial& read) {
    rod.drag = read.drag;
    rod.gravity = read.gravity;
    return rod;
  }

  void ReadDamping(ChainMaterial& m) const {
    const double ratio = Number("damping_ratio", 0.0, {0.0, 10.0, ""});
    const double omega = MatricesOf(m).omega[0];
    if (ratio > 0.0 && omega <= 0.0)
      Fail(*table_.get("damping_ratio"), "damping_ratio", "needs a stiffness that it damps");
    m.bending_damping = ratio > 0.0 ? 2.0 * ratio / omega : 0.0;
  }

  void ReadStart(StrandFile& file) const {
    const toml::node* start = table_.get("start");
    if (!start) return;
    if (start->is_array()) {
      file.start = StrandFile::Start::kGiven;
      file.given = Directions(*start, "start", file.material.links);
      return;
    }
    if (!start->is_string())
      Fail(*start, "start", "expected \"rest\", \"equilibrium\" or a list of directions");
    if (Word(*start, "start", {"rest", "equilibrium"}) == "equilibrium")
      file.start = StrandFile::Start::kEquilibrium;
  }

  const std::string& path_;
  toml::table table_;
};

}  // namespace

std::array<Double3, kMaxLinks> StrandFile::StartIn(const BodyPose& pose) const {
  if (start == Start::kGiven) return given;
  Strand turned = strand;
  for (Double3& rest : turned.rest) rest = pose.Turn(rest);
  return start == Start::kEquilibrium ? FindEquilibrium(material, turned) : turned.rest;
}

StrandFile ParseStrand(std::string_view text, const std::string& path) {
  if (text.size() > kMostBytes)
    throw Error(
        fmt::format("{}: {} bytes; a strand has at most {}", path, text.size(), kMostBytes));
  return StrandParser(text, path).Parse();
}

StrandFile ReadStrandFile(const std::string& path) {
  const std::vector<std::byte> bytes = ReadFileBytes("strand", path, kMostBytes).OrThrow();
  return ParseStrand(AsText(bytes), path);
}

}  // namespace pelt::accuracy
