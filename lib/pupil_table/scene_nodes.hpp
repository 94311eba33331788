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
template <int angles_of_field>
struct SceneNodes {
  using Chart = SceneChart<angles_of_field>;
  static constexpr Lattice lattice{{Chart::distances, Chart::angles == 1 ? 0 : Chart::fields, Chart::fields}};
  std::array<double, Chart::limits> widest{};  ///< SceneChart::widest
  std::vector<PupilPolygon> polygons;          ///< empty if pupils are not star-shaped about a middle

  /// The last field at a distance, by angle.
  Vec2<double> last(double distance) const noexcept {
    const auto fields = Chart{.widest = widest.data()}.last(distance, 0);
    return {fields.front(), fields.back()};
  }
  /// The point of the chart with the angles of SceneChart; fields outside the grid are limited to the last field.
  ChartPoint point(double distance, const Vec2<double>& angles) const noexcept {
    const Vec2<double> limit = last(distance), fraction = glm::min(angles, limit) / limit;
    return {distance, fraction.y, Chart::angles == 1 ? fraction.y : fraction.x};
  }
  /// The angles of a point.
  Vec2<double> angles(const ChartPoint& point) const noexcept {
    return last(point[0]) * Vec2<double>{Chart::angles == 1 ? 0 : point[2], Chart::angles == 1 ? point[2] : point[1]};
  }
};

/// @param rays leaving_rays() of the wavelength
/// @param steepest largest reciprocal distance, 1/mm
template <int angles>
SceneNodes<angles> scene_nodes(const Vec3<double>& centre, double steepest, const std::vector<Ray<double>>& rays,
                               std::size_t wavelength, const ScenePassing& passing);

}  // namespace petzval::pupil_table_detail
