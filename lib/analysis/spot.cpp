// SPDX-License-Identifier: Apache-2.0
#include "petzval/analysis/spot.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "partial_sums.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/illumination.hpp"
#include "points.hpp"
#include "pupil/trace_rays.hpp"
#include "spot_moments.hpp"

namespace petzval {
namespace {

/// Sets: a range of values with x, y and weights; weights may be empty.
template <class Sets>
SpotSize size_of(const Sets& sets) noexcept {
  SpotSize size;
  for (const auto& points : sets) {
    if (analysis_detail::point_count(points) == 0) continue;
    size.centroid = {points.x[0], points.y[0]};
    break;
  }
  analysis_detail::PartialSums weights{};
  analysis_detail::for_each(sets, [&](std::size_t part, double, double, double w) { weights[part] += w; });
  const double n = analysis_detail::sum(weights);
  if (!(n > 0)) return size;

  // Sums are relative to one of the points: rounding errors are then proportional to the size of the spot and not to
  // its height.
  const double x0 = size.centroid.x, y0 = size.centroid.y;
  analysis_detail::PartialSums dx{}, dy{};
  analysis_detail::for_each(sets, [&](std::size_t part, double x, double y, double w) {
    dx[part] += w * (x - x0), dy[part] += w * (y - y0);
  });
  const double cx = x0 + analysis_detail::sum(dx) / n, cy = y0 + analysis_detail::sum(dy) / n;

  analysis_detail::PartialSums xx{}, yy{}, xy{}, squares{}, farthest{};
  analysis_detail::for_each(sets, [&](std::size_t part, double x, double y, double w) {
    const double squared = (x - cx) * (x - cx) + (y - cy) * (y - cy);
    xx[part] += w * ((x - cx) * (x - cx));
    yy[part] += w * ((y - cy) * (y - cy));
    xy[part] += w * ((x - cx) * (y - cy));
    squares[part] += w * squared;
    farthest[part] = std::max(farthest[part], squared);
  });
  size.centroid = {cx, cy};
  size.rms_radius = std::sqrt(analysis_detail::sum(squares) / n);
  size.max_radius = std::sqrt(analysis_detail::largest(farthest));
  size.xx = analysis_detail::sum(xx) / n;
  size.yy = analysis_detail::sum(yy) / n;
  size.xy = analysis_detail::sum(xy) / n;
  return size;
}

std::optional<double> chief_ray_height(const Lens& lens, const FieldPoint& point, std::size_t wavelength) {
  const auto hit = analysis_detail::chief_point(lens, point, wavelength);
  return hit ? std::optional(hit->y) : std::nullopt;
}

/// The film with the least RMS radius at one wavelength.
std::optional<double> sharpest_film(const Lens& lens, double subject_z, std::size_t wavelength) {
  FocusOptions options{.criterion = FocusCriterion::min_rms};
  options.wavelength_weights.assign(lens.wavelengths_nm().size(), 0);
  options.wavelength_weights[wavelength] = 1;
  const FocusSolution focus = solve_focus(lens, -subject_z, options);
  return focus ? std::optional(focus.film_z) : std::nullopt;
}

/// Differences from the value at index `from`; nullopt if either value is not set.
std::vector<std::optional<double>> differences(const std::vector<std::optional<double>>& values, std::size_t from) {
  std::vector<std::optional<double>> result(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] && values[from]) result[i] = *values[i] - *values[from];
  }
  return result;
}

}  // namespace

SpotSize spot_size(std::span<const double> x, std::span<const double> y) noexcept {
  return size_of(std::array{analysis_detail::Points{x, y}});
}

SpotSize analysis_detail::spot_size(std::span<const Points> sets) noexcept { return size_of(sets); }

SpotSize spot_size(std::span<const RayBundle> sets) noexcept { return size_of(sets); }

