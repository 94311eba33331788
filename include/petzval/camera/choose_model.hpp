// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "petzval/camera/model_error.hpp"
#include "petzval/camera/ray_model.hpp"
#include "petzval/core/export.hpp"
#include "petzval/film/film.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::inline v0 {

/// What a scene asks of a camera.
struct SceneRequirements {
  double near_mm = 0;  ///< nearest thing, from the film, mm
  double far_mm = std::numeric_limits<double>::infinity();
  Film film = {};
  std::optional<double> f_number = {};      ///< else the lens as it is
  std::vector<double> wavelengths_nm = {};  ///< of those that the lens was compiled for; empty: all of them
};

/// How wrong a model may be. What is not given does not count; nothing given: anything will do.
struct ErrorBudget {
  std::optional<double> max_px = {};       ///< largest error of a ray, pixels
  std::optional<double> max_of_blur = {};  ///< or, where that is larger, this fraction of the local blur
  std::optional<double> exposure = {};     ///< as a fraction
  std::optional<double> pupil_shape = {};  ///< as a fraction of the pupil's area
};

/// One rung, as measured for a scene.
///
/// Bounds are what the choice compares with a budget: above what fresh samples show. For rays: the largest error found,
/// with 16 times as many lines from the film points where it is largest, and 4 % more (50 % for exact_float, whose
/// errors are noise; 15 % against the blur, which has sharp minima over the film, and is looked for at each field's
/// sharpest depth where a budget asks for it), and float's eps times the focal length. For exposure and pupil shape:
/// 4 % and what the counting of samples leaves uncertain.
struct ModelCandidate {
  ModelKind model{};
  bool available = true;  ///< false: it cannot be built for this lens, and `remark` says why
  std::string remark = {};
  ModelError error = {};  ///< as measured; RMS and 99 % are of this
  double bound_px = 0, bound_of_blur = 0, bound_exposure = 0, bound_pupil_shape = 0;
  double ns_per_ray = 0;  ///< of sample_rays for many rays on one thread, on this machine now, at best
  double setup_ms = 0;    ///< to build it
  bool inside = false;    ///< the budget
};

struct ModelChoice {
  ModelKind model = ModelKind::exact_double;  ///< which is always inside: its errors are 0 by definition
  std::vector<std::string> reasons = {};      ///< why this one, and why not each cheaper one, with the numbers
  /// What else the scene does without, with the numbers: each by itself inside the budget, not all at once.
  std::vector<std::string> not_needed = {};
  std::vector<ModelCandidate> table = {};  ///< every rung, in the order of models()
};

/// The fastest model whose errors stay inside a budget, all over the film, the pupil and the depths of the scene.
///
/// The lens's film stays where it is: focus first. Stopped down by with_f_number. Errors are compared at the nearest
/// and the farthest depth, at three between them (equally spaced in 1/distance) and at the paraxial focus. Of two rungs
/// equally fast the first of models() is taken; all of first order count as equally fast.
///
///     const ModelChoice choice = choose_model(lens, {.near_mm = 1000, .film = film}, {.max_px = 0.25});
///     const Camera camera(lens, film, {.model = choice.model});
///
/// Throws Error for a tilted film, near_mm not in front of the lens or beyond far_mm, wavelengths that were not
/// compiled, a part of the budget that is negative or NaN, and where with_f_number, Camera with ModelKind::exact_double
/// and model_error do.
PETZVAL_API ModelChoice choose_model(const Lens& lens, const SceneRequirements& scene, const ErrorBudget& budget,
                                     int threads = 1);
/// One choice for each of several budgets, from one measurement.
PETZVAL_API std::vector<ModelChoice> choose_models(const Lens& lens, const SceneRequirements& scene,
                                                   std::span<const ErrorBudget> budgets, int threads = 1);

}  // namespace petzval::inline v0
