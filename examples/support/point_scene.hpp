// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "petzval/core/film.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace examples {

/// A scene through known points. At every place 1/distance is that of a plane fitted to the points, with weights by the
/// inverse fourth power of their angular distance (moving least squares). The scene contains every point; points of a
/// plane give that plane. 1/distance exceeds the range of the points by at most that range, and is never negative.
class PointScene {
 public:
  /// Leaves out points behind the lens. Needs at least one other.
  PointScene(const petzval::IdealLens& lens, std::span<const petzval::ScenePoint> points);

  /// The scene point that the ideal lens images at a film point, by the chief ray. Nothing if that ray does not come
  /// from the scene.
  std::optional<petzval::ScenePoint> at(const petzval::Film& film, const petzval::FilmPoint& point) const;

 private:
  struct Known {
    double x = 0, y = 0, inverse_distance = 0;
  };
  double inverse_distance(double x, double y) const;

  petzval::IdealLens lens_;
  double from_z_ = 0;      // of distances
  bool parallel_ = false;  // chief rays, in front of a lens telecentric there: x and y are places, not slopes
  std::vector<Known> known_;
};

/// The hit of a scene point's chief ray on the film. Nothing if the point has no real image or the ray misses the film.
std::optional<petzval::FilmPoint> on_film(const petzval::IdealLens& lens, const petzval::Film& film,
                                          const petzval::ScenePoint& place);

}  // namespace examples
