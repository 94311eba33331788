// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/pupil/pupil_boundary.hpp"

namespace petzval {

/// The rays of one point and wavelength that pass a lens, by their points in a plane behind it. One value each, in the
/// order in which they were sent.
struct RayBundle {
  double plane_z = 0;                        ///< of the plane across the axis, lens frame, mm
  std::vector<double> x, y;                  ///< in the plane, mm
  std::vector<double> slope_x{}, slope_y{};  ///< per mm of z; empty where the plane is all that matters
  std::vector<double> weights{};             ///< empty where all rays have the same weight
  std::size_t sent = 0;                      ///< rays started
  double sampled_area = 0;                   ///< area of the pupil plane that uniform rays started from, mm^2

  std::size_t size() const noexcept { return x.size(); }
  bool empty() const noexcept { return x.empty(); }
  /// Area of the pupil plane that the lens passes, of uniform rays, mm^2.
  double transmitted_area() const noexcept {
    return sent == 0 ? 0.0 : sampled_area * static_cast<double>(size()) / static_cast<double>(sent);
  }
};

/// Traces `samples` rays, Owen-scrambled Sobol over the pupil from point `first` of the sequence on, onto the lens's
/// film; without slopes.
///
/// The bundle does not depend on `threads` (1 or more; more than one starts threads and ends them before it returns).
/// Rays that leave the lens away from the film are lost. Throws Error for less than one thread, and for a pupil whose
/// wavelength the lens does not have.
PETZVAL_API RayBundle trace_bundle(const Lens& lens, const PupilSampler& pupil, std::uint32_t samples,
                                   std::uint32_t seed = 0, int threads = 1, std::uint32_t first = 0);

}  // namespace petzval
