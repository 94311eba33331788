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

/// The depths, film points and wavelengths at which a model is compared with the lens.
struct ErrorSamples {
  /// z of the scene planes in which ray hits are compared (lens frame, mm); -inf is infinity.
  std::vector<double> depths_z;
  /// If set, also compares each film point in the plane between these two z in which its spot is smallest: the plane
  /// with the largest errors relative to the local blur.
  std::optional<std::array<double, 2>> sharpest_between_z = {};
  std::size_t film_points = 256;              ///< 1 to 2^20, each with 128 rays per wavelength
  std::uint32_t seed = 0;                     ///< of the random samples
  std::vector<std::size_t> wavelengths = {};  ///< wavelength indices; empty: all
  int threads = 1;
};

/// Statistics of ray errors on the film.
///
/// RMS and 99th percentile belong to uniform samples of film, pupil and depths. The maximum also covers samples in the
/// corners and along the sides of the film and along the pupil rims, which uniform samples rarely hit.
struct RayErrors {
  double rms_mm = 0, p99_mm = 0, max_mm = 0;
  double rms_px = 0, p99_px = 0, max_px = 0;  ///< in pixels of the film
  /// Largest error divided by the local blur: the largest diameter of the exact spot at that depth and field.
  double max_of_blur = 0;
  std::size_t rays = 0;  ///< number of rays that pass both the model and the lens
};

/// The deviation of a ray model from the exact lens over film, pupil and depth.
///
/// The error of a ray at depth z is the distance between its hit on the plane z and the hit of the exact double ray
/// with the same film point and pupil point, scaled to the film by the exact magnification of the chief ray. At
/// infinity it is the angle between the rays times the focal length.
///
/// Rays that pass only the model or only the lens count in pupil_shape and not in the ray errors, unless no ray of the
/// film point passes both: then the model is evaluated along the rays of the lens without its own pupil. Models other
/// than exact_double are measured in float. Film points below 1 % of the largest irradiance are left out.
struct ModelError {
  RayErrors all;                      ///< all wavelengths
  std::vector<RayErrors> wavelength;  ///< errors of each sampled wavelength
  /// Area that belongs to only one of the two pupils, divided by the area of the exact pupil: the largest value over
  /// film points and wavelengths. 1 for a pinhole.
  double pupil_shape = 0;
  double exposure = 0;  ///< largest |irradiance / exact irradiance - 1| over film points and wavelengths
};

/// Measures the errors of a built-in model.
///
/// @param lens     the focused lens
/// @param film     an upright film
/// @param model    the model
/// @param samples  the depths, film points and wavelengths
/// @return         errors relative to the exact lens
/// @throws Error   if the model cannot be built (see Camera), the film is tilted or travels, there are no depths or
///                 depths that are not in front of the lens, film_points is out of range, a wavelength was not
///                 compiled, the lens has no focal length, or no light reaches the film
PETZVAL_API ModelError model_error(const Lens& lens, const Film& film, ModelKind model, const ErrorSamples& samples);
/// Measures models that were built for this lens and film, including custom models. Exact rays are traced only once.
PETZVAL_API std::vector<ModelError> model_errors(const Lens& lens, const Film& film,
                                                 std::span<const AnyRayModel> models, const ErrorSamples& samples);

}  // namespace petzval
