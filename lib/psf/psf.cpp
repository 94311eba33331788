// SPDX-License-Identifier: Apache-2.0
#include "petzval/psf/psf.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <string>

#include "core/text.hpp"
#include "partial_sums.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "psf/histogram.hpp"

namespace petzval::inline v0 {
namespace {

void validate(const PsfOptions& options) {
  if (options.samples == 0) throw Error("point_image: samples is 0, wanted 1 or more");
  constexpr int most = 1 << 15;
  if (options.pixels < 1 || options.pixels > most) {
    throw Error("point_image: pixels is " + std::to_string(options.pixels) + ", wanted 1 to " + std::to_string(most));
  }
  if (!std::isfinite(options.half_width_mm) || options.half_width_mm < 0) {
    throw Error("point_image: half_width_mm is " + to_text(options.half_width_mm) + ", wanted a length, or 0 to fit");
  }
}

/// Half the side of a square about the centroid that holds all hits.
double fitting_half_width(const std::vector<RayBundle>& sets, const SpotSize& size) {
  const double cx = size.centroid.x, cy = size.centroid.y;
  psf_detail::PartialSums extent{};
  psf_detail::for_each(sets, [&](std::size_t part, double x, double y) {
    extent[part] = std::max(extent[part], std::max(std::abs(x - cx), std::abs(y - cy)));
  });
  return std::max(1.05 * psf_detail::largest(extent), 1e-4);
}

void fill_counts(Psf& psf, const std::vector<RayBundle>& sets) {
  const psf_detail::PixelGrid grid{psf.centre, psf.pixel_mm, psf.pixels};
  const std::size_t plane = static_cast<std::size_t>(psf.pixels) * static_cast<std::size_t>(psf.pixels);
  psf.counts.assign(sets.size() * plane, 0);
  for (std::size_t w = 0; w < sets.size(); ++w) {
    psf_detail::count_points(grid, sets[w].x, sets[w].y, std::span(psf.counts).subspan(w * plane, plane));
  }
}

constexpr std::size_t rings = std::tuple_size_v<decltype(PointImage::radial_profile)>;

/// The number of hits in each ring of a width about a centre; the last ring has those that rounding puts beyond it.
std::array<std::uint64_t, rings> count_by_ring(const RayBundle& hits, const Vec2<double>& centre, double width) {
  constexpr std::size_t block = 256;
  std::array<std::int32_t, block> ring;
  std::array<std::uint64_t, rings> counts{};
  const double cx = centre.x, cy = centre.y;
  const double scale = 1 / width;
  for (std::size_t begin = 0; begin < hits.x.size(); begin += block) {
    const std::size_t count = std::min(block, hits.x.size() - begin);
    const double *x = hits.x.data() + begin, *y = hits.y.data() + begin;
    for (std::size_t i = 0; i < count; ++i) {
      const double r = std::sqrt((x[i] - cx) * (x[i] - cx) + (y[i] - cy) * (y[i] - cy)) * scale;
      ring[i] = static_cast<std::int32_t>(r < rings - 1.0 ? r : rings - 1.0);
    }
    for (std::size_t i = 0; i < count; ++i) ++counts[static_cast<std::size_t>(ring[i])];
  }
  return counts;
}

void fill_profile(PointImage& image, const std::vector<RayBundle>& sets) {
  const double width = image.size.max_radius / rings;
  if (width == 0) return;
  for (std::size_t w = 0; w < sets.size(); ++w) {
    const auto counts = count_by_ring(sets[w], image.size.centroid, width);
    for (std::size_t k = 0; k < rings; ++k) {
      const double area = std::numbers::pi * width * width * static_cast<double>(2 * k + 1);
      image.radial_profile[k] +=
          image.psf.ray_weight(w) * static_cast<double>(counts[k]) / area / static_cast<double>(sets.size());
    }
  }
}

}  // namespace

double Psf::ray_weight(std::size_t wavelength) const noexcept {
  if (entrance_pupil_area == 0 || sent[wavelength] == 0) return 0;
  return sampled_area[wavelength] / (static_cast<double>(sent[wavelength]) * entrance_pupil_area);
}

double Psf::throughput(std::size_t wavelength) const noexcept {
  return ray_weight(wavelength) * static_cast<double>(transmitted[wavelength]);
}

PointImage point_image(const Lens& lens, const FieldPoint& point, const PsfOptions& options) {
  validate(options);
  PointImage image;
  Psf& psf = image.psf;
  psf.wavelengths_nm.assign(lens.wavelengths_nm().begin(), lens.wavelengths_nm().end());
  psf.entrance_pupil_area = std::numbers::pi / 4 *
                            pupils(lens, lens.primary_wavelength(), Meridian::x).entrance.diameter *
                            pupils(lens, lens.primary_wavelength(), Meridian::y).entrance.diameter;
  std::vector<RayBundle> sets;
  for (std::size_t w = 0; w < psf.wavelengths_nm.size(); ++w) {
    const PupilSampler pupil(pupil_boundary(lens, point, w));
    sets.push_back(trace_bundle(lens, pupil, options.samples, options.seed, options.threads));
    psf.sent.push_back(options.samples);
    psf.transmitted.push_back(sets.back().x.size());
    psf.sampled_area.push_back(pupil.area());
    image.throughput += psf.throughput(w) / static_cast<double>(psf.wavelengths_nm.size());
  }
  image.size = spot_size(sets);
  psf.centre = image.size.centroid;
  psf.pixels = options.pixels;
  const double half = options.half_width_mm > 0 ? options.half_width_mm : fitting_half_width(sets, image.size);
  psf.pixel_mm = 2 * half / options.pixels;
  fill_counts(psf, sets);
  fill_profile(image, sets);
  return image;
}

}  // namespace petzval::inline v0
