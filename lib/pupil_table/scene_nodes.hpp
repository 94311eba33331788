// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <glm/common.hpp>
#include <vector>

#include "petzval/core/geometry.hpp"
#include "petzval/core/ray.hpp"
#include "pupil_chart.hpp"
#include "pupil_table/entrance_pupil_table.hpp"
#include "scene_grid.hpp"

/// The polygons at the nodes of a SceneGrid, while a table is made.
namespace petzval::pupil_table_detail {

/// Largest field, in rad, of the points at which rays leave a sphere about a centre.
double widest_field(const Vec3<double>& centre, const std::vector<Ray<double>>& rays,
                    double reciprocal_radius) noexcept;

/// The nodes of one wavelength. Their chart has layers of equal reciprocal distance, as fractions of the largest.
template <int dimensions>
struct SceneNodes {
  using L = SceneLayout<dimensions>;
  static constexpr Lattice lattice{{L::distances, dimensions == 2 ? 0 : L::fields, L::fields}};
  std::array<double, L::limits> widest{};  ///< SceneGrid::widest
  std::vector<PupilPolygon> polygons;      ///< empty if pupils are not star-shaped about a middle

  /// The last field at a distance, by angle.
  Vec2<double> last(double distance) const noexcept {
    return {last_field<dimensions>(widest.data(), distance, 0),
            last_field<dimensions>(widest.data(), distance, L::angles - 1)};
  }
  /// The point of the chart with the angles of SceneLayout; fields outside the grid are limited to the last field.
  ChartPoint point(double distance, const Vec2<double>& angles) const noexcept {
    const Vec2<double> limit = last(distance), fraction = glm::min(angles, limit) / limit;
    return {distance, fraction.y, dimensions == 2 ? fraction.y : fraction.x};
  }
  /// The angles of a point.
  Vec2<double> angles(const ChartPoint& point) const noexcept {
    return last(point[0]) * Vec2<double>{dimensions == 2 ? 0 : point[2], dimensions == 2 ? point[2] : point[1]};
  }
};

/// @param rays leaving_rays() of the wavelength
/// @param steepest largest reciprocal distance, 1/mm
template <int dimensions>
SceneNodes<dimensions> scene_nodes(const Vec3<double>& centre, double steepest, const std::vector<Ray<double>>& rays,
                                   std::size_t wavelength, const ScenePassing& passing);

}  // namespace petzval::pupil_table_detail
