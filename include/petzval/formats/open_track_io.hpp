// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "petzval/analysis/lens_metadata.hpp"
#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval {

/// A lens as one sample of OpenTrackIO 1.0.1 (SMPTE RIS), for Unreal Engine and others: JSON with
///
/// - static.camera: activeSensorPhysicalDimensions (mm) and activeSensorResolution, those of the film;
/// - static.lens: make, model, serialNumber, nominalFocalLength (mm), distortionOverscanMax, and calibrationHistory,
/// one
///   text that says how large the errors of the distortion and of the falloff are, up to which field they hold, and
///   from which field on the coefficients fold the picture;
/// - lens: distortion as "Brown-Conrady D-U" and "Brown-Conrady U-D", whose radial coefficients are those of OpenLensIO
///   1.0: radii in mm on the film, k1, k3, k5 in the numerator and k2, k4, k6 in the denominator; overscan;
///   pinholeFocalLength (mm), projectionOffset (mm, to the right and down), entrancePupilOffset and focusDistance from
///   the film (m, that one absent at infinity), fStop, tStop, and exposureFalloff (1/mm^2, 1/mm^4, 1/mm^6).
///
/// No key is written whose value is unknown. The lens has the film where it is focused. Throws Error where
/// LensDistortion, fit_brown_conrady(), overscan() and fit_exposure_falloff() do: for fisheyes, lenses with cylinders
/// and tilted films among others; and for texts that are not UTF-8 or longer than 1023 bytes.
PETZVAL_API std::string format_open_track_io(const Lens& lens, const Film& film, const LensIdentity& identity = {});

/// Writes that text as write_file does. Throws Error that names the file.
PETZVAL_API void write_open_track_io(const Lens& lens, const Film& film, const LensIdentity& identity,
                                     const std::filesystem::path& file);

}  // namespace petzval
