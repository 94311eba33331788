// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "camera/ray_model.hpp"
#include "petzval/core/film.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::analysis_detail {

/// ModelCandidate::cost.
double cost(ModelKind model, const Lens& lens);

/// Time per ray of each model, ns, in batches of float (exact_double: double) on this thread. Each time is the minimum
/// over several rounds. A round times every model once, so that other load on the machine affects all models equally.
std::vector<double> time_rays(std::span<const std::shared_ptr<const RayModel>> models, const Film& film);

}  // namespace petzval::analysis_detail