std::optional<Vec2<double>> analysis_detail::chief_point(const Lens& lens, const FieldPoint& point,
                                                         std::size_t wavelength) {
  const AimedRay chief = chief_ray(lens, point, wavelength);
  const auto hit = chief && chief.end.transmitted() ? pupil_detail::meet_film(lens, chief.end.ray) : std::nullopt;
  return hit ? std::optional(Vec2<double>{hit->x, hit->y}) : std::nullopt;
}

double airy_radius(const Lens& lens, Wavelength wavelength) {
  const double nm = wavelength.in_nm() ? *wavelength.in_nm() : lens.wavelengths_nm()[lens.wavelength_index(wavelength)];
  return 1.22 * nm * 1e-6 / lens.index(lens.surface_count(), wavelength) * film_side_f_number(lens);
}

std::string_view name(Diffraction diffraction) noexcept {
  switch (diffraction) {
    case Diffraction::negligible: return "negligible";
    case Diffraction::visible: return "visible";
    case Diffraction::dominant: break;
  }
  return "dominant";
}

Diffraction diffraction(double airy_radius_mm, const SpotSize& size) noexcept {
  const double blur = std::sqrt(2.0) * size.rms_radius;
  if (airy_radius_mm <= blur / 10) return Diffraction::negligible;
  return airy_radius_mm < blur ? Diffraction::visible : Diffraction::dominant;
}

Spot analysis_detail::trace_spot(const Lens& lens, const FieldPoint& point, std::size_t wavelength,
                                 std::uint32_t samples) {
  const std::size_t directions = lens.surface_count() > 512 ? 32 : 256;  // seconds for thousands of surfaces
  const PupilSampler pupil(pupil_boundary(lens, point, wavelength, directions));
  RayBundle rays = trace_bundle(lens, pupil, samples, 0, 1, 0, true);
  Spot spot;
  spot.point = point;
  spot.wavelength = wavelength;
  spot.x = std::move(rays.x), spot.y = std::move(rays.y);
  spot.slope_x = std::move(rays.slope_x), spot.slope_y = std::move(rays.slope_y);
  spot.sent = rays.sent;
  spot.size = petzval::spot_size(spot.x, spot.y);
  return spot;
}

Grid<Spot> spot_diagram(const Lens& lens, double subject_z, std::span<const double> fields_rad, std::uint32_t samples,
                        int threads) {
  const std::size_t wavelengths = lens.wavelengths_nm().size();
  Grid<Spot> spots{std::vector<Spot>(fields_rad.size() * wavelengths), wavelengths};
  parallel_for(spots.values.size(), 1, threads, [&](std::size_t at, std::size_t) {
    const std::size_t w = at % wavelengths;
    const FieldPoint point{fields_rad[at / wavelengths], subject_z};
    Spot& spot = spots.values[at];
    spot = analysis_detail::trace_spot(lens, point, w, samples);
    spot.relative_illumination = relative_illumination(lens, point, w);
    spot.chief_ray_height = chief_ray_height(lens, point, w);
  });
  return spots;
}

ChromaticAberration chromatic_aberration(const Lens& lens, double subject_z, std::span<const double> fields_rad) {
  const std::size_t count = lens.wavelengths_nm().size(), primary = lens.primary_wavelength();
  const Meridian meridian = main_meridian(lens);
  std::vector<std::optional<double>> paraxial(count), sharpest(count), heights(count);
  for (std::size_t w = 0; w < count; ++w) {
    const double image_z = paraxial_image_z(lens, subject_z, w, meridian);
    if (std::isfinite(image_z)) paraxial[w] = image_z;
    sharpest[w] = sharpest_film(lens, subject_z, w);
  }
  ChromaticAberration result{differences(paraxial, primary), differences(sharpest, primary), {}};
  for (const double field : fields_rad) {
    for (std::size_t w = 0; w < count; ++w) heights[w] = chief_ray_height(lens, {field, subject_z}, w);
    result.lateral.push_back(differences(heights, primary));
  }
  return result;
}

}  // namespace petzval
