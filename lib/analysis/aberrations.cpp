// SPDX-License-Identifier: Apache-2.0
#include "petzval/analysis/aberrations.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include "core/meet_plane.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/pupil/aim.hpp"
#include "points.hpp"

namespace petzval {
namespace {

using FilmRay = core_detail::SlopeRay<double>;

/// The ray behind the lens, at the film.
std::optional<FilmRay> at_film(const Lens& lens, const AimedRay& aimed) {
  if (!aimed || !aimed.end.transmitted()) return {};
  const FilmRay ray = core_detail::slope_ray(aimed.end.ray, lens.film_z());
  if (!std::isfinite(ray.x + ray.y)) return {};
  return ray;
}

/// Distance at which rays on both sides of a chief ray intersect.
std::optional<double> crossing(double position_change, double slope_change) {
  const double distance = -position_change / slope_change;
  if (!std::isfinite(distance)) return {};
  return distance;
}

}  // namespace

std::vector<RayFan> ray_fans(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                             std::size_t count) {
  if (count < 2) throw Error("ray_fans: count = " + std::to_string(count) + "; must be at least 2");
  std::vector<RayFan> fans;
  for (const double field : fields_rad) {
    const FieldPoint point{.field_rad = field, .z = subject_z};
    const auto chief = analysis_detail::chief_point(lens, point, lens.primary_wavelength());
    for (std::size_t w = 0; w < lens.wavelengths_nm().size(); ++w) {
      RayFan& fan = fans.emplace_back(RayFan{field, w, {}});
      const auto ray = [&](const Vec2<double>& target) -> std::optional<FilmRay> {
        const AimedRay aimed = aim(lens, point, target, w);
        if (!chief || aimed.status != AimStatus::converged) return {};
        return at_film(lens, aimed);
      };
      for (std::size_t i = 0; i < count; ++i) {
        const double pupil = 2 * static_cast<double>(i) / static_cast<double>(count - 1) - 1;
        RayFan::Point& at = fan.points.emplace_back(RayFan::Point{pupil, {}, {}});
        constexpr double inside = 1 - 1e-9;  // rays on the rim of the stop may be clipped by rounding
        if (const auto tangential = ray({0, inside * pupil})) at.tangential_mm = tangential->y - chief->y;
        if (const auto sagittal = ray({inside * pupil, 0})) at.sagittal_mm = sagittal->x - chief->x;
      }
    }
  }
  return fans;
}

std::vector<FieldFocus> field_curvature(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                        Wavelength wavelength) {
  constexpr double step = 1e-3;  // semi-diameters of the stop
  std::vector<FieldFocus> foci;
  for (const double field : fields_rad) {
    const FieldPoint point{.field_rad = field, .z = subject_z};
    const auto ray = [&](const Vec2<double>& target) { return at_film(lens, aim(lens, point, target, wavelength)); };
    const auto up = ray({0, step}), down = ray({0, -step}), right = ray({step, 0}), left = ray({-step, 0});
    FieldFocus& focus = foci.emplace_back(FieldFocus{field, {}, {}});
    if (up && down) focus.tangential_mm = crossing(up->y - down->y, up->slope_y - down->slope_y);
    if (right && left) focus.sagittal_mm = crossing(right->x - left->x, right->slope_x - left->slope_x);
  }
  return foci;
}

std::vector<FieldDistortion> distortion_percent(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                                Wavelength wavelength) {
  const auto height = [&](double field) -> std::optional<double> {
    const FieldPoint point{.field_rad = field, .z = subject_z};
    const auto hit = analysis_detail::chief_point(lens, point, wavelength.position(lens.primary_wavelength()));
    if (!hit) return {};
    return hit->y;
  };
  constexpr double small = 1e-4;  // rad; the ratio differs by 1e-8 from its limit
  const auto near_axis = height(small);
  std::vector<FieldDistortion> result;
  for (const double field : fields_rad) {
    FieldDistortion& own = result.emplace_back(FieldDistortion{field, height(field), {}, {}});
    if (!own.height_mm || !near_axis) continue;
    const auto percent = [&](double projected, double limit) {
      return field == 0 ? 0 : 100 * (*own.height_mm / (*near_axis / limit * projected) - 1);
    };
    own.f_theta_percent = percent(field, small);
    if (std::abs(field) < std::numbers::pi / 2) own.f_tan_theta_percent = percent(std::tan(field), std::tan(small));
  }
  return result;
}

std::vector<MtfPoint> geometric_mtf(std::span<const Spot> spots, std::size_t wavelengths,
                                    std::span<const double> frequencies_per_mm,
                                    std::span<const double> wavelength_weights, int threads) {
  const bool weighted = !wavelength_weights.empty();
  if (wavelengths == 0 || spots.size() % wavelengths != 0 || (weighted && wavelength_weights.size() != wavelengths)) {
    throw Error("geometric_mtf: " + std::to_string(spots.size()) + " spots, " + std::to_string(wavelengths) +
                " wavelengths and " + std::to_string(wavelength_weights.size()) +
                " weights; must be spots of all wavelengths of each field, and a weight for each wavelength or none");
  }
  const std::size_t count = frequencies_per_mm.size();
  std::vector<MtfPoint> result(spots.size() / wavelengths * count);
  parallel_for(result.size(), 1, threads, [&](std::size_t at, std::size_t) {
    const auto own = spots.subspan(at / count * wavelengths, wavelengths);
    const double frequency = frequencies_per_mm[at % count];
    std::complex<double> along_y = 0, along_x = 0;
    double total = 0;
    for (std::size_t w = 0; w < wavelengths; ++w) {
      const Spot& spot = own[w];
      // Rays sample the pupil evenly: a wavelength counts by its weight and by the rays that pass.
      const double weight =
          (weighted ? wavelength_weights[w] : 1) / static_cast<double>(std::max<std::size_t>(spot.sent, 1));
      for (std::size_t i = 0; i < spot.x.size(); ++i) {
        along_y += std::polar(weight, -2 * std::numbers::pi * frequency * spot.y[i]);
        along_x += std::polar(weight, -2 * std::numbers::pi * frequency * spot.x[i]);
      }
      total += weight * static_cast<double>(spot.x.size());
    }
    const auto contrast = [total](const std::complex<double>& sum) { return total > 0 ? std::abs(sum) / total : 0; };
    result[at] = {own.front().point.field_rad, frequency, contrast(along_y), contrast(along_x)};
  });
  return result;
}

double diffraction_limited_mtf(double frequency_per_mm, double wavelength_nm, double f_number) noexcept {
  const double s = std::abs(frequency_per_mm) * wavelength_nm * 1e-6 * f_number;
  return s < 1 ? 2 / std::numbers::pi * (std::acos(s) - s * std::sqrt(1 - s * s)) : 0;
}

}  // namespace petzval
