// SPDX-License-Identifier: Apache-2.0
#include "petzval/analysis/psf.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <numbers>
#include <numeric>
#include <span>
#include <string>

#include "analysis/histogram.hpp"
#include "analysis/points.hpp"
#include "core/text.hpp"
#include "partial_sums.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/core/sobol.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {
namespace {

void validate(const PsfOptions& options) {
  if (options.samples == 0) throw Error("point_image: samples = 0; must be at least 1");
  constexpr int max_pixels = 1 << 15;
  if (options.pixels < 1 || options.pixels > max_pixels) {
    throw Error("point_image: pixels = " + std::to_string(options.pixels) + "; must be 1 to " +
                std::to_string(max_pixels));
  }
  if (!std::isfinite(options.half_width_mm) || options.half_width_mm < 0) {
    throw Error("point_image: half_width_mm = " + to_text(options.half_width_mm) + "; must be finite and at least 0");
  }
  if (!(options.tolerance >= 0)) {
    throw Error("point_image: tolerance = " + to_text(options.tolerance) + "; must be at least 0");
  }
  if (options.centre && !(std::isfinite(options.centre->x) && std::isfinite(options.centre->y))) {
    throw Error("point_image: centre = (" + to_text(options.centre->x) + ", " + to_text(options.centre->y) +
                "); must be finite");
  }
}

/// Number of consecutive parts of one sequence, from which errors are estimated. Separately scrambled parts would give
/// unbiased estimates, but their common error would be 1.2 to 3.5 times as large: the bound would not be lower, and the
/// image would be worse (tests/analysis/psf_sampling_test.cpp).
constexpr std::size_t subsets = 8;

/// Rays of a point at a wavelength, for `count` samples of a sequence from `first` on.
using SendRays = std::function<RayBundle(std::size_t wavelength, std::uint32_t first, std::uint32_t count)>;

/// The rays of a point at each wavelength, sampled in parts.
struct Rays {
  std::vector<RayBundle> sets;
  std::vector<std::size_t> wavelength, subset;    ///< per set
  std::vector<std::vector<std::uint32_t>> units;  ///< per set, of each ray with a weight
  std::uint32_t sent = 0;                         ///< per wavelength

  /// Sends the samples up to a number. The first call sends eight parts. Each later call must double the number: the
  /// eight parts are merged in pairs, and the new samples are four more parts.
  void send(std::size_t wavelengths, std::uint32_t samples, const SendRays& send_rays) {
    const std::size_t first_subset = sent == 0 ? 0 : subsets / 2;
    for (std::size_t& own : subset) own /= 2;
    for (std::size_t w = 0; w < wavelengths; ++w) {
      for (std::size_t k = first_subset; k < subsets; ++k) {
        const std::uint32_t begin = begin_of(k, samples), count = begin_of(k + 1, samples) - begin;
        sets.push_back(send_rays(w, begin, count));
        wavelength.push_back(w);
        subset.push_back(k);
        auto& own = units.emplace_back();
        for (const double weight : sets.back().weights) own.push_back(units_of(weight));
      }
    }
    sent = samples;
  }
  bool weighted() const noexcept {
    return std::any_of(units.begin(), units.end(), [](const auto& own) { return !own.empty(); });
  }

  /// True if the variance of the weights is above a quarter of their squared mean.
  bool uneven() const noexcept {
    double count = 0, sum = 0, squares = 0;
    for (const RayBundle& set : sets) {
      for (const double weight : set.weights) ++count, sum += weight, squares += weight * weight;
    }
    constexpr double max_relative_variance = 0.25;
    return count * squares > (1 + max_relative_variance) * sum * sum;
  }

