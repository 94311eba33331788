// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/lens/lens.hpp"
#include "pupil/pupil_boundary.hpp"

namespace petzval {

/// The rays of one point and wavelength that pass a lens, by their intersections with a plane behind the lens; one
/// value per ray, in the order of the samples.
struct RayBundle {
  double plane_z = 0;                        ///< plane perpendicular to the axis, lens frame, mm
  std::vector<double> x, y;                  ///< in the plane, mm
  std::vector<double> slope_x{}, slope_y{};  ///< per mm of z; empty if not requested
  std::vector<double> weights{};             ///< empty if all rays have equal weight
  std::size_t sent = 0;                      ///< rays started
  double sampled_area = 0;                   ///< area of the pupil plane in which uniform rays started, mm^2

  std::size_t size() const noexcept { return x.size(); }
  bool empty() const noexcept { return x.empty(); }
  /// Area of the pupil plane through which uniform rays pass the lens (mm^2).
  double transmitted_area() const noexcept {
    return sent == 0 ? 0.0 : sampled_area * static_cast<double>(size()) / static_cast<double>(sent);
  }
};

/// Traces rays through a pupil to the film of the lens.
///
/// Rays that leave the lens away from the film are lost.
///
/// @param lens     the lens
/// @param pupil    the pupil, sampled by an Owen-scrambled Sobol sequence
/// @param samples  number of rays
/// @param seed     seed of the scrambling
/// @param threads  at least 1; the bundle is the same for every number
/// @param first    first point of the sequence
/// @param slopes   true: with slopes
/// @throws Error   if threads is less than 1, or the lens does not have the wavelength of the pupil
PETZVAL_API RayBundle trace_bundle(const Lens& lens, const PupilSampler& pupil, std::uint32_t samples,
                                   std::uint32_t seed = 0, int threads = 1, std::uint32_t first = 0,
                                   bool slopes = false);

}  // namespace petzval
