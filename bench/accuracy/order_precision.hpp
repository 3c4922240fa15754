// How wrong a scene's pictures are for the order that its hairs are drawn in, and what that order costs: Pelt's own
// sort, the same less often, other places on a strand to sort by, and none.
//
// Pictures of a moving scene are compared with every pixel's fragments by depth (bench/picture/order_error.hpp). An
// order from an earlier frame holds for the hairs that it has; those that are new are painted last.
//
// Invariant: errors depend on nothing but the scene's frames. Times are this machine's.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bench/scenarios/scenarios.hpp"

namespace pelt::accuracy {

struct OrderOptions {
  uint32_t pictures = 8;  // eight frames apart, behind a second
  uint32_t width_px = 640, height_px = 480;
  Isa isa = BestIsa();
  bool quick = false;
  std::function<void(size_t done, size_t total)> progress = {};
};

struct OrderRow {
  std::string name;
  // Of the whole picture, over the mean square error of all; infinite: the same. Share of the pixels with hair that
  // are off by more than 2 of 255, mean of all pictures.
  double psnr_db = 0.0, wrong_pixels = 0.0;
  double sort_ns =
      -1.0;  // of sorting, per strand of the scene and frame; below 0: not one of Pelt's ways
};

struct OrderPrecision {
  OrderOptions options;  // as used
  std::string scene;     // its name
  uint64_t strands = 0;
  double drawn_strands = 0.0;  // mean of the pictures
  std::vector<OrderRow> rows;
};

OrderPrecision MeasureOrderPrecision(const Scenario& scene, const OrderOptions& options);

}  // namespace pelt::accuracy
