// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "block.hpp"
#include "lens/lens_view.hpp"

namespace petzval::inline v0::trace_detail {

/// A job without its rays. Options: of one ray or of a batch; all: their one wavelength.
template <class R, class Options>
BlockJob<R> job_for(const kernel::LensView<R>& view, const Options& options, Wavelength all) noexcept {
  BlockJob<R> job;
  job.sequence = options.travel == Travel::to_film ? view.sequence_to_film : view.sequence_to_scene;
  job.steps = view.count;
  job.aspheres = view.aspheres;
  job.compiled_wavelengths = view.wavelengths;
  job.apertures = options.apertures;
  job.iris = view.iris;
  if (const auto nm = all.in_nm()) {
    job.spectral = true;
    job.nm = static_cast<R>(*nm);
  } else if (const std::size_t wavelength = all.position(view.primary); wavelength < view.wavelengths) {
    job.wavelength = wavelength;
  } else {
    static constexpr R no_index = std::numeric_limits<R>::quiet_NaN();
    job.sequence.n_first = &no_index;  // which loses every ray
  }
  return job;
}

}  // namespace petzval::inline v0::trace_detail
