// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "iris/iris_shape.hpp"
#include "petzval/core/export.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/iris/iris_weights.hpp"

namespace petzval::iris_detail {

/// Throws Error, which begins with `where`, for weights that are not finite or negative, sizes that do not fit them,
/// and more than 2^26 pixels.
PETZVAL_API void check(const IrisMap& map, const std::string& where);

/// The map as an image shows it that is upside down along an axis, or along both.
PETZVAL_API IrisMap upside_down(IrisMap map, bool along_x, bool along_y);

/// Weights over an iris, and samples that follow them.
class PETZVAL_API IrisWeights {
 public:
  /// map: as check() lets it pass. uniform_part: of the samples, whatever the weights are. Throws Error, which begins
  /// with `where`, for an edge out of range and a map that is black on the iris.
  IrisWeights(const Iris& iris, const EdgeWeight& edge, const IrisMap& map, double uniform_part,
              const std::string& where);

  /// At a point of the stop, in semi-diameters. Beyond the rim: as there.
  double at(const Vec2<double>& place) const noexcept;
  /// At IrisShape::sample(u, v).
  double of_sample(double u, double v) const noexcept;
  /// Over the iris.
  double mean() const noexcept { return mean_; }

  /// Where uniform numbers of the unit square go: numbers of IrisShape::sample() whose density is nearly in proportion
  /// to the weights.
  struct Drawn {
    double u, v, density;
  };
  Drawn draw(double u, double v) const noexcept;
  /// Of such numbers at a place.
  double density(double u, double v) const noexcept;

 private:
  void tabulate_edge();
  /// Rows with equal parts of the samples that follow the edge's weights: in each, these are nearly even.
  void divide_rows(std::size_t count, double uniform_part);
  /// The light of each row's columns by edge and map, of the map of mean 1 if it keeps that: together the mean weight.
  std::vector<double> light_of_cells();
  /// Samples in cells. parts: of the light, of each row's columns.
  void divide_columns(const std::vector<double>& parts, double uniform_part);

  double edge_at(double share) const noexcept;
  double map_at(const Vec2<double>& place) const noexcept;
  std::size_t row_of(double v) const noexcept;
  std::size_t column_of(double u) const noexcept;

  IrisShape shape_;
  EdgeWeight edge_;
  /// The edge's weight and how much it grows in a step, at even steps of the share, where cubic polynomials between
  /// them are near enough; else empty. A power takes four times as long.
  std::vector<std::array<double, 2>> edge_steps_;
  IrisMap map_;  // scaled
  double mean_ = 1;
  std::vector<double> rows_;           // where they begin, by v; the end of the last one
  std::vector<double> row_densities_;  // of samples in each
  // Of a map; else rows have equal parts of all samples.
  std::vector<double> before_rows_;    // the part of all samples, likewise
  std::vector<double> before_in_row_;  // [row][column]: the part of the row's samples, one more than columns
};

}  // namespace petzval::iris_detail
