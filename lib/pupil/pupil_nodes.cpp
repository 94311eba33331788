// SPDX-License-Identifier: Apache-2.0
#include "pupil_nodes.hpp"

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "core/bisect.hpp"
#include "petzval/trace/trace.hpp"
#include "trace_rays.hpp"

namespace petzval::pupil_detail {
namespace {

/// Points of a pupil plane with weights.
struct PupilPoints {
  std::vector<double> x, y, weights;

  void add(const Vec2<double>& point, double weight) {
    x.push_back(point[0]), y.push_back(point[1]);
    weights.push_back(weight);
  }
};

RayBundle trace_points(const Lens& lens, const PupilBoundary& boundary, double plane_z, const PupilPoints& points) {
  const std::span<const double> x = points.x, y = points.y;
  // Reproducible batches equal single rays to the bit: edges found with single rays also pass in a batch.
  return trace_rays(lens, plane_z, x.size(),
                    {.wavelength = boundary.wavelength, .slopes = true, .weights = points.weights},
                    [&](std::size_t begin, std::size_t end, const RayArrays<double>& rays) {
                      boundary.plane.rays(x.subspan(begin, end - begin), y.subspan(begin, end - begin), rays);
                      return end - begin;
                    });
}

/// Adds the corners of a pupil, where the limiting rim changes. Each corner lies between the last direction limited by
/// one rim and the first direction limited by the next rim.
void add_corners(const Lens& lens, const PupilBoundary& boundary, PupilPoints& points) {
  using Position = Vec2<double>;
  const std::size_t count = boundary.spans.size();
  if (count != boundary.directions || count < 3) return;
  const auto traced = [&](const Position& position) {
    return trace(lens, boundary.plane.ray(position[0], position[1]), {.wavelength = boundary.wavelength});
  };
  for (std::size_t k = 0; k < count; ++k) {
    const PupilSpan &one = boundary.spans[k], &other = boundary.spans[(k + 1) % count];
    if (one.to.surface == other.to.surface || one.from_radius > 0 || other.from_radius > 0) continue;
    // Search along the chord, which every line outwards from the middle crosses once.
    const auto edge = [&](double fraction) {
      const Position from{one.to.x, one.to.y}, chord = from + fraction * (Position{other.to.x, other.to.y} - from);
      const auto at = [&](double reach) { return boundary.middle + reach * (chord - boundary.middle); };
      int surface = one.to.surface;
      const double last = core_detail::last_with(0.5, 2.0, [&](double reach) {
        const auto end = traced(at(reach));
        if (!end.transmitted()) surface = end.surface;
        return end.transmitted();
      });
      return std::pair(at(last), surface);
    };
    const double fraction =
        core_detail::last_with(0.0, 1.0, [&](double p) { return edge(p).second == one.to.surface; });
    points.add(edge(fraction).first, 0);
  }
}

}  // namespace

RayBundle trace_nodes(const Lens& lens, const PupilBoundary& boundary, double plane_z) {
  const double cell = boundary.half_axes[0] * boundary.half_axes[1];
  PupilPoints points;
  pupil_detail::for_each_node<32>(boundary, [&](const Vec2<double>& position, double area, double weight) {
    points.add(position, cell * area * weight);
  });
  return trace_points(lens, boundary, plane_z, points);
}

RayBundle trace_rim(const Lens& lens, const PupilBoundary& boundary, double plane_z) {
  PupilPoints points;
  for (const PupilSpan& span : boundary.spans) {
    points.add({span.from.x, span.from.y}, 0);
    points.add({span.to.x, span.to.y}, 0);
  }
  add_corners(lens, boundary, points);
  return trace_points(lens, boundary, plane_z, points);
}

}  // namespace petzval::pupil_detail
