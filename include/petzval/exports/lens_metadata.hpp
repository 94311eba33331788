// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "petzval/analysis/transmittance.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/exports/distortion.hpp"
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

/// Formats a lens as one sample of OpenTrackIO 1.0.1 (SMPTE RIS), for Unreal Engine and other programs.
///
/// The JSON contains these keys; keys with unknown values are omitted:
/// - static.camera: activeSensorPhysicalDimensions (mm) and activeSensorResolution of the film;
/// - static.lens: make, model, serialNumber, nominalFocalLength (mm), distortionOverscanMax, and calibrationHistory, a
///   text with the errors of distortion and falloff, the field up to which they hold, and the field from which on the
///   coefficients fold the picture;
/// - lens.distortion: "Brown-Conrady D-U" and "Brown-Conrady U-D", with overscan and the radial coefficients of
///   OpenLensIO 1.0 for radii in mm on the film: k1, k3, k5 in the numerator and k2, k4, k6 in the denominator;
/// - lens: pinholeFocalLength (mm), projectionOffset (mm, to the right and down), entrancePupilOffset and focusDistance
///   from the film (m; focusDistance is omitted at infinity), fStop, tStop (only if the lens states a coating,
///   LensState::t_number), and exposureFalloff (1/mm^2, 1/mm^4, 1/mm^6).
///
/// @param lens      the lens, with its film at the focus
/// @param film      size, resolution and shift of the sensor
/// @param identity  make, model, serial number and nominal focal length
/// @throws Error    if LensDistortion, fit_brown_conrady(), overscan() or fit_exposure_falloff() throws: for fisheyes,
///                  lenses with cylinders, tilted films and others; if a text is not UTF-8 or exceeds 1023 bytes
PETZVAL_API std::string format_open_track_io(const Lens& lens, const Film& film, const LensIdentity& identity = {});

/// Writes the result of format_open_track_io() to a file.
///
/// @throws Error if format_open_track_io() or write_file() throws
PETZVAL_API void write_open_track_io(const Lens& lens, const Film& film, const LensIdentity& identity,
                                     const std::filesystem::path& file);

}  // namespace petzval
