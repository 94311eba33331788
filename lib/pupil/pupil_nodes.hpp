// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/config.hpp"
#include "petzval/lens/lens.hpp"
#include "pupil/pupil_boundary.hpp"
#include "pupil/ray_bundle.hpp"

namespace petzval::pupil_detail {

/// Traces the rays of a scene point at Gauss-Legendre nodes between the edges of its pupil.
///
/// Integrals over this bundle are smooth functions of the scene point, which solvers require; samples of a fixed region
/// are not smooth. Weights: mm^2 of the pupil plane, up to a constant factor.
PETZVAL_API RayBundle trace_nodes(const Lens& lens, const PupilBoundary& boundary, double plane_z);

/// Traces the edges and the corners of the same pupil, with weight 0. Corners lie farther out than the adjacent edges.
PETZVAL_API RayBundle trace_rim(const Lens& lens, const PupilBoundary& boundary, double plane_z);

}  // namespace petzval::pupil_detail
