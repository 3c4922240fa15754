#include "bench/fit/purchases.hpp"

#include <algorithm>

namespace pelt {
namespace {

// Of a share that is 1.
constexpr uint64_t kWhole = 1u << 20;

// a / b > c / d, of b and d that are not 0: without products, which may not fit.
bool IsMore(uint64_t a, uint64_t b, uint64_t c, uint64_t d) {
  while (true) {
    if (a / b != c / d) return a / b > c / d;
    const uint64_t left = a % b, right = c % d;
    if (left == 0 || right == 0) return left > right;
    // left / b > right / d, as d / right > b / left.
    a = d;
    c = b;
    b = right;
    d = left;
  }
}

// Rounded up, so that what costs something has a share.
uint64_t ShareOf(uint64_t ns, uint64_t of_ns) {
  of_ns = std::max<uint64_t>(of_ns, 1);
  return (ns * kWhole + of_ns - 1) / of_ns;
}

// The largest over the platforms of what `to` costs more than `from`.
uint64_t LargestShare(const LayerOption* from, const LayerOption& to,
                      const Purchases::Costs& of_ns) {
  uint64_t largest = 0;
  for (size_t p = 0; p < of_ns.size(); ++p) {
    const uint64_t before = from ? from->ns[p] : 0;
    if (to.ns[p] > before) largest = std::max(largest, ShareOf(to.ns[p] - before, of_ns[p]));
  }
  return largest;
}

bool CanPay(const LayerOption& from, const LayerOption& to, const Purchases::Costs& left_ns) {
  for (size_t p = 0; p < left_ns.size(); ++p)
    if (to.ns[p] > from.ns[p] && to.ns[p] - from.ns[p] > left_ns[p]) return false;
  return true;
}

}  // namespace

LayerOptions WithoutWorse(const LayerOptions& options) {
  LayerOptions out;
  for (size_t i = 0; i < options.size(); ++i) {
    const auto is_no_worse = [&](size_t j) {
      const LayerOption &a = options[i], &b = options[j];
      bool same = a.error == b.error;
      for (size_t p = 0; p < a.ns.size(); ++p) {
        if (b.ns[p] > a.ns[p]) return false;
        same = same && a.ns[p] == b.ns[p];
      }
      return b.error <= a.error && (!same || j < i);
    };
    bool worse = false;
    for (size_t j = 0; j < options.size(); ++j) worse = worse || (j != i && is_no_worse(j));
    if (!worse) out.push_back(options[i]);
  }
  return out;
}

Purchases::Purchases(std::vector<LayerOptions> layers) : layers_(std::move(layers)) {
  for (LayerOptions& options : layers_) {
    options = WithoutWorse(options);
    closed_.emplace_back(options.size());
  }
}

Purchases::Costs Purchases::CostOf(const Choice& choice) const {
  Costs sum(layers_.empty() ? 0 : layers_[0][0].ns.size());
  for (size_t l = 0; l < layers_.size(); ++l)
    for (size_t p = 0; p < sum.size(); ++p) sum[p] += layers_[l][choice[l]].ns[p];
  return sum;
}

Purchases::Choice Purchases::Cheapest(const Costs& budget_ns) const {
  Choice choice;
  for (const LayerOptions& options : layers_) {
    uint32_t best = 0;
    for (uint32_t o = 1; o < options.size(); ++o)
      if (LargestShare(nullptr, options[o], budget_ns) <
          LargestShare(nullptr, options[best], budget_ns))
        best = o;
    choice.push_back(best);
  }
  return choice;
}

std::optional<Purchase> Purchases::Find(const Choice& choice, const Costs& of_ns,
                                        const Costs* left_ns) const {
  std::optional<Purchase> best;
  uint64_t best_gain = 0, best_share = 1;
  for (uint32_t l = 0; l < layers_.size(); ++l) {
    const LayerOption& from = layers_[l][choice[l]];
    for (uint32_t o = 0; o < layers_[l].size(); ++o) {
      const LayerOption& to = layers_[l][o];
      if (to.error >= from.error || closed_[l][o] || (left_ns && !CanPay(from, to, *left_ns)))
        continue;
      const uint64_t gain = from.error - to.error;
      // Not 0: what costs no more anywhere and is better would have left the other out.
      const uint64_t share = LargestShare(&from, to, of_ns);
      if (best && !IsMore(gain, share, best_gain, best_share)) continue;
      best = Purchase{l, o};
      best_gain = gain;
      best_share = share;
    }
  }
  return best;
}

std::vector<Purchase> Purchases::Fill(Choice choice, const Costs& budget_ns) const {
  std::vector<Purchase> bought;
  while (true) {
    const Costs spent = CostOf(choice);
    Costs left = budget_ns;
    for (size_t p = 0; p < left.size(); ++p) {
      if (spent[p] > left[p]) return bought;
      left[p] -= spent[p];
    }
    const auto purchase = Find(choice, left, &left);
    if (!purchase) return bought;
    choice[purchase->layer] = purchase->option;
    bought.push_back(*purchase);
  }
}

std::optional<Purchase> Purchases::Next(const Choice& choice, const Costs& budget_ns) const {
  return Find(choice, budget_ns, nullptr);
}

void Purchases::Close(uint32_t tier, const Choice& choice) {
  for (size_t l = 0; l < layers_.size(); ++l)
    for (size_t o = 0; o < layers_[l].size(); ++o)
      if (layers_[l][o].tier == tier && choice[l] != o) closed_[l][o] = true;
}

}  // namespace pelt
