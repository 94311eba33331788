// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "lens_facts.hpp"
#include "petzval/camera/ray_model.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/pupil_table/two_plane_rays.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval::camera_detail {

/// Where an exact line of the film's space goes, clear apertures ignored.
TracedRay<double> unclipped(const Lens& lens, const TwoPlanes& space, Wavelength wavelength, const TwoPlaneRay& line);

/// The chief rays of one wavelength as image-space rays: for the exact and polynomial models, exact rays through the
/// centre of the stop; for the others, the model's rays through the middles of its own pupils.
class ChiefRayTable {
 public:
  /// middle: of first-order models, where chief rays pass the plane of the pupil instead, over their film points.
  ChiefRayTable(const LensFacts& facts, const AnyRayModel& model, double film_radius, std::size_t wavelength,
                std::optional<double> middle = {});

  /// Where a film point's chief ray passes the plane of the pupil.
  std::array<double, 2> pupil_point(const FilmPoint& film) const noexcept;

  /// Roughly the film point whose chief ray comes from a point of the scene. Nothing where no chief ray does, or one
  /// that meets the film's plane beyond 1.5 times the film's radius.
  std::optional<FilmPoint> about(const Vec3<double>& point) const noexcept;

 private:
  /// Chief rays in the meridian of +y or, for lenses that differ, of +x: heights there and along z.
  struct Node {
    double film = 0, ratio = 0;  // height on the film, and the height in the pupil over it
    double height = 0, z = 0, direction_height = 0, direction_z = 0;  // towards the scene
  };
  using Meridian = std::vector<Node>;

  static double ratio(const Meridian& nodes, double film) noexcept;
  static std::optional<double> find(const Meridian& nodes, double height, double z) noexcept;

  Meridian y_, x_;  // x_ is empty where it is as y_
};

}  // namespace petzval::camera_detail
