// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>
#include <vector>

#include "iris/iris_sample.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/iris/iris.hpp"

namespace petzval::iris_detail {

/// The shape of an iris in units of the stop's semi-diameter, for sampling.
class PETZVAL_API IrisShape {
 public:
  /// The unit disc.
  IrisShape() = default;
  /// Throws Error if blades, roundness or rotation are out of range.
  explicit IrisShape(const Iris& iris);

  const Iris& iris() const noexcept { return iris_; }
  bool round() const noexcept { return iris_.round(); }
  double area() const noexcept { return area_; }
  /// A uniform point of the iris for u and v in [0, 1]. u runs around the axis from +y towards +x, starting at the
  /// first corner (of a disc: at +y). v runs outwards and is the fraction of the area nearer to the centre. The map
  /// preserves ratios of areas and is continuous.
  Vec2<double> sample(double u, double v) const noexcept;
  /// The inverse of sample(): u and v of a point. v is above 1 outside the iris; u is 0 at the centre.
  Vec2<double> position(double x, double y) const noexcept;
  /// v of position(): the fraction of the area nearer to the centre.
  double area_fraction(double x, double y) const noexcept;
  bool contains(double x, double y) const noexcept;

  /// The arrays for loops over samples, in float or double.
  template <class R>
  IrisSectors<R> sectors() const noexcept {
    const auto of = [](const auto& columns) -> IrisSectors<R> {
      return {columns.turns.size() / 2, columns.turns.data(), columns.across.data(), columns.along.data(),
              columns.edges.data()};
    };
    if constexpr (sizeof(R) == sizeof(float)) {
      return of(single_);
    } else {
      return of(twice_);
    }
  }

 private:
  template <class R>
  struct Columns {
    std::vector<R> turns, across, along, edges;
  };
  template <class R>
  void fill(Columns<R>& columns) const;

  Iris iris_;
  double area_ = std::numbers::pi;
  Columns<float> single_;
  Columns<double> twice_;
};

}  // namespace petzval::iris_detail