  static constexpr std::uint32_t units_per_ray = 1u << 16;
  static std::uint32_t units_of(double weight) noexcept {
    return static_cast<std::uint32_t>(std::min(weight * units_per_ray + 0.5, 4294967295.0));
  }
  static std::uint32_t begin_of(std::size_t subset, std::uint32_t samples) noexcept {
    return static_cast<std::uint32_t>(std::uint64_t{samples} * subset / subsets);
  }
};

/// Half the side of a square around a centre that contains all hits.
double fitting_half_width(const std::vector<RayBundle>& sets, const Vec2<double>& centre) {
  const double cx = centre.x, cy = centre.y;
  analysis_detail::PartialSums extent{};
  analysis_detail::for_each(sets, [&](std::size_t subset, double x, double y, double) {
    extent[subset] = std::max(extent[subset], std::max(std::abs(x - cx), std::abs(y - cy)));
  });
  return analysis_detail::fitting_half_width(analysis_detail::largest(extent));
}

void fill_counts(Psf& psf, const Rays& rays) {
  const analysis_detail::PixelGrid grid{psf.centre, psf.pixel_mm, psf.pixels};
  const std::size_t plane = static_cast<std::size_t>(psf.pixels) * static_cast<std::size_t>(psf.pixels);
  psf.counts.assign(psf.wavelengths_nm.size() * plane, 0);
  for (std::size_t i = 0; i < rays.sets.size(); ++i) {
    const auto own = std::span(psf.counts).subspan(rays.wavelength[i] * plane, plane);
    analysis_detail::count_points(grid, rays.sets[i].x, rays.sets[i].y, own, rays.units[i]);
  }
}

constexpr std::size_t rings = std::tuple_size_v<decltype(Psf::radial_profile)>;

/// Counts of hits in rings of equal width around a centre. Hits outside the last ring, due to rounding, are counted in
/// it.
std::array<std::uint64_t, rings> count_by_ring(const RayBundle& hits, std::span<const std::uint32_t> units,
                                               const Vec2<double>& centre, double width) {
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
    for (std::size_t i = 0; i < count; ++i) {
      counts[static_cast<std::size_t>(ring[i])] += units.empty() ? 1 : units[begin + i];
    }
  }
  return counts;
}

struct Rings {
  Vec2<double> centre;
  double width;
};

/// The light in the rings `own`, of one part of the rays, as a fraction of the light on the paraxial entrance pupil.
/// All rays are used if part == parts.
std::array<double, rings> light_by_ring(const Psf& psf, const Rays& rays, const Rings& own, std::size_t subset) {
  std::array<double, rings> light{};
  for (std::size_t i = 0; i < rays.sets.size(); ++i) {
    if (subset != subsets && rays.subset[i] != subset) continue;
    const auto counts = count_by_ring(rays.sets[i], rays.units[i], own.centre, own.width);
    const double weight = psf.ray_weight(rays.wavelength[i]) / static_cast<double>(psf.wavelengths_nm.size());
    for (std::size_t k = 0; k < rings; ++k) light[k] += weight * static_cast<double>(counts[k]);
  }
  return light;
}

/// Factor from the standard error to a bound that holds in 95 of 100 repeated runs (tests/analysis/psf_error_test.cpp).
constexpr double confidence = 1.6;
/// The same factor for uneven rays, of which only a few determine the edge of a bright rim.
constexpr double uneven_confidence = 3.6;

/// Sets profile and error. Each part has rings of its own width, because the width contributes to the error.
void fill_profile(Psf& image, const Rays& rays) {
  const double width = image.size.max_radius / rings;
  image.radial_profile = {};
  if (width == 0) return;
  const auto light = light_by_ring(image, rays, {image.size.centroid, width}, subsets);
  double errors = 0, squares = 0;
  for (std::size_t k = 0; k < rings; ++k) {
    squares += light[k] * light[k];
    image.radial_profile[k] = light[k] / (std::numbers::pi * width * width * static_cast<double>(2 * k + 1));
  }
  for (std::size_t subset = 0; subset < subsets; ++subset) {
    std::vector<analysis_detail::Points> own;
    for (std::size_t i = 0; i < rays.sets.size(); ++i) {
      if (rays.subset[i] == subset) own.push_back({rays.sets[i].x, rays.sets[i].y, rays.sets[i].weights});
    }
    const SpotSize size = analysis_detail::spot_size(own);
    std::array<double, rings> its{};
    if (std::ranges::any_of(own, [](const analysis_detail::Points& points) { return !points.x.empty(); })) {
      if (size.max_radius == 0) continue;  // all hits coincide
      its = light_by_ring(image, rays, {size.centroid, size.max_radius / rings}, subset);
    }
    for (std::size_t k = 0; k < rings; ++k) errors += (subsets * its[k] - light[k]) * (subsets * its[k] - light[k]);
  }
  image.error =
      (rays.uneven() ? uneven_confidence : confidence) * std::sqrt(errors / (subsets * (subsets - 1)) / squares);
}

