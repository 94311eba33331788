// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>

#include "petzval/analysis/distortion.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval {

/// Names and nominal data of a lens for file metadata. Empty strings are not written.
struct LensIdentity {
  std::string make{}, model{}, serial_number{};
  std::optional<double> nominal_focal_length_mm{};  ///< as engraved
};

/// The identity of a prescription: its name as the model, and its nominal focal length.
PETZVAL_API LensIdentity identity_of(const Prescription& prescription);

/// A default film for a lens: 3:2 with 1920 x 1280 pixels.
///
/// The diagonal is the image diagonal of the prescription. If the prescription declares no diagonal, it is the diameter
/// of the image circle within which the irradiance is at least a tenth of the irradiance on the axis.
///
/// @throws Error unless the diagonal is positive and finite; an image circle above 1000 focal lengths is infinite
PETZVAL_API Film film_of(const Prescription& prescription, const Lens& lens);

/// The f-numbers and the T-stop of a lens, for reports and file formats.
struct ApertureState {
  double f_number = 0;       ///< real_f_number(), the argument of with_f_number() if the lens is stopped down
  double area_f_number = 0;  ///< area_f_number(), at least f_number: with blades and obscurations, without losses
  /// T-stop: area_f_number divided by the root of the transmittance() of the axis at infinity, at the primary
  /// wavelength; nullopt unless a coating is stated (states_coatings()): the losses are unknown.
  std::optional<double> t_number{};
};

/// The aperture state of a lens at its primary wavelength.
///
/// @throws Error under the conditions of real_f_number() and area_f_number(), and of transmittance() if a coating is
///               stated
PETZVAL_API ApertureState aperture_state(const Lens& lens);

/// Lens settings, with the terms of OpenEXR and OpenTrackIO.
struct LensState : ApertureState {
  double effective_focal_length_mm = 0;  ///< in the main meridian
  double pinhole_focal_length_mm = 0;    ///< vertical focal length of Pinhole
  double focus_distance_mm = 0;          ///< from the film to the subject; infinite at infinity
  double entrance_pupil_offset_mm = 0;   ///< from the film to the entrance pupil, positive towards the scene
};

/// The lens settings of a camera, with the subject at Pinhole::subject_z_mm.
///
/// @throws Error under the conditions of scene_point() and aperture_state()
PETZVAL_API LensState lens_state(const LensDistortion& distortion);

/// Polynomial falloff of the irradiance towards the edge of the film, relative to the axis.
///
/// The relative irradiance at r mm from the axis is 1 - (a1 r^2 + a2 r^4 + a3 r^6). Source: OpenLensIO 1.0, equation
/// 20.
struct PETZVAL_API ExposureFalloff {
  std::array<double, 3> coefficients{};
  double largest_error = 0;  ///< largest error where the film is lit, as a fraction of the irradiance on the axis

  /// Relative irradiance at a distance from the axis (mm).
  double light(double radius_mm) const noexcept;
};

/// Fits an exposure falloff to film_irradiance() by least squares over the lit area of the film.
///
/// Lenses without rotational symmetry are sampled in four directions from the axis.
///
/// @throws Error if the axis is dark; also under the conditions of film_irradiance()
PETZVAL_API ExposureFalloff fit_exposure_falloff(const Lens& lens, const Film& film);

}  // namespace petzval
