// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "camera/check_film.hpp"
#include "camera/make_model.hpp"
#include "camera/ray_model.hpp"
#include "camera/tilted_film.hpp"
#include "petzval/camera/camera.hpp"

namespace petzval::testing {

/// The model and the tilted film of a camera.
struct CameraParts {
  std::shared_ptr<const RayModel> made;
  const RayModel& model = *made;
  std::optional<camera_detail::TiltedFilm> tilted;

  CameraParts(const Lens& lens, const Film& film, ModelKind kind)
      : made(
            camera_detail::make_model(kind, camera_detail::placed(lens, film).lens, upright_radius(lens, film, kind))) {
    if (camera_detail::tilted_or_moving(film)) tilted.emplace(film, model.pupils());
  }
  explicit CameraParts(const Camera& camera) : CameraParts(camera.lens(), camera.film(), camera.model()) {}
  const FilmPupilTable& pupils() const { return model.pupils(); }
  /// The sample of a film point nearby whose pupil point has moved as derivatives assume.
  CameraSample moved(const CameraSample& sample, double by_x, double by_y) const {
    const FilmPupilTable& table = tilted ? tilted->pupils() : pupils();
    CameraSample result = sample;
    result.film.x += by_x, result.film.y += by_y;
    const auto place = [&](const FilmPoint& film) {
      return tilted ? tilted->plane(sample.time).virtual_point(film) : film;
    };
    const FilmPoint from = place(sample.film), to = place(result.film);
    const PupilSample p = table.sample(from, sample.pupil_u, sample.pupil_v, sample.wavelength);
    const auto by = table.derivatives(from, sample.pupil_u, sample.pupil_v, sample.wavelength);
    const Vec2<double> move = (to.x - from.x) * by.by_film_x + (to.y - from.y) * by.by_film_y;
    const Vec2<double> at = table.position(to, p.x + move.x, p.y + move.y, sample.wavelength);
    result.pupil_u = at.x, result.pupil_v = at.y;
    return result;
  }
};

/// Cardinal points of a first-order model in air. The model has the focus of exact rays, so that they differ slightly
/// from the paraxial cardinal points.
struct CardinalPoints {
  double front_principal_z, rear_principal_z, focal_length;
};

/// Derived from rays parallel to the axis at 1 mm on either side: incoming and outgoing ray intersect in a principal
/// plane.
inline CardinalPoints cardinal_points(const RayModel& model) {
  const TwoPlanes& space = model.pupils().space();
  Ray<double> ray;
  model.to_scene(TwoPlaneRay{0, 1, 0, 1}, 0, ray);
  const double slope = ray.direction.y / ray.direction.z;
  TwoPlaneRay line;
  RayFate fate{};
  const double zero = 0, one = 1;
  model.to_film(1, {&zero, &one, &zero, &zero, &zero, &one}, {},
                {&line.film_x, &line.film_y, &line.pupil_x, &line.pupil_y}, &fate);
  const double slope_behind = (line.pupil_y - line.film_y) / space.depth();
  return {ray.origin.z + (1 - ray.origin.y) / slope, space.film_z + (1 - line.film_y) / slope_behind, 1 / slope};
}

}  // namespace petzval::testing