/// The rays of a camera that connect a point with the entrance pupil. The weight of a ray is the area of the pupil
/// plane that it represents, divided by the mean area `area` / count.
RayBundle connected_rays(const Camera& camera, const PupilPlane& plane, std::size_t wavelength, double area,
                         std::uint32_t first, std::uint32_t count, const PsfOptions& options) {
  const bool far = plane.reciprocal_distance() == 0;
  const Vec3<double> point = far ? plane.centre() : plane.centre() + plane.towards() / plane.reciprocal_distance();
  // Importance is the contribution of a ray to the mean irradiance of the film.
  const double index = camera.lens().index(0, wavelength);
  const double per_importance = camera.film().area_mm2() / (index * index) / area;
  std::vector<double> x(count), y(count), weights(count);
  constexpr std::size_t block = 4096;
  parallel_for(count, block, options.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec2<double> at = owen_sobol(first + static_cast<std::uint32_t>(i), options.seed);
      const ImportanceSample s = far ? camera.sample_distant_importance(-plane.towards(), at.x, at.y, wavelength)
                                     : camera.sample_importance(point, at.x, at.y, wavelength);
      if (!(s.pdf > 0)) continue;
      const double cosine = std::abs(glm::dot(s.direction, plane.normal()));
      // Factor from solid angle, or from area across the ray, to area of the plane.
      const double distance_ratio = far ? 1 : glm::dot(plane.centre() - point, plane.normal()) / cosine;
      const double spread = distance_ratio * distance_ratio / cosine;
      x[i] = s.importance.film.x, y[i] = s.importance.film.y;
      weights[i] = s.importance.we / s.pdf * per_importance * spread;
    }
  });
  RayBundle bundle{.plane_z = camera.lens().film_z(), .x = {}, .y = {}};
  for (std::size_t i = 0; i < count; ++i) {
    if (!(weights[i] > 0)) continue;
    bundle.x.push_back(x[i]), bundle.y.push_back(y[i]), bundle.weights.push_back(weights[i]);
  }
  bundle.sent = count;
  bundle.sampled_area = area;
  return bundle;
}

/// The largest weight of a few rays, over all wavelengths; 1 if no ray has a weight.
double brightest(const SendRays& send, std::size_t wavelengths) {
  constexpr std::uint32_t trial_samples = 256;
  double result = 0;
  for (std::size_t w = 0; w < wavelengths; ++w) {
    for (const double weight : send(w, 0, trial_samples).weights) result = std::max(result, weight);
  }
  return result > 0 ? result : 1;
}

/// Indices of the wavelengths of an image.
std::vector<std::size_t> wavelengths_of(const Lens& lens, const PsfOptions& options) {
  if (options.wavelength) return {lens.wavelength_index(*options.wavelength)};
  std::vector<std::size_t> all(lens.wavelengths_nm().size());
  std::iota(all.begin(), all.end(), std::size_t(0));
  return all;
}

