// Which option each layer gets for a budget: from the cheapest of all, what takes most of the error away
// for its price is bought until nothing more can be paid for.
//
// All numbers are integers and ties go to the first, so that the choice is the same on every machine.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace pelt {

struct LayerOption {
  uint32_t tier = 0;              // what it stands for: the caller's
  uint64_t error = 0;             // of the layer, weighed against other layers'
  std::vector<uint64_t> ns = {};  // core time of the layer, by platform
  uint32_t level = 0;             // as `tier`; but a tier that is closed is so at every level
  uint32_t micropixels = 0;       // what `error` is made of
};
using LayerOptions = std::vector<LayerOption>;  // of one layer, at least one

// Without options that cost as much as another on every platform and are no better.
LayerOptions WithoutWorse(const LayerOptions& options);

struct Purchase {
  uint32_t layer = 0, option = 0;
};

class Purchases {
 public:
  using Choice = std::vector<uint32_t>;  // the option of each layer
  using Costs = std::vector<uint64_t>;   // core time of all layers, ns, by platform

  // Without worse options.
  explicit Purchases(std::vector<LayerOptions> layers);

  const std::vector<LayerOptions>& layers() const { return layers_; }
  // The least cost, by the largest share of `budget_ns` over the platforms.
  Choice Cheapest(const Costs& budget_ns) const;
  // What is bought one after the other until the budget is spent; nothing, if `from` cannot be paid for.
  std::vector<Purchase> Fill(Choice from, const Costs& budget_ns) const;
  // The best purchase, regardless of what is left to pay it with; none: all is bought.
  std::optional<Purchase> Next(const Choice& choice, const Costs& budget_ns) const;
  // From now on only layers that have a tier in `choice` can have it.
  void Close(uint32_t tier, const Choice& choice);

  Costs CostOf(const Choice& choice) const;

 private:
  std::optional<Purchase> Find(const Choice& choice, const Costs& of_ns,
                               const Costs* left_ns) const;

  std::vector<LayerOptions> layers_;
  std::vector<std::vector<bool>> closed_;  // [layer][option]
};

}  // namespace pelt
