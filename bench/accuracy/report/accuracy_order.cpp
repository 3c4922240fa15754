#include "bench/accuracy/report/accuracy_order.hpp"

#include <fmt/format.h>

#include <cmath>

namespace pelt {

using namespace accuracy;

ReportTree MakeOrderTree(const OrderPrecision& t, const Machine& machine) {
  const OrderOptions& o = t.options;
  ReportTree tree;
  tree.Add(InJson("format"), kOrderAccuracyFormat);
  tree.Say(fmt::format(
      "Error of drawing orders, {}: whole hairs painted one over the other, against every pixel's "
      "fragments by their own depth. {} pictures of {} x {}, one sample a pixel, hair alone. "
      "Wrong: "
      "of the pixels with hair, those off by more than 2 of 255.",
      t.scene, o.pictures, o.width_px, o.height_px));
  ReportTable& rows = tree.AddTable("rows", {{"order", "", -1, "hairs drawn"},
                                             {"psnr_db", "dB", 1, "PSNR"},
                                             {"wrong_pixels", "%", 2, "wrong", 100},
                                             {"sort_ns", "ns", 2, "sorting"}});
  for (const OrderRow& row : t.rows)
    rows.Add({row.name, std::isfinite(row.psnr_db) ? Value(row.psnr_db) : Value{}, row.wrong_pixels,
              row.sort_ns >= 0.0 ? Value(row.sort_ns) : Value{}});
  tree.BlankLine();
  tree.Say(fmt::format(
      "Sorting: keys, sort and order of layers per strand of the scene ({}; {:.0f} drawn in the "
      "mean) and frame, {} kernels, one core; every second frame costs half. Layers are drawn one "
      "after the other, by their sort_bias, where it does not say 'all layers'. Further off: with "
      "all strands and with level of detail, against all strands by depth.",
      t.strands, t.drawn_strands, IsaName(o.isa)));
  AddMachine(machine, tree);
  tree.Add(InJson("scene"), t.scene).Add(InJson("pictures"), o.pictures);
  tree.Add(InJson("width_px"), o.width_px).Add(InJson("height_px"), o.height_px);
  tree.Add(InJson("quick"), o.quick).Add(InJson("isa"), IsaName(o.isa));
  tree.Add(InJson("strands"), t.strands).Add(InJson("drawn_strands"), t.drawn_strands);
  return tree;
}

}  // namespace pelt
