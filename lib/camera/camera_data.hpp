// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "petzval/camera/camera.hpp"
#include "petzval/camera/ray_model.hpp"
#include "petzval/lens/lens.hpp"
#include "sample_rays.hpp"
#include "scene_side.hpp"
#include "tilted_film.hpp"

namespace petzval::inline v0 {

/// Everything that a camera works out once.
struct Camera::Data {
  /// radius: upright_radius() of the film.
  Data(const camera_detail::LensFacts& facts, const Film& placed, const AnyRayModel& model, double radius,
       Normalisation normalisation);

  Lens lens;
  Film film;
  AnyRayModel model;
  std::optional<camera_detail::TiltedFilm> tilted;
  std::vector<double> scale;  ///< of weights and importance, by wavelength
  camera_detail::SceneSide scene;

  camera_detail::FilmView view() const noexcept {
    return {model, film, tilted ? &*tilted : nullptr, scale, scene.front()};
  }
};

}  // namespace petzval::inline v0
