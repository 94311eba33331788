// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "iris/iris_shape.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/iris/iris.hpp"

namespace petzval::iris_detail {

/// Throws Error, prefixed with `where`, if a weight is negative or not finite, the number of values is not width x
/// height, or there are more than 2^26 pixels.
PETZVAL_API void check(const IrisMap& map, const std::string& where);

/// The map as it appears in an image that is mirrored along x, along y, or along both.
PETZVAL_API IrisMap upside_down(IrisMap map, bool along_x, bool along_y);

/// Weights over an iris, and importance sampling of the weights.
class PETZVAL_API IrisWeights {
 public:
  /// @param map a map that passes check()
  /// @param uniform_fraction fraction of the samples that is spread uniformly, independent of the weights
  /// @throws Error, prefixed with `where`, if the edge is out of range or the map is black on the iris
  IrisWeights(const Iris& iris, const EdgeWeight& edge, const IrisMap& map, double uniform_fraction,
              const std::string& where);

  /// The weight at a point of the stop, in semi-diameters. Outside the iris the edge weight keeps its value at the rim.
  double at(const Vec2<double>& stop_point) const noexcept;
  /// The weight at IrisShape::sample(u, v).
  double of_sample(double u, double v) const noexcept;
  /// The mean weight over the iris.
  double mean() const noexcept { return mean_; }

  /// Arguments of IrisShape::sample() with their probability density on the unit square.
  struct IrisSample {
    double u, v, density;
  };
  /// Maps uniform random numbers to (u, v) whose density is nearly proportional to the weights.
  IrisSample draw(double u, double v) const noexcept;
  /// The density of draw() at (u, v).
  double density(double u, double v) const noexcept;

 private:
  void tabulate_edge();
  /// Divides v into rows that receive equal fractions of the samples. Edge weights are nearly constant within a row.
  void divide_rows(std::size_t count, double uniform_fraction);
  /// The contribution of each cell to the mean weight, [row][column]. Scales the map to mean 1 if it keeps its mean.
  std::vector<double> light_of_cells();
  /// Distributes samples over the cells.
  /// @param contributions contributions to the mean weight, scaled to the sum 1
  void divide_columns(const std::vector<double>& contributions, double uniform_fraction);

  double edge_at(double area_fraction) const noexcept;
  double map_at(const Vec2<double>& stop_point) const noexcept;
  std::size_t row_of(double v) const noexcept;
  std::size_t column_of(double u) const noexcept;

  IrisShape shape_;
  EdgeWeight edge_;
  /// Edge weight and its change per step at equally spaced fractions of the area, for cubic interpolation, which is
  /// four times as fast as a power. Empty if interpolation is not accurate enough.
  std::vector<std::array<double, 2>> edge_steps_;
  IrisMap map_;  // scaled by the constructor
  double mean_ = 1;
  std::vector<double> rows_;           // lower ends of the rows in v, then 1
  std::vector<double> row_densities_;  // sample density of each row
  // With a map only; without a map every row has the same fraction of the samples.
  std::vector<double> before_rows_;    // [rows + 1] fraction of all samples in the rows before
  std::vector<double> before_in_row_;  // [row][columns + 1] fraction of the row's samples in the columns before
};

}  // namespace petzval::iris_detail
