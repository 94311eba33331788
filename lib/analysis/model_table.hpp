// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "error_study.hpp"
#include "petzval/analysis/choose_model.hpp"
#include "pupil_study.hpp"

namespace petzval::analysis_detail {

/// The data for a choice: the measurements of every model for a scene, and of possible simplifications.
struct ModelTable {
  std::vector<ModelCandidate> models;
  /// Bounds of errors divided by tolerances, [model][tolerance].
  std::vector<std::vector<double>> of_tolerance;

  /// Bounds of the errors if one wavelength represents all, and if chief rays are traced to first order. nullopt if not
  /// measurable.
  std::optional<RayStudy::Largest> one_wavelength, no_distortion;
  double pixel_mm = 0;
  std::size_t wavelengths = 1;
  double central_nm = 0;
  double constant_pupil_shape = 0;
  TransmissionError without_transmission;
};
ModelTable model_table(const Lens& lens, const SceneRequirements& scene, std::span<const Tolerance> tolerances,
                       int threads);

}  // namespace petzval::analysis_detail
