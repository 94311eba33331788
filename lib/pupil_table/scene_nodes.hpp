// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "petzval/core/geometry.hpp"
#include "petzval/core/ray.hpp"
#include "pupil/pupil_plane.hpp"
#include "pupil_table/entrance_pupil_table.hpp"
#include "pupil_table/pupil_polygon.hpp"
#include "scene_grid.hpp"

/// The polygons at the nodes of a SceneGrid, while a table is made.
namespace petzval::pupil_table_detail {

/// Clearances of positions in planes, from the rays through the positions.
class RayClearances {
 public:
  /// @param passing must outlive this object
  RayClearances(const ScenePassing& passing, std::size_t wavelength) : passing_(passing), wavelength_(wavelength) {}
  /// @param ray_at function; ray_at(i) is ray i of `count` rays
  /// @param clearances results as of PlaceClearances; only the signs are meaningful
  template <class RayAt>
  void operator()(std::size_t count, const RayAt& ray_at, double* clearances) {
    for (auto& component : components_) component.resize(count);
    for (std::size_t r = 0; r < count; ++r) {
      const Ray<double> ray = ray_at(r);
      for (int i : {0, 1, 2}) components_[i][r] = ray.origin[i], components_[3 + i][r] = ray.direction[i];
    }
    test(count, clearances);
  }

 private:
  void test(std::size_t count, double* clearances);

  const ScenePassing& passing_;
  std::size_t wavelength_;
  std::array<std::vector<double>, 6> components_;
  std::vector<std::uint8_t> through_;
};

/// Direction from a centre to the point at which a ray leaves a sphere about the centre.
Bearing bearing_on_sphere(const Vec3<double>& centre, const Ray<double>& ray, double reciprocal_radius) noexcept;
/// Largest field, in rad, of the points at which rays leave a sphere about a centre.
double widest_field(const Vec3<double>& centre, const std::vector<Ray<double>>& rays,
                    double reciprocal_radius) noexcept;
/// The plane that faces a scene point.
PupilPlane plane_facing(const Vec3<double>& centre, const Bearing& bearing, double reciprocal_distance) noexcept;

/// The nodes of one wavelength.
template <int dimensions>
struct SceneNodes {
  using L = SceneLayout<dimensions>;
  std::array<double, L::limits> widest{};  ///< SceneGrid::widest
  std::vector<PupilPolygon> polygons;      ///< empty if pupils are not star-shaped about a middle

  /// Weights for the fractions of cell_of().
  static PolygonWeights weights_at(double distance, double down, double across) noexcept {
    const SceneCell<dimensions> cell = cell_of<dimensions>(distance, down, across);
    PolygonWeights result;
    for (std::size_t j = 0; j < L::cell_nodes; ++j) {
      result.polygons[j] = static_cast<std::size_t>(cell.first + L::offset(j));
      result.weights[j] = cell.weight(j);
    }
    return result;
  }
  /// The last field, by angle.
  Vec2<double> last(double distance) const noexcept {
    return {last_field<dimensions>(widest.data(), distance, 0),
            last_field<dimensions>(widest.data(), distance, L::angles - 1)};
  }
  /// nullopt if the field lies outside the grid.
  /// @param distance fraction of the largest reciprocal distance
  std::optional<PolygonWeights> weights(const Vec2<double>& field, double distance) const noexcept {
    const Vec2<double> fraction = field / last(distance);
    if (!(fraction.x <= 1 && fraction.y <= 1)) return {};
    return weights_at(distance, fraction.y, fraction.x);
  }
};

/// The angles of SceneLayout.
template <int dimensions>
Vec2<double> angles(const Bearing& bearing) noexcept {
  return {angle_of<dimensions>(bearing, 0), angle_of<dimensions>(bearing, dimensions - 2)};
}

/// The nodes of a lens of revolution.
/// @param rays leaving_rays() of the wavelength
/// @param steepest largest reciprocal distance, 1/mm
SceneNodes<2> nodes_of_revolution(const Vec3<double>& centre, double steepest, const std::vector<Ray<double>>& rays,
                                  std::size_t wavelength, const ScenePassing& passing, ClippedBy clipped_by);
/// The nodes of a lens that is symmetric in x and in y.
SceneNodes<3> nodes_with_cylinders(const Vec3<double>& centre, double steepest, const std::vector<Ray<double>>& rays,
                                   std::size_t wavelength, const ScenePassing& passing);

}  // namespace petzval::pupil_table_detail
