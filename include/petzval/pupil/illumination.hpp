// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <optional>

#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/pupil/aim.hpp"

namespace petzval {

/// Irradiance of the film at a point for a uniform scene of radiance 1 (sr): n'^2 times the projected solid angle in
/// which the point sees the scene through its vignetted pupil.
///
/// @throws Error  if the point is not finite or the film lies in the plane of the last vertex
///
/// Accuracy: 5e-4 for stops of at least 1e-6 mm (tests/pupil compares every lens of data/ with rays in all directions);
/// a stop too small for rays counts as closed. 5 % if the light travels along the film, outside a lens that almost
/// touches the film.
PETZVAL_API double film_irradiance(const Lens& lens, const FilmPoint& point, Wavelength wavelength = {});

/// Irradiance at the film point of a scene point's chief ray, relative to the axis: natural and optical vignetting,
/// with distortion and pupil aberration. nullopt if the axis is dark, no chief ray reaches the film, or the film lies
/// in the plane of the last vertex.
///
/// @throws Error  if scene_point() does
PETZVAL_API std::optional<double> relative_illumination(const Lens& lens, const FieldPoint& point,
                                                        Wavelength wavelength = {});

/// Diameter of the image circle on the film (mm): the irradiance inside is at least a fraction of that on the axis.
///
/// For a lens without symmetry of revolution, this holds in eight directions. 0 if the axis is dark; infinite if the
/// circle is wider than 1000 focal lengths.
///
/// @param lens        the lens
/// @param least_fraction  smallest fraction of the irradiance on the axis, 0 to 1; 0: any light
/// @param wavelength  a compiled wavelength
/// @throws Error      if film_irradiance() does, or least_fraction is outside [0, 1]
///
/// Accuracy: 1e-4 focal lengths.
///
/// Limitations: heights are tested in steps of a tenth of the focal length; a dark ring between two steps is missed.
PETZVAL_API double image_circle_mm(const Lens& lens, double least_fraction = 0, Wavelength wavelength = {});

/// The default film of a lens: 3:2 with 1920 x 1280 pixels.
///
/// @param lens         the lens
/// @param diagonal_mm  the declared diagonal, for example Prescription::image_diagonal_mm. nullopt: the diameter of the
///                     image circle with at least a tenth of the irradiance on the axis
/// @param largest_mm   limit of the diameter of the image circle; the diagonal of Film{} gives at most 36 x 24 mm
/// @throws Error       unless the diagonal is positive and finite
PETZVAL_API Film default_film(const Lens& lens, std::optional<double> diagonal_mm = {},
                              double largest_mm = std::numeric_limits<double>::infinity());

}  // namespace petzval
