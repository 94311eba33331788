// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval::ghosts_detail {

inline double cross(const Vec2<double>& a, const Vec2<double>& b) noexcept { return a.x * b.y - a.y * b.x; }

/// A raster of sums over pixels of polygons with uniform density, exact in area.
///
/// Edges are accumulated as differences along rows, so that a polygon costs time by its circumference. A polygon
/// narrower than 0.02 pixels is widened to it and keeps its energy.
class PETZVAL_API AreaRaster {
 public:
  AreaRaster(std::size_t columns, std::size_t rows)
      : columns_(columns), rows_(rows), differences_((columns + 2) * rows) {}

  std::size_t rows() const noexcept { return rows_; }

  /// Adds the energy of a polygon to the rows [first, last). Polygons may leave the raster. Raster coordinates; rows
  /// may be added by several threads if their ranges are disjoint.
  void add(std::span<const Vec2<double>> polygon, double energy, std::size_t first, std::size_t last) noexcept;
  /// Writes the energy of the pixels of a row.
  void read(std::size_t row, std::span<double> energies) const noexcept;

 private:
  void add_edge(const Vec2<double>& from, const Vec2<double>& to, double density, std::size_t first,
                std::size_t last) noexcept;
  void add_slice(std::size_t row, double x0, double x1, double weight) noexcept;

  std::size_t columns_, rows_;
  std::vector<double> differences_;
};

}  // namespace petzval::ghosts_detail
