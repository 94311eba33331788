// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "core/quadrature.hpp"
#include "petzval/core/config.hpp"
#include "petzval/lens/lens.hpp"
#include "pupil/pupil_boundary.hpp"
#include "pupil/ray_bundle.hpp"

namespace petzval::pupil_detail {

/// Calls visit(place, area, weight) at N Gauss-Legendre nodes between the edges of each span of a pupil. The nodes are
/// spaced in the squared radius, so that equal steps have equal areas. area * weight is the fraction of the pupil, in
/// squared radii, that a node represents.
template <int N, class Visit>
void for_each_node(const PupilRegion& region, const Visit& visit) {
  static const auto nodes = core_detail::gauss_legendre<N>();
  for (const PupilSpan& span : region.spans) {
    const double inner = span.from_radius * span.from_radius;
    const double area = (span.to_radius - span.from_radius) * (span.to_radius + span.from_radius);
    for (const auto& [node, weight] : nodes) {
      visit(region.at(span.direction, std::sqrt(inner + area * node)), area, weight);
    }
  }
}

/// Traces the rays of a scene point at Gauss-Legendre nodes between the edges of its pupil.
///
/// Integrals over this bundle are smooth functions of the scene point, which solvers require; samples of a fixed region
/// are not smooth. Weights: mm^2 of the pupil plane, up to a constant factor.
PETZVAL_API RayBundle trace_nodes(const Lens& lens, const PupilBoundary& boundary, double plane_z);

/// Traces the edges and the corners of the same pupil, with weight 0. Corners lie farther out than the adjacent edges.
PETZVAL_API RayBundle trace_rim(const Lens& lens, const PupilBoundary& boundary, double plane_z);

}  // namespace petzval::pupil_detail
