// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "petzval/camera/camera.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/focus/focus.hpp"
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

/// The effect of leaving out the transmission of a lens (CameraOptions::transmission): the light that surfaces reflect
/// and glasses absorb, the same for all models. As fractions; surfaces without a stated coating count as uncoated.
struct TransmissionError {
  double exposure = 0;  ///< the film is so much too bright on the axis at the primary wavelength: 1/transmittance - 1
  double field = 0;   ///< largest change of the transmittance from the axis to other film points, relative to the axis
  double colour = 0;  ///< largest change from the primary wavelength to the other compiled wavelengths, on the axis
};

/// Measures the effect of leaving out the transmission, along exact rays.
///
/// @param lens    the focused lens
/// @param film    an upright film
/// @throws Error  if the film is tilted or travels; if a compiled wavelength is outside a table of reflectances; as
///                Camera with ModelKind::exact_double
PETZVAL_API TransmissionError transmission_error(const Lens& lens, const Film& film);

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
  TransmissionError without_transmission{};  ///< transmission_error(): not an error of the model
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
/// The scene for which choose_model() selects a camera model.
struct SceneRequirements {
  double near_mm = 0;                                       ///< distance of the nearest object from `origin`, mm
  double far_mm = std::numeric_limits<double>::infinity();  ///< distance of the farthest object, mm
  Film film = {};
  std::optional<double> f_number = {};      ///< unset: the lens is used unchanged
  std::vector<double> wavelengths_nm = {};  ///< compiled wavelengths to check; empty: all
  DistanceOrigin origin = DistanceOrigin::front_vertex;
};

/// Error limits for choose_model(). Unset limits are not checked.
///
/// max_px and max_of_blur limit the position of rays that pass both the model and the lens. They ignore rays that pass
/// only one of the two; such rays change the shape of a blur and carry light into dark regions of the image.
/// pupil_shape limits these rays. It is the only limit that is set by default: without it, a thin lens with its round
/// pupils would be accepted for a lens with cat's-eye pupils. exposure limits the irradiance of film points only.
struct ErrorBudget {
  std::optional<double> max_px = {};        ///< ray error in pixels
  std::optional<double> max_of_blur = {};   ///< ray error as a fraction of the local blur; the larger limit counts
  std::optional<double> exposure = {};      ///< irradiance error as a fraction
  std::optional<double> pupil_shape = 0.1;  ///< as a fraction of the pupil area; std::nullopt removes the limit
};

/// The measured errors and cost of one model for a scene.
///
/// The choice compares the bounds with a budget. The bound of ray errors is the largest measured error, refined with 16
/// times as many lines at the film points where it is largest, plus a margin and float epsilon times the focal length.
/// The margin is 4 %; 50 % for exact_float, whose errors are noise; 15 % for errors relative to the blur, because the
/// blur has sharp minima over the film. If a budget limits errors relative to the blur, they are also measured at the
/// sharpest depth of each field. The bounds of exposure and pupil shape add 4 % and the uncertainty of sample counts.
///
/// Accuracy: new samples stay below the bounds, except for pupil shape and exposure of lenses whose pupils change
/// abruptly over the film (exceeded by 20 % for a catadioptric lens, by 6 % for an anamorphic lens).
struct ModelCandidate {
  ModelKind model{};
  bool available = true;  ///< false if the model cannot be built for the lens; see `remark`
  std::string remark = {};
  ModelError error = {};  ///< measured errors, without the margins of the bounds
  double bound_px = 0, bound_of_blur = 0, bound_exposure = 0, bound_pupil_shape = 0;
  /// Expected time of a ray, in rays of a thin lens, which ranks the models: by their degree or the surfaces of the
  /// lens, the same on all machines.
  double cost = 0;
  double ns_per_ray = 0;  ///< best time of Camera::sample() in batches on one thread of this machine
  double setup_ms = 0;    ///< time to build the model
  bool inside = false;    ///< true if all bounds are within the budget
};

/// The result of choose_model().
struct ModelChoice {
  ModelKind model = ModelKind::exact_double;  ///< exact_double always fits: its errors are 0 by definition
  std::vector<std::string> reasons = {};      ///< reasons for this model and against faster ones, with numbers
  /// Lens properties that the scene can ignore, with numbers. Each is within the budget by itself, not in combination.
  std::vector<std::string> not_needed = {};
  std::vector<ModelCandidate> table = {};  ///< every model, in the order of models()
  /// Part of `not_needed` if field and colour are within ErrorBudget::exposure, else of `reasons`.
  TransmissionError without_transmission{};
};

/// Chooses the fastest model whose errors stay within a budget over film, pupil and scene depths.
///
/// The lens must be focused; with_f_number() stops it down. Errors are measured at the nearest and farthest depth, at
/// three depths between them (equally spaced in 1/distance from the film) and at the focus, which is the same for all
/// models (min_rms). The model with the least ModelCandidate::cost is chosen; among models of equal cost, such as
/// pinhole, thin and thick, the first of models().
///
///     const ModelChoice choice = choose_model(lens, {.near_mm = 1000, .film = film}, {.max_px = 0.25});
///     const Camera camera(lens, film, {.model = choice.model});
///
/// @param lens     the focused lens
/// @param scene    depths, film, f-number and wavelengths
/// @param budget   the largest permitted errors
/// @param threads  number of threads for the measurement
/// @return         the model, the reasons and a table of all models
/// @throws Error   if the film is tilted or travels, near_mm is not in front of the lens or exceeds far_mm, a
///                 wavelength was not compiled, or a limit is negative or NaN; also under the conditions of
///                 with_f_number(), of Camera with ModelKind::exact_double and of model_error()
PETZVAL_API ModelChoice choose_model(const Lens& lens, const SceneRequirements& scene, const ErrorBudget& budget,
                                     int threads = 1);
/// Chooses a model for each of several budgets from a single measurement.
PETZVAL_API std::vector<ModelChoice> choose_models(const Lens& lens, const SceneRequirements& scene,
                                                   std::span<const ErrorBudget> budgets, int threads = 1);

}  // namespace petzval
