// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "paraxial_model.hpp"

namespace petzval::inline v0::camera_detail {

/// Film lines as rays in the plane z, for first-order models. maps: one for each wavelength, `known` of them.
struct ParaxialJob {
  const SectionMaps* maps = nullptr;
  std::size_t known = 0, primary = 0;
  double z = 0;
  RayWavelengths wavelengths;
};

struct ParaxialLoops {
  void (*of_float)(std::size_t count, const ParaxialJob& job, const TwoPlaneRays<const float>& lines,
                   const RayArrays<float>& rays, RayFate* fates) noexcept;
  void (*of_double)(std::size_t count, const ParaxialJob& job, const TwoPlaneRays<const double>& lines,
                    const RayArrays<double>& rays, RayFate* fates) noexcept;
};

}  // namespace petzval::inline v0::camera_detail
