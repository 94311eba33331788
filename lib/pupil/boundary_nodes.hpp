// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "core/quadrature.hpp"
#include "pupil/pupil_boundary.hpp"

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

}  // namespace petzval::pupil_detail
