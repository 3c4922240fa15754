#include "bench/accuracy/quantisation.hpp"

#include <cmath>

#include "bench/accuracy/modal_solver.hpp"
#include "bench/accuracy/packing.hpp"
#include "bench/accuracy/solver_run.hpp"

namespace pelt::accuracy {
namespace {

constexpr int kRate = 60;
constexpr double kBox_m = 2.0;  // a character's
// The default layer's state: that of ModalStateBlock, a float each.
constexpr int kStateFloats[] = {61, 77};

struct StateRow {
  StateFormat format;
  const char* what;
  int half_floats[2];  // of the state's, 3 and 4 links
};
constexpr StateRow kStates[] = {
    {StateFormat::kHalf, "state, all of it half floats", {61, 77}},
    {StateFormat::kSignedAndHalf, "state, half floats, directions 16 bits signed", {61, 77}},
    {StateFormat::kHalfHistory, "state, half floats but for directions and speeds", {43, 53}}};

// What is read back of a place, m: a character's middle, a root from there, a point from its root;
// the last again.
using Packed = double(double middle, double root, double point);
struct PlaceRow {
  const char* what;
  int bytes;
  Packed* packed;
};
constexpr PlaceRow kPlaces[] = {
    {"places, floats, as written", 12,
     [](double m, double r, double p) { return double(float(m + r + p)) - (m + r); }},
    {"places, half floats", 6,
     [](double m, double r, double p) { return double(RoundHalf(float(m + r + p))) - (m + r); }},
    {"places, half floats from the character's middle", 6,
     [](double, double r, double p) { return double(RoundHalf(float(r + p))) - r; }},
    {"places, 16 bits over a box of 2 m around it", 6,
     [](double, double r, double p) {
       return RoundWithin16(r + p, -0.5 * kBox_m, 0.5 * kBox_m) - r;
     }},
    {"places, half floats from the root", 6,
     [](double, double, double p) { return double(RoundHalf(float(p))); }}};

Double3 Each(Double3 middle, Double3 root, Double3 p, Packed* packed) {
  return {packed(middle.x, root.x, p.x), packed(middle.y, root.y, p.y),
          packed(middle.z, root.z, p.z)};
}

struct Sums {
  double off = 0.0, moved = 0.0, shares = 0.0, worst = 0.0;
  int64_t points = 0;

  void Add(double distance, double length, double secondary) {
    off += distance * distance;
    shares += distance * distance / (length * length);
    moved += secondary * secondary;
    worst = std::max(worst, distance);
    ++points;
  }
  void Fill(QuantisationRow& row) const {
    row.rms_m = std::sqrt(off / double(points));
    row.worst_m = worst;
    row.of_length = std::sqrt(shares / double(points));
    row.of_secondary = std::sqrt(off / moved);
  }
};

struct AllSums {
  Sums state[std::size(kStates)], place[std::size(kPlaces)], tangent;
};

// The strands of one motion and material, with the state as it is and in every format.
void RunMotion(const QuantisationOptions& options, const Preset& preset, int motion, Isa isa,
               AllSums& sums) {
  Preset scaled = preset;
  scaled.length *= DrawLengthScale(options.drawn.seed, motion);
  const ChainMaterial material = MakeMaterial(scaled, options.links, Coefficients::kCalibrated);
  const std::vector<Strand> strands =
      DrawStrands(options.links, options.strands, options.drawn.seed, motion);
  const BodyMotion body = DrawMotion(options.drawn.seed, motion);
  std::vector<LinkDirections> start;
  for (const Strand& strand : strands) start.push_back(FindEquilibrium(material, strand));
  const ModalKernels kernels = ModalKernelsOf(isa);
  const auto run_of = [&](StateFormat format) {
    return SolverRun(ModalFactory(kernels, ModalQuality::kFine, {.state = format}), material,
                     1.0 / kRate, strands, start, body(0.0));
  };
  SolverRun plain = run_of(StateFormat::kFloat);
  std::vector<SolverRun> packed;
  for (const StateRow& row : kStates) packed.push_back(run_of(row.format));
  const double length = material.TotalLength();
  const int frames = int(options.seconds * kRate + 1e-9);
  for (int frame = 1; frame <= frames; ++frame) {
    const BodyPose pose = body(double(frame) / kRate);
    plain.Step(pose);
    for (SolverRun& run : packed) run.Step(pose);
    for (size_t s = 0; s < strands.size(); ++s) {
      const Double3 root = pose.Place(strands[s].root) - pose.position;
      Double3 rigid = kZero3, above = kZero3;
      for (int i = 0; i < options.links; ++i) {
        const Double3 point = plain.Point(s, i), link = point - above;
        rigid = rigid + pose.Turn(start[s][size_t(i)]) * material.length[size_t(i)];
        const double secondary = Length(point - rigid);
        for (size_t r = 0; r < packed.size(); ++r)
          sums.state[r].Add(Length(packed[r].Point(s, i) - point), length, secondary);
        for (size_t r = 0; r < std::size(kPlaces); ++r)
          sums.place[r].Add(Length(Each(pose.position, root, point, kPlaces[r].packed) - point),
                            length, secondary);
        const Double3 tangent = Unit(link);
        const Double3 read = {RoundSigned16(float(tangent.x)), RoundSigned16(float(tangent.y)),
                              RoundSigned16(float(tangent.z))};
        sums.tangent.Add(Length(read - tangent), 1.0, 1.0);
        above = point;
      }
    }
  }
}

}  // namespace

std::vector<QuantisationRow> MeasureQuantisation(const QuantisationOptions& options, Isa isa) {
  AllSums sums;
  for (const Preset& preset : options.presets)
    for (int motion = 0; motion < options.drawn.motions; ++motion)
      RunMotion(options, preset, motion, isa, sums);
  const size_t kind = options.links == 3 ? 0 : 1;
  std::vector<QuantisationRow> rows;
  for (size_t r = 0; r < std::size(kStates); ++r) {
    QuantisationRow& row = rows.emplace_back();
    row.what = kStates[r].what;
    row.bytes = 4 * kStateFloats[kind] - 2 * kStates[r].half_floats[kind];
    sums.state[r].Fill(row);
  }
  for (size_t r = 0; r < std::size(kPlaces); ++r) {
    QuantisationRow& row = rows.emplace_back();
    row.what = kPlaces[r].what;
    row.bytes = kPlaces[r].bytes;
    sums.place[r].Fill(row);
  }
  QuantisationRow& row = rows.emplace_back();
  row.what = "tangents of lines, 16 bits signed, as written";
  row.bytes = 6;
  sums.tangent.Fill(row);
  row.rms_m = row.worst_m = row.of_secondary = 0.0;
  return rows;
}

}  // namespace pelt::accuracy
