#include "core/groom/layer_params.hpp"

#include <algorithm>
#include <type_traits>

#include "core/float_rules.hpp"
#include "core/format.hpp"

namespace pelt {
namespace {

using P = LayerParams;

struct ParamRow {
  ParamBounds bounds;
  bool (*holds)(const ParamBounds&, const LayerParams&);
};

template <class T>
bool IsInside(const ParamBounds& bounds, const T& value) {
  if constexpr (requires { value.begin(); }) {
    return std::all_of(value.begin(), value.end(),
                       [&](auto element) { return IsInside(bounds, element); });
  } else {
    // As floats, so that a bound that float rounds outward still admits the value it was read from.
    return float(value) >= float(bounds.low) && float(value) <= float(bounds.high);
  }
}

template <auto kMember>
constexpr ParamRow Row(std::string_view key, double low, double high) {
  return {{key, low, high}, [](const ParamBounds& bounds, const LayerParams& params) {
            return IsInside(bounds, params.*kMember);
          }};
}

// Bounds are there to catch slips and to keep hostile files from asking for absurd amounts of work;
// they are far outside what looks good.
constexpr ParamRow kRows[] = {
    Row<&P::sort_bias>("sort_bias", -1000, 1000),
    Row<&P::solver>("solver", 0, 2),
    Row<&P::chain>("chain", 0, 1),
    Row<&P::points>("points", 4, 5),
    Row<&P::output>("output", 0, 1),
    Row<&P::tip_width>("tip_width", 0, 4),
    Row<&P::frequency_hz>("frequency", 0, 2000),
    Row<&P::damping_ratio>("damping_ratio", 0, 10),
    Row<&P::quality>("quality", 0, 2),
    Row<&P::max_distance>("max_distance", 0, 2),
    Row<&P::iterations>("iterations", 1, 32),
    Row<&P::weight>("weight", -10, 10),
    Row<&P::bounce>("bounce", 0, 1),
    Row<&P::velocity_damping>("velocity_damping", 0, 1000),
    Row<&P::motion_damping>("motion_damping", 0, 1),
    Row<&P::segment_hardness>("segment_hardness", 0, 1),
    Row<&P::angular_hardness_middle>("angular_hardness_middle", 0, 1),
    Row<&P::angular_hardness_end>("angular_hardness_end", 0, 1),
    Row<&P::surface_hardness>("surface_hardness", 0, 1),
    Row<&P::stiffness>("stiffness", 0, 1),
    Row<&P::clump>("clump", 0, 1),
    Row<&P::wind_response>("wind_response", 0, 1000),
    Row<&P::backface_tolerance>("backface_tolerance", 0, 1),
    Row<&P::wet_weight>("wet_weight", 0, 10),
    Row<&P::wet_clump>("wet_clump", 0, 1),
    Row<&P::wet_hardness>("wet_hardness", 0, 1),
    Row<&P::wet_darken>("wet_darken", 0, 1),
    Row<&P::dirt_colour>("dirt_colour", 0, 1),
};

}  // namespace

const ParamBounds* FindParamBounds(std::string_view key) {
  for (const ParamRow& row : kRows)
    if (row.bounds.key == key) return &row.bounds;
  return nullptr;
}

std::optional<BadKey> FindBadCombination(const LayerParams& params) {
  if (params.chain == ChainKind::kVertex && params.points != 4) {
    return BadKey{"points", "chains at mesh vertices have 4 points; chain = \"strand\" has 4 or 5"};
  }
  if (params.chain == ChainKind::kVertex && params.solver == Solver::kVerlet) {
    return BadKey{"solver", "verlet needs a chain for each strand: chain = \"strand\""};
  }
  if (params.max_distance > 0.0f && params.max_distance < kLeastMaxDistance) {
    return BadKey{"max_distance", "0 (no limit) or at least 0.05; strength = 0 holds a strand"};
  }
  if (params.max_distance > 0.0f && params.solver != Solver::kModal) {
    return BadKey{"max_distance", "only solver = \"modal\" keeps it"};
  }
  return std::nullopt;
}

std::string FindBadParam(const LayerParams& params) {
  for (const auto& [bounds, holds] : kRows) {
    if (!holds(bounds, params)) {
      return Format("{} is not between {} and {}", bounds.key, bounds.low, bounds.high);
    }
  }
  const auto bad = FindBadCombination(params);
  return bad ? Format("{}: {}", bad->key, bad->reason) : std::string();
}

}  // namespace pelt
