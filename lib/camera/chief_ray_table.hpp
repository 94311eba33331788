// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "camera/ray_model.hpp"
#include "lens_facts.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil_table/two_plane_rays.hpp"

namespace petzval::camera_detail {

/// Traces an image-space line to the scene, ignoring clear apertures.
TracedRay<double> unclipped(const Lens& lens, const TwoPlanes& space, Wavelength wavelength, const TwoPlaneRay& line);

/// Chief rays of one wavelength as image-space rays. For exact and polynomial models they are exact rays through the
/// centre of the stop, for other models rays of the model through the centres of its pupils.
class ChiefRayTable {
 public:
  /// @param middle for first-order models: pupil position divided by film point, for chief rays
  ChiefRayTable(const LensFacts& facts, const RayModel& model, double film_radius, std::size_t wavelength,
                std::optional<double> middle = {});

  /// Intersection of the chief ray of a film point with the pupil plane.
  std::array<double, 2> pupil_point(const FilmPoint& film) const noexcept;

  /// Approximate film point whose chief ray comes from a scene point. nullopt if there is no such chief ray, or if the
  /// film point is farther from the axis than 1.5 film radii.
  std::optional<FilmPoint> about(const Vec3<double>& point) const noexcept;

 private:
  /// A chief ray in the meridian of +y or, for lenses with cylinders, of +x: heights in the meridian, and z.
  struct Node {
    double film = 0, ratio = 0;                                       // height on the film; pupil height / film height
    double height = 0, z = 0, direction_height = 0, direction_z = 0;  // ray towards the scene
  };
  using Meridian = std::vector<Node>;

  static double ratio(const Meridian& nodes, double film) noexcept;
  static std::optional<double> find(const Meridian& nodes, double height, double z) noexcept;

  Meridian y_, x_;  // x_ is empty if equal to y_
};

}  // namespace petzval::camera_detail
