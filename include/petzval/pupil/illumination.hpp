// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/pupil/pupil_plane.hpp"

namespace petzval {

/// Irradiance of the film of a lens at a point, in units of the radiance of a scene that is uniform in all directions:
/// n'^2 times the projected solid angle in which the point sees the scene through the lens, in sr. Within 5e-4 for
/// stops of 1e-6 mm and more; one that rays do not resolve counts as closed. Only light of the
/// pupil counts, as in pupil_boundary; tests/pupil compares every lens of data/ with rays in all directions. Within 5 %
/// of the little light that comes along the film beside a lens that nearly touches it. Throws Error where
/// pupil_boundary does.
PETZVAL_API double film_irradiance(const Lens& lens, const FilmPoint& point, Wavelength wavelength = {});

/// film_irradiance where the chief ray of a scene point meets the film, relative to that on the axis: natural and
/// optical vignetting, with the effects of distortion and pupil aberration. No value where the axis is dark or no chief
/// ray reaches the film. Throws Error where PupilPlane does, for scene points and for the film.
PETZVAL_API std::optional<double> relative_illumination(const Lens& lens, const FieldPoint& point,
                                                        Wavelength wavelength = {});

/// The diameter of the circle about the axis, on the film of the lens, in which film_irradiance is at least a part of
/// that on the axis, mm; for 0, in which any light arrives at all. 0 where the axis is dark, infinite where the circle
/// is wider than 1000 focal lengths. Without symmetry of revolution: the largest circle in which this holds in eight
/// directions.
///
/// Within 1e-4 of the focal length. Fields are looked at in steps of a tenth of the focal length: a darker ring between
/// two of them is not seen. Throws Error where film_irradiance does, and for a part that is not from 0 to 1.
PETZVAL_API double image_circle_mm(const Lens& lens, double least_part = 0, Wavelength wavelength = {});

}  // namespace petzval
