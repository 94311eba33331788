// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/pupil/pupil_sampler.hpp"

namespace petzval::inline v0 {

/// Where the rays of one point and wavelength meet the film.
struct FilmHits {
  std::vector<double> x, y;  ///< of the transmitted rays, mm, film plane of the lens, lens frame
  std::size_t sent = 0;      ///< rays started
  double sampled_area = 0;   ///< of the pupil plane they were spread over, mm^2
  double transmitted_area() const noexcept {
    return sent == 0 ? 0.0 : sampled_area * static_cast<double>(x.size()) / static_cast<double>(sent);
  }
};

/// Traces `samples` rays (Owen-scrambled Sobol over the pupil) onto the film. The same hits in the same order for any
/// `threads` (>= 1; more than one starts threads, and ends them before it returns). A ray that leaves the lens away
/// from the film is lost. Throws Error for no threads.
PETZVAL_API FilmHits trace_bundle(const Lens& lens, const PupilSampler& pupil, std::uint32_t samples,
                                  std::uint32_t seed = 0, int threads = 1);

}  // namespace petzval::inline v0
