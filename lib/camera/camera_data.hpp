// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <optional>

#include "petzval/camera/camera.hpp"
#include "petzval/camera/ray_model.hpp"
#include "petzval/lens/lens.hpp"
#include "sample_rays.hpp"
#include "scene_side.hpp"
#include "tilted_film.hpp"

namespace petzval::inline v0 {

/// Everything that a camera works out once: the film's side when it is made, the scene's when it is first asked for.
struct Camera::Data {
  /// radius: upright_radius() of the film.
  Data(const camera_detail::LensFacts& facts, const Film& placed, const AnyRayModel& model, double radius,
       const CameraOptions& options);

  Lens lens;
  Film film;
  AnyRayModel model;
  std::optional<camera_detail::TiltedFilm> tilted;
  camera_detail::PupilWeights weights;
  camera_detail::WavelengthFacts wavelengths;  ///< scales of weights and importance
  camera_detail::Front front;
  camera_detail::LocalFocus focus;
  Normalisation normalisation;
  double pdf_film;  ///< of film points spread uniformly over the film, 1/mm^2

  const camera_detail::FilmView& view() const noexcept { return view_; }
  /// A wavelength as the model takes it: a position, or nm where it takes any.
  Wavelength resolved(Wavelength given) const noexcept {
    if (!given.in_nm()) return given.position(primary_);
    return model.any_wavelength() ? given : Wavelength(lens.position(given));
  }
  /// Renderers that trace paths from the film alone never ask for it.
  const camera_detail::SceneSide& scene() const {
    std::call_once(scene_once_,
                   [&] { scene_.emplace(facts_, film, tilted, front, focus, model, radius_, wavelengths, weights); });
    return *scene_;
  }

 private:
  camera_detail::LensFacts facts_;
  double radius_;
  std::size_t primary_;
  camera_detail::FilmView view_;
  mutable std::once_flag scene_once_;
  mutable std::optional<camera_detail::SceneSide> scene_;
};

}  // namespace petzval::inline v0
