// A layer's modal table from frame to frame: what its strands are made of, as weather bends it, and
// how long the last frames were.
//
// Idea: a table costs some microseconds, and in most frames neither the material nor the lengths of
// the frames have changed; then it stays as it is. Layers of one material share the work
// (`others`).
//
// Invariant: the table is a function of the rod, the quality, the last three frame lengths
// and whether velocities are known, alone, so that layers that share and layers that do not get the same bits.
#pragma once

#include <span>

#include "core/modal/modal_table.hpp"

namespace pelt {

// What StrandMaterial takes, and how its curl turns.
struct RodMaterial {
  uint32_t points;       // 4, 5 or 9
  double frequency_hz;   // of the first bending mode, without gravity
  double damping_ratio;  // that bending gives it
  double drag_per_s;
  bool stiff = false;        // for its weight
  bool parent_curl = false;  // ModalMaterial::parent_curl
  friend bool operator==(const RodMaterial&, const RodMaterial&) = default;
};

class ModalCourse {
 public:
  // Fills the table for a frame of dt_s seconds; the first call assumes that the frames before were
  // as long. `velocities`: the root's are known in this frame. Says whether the table changed. `others` and `tables`
  // are courses that have advanced to this frame, with their tables.
  bool Advance(const RodMaterial& rod, ModalQuality quality, double dt_s, bool velocities,
               std::span<const ModalCourse> others, const ModalTableBlock* tables,
               ModalTableBlock* table);

  // Of the last frame.
  ModalQuality quality() const { return quality_; }
  // Of the table's frame (modal_table.hpp).
  double push_ratio() const { return push_ratio_; }

  // What the next frame takes over, but for the table, for an archive (jobs/scene_snapshot.cpp). What
  // follows from the rod is worked out again when it is needed: ForgetLayer after reading.
  static void ListState(auto& io, auto& self) {
    io(self.begun_);
    io(self.rod_.points);
    io(self.rod_.frequency_hz);
    io(self.rod_.damping_ratio);
    io(self.rod_.drag_per_s);
    io(self.rod_.stiff);
    io(self.rod_.parent_curl);
    io(self.quality_);
    io(self.times_.dt_s);
    io(self.times_.velocities);
    io(self.push_ratio_);
  }
  void ForgetLayer() { knows_layer_ = false; }

 private:
  bool HasTableOf(const ModalCourse& other) const;

  bool begun_ = false, knows_layer_ = false;
  RodMaterial rod_{};
  ModalQuality quality_{};
  FrameTimes times_{};
  ModalLayer layer_{};
  double push_ratio_ = 0.0;
};

}  // namespace pelt
