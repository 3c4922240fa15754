// Links, nodes and the rod as a CurveStrand.
#include <fmt/format.h>

#include <algorithm>

#include "bench/accuracy/curve_motion.hpp"

namespace pelt::accuracy {
namespace {

// Whether layers have chains of so many.
bool IsOfLayers(int links) { return links == 3 || links == 4 || links == 8; }

// Of each joint over B / L, of each point over rho L; the midpoint rule: the clamp is half a link from the
// middle of the first, the tip bears half a link.
void FillLinks(int n, UnknownRow& stiffness, UnknownRow& mass) {
  for (size_t i = 0; i < size_t(n); ++i) {
    stiffness[i] = (i == 0 ? 2.0 : 1.0) * n;
    mass[i] = (int(i) + 1 == n ? 0.5 : 1.0) / n;
    if (!IsOfLayers(n)) continue;
    const RodCoefficients& c = CalibratedCoefficients(n);
    stiffness[i] = c.stiffness[i] * n;
    mass[i] = c.mass[i] / n;
  }
}

// So that the first mode's frequency is 1.
void ScaleToFirstMode(CurveStrand& strand) {
  UnknownMatrix modes;
  UnknownRow squares;
  SolveModes(strand.count, strand.mass, strand.stiffness, modes, squares);
  for (auto& row : strand.stiffness)
    for (double& k : row) k /= squares[0];
}

// Gauss's 10 points on [0, 1]: visit(s, weight).
template <class Visit>
void ForEachGaussPoint(const Visit& visit) {
  static constexpr double kPoint[5] = {0.1488743389816312, 0.4333953941292472, 0.6794095682990244,
                                       0.8650633666889845, 0.9739065285171717};
  static constexpr double kWeight[5] = {0.2955242247147529, 0.2692667193099963, 0.2190863625159820,
                                        0.1494513491505806, 0.0666713443086881};
  for (const double side : {-1.0, 1.0})
    for (size_t i = 0; i < 5; ++i) visit(0.5 * (1.0 + side * kPoint[i]), 0.5 * kWeight[i]);
}

// Radau's nodes on (0, 1], of which the last is the tip.
constexpr NodePlaces<8> kCoarseRadau = {
    0.0,
    {0.02247938643871250, 0.11467905316090423, 0.26578982278458946, 0.45284637366944461,
     0.64737528288683036, 0.81975930826310763, 0.94373743946307786, 1.00000000000000000}};
constexpr NodePlaces<10> kRadau = {
    0.0,
    {0.01441240964887655, 0.07438738970919604, 0.17611665616299528, 0.30966757992763782,
     0.46197040108101093, 0.61811723469529402, 0.76282301518503961, 0.88192102121000130,
     0.96374218711679054, 1.00000000000000000}};

}  // namespace

CurveStrand LinksOfStrand(int links) {
  CurveStrand strand{std::to_string(links) + " links", links};
  UnknownRow stiffness{}, mass{};
  FillLinks(links, stiffness, mass);
  const size_t n = size_t(links);
  const double link = 1.0 / links;
  double below[kMostUnknowns + 1] = {};
  for (size_t i = n; i-- > 0;) below[i] = below[i + 1] + mass[i];
  for (size_t i = 0; i < n; ++i) {
    strand.pull[i] = link * below[i];
    strand.at[i] = (double(i) + 0.5) * link;
    for (size_t j = 0; j < n; ++j) strand.mass[i][j] = link * link * below[std::max(i, j)];
    strand.stiffness[i][i] += stiffness[i];
    if (i > 0) {
      strand.stiffness[i - 1][i - 1] += stiffness[i];
      strand.stiffness[i][i - 1] -= stiffness[i];
      strand.stiffness[i - 1][i] -= stiffness[i];
    }
    for (size_t p = 0; p < kComparedPoints; ++p)
      strand.place[p][i] =
          std::clamp(double(p + 1) / kComparedPoints - double(i) * link, 0.0, link);
  }
  ScaleToFirstMode(strand);
  return strand;
}

template <size_t N>
CurveStrand NodesOfStrand(std::string name, const NodePlaces<N>& places) {
  const NodeModel<N> model = MakeNodeModel(places);
  CurveStrand strand{std::move(name), int(N)};
  for (size_t i = 0; i < N; ++i) {
    for (size_t j = 0; j < N; ++j) {
      strand.mass[i][j] = model.mass[i][j];
      strand.stiffness[i][j] = model.stiffness[i][j];
    }
    strand.pull[i] = model.pull[i];
    strand.at[i] = places.node[i];
  }
  ForEachGaussPoint([&](double s, double weight) {
    BendPlace place{s, weight, {}, {}};
    const auto tangent = model.TangentAt(s), bend = model.BendAt(s);
    std::copy(tangent.begin(), tangent.end(), place.tangent.begin());
    std::copy(bend.begin(), bend.end(), place.bend.begin());
    strand.bends.push_back(place);
  });
  for (size_t p = 0; p < kComparedPoints; ++p) {
    const auto place = model.PlaceAt(double(p + 1) / kComparedPoints);
    std::copy(place.begin(), place.end(), strand.place[p].begin());
  }
  return strand;
}
template CurveStrand NodesOfStrand(std::string, const NodePlaces<3>&);
template CurveStrand NodesOfStrand(std::string, const NodePlaces<4>&);

namespace {

template <size_t N>
CurveStrand ClampedRod(const NodePlaces<N>& places) {
  CurveStrand rod = NodesOfStrand(fmt::format("rod, {} nodes", N), places);
  const NodeModel<N> model = MakeNodeModel(places);
  std::copy(model.clamp.begin(), model.clamp.end(), rod.clamp.begin());
  return rod;
}

}  // namespace

CurveStrand RodOfStrand() { return ClampedRod(kRadau); }
UnknownRow RodPlaceAt(double s) {
  const auto place = MakeNodeModel(kRadau).PlaceAt(s);
  UnknownRow row{};
  std::copy(place.begin(), place.end(), row.begin());
  return row;
}
CurveStrand CoarseRodOfStrand() { return ClampedRod(kCoarseRadau); }

}  // namespace pelt::accuracy
