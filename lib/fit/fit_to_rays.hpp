// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "focus/image_rays.hpp"
#include "petzval/fit/tilt_fit.hpp"

namespace petzval {

/// fit_tilt() with exact rays that are set up already; TiltOptions::rays is ignored.
PETZVAL_API TiltFit fit_tilt(const ImageRays& lens, std::span<const FocusTarget> targets,
                             const TiltOptions& options = {});

}  // namespace petzval
