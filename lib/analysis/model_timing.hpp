// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "petzval/camera/ray_model.hpp"
#include "petzval/core/film.hpp"

namespace petzval::analysis_detail {

/// Time of a ray of each model, ns, in batches of float (exact_double: of double) on this thread: the best of several
/// rounds in which the models take turns, so that other work of the machine affects them alike.
std::vector<double> time_rays(std::span<const AnyRayModel> models, const Film& film);

}  // namespace petzval::analysis_detail
