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
  float position[3] = {0.0f, 1.0f, 3.0f};
  float target[3] = {0.0f, 1.0f, 0.0f};
  float up[3] = {0.0f, 1.0f, 0.0f};
  float vertical_fov_rad = 0.9f;  // whole angle, in (0, pi)
  float viewport_width_px = 1280.0f;
  float viewport_height_px = 720.0f;
  float near_m = 0.05f;
  float far_m = 1000.0f;
};

struct View {
  float eye[3];                 // m
  float forward[3];             // unit
  float planes[6][4];           // left, right, bottom, top, near, far; unit normals, inwards
  float pixels_per_unit_at_1m;  // pixels a length of 1 m covers across the view, 1 m ahead
  float near_m;
};

// Null when the camera can make a view, otherwise the reason it cannot: a value is not finite,
// target and position coincide, or fov, viewport, near or far is out of range.
const char* FindCameraFault(const Camera& camera);

// The view of a camera. A faulty camera (above) gives a finite view all the same: the fault is
// replaced by the nearest usable value, so that a frame never sees a NaN. `up` along the line of
// sight is replaced by the world axis farthest from it.
View MakeView(const Camera& camera);

}  // namespace pelt
