// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "block.hpp"
#include "lens/lens_view.hpp"

namespace petzval::trace_detail {

/// The path of rays through a lens.
/// @param options options of one ray or of a batch
/// @param all the common wavelength
template <class R, class Options>
Route<R> route_of(const kernel::LensView<R>& view, const Options& options, Wavelength all) noexcept {
  Route<R> route;
  route.sequence = options.travel == Travel::to_film ? view.sequence_to_film : view.sequence_to_scene;
  route.steps = view.count;
  route.aspheres = view.aspheres;
  route.apertures = options.apertures;
  route.iris = view.iris;
  if (const auto nm = all.in_nm()) {
    route.spectral = true;
    route.nm = static_cast<R>(*nm);
  } else if (const std::size_t wavelength = all.index(view.primary); wavelength < view.wavelengths) {
    route.wavelength = wavelength;
  } else {
    static constexpr R no_index = std::numeric_limits<R>::quiet_NaN();
    route.sequence.n_first = &no_index;  // loses every ray
  }
  return route;
}

}  // namespace petzval::trace_detail
