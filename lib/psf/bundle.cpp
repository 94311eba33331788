// SPDX-License-Identifier: Apache-2.0
#include "petzval/psf/bundle.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <utility>

#include "film.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/core/sobol.hpp"

namespace petzval::inline v0 {
namespace {

/// The block's rays behind the lens, from point `first` of the sequence on.
void trace_block(const Lens& lens, const PupilSampler& pupil, std::uint32_t first, std::size_t count,
                 std::uint32_t seed, psf_detail::RayBlock& rays) noexcept {
  std::array<double, psf_detail::RayBlock::size> room_u, room_v;
  const std::span u(room_u.data(), count), v(room_v.data(), count);
  owen_sobol(first, seed, u, v);
  pupil(u, v, u, v);
  pupil.plane().rays(u, v, rays.arrays());
  // The same bits from every processor: a picture is a measurement.
  trace<double>(lens, count, std::as_const(rays).arrays(), rays.arrays(), rays.fates.data(), nullptr,
                {.wavelengths = {pupil.wavelength()}, .arithmetic = Arithmetic::reproducible});
}

/// Moves what each block found at its own place to the front, one behind the other.
void close_gaps(std::vector<double>& values, const std::vector<std::size_t>& found) {
  auto end = values.begin();
  for (std::size_t k = 0; k < found.size(); ++k) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(k * psf_detail::RayBlock::size);
    end = std::copy(begin, begin + static_cast<std::ptrdiff_t>(found[k]), end);
  }
  values.erase(end, values.end());
}

}  // namespace

FilmHits trace_bundle(const Lens& lens, const PupilSampler& pupil, std::uint32_t samples, std::uint32_t seed,
                      int threads) {
  if (threads < 1) throw Error("trace_bundle: threads is " + std::to_string(threads) + ", wanted 1 or more");
  FilmHits hits;
  hits.sent = samples;
  hits.sampled_area = pupil.area();
  if (pupil.empty() || samples == 0) return hits;

  // Every block has its place: which thread did it leaves no trace.
  constexpr std::size_t size = psf_detail::RayBlock::size;
  hits.x.resize(samples);
  hits.y.resize(samples);
  std::vector<std::size_t> found((samples - 1) / size + 1);
  const psf_detail::Film film(lens);
  parallel_for(samples, size, threads, [&](std::size_t begin, std::size_t end) {
    psf_detail::RayBlock rays;
    trace_block(lens, pupil, static_cast<std::uint32_t>(begin), end - begin, seed, rays);
    found[begin / size] = film.meet(end - begin, rays, &hits.x[begin], &hits.y[begin]);
  });
  close_gaps(hits.x, found);
  close_gaps(hits.y, found);
  return hits;
}

}  // namespace petzval::inline v0
