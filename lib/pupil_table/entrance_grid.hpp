// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "petzval/core/geometry.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/pupil/pupil_plane.hpp"
#include "pupil_table/entrance_pupil_table.hpp"
#include "pupil_table/pupil_polygon.hpp"

namespace petzval::pupil_table_detail {

/// What clearances tell of places in planes, by the rays that meet them there.
class RayClearances {
 public:
  /// passing has to outlive this.
  RayClearances(const ScenePassing& passing, std::size_t wavelength) : passing_(passing), wavelength_(wavelength) {}
  /// ray_at(i): one of `count` rays. clearances: as PlaceClearances, where no more is known than whether rays pass.
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

/// Where a direction from the centre of a table of entrance pupils lies.
struct Bearing {
  double field = 0;
  Vec2<double> azimuth{0, 1};

  explicit Bearing(const Vec3<double>& unit) noexcept;
  /// Where a ray leaves the sphere of a radius about the centre.
  Bearing(const Vec3<double>& centre, const Ray<double>& ray, double reciprocal_radius) noexcept;

  /// Of a place in the plane that faces this way: along the axes of the lens, as a place seen on the axis has them, and
  /// back. In the quadrant x, y >= 0 of the azimuth; those of other azimuths are mirror images.
  Vec2<double> in_quadrant(const Vec2<double>& place) const noexcept;
  Vec2<double> from_quadrant(const Vec2<double>& place) const noexcept;
};

/// The entrance pupils of a lens that is alike at x and -x and at y and -y, at one wavelength: over the two angles of a
/// field, field times azimuth, and reciprocal distance. Polygons lie in_quadrant() of the planes that face their
/// points.
class EntranceGrid {
 public:
  /// rays: those that leave the lens. steepest: the largest reciprocal distance, 1/mm.
  EntranceGrid(const Vec3<double>& centre, double steepest, const std::vector<Ray<double>>& rays,
               std::size_t wavelength, const ScenePassing& passing);

  /// The pupil of a point; empty for fields beyond the grid.
  PupilPolygon polygon(const Bearing& bearing, double reciprocal_distance) const noexcept;
  /// Pupils that no polygon about a middle describes: there is no table.
  bool empty() const noexcept { return polygons_.empty(); }

 private:
  static constexpr std::size_t steps = 6, distance_steps = 2;  // cells along an angle, along reciprocal distance
  static constexpr std::size_t nodes = steps + 1, distances = distance_steps + 1;

  std::optional<PolygonWeights> weights(const Bearing& bearing, double reciprocal_distance) const noexcept;
  /// By parts in [0, 1] of the largest reciprocal distance and of the largest angles at it.
  static PolygonWeights weights_at(double distance, double down, double across) noexcept;
  Vec2<double> widest(double distance) const noexcept;

  double steepest_;
  std::array<Vec2<double>, distances> widest_{};  // angles, rad
  std::vector<PupilPolygon> polygons_;            // [distance][y][x]
};

}  // namespace petzval::pupil_table_detail
