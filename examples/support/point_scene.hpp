// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "petzval/film/film.hpp"
#include "petzval/movement/ideal_lens.hpp"

namespace examples {

/// A scene of which some points are known. In between, its 1/distance follows a plane fitted to theirs anew at every
/// place, with weights by the inverse fourth power of how far off they look (moving least squares): it goes through
/// every point, and points of a plane show that plane. Away from all points it leaves their range by no more than that
/// range, and stays real.
class PointScene {
 public:
  /// Points behind the lens are left out; there must be another.
  PointScene(const petzval::IdealLens& lens, std::span<const petzval::ScenePoint> points);

  /// What the ideal lens has at a film point, by the chief ray. Nothing where that does not come from the scene.
  std::optional<petzval::ScenePoint> at(const petzval::Film& film, const petzval::FilmPoint& point) const;

 private:
  struct Known {
    double x = 0, y = 0, disparity = 0;
  };
  double disparity(double x, double y) const;

  petzval::IdealLens lens_;
  double from_z_ = 0;      // of distances
  bool parallel_ = false;  // chief rays, in front of a lens telecentric there: x and y are places, not slopes
  std::vector<Known> known_;
};

/// Where the ideal lens's chief ray of a place meets the film. Nothing for one without a real image, or beside it.
std::optional<petzval::FilmPoint> on_film(const petzval::IdealLens& lens, const petzval::Film& film,
                                          const petzval::ScenePoint& place);

}  // namespace examples
