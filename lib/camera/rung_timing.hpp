// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "petzval/camera/any_model.hpp"
#include "petzval/film/film.hpp"

namespace petzval::inline v0::camera_detail {

/// Nanoseconds that sample_rays takes for a ray of each model, in batches of float (exact_double: of double) on this
/// thread: the best of several rounds, in which all models take turns, so that whatever else the machine does strikes
/// them alike.
std::vector<double> time_rays(std::span<const AnyModel> models, const Film& film);

}  // namespace petzval::inline v0::camera_detail
