// Pelt's modal kernel under the yardstick: any build of it, handed over as its description.
#pragma once

#include "bench/accuracy/strand_solver.hpp"
#include "core/kernels/frame_table.hpp"
#include "core/modal/modal_table.hpp"

namespace pelt::accuracy {

// SimulateModal<V, points, false> of one V; kept by the factory. Materials with links of equal
// length.
struct ModalKernels {
  struct OfLinks {
    KernelDesc plain, rated;  // SimulateModal, SimulateModalRated
  };
  OfLinks three_links, four_links, eight_links;
  // Null where there are none.
  const OfLinks* Of(int links) const {
    return links == 3   ? &three_links
           : links == 4 ? &four_links
           : links == 8 ? &eight_links
                        : nullptr;
  }
};
// As built for an instruction set. Throws Error when this program or processor lacks it.
ModalKernels ModalKernelsOf(Isa isa);

// What acts on the strands besides their material, gravity and wind. As it stands here: nothing.
struct ModalFeatures {
  bool wind = true;               // the layer reads the wind
  float surface_hardness = 0.0f;  // contact with the plane across the first link's rest direction
  bool use_ground = false;
  Double3 ground_normal = {0.0, 1.0, 0.0};
  double ground_offset = 0.0;  // free space is n . x + offset >= 0
  double sphere_radius = 0.0;  // 0: no sphere
  Double3 sphere_centre = kZero3;
  double capsule_radius = 0.0;  // 0: no capsule
  Double3 capsule_from = kZero3, capsule_to = kZero3;
  // Sphere and capsule go this far to either side, as a sine, and on at this speed, m/s; their velocity is
  // passed to the solver.
  Double3 swing = kZero3, going = kZero3;
  double swing_period = 1.0;  // s
  float bounce = 0.0f;
  float friction = 0.0f;
  float max_distance = 0.0f;  // of a point from the groom, share of its distance along the strand
  float clump = 0.0f;         // towards the first strands of a chunk
  float strength = 1.0f;      // of every strand
  bool velocities = false;    // of the root are given with its poses
};
// How far sphere and capsule have gone, the runs beginning at 0 s, and how fast they go.
Double3 ColliderWay(const ModalFeatures& features, double seconds);
Double3 ColliderSpeed(const ModalFeatures& features, double seconds);
SolverFactory ModalFactory(const ModalKernels& kernels, ModalQuality quality,
                           const ModalFeatures& features = {});

// The same of a strand with nodes: its parts are the material's links, and what it starts along are tangents at
// the nodes.
SolverFactory StrandFactory(const ModalKernels& kernels, ModalQuality quality,
                            const ModalMaterial& strand, const ModalFeatures& features = {});

// The same, the strand being what a layer makes of the material's first frequency, damping, drag and length.
SolverFactory LayerFactory(const ModalKernels& kernels, ModalQuality quality,
                           const ModalFeatures& features = {});

// The material in the modal solver's terms: links of length 1, total mass 1. At most kMaxNodes of them.
ModalMaterial ToModal(const ChainMaterial& material);

}  // namespace pelt::accuracy
