// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "petzval/analysis/lens_metadata.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval {

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
