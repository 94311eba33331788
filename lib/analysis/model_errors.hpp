// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "camera/ray_model.hpp"
#include "petzval/analysis/choose_model.hpp"

namespace petzval {

/// Measures models that were built for this lens and film. Exact rays are traced only once.
///
/// @throws Error  if model_error() does
PETZVAL_API std::vector<ModelError> model_errors(const Lens& lens, const Film& film,
                                                 std::span<const std::shared_ptr<const RayModel>> models,
                                                 const ErrorSamples& samples);

}  // namespace petzval
