// A frame of modal chains in short steps: the table for them, made from the frame's.
//
// A table's weights for whole substeps are exact, and take exponentials and sines. Those of short
// steps follow the trapezoidal rule, so that plus, times and divide do; a chain's fastest modes are
// then as stable as ever, and slower ones right to (omega h)^2 / 12. What the root does is the
// parabola through the frame that has the cubic's ends and its velocity at the frame's end.
#pragma once

#include "core/modal/modal_block.hpp"
#include "core/simd.hpp"

namespace pelt::modal {

// The longest short step, s, and that of the best quality: what slides along a whipping strand is
// followed by the second alone, at four times the price.
inline constexpr float kShortStep = 1.0f / 2000.0f, kShortStepOfBest = 1.0f / 8000.0f;

// The table of a frame, of strands of N nodes, for short steps. By the vector type, as the machine code of no
// instruction set may stand for another's (tests/porting/isa_leak_test.sh).
template <class W, uint32_t N>
class ShortSteps {
 public:
  explicit ShortSteps(const ModalTableBlock& frame) : table_(frame) {
    const float longest = frame.use_slope != 0 ? kShortStepOfBest : kShortStep;
    count_ = uint32_t(frame.frame_s * (1.0f / longest)) + 1;
    table_.substeps = 2;  // the one before and the present one
    table_.looks = 2;
    table_.look_share = 1.0f;
    table_.half_step_s = 0.5f * step_s();
    lag_ = frame.euler_bend / frame.euler_speed;
    const float drag =
        (frame.euler_place - frame.euler_speed * frame.euler_speed) / frame.euler_speed;
    for (uint32_t m = 0; m < frame.nodes; ++m) FillMode(m, drag);
    for (uint32_t i = 0; i < frame.nodes; ++i)
      for (uint32_t j = 0; j < frame.nodes; ++j) {
        float sum = 0.0f;
        for (uint32_t m = 0; m < frame.nodes; ++m)
          sum += frame.shape[i][m] * table_.y_of_force[m] * frame.shape[j][m];
        table_.response[i][j] = 0.5f * sum;
        table_.slope[i][j] = 0.0f;
      }
    Place(0, -1.0f);
  }
  // For the step with that number.
  PELT_INLINE const ModalTableBlock& At(uint32_t step) {
    const float last = step + 1 < count_ ? Time(step + 1) : 0.0f;
    Place(1, last);
    const float middle = 0.5f * (Time(step) + last);
    ModalSubstep& s = table_.substep[1];
    for (uint32_t k = 0; k + 1 < kModalSamples; ++k) {
      // T and what damping makes of its change.
      const float pull = WeightAt(k, middle) + lag_ * ChangeAt(k, middle);
      for (uint32_t m = 0; m < table_.nodes; ++m) {
        s.bend_q[k][m] = table_.y_of_force[m] * pull;
        s.bend_z[k][m] = table_.v_of_force[m] * pull;
      }
    }
    for (uint32_t m = 0; m < table_.nodes; ++m) {
      s.wind_q[m] = table_.y_of_force[m] * table_.pull_mode[m] * middle;
      s.wind_z[m] = table_.v_of_force[m] * table_.pull_mode[m] * middle;
    }
    return table_;
  }
  // The present step is the last one of the next.
  PELT_INLINE void GoOn() { table_.substep[0] = table_.substep[1]; }
  uint32_t count() const { return count_; }
  float step_s() const { return table_.frame_s / float(count_); }
  // A step's start, as a share of the frame from its end.
  float Time(uint32_t step) const { return float(step) / float(count_) - 1.0f; }

 private:
  void FillMode(uint32_t m, float drag) {
    ModalTableBlock& t = table_;
    float square = 0.0f;  // omega^2
    for (uint32_t i = 0; i < t.nodes; ++i) square += t.bend[m][i] * t.shape[i][m];
    const float step = step_s(), half = 0.5f * step;
    const float damped = half * (drag + lag_ * square), stiff = half * half * square;
    const float over = 1.0f / (1.0f + damped + stiff);
    t.v_of_force[m] = step * over;
    t.v_of_v[m] = (1.0f - damped - stiff) * over;
    t.v_of_y[m] = -square * t.v_of_force[m];
    t.y_of_force[m] = half * t.v_of_force[m];
    t.y_of_v[m] = half * (1.0f + t.v_of_v[m]);
    t.y_of_y[m] = 1.0f + half * t.v_of_y[m];
    t.impulse[m] = 0.5f * t.v_of_force[m];
    t.impulse_slope[m] = 0.0f;
  }
  // What a backward difference weighs at a time, the parabola that has its ends and its change at
  // the frame's end; and its change, 1/s.
  float WeightAt(uint32_t k, float time) const {
    const float end = table_.root_end_speed[k] * table_.frame_s;
    const float curve = k == 0 ? end - 1.0f : end;
    return (end + curve * time) * time;
  }
  float ChangeAt(uint32_t k, float time) const {
    const float end = table_.root_end_speed[k] * table_.frame_s;
    const float curve = k == 0 ? end - 1.0f : end;
    return (end + 2.0f * curve * time) * table_.euler_speed;
  }
  void Place(uint32_t substep, float time) {
    ModalSubstep& s = table_.substep[substep];
    for (uint32_t k = 0; k + 1 < kModalSamples; ++k) {
      if (substep == 1) s.middle_place[k] = WeightAt(k, time - 0.5f / float(count_));
      s.root_place[k] = WeightAt(k, time);
      s.root_speed[k] = ChangeAt(k, time);
    }
  }

  ModalTableBlock table_;
  uint32_t count_;
  float lag_;
};

}  // namespace pelt::modal
