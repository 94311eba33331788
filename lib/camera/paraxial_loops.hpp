// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "paraxial_model.hpp"

namespace petzval::camera_detail {

/// Maps film lines to rays in the plane z, for first-order models.
template <class T>
struct ParaxialJob {
  lens_detail::WavelengthRows<T> maps;  ///< the numbers of two SectionMaps
  bool equal_sections = false;          ///< true if both sections are equal
  const SectionMaps* shared = nullptr;  ///< at the common wavelength; null if it is not covered
  T z = 0;
  T reach = 0;  ///< largest sum of absolute coordinates of a line
  RayWavelengths wavelengths;
};

struct ParaxialLoops {
  void (*of_float)(std::size_t count, const ParaxialJob<float>& job, const TwoPlaneRays<const float>& lines,
                   const RayArrays<float>& rays, RayFate* fates) noexcept;
  void (*of_double)(std::size_t count, const ParaxialJob<double>& job, const TwoPlaneRays<const double>& lines,
                    const RayArrays<double>& rays, RayFate* fates) noexcept;
  /// Maps one line.
  /// @param maps null like `shared`
  RayFate (*one)(const SectionMaps* maps, double z, double reach, const TwoPlaneRay& line, Ray<double>& ray) noexcept;
};

}  // namespace petzval::camera_detail
