// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "petzval/camera/any_model.hpp"
#include "petzval/core/vec.hpp"
#include "petzval/film/film.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::inline v0::camera_detail {

/// The chief rays of one wavelength, as lines of the film's space: through the centre of the stop, by exact rays, for
/// every model of the lens but those of first order, whose pupils have middles of their own.
class ChiefLines {
 public:
  ChiefLines(const Lens& lens, const AnyModel& model, double film_radius, std::size_t wavelength);

  /// Where a film point's chief ray passes the plane of the pupil.
  std::array<double, 2> pupil_point(const FilmPoint& film) const noexcept;

  /// About the film point whose chief ray comes from a point of the scene; nothing where no chief ray does, or one that
  /// meets the film's plane farther from the axis than half as much again as the film.
  std::optional<FilmPoint> about(const Vec3<double>& point) const noexcept;

 private:
  /// Chief rays in the meridian of +y or, for lenses that differ, of +x: heights there and along z.
  struct Node {
    double film = 0, ratio = 0;  // height on the film, and what part of it that in the pupil is
    double height = 0, z = 0, direction_height = 0, direction_z = 0;  // towards the scene
  };
  using Meridian = std::vector<Node>;

  static double ratio(const Meridian& nodes, double film) noexcept;
  static std::optional<double> find(const Meridian& nodes, double height, double z) noexcept;

  Meridian y_, x_;  // x_ is empty where it is as y_
};

}  // namespace petzval::inline v0::camera_detail
