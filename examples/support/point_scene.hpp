// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "petzval/core/film.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace examples {

/// A scene surface through known points. 1/distance is interpolated by planes fitted to the points with weights of the
/// inverse fourth power of the angular distance (moving least squares). The surface contains every point and reproduces
/// planes. 1/distance exceeds the range of the points by at most the width of that range, and is never negative.
class PointScene {
 public:
  /// Ignores points behind the lens. @throws petzval::Error if no point is in front of the lens
  PointScene(const petzval::IdealLens& lens, std::span<const petzval::ScenePoint> points);

  /// The scene point that the ideal lens images at a film point, by the chief ray; nullopt if that ray does not come
  /// from the scene.
  std::optional<petzval::ScenePoint> at(const petzval::Film& film, const petzval::FilmPoint& point) const;

 private:
  struct Known {
    double x = 0, y = 0, inverse_distance = 0;
  };
  double inverse_distance(double x, double y) const;

  petzval::IdealLens lens_;
  double from_z_ = 0;      // z from which distances count
  bool parallel_ = false;  // object-space telecentric: x and y are positions, not slopes
  std::vector<Known> known_;
};

/// The film point of a scene point's chief ray; nullopt if the point has no real image or the ray misses the film.
std::optional<petzval::FilmPoint> on_film(const petzval::IdealLens& lens, const petzval::Film& film,
                                          const petzval::ScenePoint& scene_point);

}  // namespace examples
