// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/pupil/pupil_boundary.hpp"
#include "petzval/pupil/ray_bundle.hpp"

namespace petzval::pupil_detail {

/// The bundle of a scene point with its rays at Gauss-Legendre nodes between the edges of its pupil: every integral
/// over it is a smooth function of the point, which solvers need and samples of a fixed region do not give. Weights: in
/// mm^2 of the pupil plane, but for a constant.
PETZVAL_API RayBundle trace_nodes(const Lens& lens, const PupilBoundary& boundary, double plane_z);

/// The rays along the rim of the same pupil, of weight 0: its edges, and its corners, which lie farther out.
PETZVAL_API RayBundle trace_rim(const Lens& lens, const PupilBoundary& boundary, double plane_z);

}  // namespace petzval::pupil_detail
