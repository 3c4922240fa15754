// Layer order against std::stable_sort on coordinates that floats hold exactly.
#include "core/kernels/order_layers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/kernels/run_kernel.hpp"

namespace pelt::test {
namespace {

struct World {
  Blocks<LayerBlock> layers;
  Blocks<BoundsBlock> bounds;
  Blocks<LodBlock> lod;
  Blocks<LayerSortBlock> sort;
  Blocks<DrawListBlock> list{1};
  OrderLayersParams params{{0.25f, 1.0f, 3.0f}, {0.0f, 0.5f, -1.0f}};

  explicit World(uint32_t count)
      : layers(count, 0), bounds(count, 0), lod(count, 0), sort(count, 0) {
    for (uint32_t l = 0; l < count; ++l) {
      lod[l].visible = 1;
      sort[l].visible_count = 5;
    }
  }
  // Eighths in a small range: every sum and product below is exact in float.
  void Randomise(uint32_t seed, uint32_t biases, uint32_t places) {
    std::mt19937 random(seed);
    for (uint32_t l = 0; l < layers.size(); ++l) {
      layers[l].sort_bias = float(int(random() % biases) - int(biases / 2)) * 0.5f;
      if (layers[l].sort_bias == 0.0f && random() % 2) layers[l].sort_bias = -0.0f;
      for (int a = 0; a < 3; ++a) {
        bounds[l].low[a] = float(int(random() % places) - int(places / 2)) / 8.0f;
        bounds[l].high[a] = bounds[l].low[a] + float(random() % places) / 8.0f;
      }
      lod[l].visible = random() % 8 != 0;
      sort[l].visible_count = random() % 8;
    }
  }
  template <class V = ArrayVec<4>>
  std::vector<uint32_t> Run() {
    RunKernel<OrderLayers<V>>(params,
                              {layers.Bind(), bounds.Bind(), lod.Bind(), sort.Bind(), list.Bind()});
    return {list[0].layer, list[0].layer + list[0].count};
  }
  double Depth(uint32_t l) const {
    double depth = 0.0;
    for (int a = 0; a < 3; ++a)
      depth += (0.5 * (double(bounds[l].low[a]) + bounds[l].high[a]) - params.eye[a]) *
               params.forward[a];
    return depth;
  }
  std::vector<uint32_t> SortPlainly() const {
    std::vector<uint32_t> out;
    for (uint32_t l = 0; l < layers.size(); ++l)
      if (lod[l].visible && sort[l].visible_count > 0) out.push_back(l);
    std::stable_sort(out.begin(), out.end(), [&](uint32_t x, uint32_t y) {
      if (layers[x].sort_bias != layers[y].sort_bias)
        return layers[x].sort_bias < layers[y].sort_bias;
      return Depth(x) > Depth(y);
    });
    return out;
  }
};

TEST(OrderLayers, BiasThenFartherBoxThenIndex) {
  ForEveryVector([]<class V>(const char* name) {
    for (uint32_t count : {0u, 1u, 2u, 3u, 17u, 166u, kLayersPerScene})
      for (uint32_t biases : {1u, 3u, 40u})
        for (uint32_t places : {2u, 16u}) {
          World w(count);
          w.Randomise(count + biases, biases, places);
          EXPECT_EQ(w.Run<V>(), w.SortPlainly()) << count << ' ' << biases << ' ' << name;
          for (uint32_t i = w.list[0].count; i < kLayersPerScene; ++i)
            ASSERT_EQ(w.list[0].layer[i], kNoLayer);
        }
  });
}

TEST(OrderLayers, HiddenAndEmptyLayersAreNotListed) {
  World w(4);
  w.lod[1].visible = 0;
  w.sort[2].visible_count = 0;
  EXPECT_EQ(w.Run(), (std::vector<uint32_t>{0, 3}));
  w.lod[0].visible = 0;
  w.sort[3].visible_count = 0;
  EXPECT_TRUE(w.Run().empty());
}

TEST(OrderLayers, BiasOutweighsAnyDepth) {
  World w(2);
  w.layers[0].sort_bias = 1.0f;
  w.bounds[0].low[2] = w.bounds[0].high[2] = -1000.0f;
  w.layers[1].sort_bias = -3.0f;
  EXPECT_EQ(w.Run(), (std::vector<uint32_t>{1, 0}));
  w.layers[1].sort_bias = 1.0f;
  EXPECT_EQ(w.Run(), (std::vector<uint32_t>{0, 1}));
}

}  // namespace
}  // namespace pelt::test
