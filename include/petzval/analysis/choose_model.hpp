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

/// The scene that a camera is chosen for.
struct SceneRequirements {
  double near_mm = 0;                                       ///< distance of the nearest object from `origin`, mm
  double far_mm = std::numeric_limits<double>::infinity();  ///< of the farthest
  Film film = {};
  std::optional<double> f_number = {};      ///< unset: as the lens is
  std::vector<double> wavelengths_nm = {};  ///< compiled ones; empty: all of them
  DistanceOrigin origin = DistanceOrigin::front_vertex;
};

/// The largest errors that a model may have. Unset limits are not checked.
///
/// max_px and max_of_blur see where a ray goes that passes both the model and the lens. Neither sees rays that only one
/// of the two passes: these draw blurs of another shape, and go where the picture has no light. pupil_shape sees them,
/// and is the only limit that is set by default: without it a thin lens, round at every field, passes for a lens whose
/// pupils are cat's eyes. exposure sees how bright film points are, and not why.
struct ErrorBudget {
  std::optional<double> max_px = {};        ///< of a ray, pixels
  std::optional<double> max_of_blur = {};   ///< of a ray, as a fraction of the local blur; the larger limit counts
  std::optional<double> exposure = {};      ///< as a fraction
  std::optional<double> pupil_shape = 0.1;  ///< as a fraction of the pupil's area; unset it with std::nullopt
};

/// A model as measured for a scene.
///
/// The choice compares bounds with a budget; fresh samples stay below them, but for pupil shape and exposure of lenses
/// whose pupils change abruptly over the film (a catadioptric: a fifth above, an anamorphic lens: 6 %). Rays: the
/// largest error found, with 16 times as many lines from the film points where it is largest, plus 4 % (50 % for
/// exact_float, whose errors are noise; 15 % against the blur, which has sharp minima over the film and is measured at
/// each field's sharpest depth where a budget limits it), plus float's eps times the focal length. Exposure and pupil
/// shape: 4 % and the uncertainty of counting samples.
struct ModelCandidate {
  ModelKind model{};
  bool available = true;  ///< false: the lens cannot have it; `remark` says why
  std::string remark = {};
  ModelError error = {};  ///< as measured; RMS and 99 % are of this
  double bound_px = 0, bound_of_blur = 0, bound_exposure = 0, bound_pupil_shape = 0;
  double ns_per_ray = 0;  ///< of Camera::sample() in batches, on one thread of this machine, at best
  double setup_ms = 0;    ///< time to build the model
  bool inside = false;    ///< within the budget
};

struct ModelChoice {
  ModelKind model = ModelKind::exact_double;  ///< always within the budget: its errors are 0 by definition
  std::vector<std::string> reasons = {};      ///< why this model, and why no cheaper one, with the numbers
  /// What the scene can do without, with the numbers; each by itself within the budget, not all at once.
  std::vector<std::string> not_needed = {};
  std::vector<ModelCandidate> table = {};  ///< every model, in the order of models()
};

/// The fastest model whose errors stay within a budget over film, pupil and depths of the scene.
///
/// The lens must be focused; with_f_number() stops it down. Errors are compared at the nearest and the farthest depth,
/// at three between them (equally spaced in 1/distance from the film) and at the focus, the same for all models
/// (min_rms). Among equally fast models the first of models() is chosen; pinhole, thin and thick count as equally fast.
///
///     const ModelChoice choice = choose_model(lens, {.near_mm = 1000, .film = film}, {.max_px = 0.25});
///     const Camera camera(lens, film, {.model = choice.model});
///
/// Throws Error for a film that is tilted or travels, for near_mm that is not in front of the lens or beyond far_mm,
/// for wavelengths that were not compiled, for a limit that is negative or NaN, and where with_f_number(), Camera with
/// ModelKind::exact_double and model_error() do.
PETZVAL_API ModelChoice choose_model(const Lens& lens, const SceneRequirements& scene, const ErrorBudget& budget,
                                     int threads = 1);
/// A choice for each of several budgets, from one measurement.
PETZVAL_API std::vector<ModelChoice> choose_models(const Lens& lens, const SceneRequirements& scene,
                                                   std::span<const ErrorBudget> budgets, int threads = 1);

}  // namespace petzval
