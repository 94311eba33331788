// SPDX-License-Identifier: Apache-2.0
#include "pupil/ray_bundle.hpp"

#include <array>
#include <span>
#include <string>

#include "petzval/core/error.hpp"
#include "petzval/core/sobol.hpp"
#include "trace_rays.hpp"

namespace petzval {

RayBundle trace_bundle(const Lens& lens, const PupilSampler& pupil, std::uint32_t samples, std::uint32_t seed,
                       int threads, std::uint32_t first, bool slopes) {
  if (threads < 1) throw Error("trace_bundle: threads = " + std::to_string(threads) + "; must be at least 1");
  (void)lens.wavelength_index(pupil.wavelength());
  const auto start = [&](std::size_t begin, std::size_t end, const RayArrays<double>& rays) {
    std::array<double, pupil_detail::block_rays> buffer_u, buffer_v;
    const std::span u(buffer_u.data(), end - begin), v(buffer_v.data(), end - begin);
    owen_sobol(first + static_cast<std::uint32_t>(begin), seed, u, v);
    pupil(u, v, u, v);
    pupil.plane().rays(u, v, rays);
    return end - begin;
  };
  // Reproducible arithmetic: images must be equal to the bit on every processor.
  RayBundle bundle = pupil_detail::trace_rays(
      lens, lens.film_z(), pupil.empty() ? 0 : samples,
      {.wavelength = pupil.wavelength(), .slopes = slopes, .arithmetic = Arithmetic::reproducible, .threads = threads},
      start);
  bundle.sent = samples;
  bundle.sampled_area = pupil.area();
  return bundle;
}

}  // namespace petzval
