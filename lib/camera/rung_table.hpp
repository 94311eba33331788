// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "error_study.hpp"
#include "petzval/camera/choose_model.hpp"
#include "pupil_study.hpp"

namespace petzval::inline v0::camera_detail {

/// What a choice is made of: every rung measured for a scene, and what the scene might do without.
struct RungTable {
  std::vector<ModelCandidate> rungs;
  /// Bounds of errors over tolerances, [rung][tolerance].
  std::vector<std::vector<double>> of_tolerance;

  /// Bounds of how far the scene's colours, the lens's pupils and its chief rays are from one colour, one pupil and
  /// first order; nothing where that cannot be said.
  std::optional<RayStudy::Largest> one_wavelength, no_distortion;
  double pixel_mm = 0;
  std::size_t wavelengths = 1;
  double central_nm = 0;
  double constant_pupil_shape = 0;
};
RungTable rung_table(const Lens& lens, const SceneRequirements& scene, std::span<const Tolerance> tolerances,
                     int threads);

}  // namespace petzval::inline v0::camera_detail
