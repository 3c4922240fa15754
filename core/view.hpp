// What a frame knows of the camera: made once per frame on the caller's thread, read by kernels as a
// parameter.
//
// Planes point inwards: a point p is inside when dot(plane.xyz, p) + plane.w >= 0 for all six.
// Everything is computed in double with core/exact_math.hpp and rounded once, so a camera gives the
// same bits on every machine. What breaks if ignored: a sine from libm here would change sort keys
// between machines.
#pragma once

#include <cstdint>

namespace pelt {

// World space, right-handed, metres.
struct Camera {
  float eye[3] = {0.0f, 1.0f, 3.0f};     // where it is
  float target[3] = {0.0f, 1.0f, 0.0f};  // a place that it looks at, at any distance but 0
  float up[3] = {0.0f, 1.0f, 0.0f};      // upwards in the picture; of any length, need not be exact
  float vertical_fov_rad = 0.9f;         // whole angle, in (0, pi)
  float viewport_width_px = 1280.0f;     // from 1 on; with the height the aspect ratio
  float viewport_height_px = 720.0f;     // from 1 on; by it level of detail knows sizes in pixels
  float near_m = 0.05f;                  // in front of the eye, from 1e-4 on
  float far_m = 1000.0f;                 // beyond near_m
};

struct View {
  float eye[3];                 // m
  float forward[3];             // unit
  float planes[6][4];           // left, right, bottom, top, near, far; unit normals, inwards
  float pixels_per_unit_at_1m;  // pixels a length of 1 m covers across the view, 1 m ahead
  float near_m;
};

// Null when the camera can make a view, otherwise the reason it cannot: a value is not finite,
// target and eye coincide, or fov, viewport, near or far is out of range.
const char* FindCameraFault(const Camera& camera);

// The view of a camera. A faulty camera (above) gives a finite view all the same: the fault is
// replaced by the nearest usable value, so that a frame never sees a NaN. `up` along the line of
// sight is replaced by the world axis farthest from it.
View MakeView(const Camera& camera);

}  // namespace pelt
