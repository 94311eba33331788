// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "focus/image_rays.hpp"
#include "petzval/fit/tilt_fit.hpp"
#include "tilt_problem.hpp"

/// fit_tilt() without Ceres, for the component fit, which adds the weights of robust fits, and for the C interface.
namespace petzval::fit_detail {

/// The fraction of its weight, 0 to 1, that each target of problem.used keeps.
using RobustWeights = std::function<std::vector<double>(const TiltProblem&, std::span<const ImagedTarget>)>;

/// @param robust_weights for TiltOptions::robust; empty: no target is an outlier
TiltFit fit_film(const IdealLens& lens, std::span<const FocusTarget> targets, const TiltOptions& options,
                 const RobustWeights& robust_weights);
/// With exact rays; TiltOptions::rays is ignored.
TiltFit fit_film(const ImageRays& lens, std::span<const FocusTarget> targets, const TiltOptions& options,
                 const RobustWeights& robust_weights);

}  // namespace petzval::fit_detail
