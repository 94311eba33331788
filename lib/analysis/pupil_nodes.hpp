// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "core/quadrature.hpp"
#include "pupil/pupil_boundary.hpp"

namespace petzval::analysis_detail {

/// A ray of a quadrature over a pupil.
struct PupilNode {
  Vec2<double> position{0, 0};  ///< in the pupil plane, mm
  double area = 0;              ///< mm^2
  std::size_t direction = 0;    ///< direction of the boundary
};

/// Gauss-Legendre nodes along each span of a pupil.
template <std::size_t radii = 8>
std::vector<PupilNode> pupil_nodes(const PupilRegion& pupil) {
  static const auto nodes = core_detail::gauss_legendre<radii>();
  const double sector =
      2 * std::numbers::pi / static_cast<double>(pupil.directions) * pupil.half_axes.x * pupil.half_axes.y;
  std::vector<PupilNode> result;
  result.reserve(pupil.spans.size() * radii);
  for (const PupilSpan& span : pupil.spans) {
    const double length = span.to_radius - span.from_radius;
    for (const auto& [x, weight] : nodes) {
      const double r = span.from_radius + length * x;
      result.push_back({pupil.at(span.direction, r), sector * r * length * weight, span.direction});
    }
  }
  return result;
}

/// The same nodes, then the ends of the spans, which have no area: the extremes of a pupil.
template <std::size_t radii = 8>
std::vector<PupilNode> pupil_nodes_and_rim(const PupilRegion& pupil) {
  std::vector<PupilNode> result = pupil_nodes<radii>(pupil);
  for (const PupilSpan& span : pupil.spans) result.push_back({{span.to.x, span.to.y}, 0, span.direction});
  return result;
}

}  // namespace petzval::analysis_detail
