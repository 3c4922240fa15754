#include "core/modal/modal_course.hpp"

#include <algorithm>

#include "core/float_rules.hpp"

namespace pelt {

bool ModalCourse::Advance(const RodMaterial& rod, ModalQuality quality, double dt_s,
                          bool velocities, std::span<const ModalCourse> others,
                          const ModalTableBlock* tables, ModalTableBlock* table) {
  ModalCourse next = *this;
  next.begun_ = true;
  next.rod_ = rod;
  next.quality_ = quality;
  next.times_ = begun_ ? NextTimes(times_, dt_s) : FrameTimes{{dt_s, dt_s, dt_s}};
  next.times_.velocities = velocities;
  if (HasTableOf(next)) return false;

  const auto same = std::find_if(others.begin(), others.end(),
                                 [&](const ModalCourse& other) { return next.HasTableOf(other); });
  if (same != others.end()) {
    *table = tables[same - others.begin()];
    next.layer_ = same->layer_;
    next.knows_layer_ = same->knows_layer_;
    next.push_ratio_ = same->push_ratio_;
  } else {
    if (!knows_layer_ || !(rod == rod_)) {
      ModalMaterial material = StrandMaterial(rod.points, rod.frequency_hz, rod.damping_ratio,
                                              rod.drag_per_s, rod.stiff);
      material.parent_curl = rod.parent_curl;
      next.layer_ = MakeModalLayer(material);
      next.knows_layer_ = true;
    }
    FillModalTable(next.layer_, quality, next.times_, table);
    next.push_ratio_ = PushRatio(next.layer_, quality, next.times_);
  }
  *this = next;
  return true;
}
bool ModalCourse::HasTableOf(const ModalCourse& other) const {
  return begun_ && other.begun_ && rod_ == other.rod_ && quality_ == other.quality_ &&
         times_.velocities == other.times_.velocities &&
         std::equal(std::begin(times_.dt_s), std::end(times_.dt_s), other.times_.dt_s);
}

}  // namespace pelt