/// @param sampled_area one value for each wavelength of the image
/// @param send_rays takes an index among these wavelengths
Psf image_of(const Lens& lens, const std::vector<double>& sampled_area, const SendRays& send_rays,
             const PsfOptions& options) {
  Psf psf;
  for (const std::size_t w : wavelengths_of(lens, options)) psf.wavelengths_nm.push_back(lens.wavelengths_nm()[w]);
  psf.entrance_pupil_area = analysis_detail::entrance_pupil_area(lens);
  psf.sampled_area = sampled_area;
  constexpr std::uint32_t first_samples = 1u << 14;
  Rays rays;
  for (std::uint32_t samples = options.tolerance > 0 ? std::min(first_samples, options.samples) : options.samples;;) {
    rays.send(psf.wavelengths_nm.size(), samples, send_rays);
    psf.sent.assign(psf.wavelengths_nm.size(), samples);
    psf.units_per_ray = rays.weighted() ? Rays::units_per_ray : 1;
    psf.size = spot_size(rays.sets);
    fill_profile(psf, rays);
    if (options.tolerance == 0 || psf.error <= options.tolerance || samples > options.samples / 2) break;
    samples *= 2;
  }
  psf.transmitted.assign(psf.wavelengths_nm.size(), 0);
  for (std::size_t i = 0; i < rays.sets.size(); ++i) {
    const auto& units = rays.units[i];
    psf.transmitted[rays.wavelength[i]] +=
        units.empty() ? rays.sets[i].size() : std::accumulate(units.begin(), units.end(), std::uint64_t{0});
  }
  for (std::size_t w = 0; w < psf.wavelengths_nm.size(); ++w) {
    psf.mean_throughput += psf.throughput(w) / static_cast<double>(psf.wavelengths_nm.size());
  }
  psf.centre = options.centre.value_or(psf.size.centroid);
  psf.pixels = options.pixels;
  const double half = options.half_width_mm > 0 ? options.half_width_mm : fitting_half_width(rays.sets, psf.centre);
  psf.pixel_mm = 2 * half / options.pixels;
  fill_counts(psf, rays);
  return psf;
}

}  // namespace

double analysis_detail::entrance_pupil_area(const Lens& lens) {
  const auto diameter = [&](Meridian section) {
    return pupils(lens, lens.primary_wavelength(), section).entrance.diameter;
  };
  return std::numbers::pi / 4 * diameter(Meridian::x) * diameter(Meridian::y);
}

double Psf::ray_weight(std::size_t wavelength) const noexcept {
  if (wavelength >= std::min(sent.size(), sampled_area.size())) return 0;
  if (entrance_pupil_area == 0 || sent[wavelength] == 0) return 0;
  return sampled_area[wavelength] / (static_cast<double>(sent[wavelength]) * units_per_ray * entrance_pupil_area);
}

double Psf::throughput(std::size_t wavelength) const noexcept {
  if (wavelength >= transmitted.size()) return 0;
  return ray_weight(wavelength) * static_cast<double>(transmitted[wavelength]);
}

Psf point_image(const Lens& lens, const FieldPoint& point, const PsfOptions& options) {
  validate(options);
  std::vector<PupilSampler> pupils_by_wavelength;
  std::vector<double> areas;
  for (const std::size_t w : wavelengths_of(lens, options)) {
    pupils_by_wavelength.emplace_back(pupil_boundary(lens, point, w));
    areas.push_back(pupils_by_wavelength.back().area());
  }
  const auto send = [&](std::size_t w, std::uint32_t first, std::uint32_t count) {
    return trace_bundle(lens, pupils_by_wavelength[w], count, options.seed, options.threads, first);
  };
  return image_of(lens, areas, send, options);
}

Psf point_image(const Camera& camera, const FieldPoint& point, const PsfOptions& options) {
  validate(options);
  const Lens& lens = camera.lens();
  const PupilPlane plane(lens, point);
  if (camera.normalisation() != Normalisation::irradiance) {
    throw Error(lens.name() + ": point_image: the camera's weights are relative; must be Normalisation::irradiance");
  }
  double area = analysis_detail::entrance_pupil_area(lens);
  if (!std::isfinite(area)) throw Error(lens.name() + ": point_image: the entrance pupil is infinite; must be finite");
  const std::vector<std::size_t> wavelengths = wavelengths_of(lens, options);
  const auto send = [&](std::size_t w, std::uint32_t first, std::uint32_t count) {
    return connected_rays(camera, plane, wavelengths[w], area, first, count, options);
  };
  // Counts resolve weights down to 1/65536 of the largest weight.
  area *= brightest(send, wavelengths.size());
  return image_of(lens, std::vector(wavelengths.size(), area), send, options);
}

}  // namespace petzval
