// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "petzval/camera/ray_model.hpp"
#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval {

/// Where a model is compared with the lens.
struct ErrorSamples {
  /// Planes z = ... of the scene in which hits are compared (lens frame, mm); -inf is infinity.
  std::vector<double> depths_z;
  /// Also, for each film point, the plane between these two in which its spot is smallest: errors over the local blur
  /// are largest there.
  std::optional<std::array<double, 2>> sharpest_between_z = {};
  std::size_t film_points = 256;              ///< 1 to 2^20, each with 128 lines a wavelength
  std::uint32_t seed = 0;                     ///< another seed gives other samples
  std::vector<std::size_t> wavelengths = {};  ///< positions among the compiled ones; empty: all
  int threads = 1;
};

/// Errors of rays, on the film. RMS and 99 % are those of uniform samples of film, pupil and depths. The maximum also
/// covers samples in the film's corners, along its sides and along the pupil's rims, which uniform samples rarely hit.
struct RayErrors {
  double rms_mm = 0, p99_mm = 0, max_mm = 0;
  double rms_px = 0, p99_px = 0, max_px = 0;  ///< in pixels of the film
  /// The largest error over the local blur, which is the largest diameter of the exact lens's spot at that depth and
  /// field.
  double max_of_blur = 0;
  std::size_t rays = 0;  ///< that pass both the model and the lens
};

/// How far a model is from the exact lens, over film, pupil and depth.
///
/// The error of a ray at depth z is the distance between the model's hit on the plane z and that of the exact double
/// ray, carried back to the film by the exact magnification of the chief ray there, along and across the radius: the
/// inverse of the derivative of the chief ray's hit by the film point. At infinity it is angle times focal length. From
/// 80 degrees off axis on, where planes z are seen edge-on, a plane across the chief ray replaces them, as far along
/// the ray as the plane z lies at 80 degrees. For a ray that does not run towards the plane, the angle is measured.
///
/// Rays correspond when they have the same film point and the same point in the plane of the pupil. A ray that only one
/// of the two passes counts in the shape of the pupil alone, except at film points where model and lens have no ray in
/// common: there the model is compared along the lens's rays without its pupil. Models other than exact_double are
/// measured in float, as renderers run them. Film points with less than 1 % of the irradiance of the brightest one are
/// left out.
struct ModelError {
  RayErrors all;                      ///< all wavelengths
  std::vector<RayErrors> wavelength;  ///< one for each wavelength of the samples
  /// Largest over film points and wavelengths: the area that belongs to one of the two pupils only, over that of the
  /// exact one; 1 for a pinhole.
  double pupil_shape = 0;
  double exposure = 0;  ///< largest over film points and wavelengths: |irradiance / exact irradiance - 1|
};

/// Measures a built-in model. Throws Error where it cannot be built (see Camera), for a film that is tilted or travels,
/// for no depths or depths that are not in front of the lens, for film points out of range, for wavelengths that were
/// not compiled, for a lens without focal length, and for one without light on the film.
PETZVAL_API ModelError model_error(const Lens& lens, const Film& film, ModelKind model, const ErrorSamples& samples);
/// The same for models that were built before for this lens and film, a renderer's own included. Exact rays are traced
/// once for all of them.
PETZVAL_API std::vector<ModelError> model_errors(const Lens& lens, const Film& film,
                                                 std::span<const AnyRayModel> models, const ErrorSamples& samples);

}  // namespace petzval
