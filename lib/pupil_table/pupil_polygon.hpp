// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "petzval/pupil/pupil_boundary.hpp"
#include "pupil_table/sector.hpp"

namespace petzval::pupil_table_detail {

/// A pupil as tables hold it: a middle and 64 corners around it, with an obscuration in each sector (sector.hpp).
struct PupilPolygon {
  Vec2<double> middle{0, 0};
  std::array<Vec2<double>, polygon_corners> corners{};              ///< from the middle
  std::array<double, polygon_corners> obscured_from{}, obscured{};  ///< by sector

  Sector<double> sector(std::size_t k) const noexcept {
    const auto &a = corners[k], &b = corners[(k + 1) % polygon_corners];
    return {{a[0], a[1]}, {b[0], b[1]}, obscured_from[k], obscured[k]};
  }

  /// mm^2.
  double area() const noexcept;

  /// Scales the corners outwards; obscurations shrink as much, from their outer ends.
  void widen(double by) noexcept;

  /// The way from the middle (0) to the outer edge (1) on which a place lies; -1 where it is obscured, infinite where
  /// no sector faces it.
  double way_to(double x, double y) const noexcept;
};

/// Spreads points uniformly over a polygon, which it does not keep: as PupilSampler does over a PupilBoundary, with
/// triangles for ring sectors.
class PolygonSampler {
 public:
  explicit PolygonSampler(const PupilPolygon& polygon) noexcept;
  explicit PolygonSampler(const PupilPolygon&& polygon) = delete;
  /// mm^2; 0: nothing to sample.
  double area() const noexcept { return before_[polygon_corners]; }
  /// For u and v in [0, 1] (clamped).
  Vec2<double> operator()(double u, double v) const noexcept;

 private:
  const PupilPolygon& polygon_;
  std::array<double, polygon_corners + 1> before_;  // area of the sectors before each
};

enum class PolygonFit {
  enclosing,   ///< contains the region
  equal_area,  ///< has its area
};

enum class CornerSteps {
  even,           ///< equal steps of the area
  even_in_halves  ///< in each of the halves at +x and -x of the middle: corner 32 lies towards -y
};

/// The polygon of a region, corners at equal steps of its area.
PupilPolygon polygon_of(const PupilRegion& region, PolygonFit fit, CornerSteps steps = CornerSteps::even);

/// Some polygons of a table and their weights in an interpolated one.
struct PolygonWeights {
  std::array<std::size_t, 8> polygons{};
  std::array<double, 8> weights{};
};
PupilPolygon interpolated(std::span<const PupilPolygon> polygons, const PolygonWeights& at) noexcept;

/// A region that the polygon interpolated at its place must contain.
struct InterpolationCheck {
  const PupilRegion* region = nullptr;
  PolygonWeights at;
};
/// Expands polygons until every check holds.
void expand_to_cover(std::span<PupilPolygon> polygons, std::span<const InterpolationCheck> checks);

/// Expands the polygon of one wavelength until it contains those of the wavelengths up to the middle between it and a
/// neighbour, whose pupil at the same place is `other`: edges move evenly with the wavelength, nearly.
void expand_towards(PupilPolygon& polygon, const PupilPolygon& other) noexcept;

}  // namespace petzval::pupil_table_detail
