// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "iris/iris_sample.hpp"
#include "petzval/core/export.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/iris/iris.hpp"

namespace petzval::inline v0::iris_detail {

/// The iris as an image shows it that is upside down along an axis, or along both: turned by half a turn.
PETZVAL_API Iris upside_down(Iris iris, bool along_x = true, bool along_y = true);

/// An iris in units of the stop's semi-diameter, to be sampled: the unit disc, or a polygon within it.
class PETZVAL_API IrisShape {
 public:
  /// The unit disc.
  IrisShape() = default;
  /// Throws Error for an iris with edges that do not form a polygon about the axis with its corners within the rim.
  explicit IrisShape(const Iris& iris);

  /// The disc.
  bool round() const noexcept { return twice_.x.empty(); }
  double area() const noexcept { return area_; }
  /// A uniform point for u and v in [0, 1]: u runs around the axis from +y towards +x, v outwards. Equal areas of the
  /// square become equal areas of the iris, and neighbours stay neighbours.
  Vec2<double> sample(double u, double v) const noexcept;
  bool contains(double x, double y) const noexcept;

  /// For loops over samples, in float or double.
  template <class R>
  IrisTriangles<R> triangles() const noexcept {
    const auto of = [](const auto& columns) -> IrisTriangles<R> {
      if (columns.x.empty()) return {};
      return {columns.x.size() - 1, columns.before.data(), columns.x.data(), columns.y.data()};
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
    std::vector<R> before, x, y;
  };
  template <class R>
  static void put(Columns<R>& columns, const Vec2<double>& corner, double before) {
    columns.before.push_back(static_cast<R>(before));
    columns.x.push_back(static_cast<R>(corner.x));
    columns.y.push_back(static_cast<R>(corner.y));
  }

  double area_ = std::numbers::pi;
  Columns<float> single_;
  Columns<double> twice_;
};

}  // namespace petzval::inline v0::iris_detail
