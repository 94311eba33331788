// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "camera/ray_model.hpp"
#include "lens_facts.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/config.hpp"

namespace petzval::camera_detail {

/// Builds a model for film points up to film_radius (mm) from the axis.
/// @param rim clips its pupils
/// @param paraxial_focus CameraOptions::paraxial_focus
/// @throws Error  as the constructor of the model and FilmPupilTable::clipped_by_rim()
PETZVAL_API std::shared_ptr<const RayModel> make_model(ModelKind model, const LensFacts& facts, double film_radius,
                                                       int threads = 1, const std::optional<PupilRim>& rim = {},
                                                       bool paraxial_focus = false);

/// Clips the pupils of a lens by a rim.
/// @throws Error  as FilmPupilTable::clipped_by_rim()
FilmPupilTable behind(const PupilRim& rim, const FilmPupilTable& pupils, const Lens& lens);

}  // namespace petzval::camera_detail
