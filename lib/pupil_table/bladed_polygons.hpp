// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "petzval/core/geometry.hpp"
#include "petzval/iris/iris.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/pupil_table/two_plane_rays.hpp"
#include "pupil_table/pupil_polygon.hpp"

namespace petzval::pupil_table_detail {

/// Where the rays of a film point on +y meet the stop and where the stop is seen from there, as polynomials fitted to
/// rays through its pupil. Places are counted from a middle on the y axis, mm; points of the stop in its
/// semi-diameters.
class StopMap {
 public:
  StopMap() = default;
  /// pupil: that of the round stop of the film point (0, height).
  StopMap(const Lens& lens, const TwoPlanes& space, double height, const PupilPolygon& pupil, std::size_t wavelength);

  /// Enough rays of the pupil reach the stop.
  bool known() const noexcept { return known_; }
  /// Within error().
  Vec2<double> stop(const Vec2<double>& place) const noexcept;
  double error() const noexcept { return error_; }
  /// Nearly, beyond the pupil too.
  Vec2<double> place(const Vec2<double>& stop) const noexcept;

  /// Counts places from another middle: y.
  void count_from(double middle) noexcept { middle_ = middle - base_; }

 private:
  template <std::size_t even, std::size_t odd>
  struct Mirrored {  // the coefficients of y, even in x, and of x over x
    std::array<double, even> y{};
    std::array<double, odd> x{};
  };

  double base_ = 0, middle_ = 0, radius_ = 1, error_ = 0;
  Mirrored<12, 9> to_stop_;
  Mirrored<6, 4> from_stop_;
  bool known_ = false;
};

/// A grid over the part of the film that a bladed iris makes different: rows at equal steps of the distance from the
/// axis, columns at equal steps of the azimuth from the direction of a blade's corner to that of an edge's middle.
struct BladedGrid {
  Iris iris;
  double film_radius = 0;  ///< of the last row, mm
  std::size_t rows = 0, columns = 0, corners = 0;

  /// polygons: how many those of the round stop are.
  BladedGrid(const Iris& iris, double film_radius, std::size_t polygons);

  /// The distance and the azimuth of a node, from the corner towards +x.
  std::array<double, 2> node(std::size_t i) const noexcept;
};

/// The pupils at the nodes of the grid, row by row, turned so that a corner of the iris is on +y: what the iris leaves
/// of those of the round stop or of others like them, at twice as many steps of the distance as rows. Corner k of a
/// polygon lies where the k-th part of the iris's area ends, or on the way there; those beyond grid.corners are like
/// corner 0. Middles are those of film points on +y. Obscurations are left out. maps: one for each polygon.
std::vector<PupilPolygon> bladed_polygons(const BladedGrid& grid, std::span<const PupilPolygon> round,
                                          std::vector<StopMap> maps, PolygonFit fit);

}  // namespace petzval::pupil_table_detail
