// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>

#include "petzval/analysis/lens_distortion.hpp"
#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval {

/// What files call a lens. Empty texts are not written.
struct LensIdentity {
  std::string make{}, model{}, serial_number{};
  std::optional<double> nominal_focal_length_mm{};  ///< as engraved
};

/// The name of a prescription as the model, and its nominal focal length.
PETZVAL_API LensIdentity identity_of(const Prescription& prescription);

/// A film for a lens that came without one: 3:2 and 1920 x 1280 pixels, with the image diagonal that the prescription
/// declares, else with the image circle in which the film has a tenth of the light of the axis. Throws Error where
/// neither is a positive length below 1000 focal lengths.
PETZVAL_API Film film_of(const Prescription& prescription, const Lens& lens);

/// What a lens is set to, in the words of OpenEXR and OpenTrackIO.
struct LensState {
  double effective_focal_length_mm = 0;  ///< in the main meridian
  double pinhole_focal_length_mm = 0;    ///< of Pinhole, down the picture
  double f_number = 0;                   ///< effective focal length over the diameter of the paraxial entrance pupil
  /// That of a round pupil of the area that lets light through, at least the f-number: blades and obscurations count,
  /// and glass and coatings lose nothing.
  double t_number = 0;
  double focus_distance_mm = 0;         ///< of the subject from the film; infinite at infinity
  double entrance_pupil_offset_mm = 0;  ///< from the film to the entrance pupil, positive towards the scene
};

/// The setting of the lens of a camera, with Pinhole::subject_z_mm as the subject. Throws Error where pupil_boundary()
/// does.
PETZVAL_API LensState lens_state(const LensDistortion& distortion);

/// How much darker the film gets towards its edge: 1 - (a1 r^2 + a2 r^4 + a3 r^6) of the light on the axis at r mm from
/// it. Source: OpenLensIO 1.0, equation 20.
struct PETZVAL_API ExposureFalloff {
  std::array<double, 3> a{};
  double largest_error = 0;  ///< in parts of the light on the axis, where there is light

  double light(double radius_mm) const noexcept;
};

/// Fitted to film_irradiance() by least squares over the area of the film, as far out as light reaches it. Of a lens
/// without symmetry of revolution over four directions from the axis. Throws Error where film_irradiance() does and for
/// a lens whose axis is dark.
PETZVAL_API ExposureFalloff fit_exposure_falloff(const Lens& lens, const Film& film);

}  // namespace petzval
