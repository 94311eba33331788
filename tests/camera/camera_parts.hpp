// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "camera/check_film.hpp"
#include "camera/make_model.hpp"
#include "camera/tilted_film.hpp"
#include "petzval/camera/ray_model.hpp"

namespace petzval::testing {

/// What a camera of a lens and a film is built of.
struct CameraParts {
  AnyRayModel model;
  std::optional<camera_detail::TiltedFilm> tilted;

  CameraParts(const Lens& lens, const Film& film, ModelKind kind)
      : model(
            camera_detail::make_model(kind, camera_detail::placed(lens, film).lens, upright_radius(lens, film, kind))) {
    if (film.tilted()) tilted.emplace(film, model.pupils());
  }
  const FilmPupilTable& pupils() const { return model.pupils(); }
};

}  // namespace petzval::testing
