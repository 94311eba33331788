// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "petzval/analysis/model_error.hpp"
#include "petzval/camera/model_kind.hpp"
#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval {

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
  double ns_per_ray = 0;  ///< best time of Camera::sample() in batches on one thread of this machine
  double setup_ms = 0;    ///< time to build the model
  bool inside = false;    ///< true if all bounds are within the budget
};

struct ModelChoice {
  ModelKind model = ModelKind::exact_double;  ///< exact_double always fits: its errors are 0 by definition
  std::vector<std::string> reasons = {};      ///< reasons for this model and against faster ones, with numbers
  /// Lens properties that the scene can ignore, with numbers. Each is within the budget by itself, not in combination.
  std::vector<std::string> not_needed = {};
  std::vector<ModelCandidate> table = {};  ///< every model, in the order of models()
};

/// Chooses the fastest model whose errors stay within a budget over film, pupil and scene depths.
///
/// The lens must be focused; with_f_number() stops it down. Errors are measured at the nearest and farthest depth, at
/// three depths between them (equally spaced in 1/distance from the film) and at the focus, which is the same for all
/// models (min_rms). Among equally fast models the first of models() is chosen; pinhole, thin and thick count as
/// equally fast.
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
