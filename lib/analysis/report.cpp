// SPDX-License-Identifier: Apache-2.0
#include "petzval/analysis/report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "analysis/spot_moments.hpp"
#include "core/text.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace {

/// The result of `compute`, or the message of its Error.
template <class Compute>
auto quantity(const Compute& compute) -> LensReport::Quantity<decltype(compute())> {
  try {
    return {compute(), {}};
  } catch (const Error& error) {
    return {{}, error.what()};
  }
}

/// Rays of a spot. The sampling errors grow with lenses of more than 512 surfaces.
std::uint32_t rays_per_spot(const Lens& lens) {
  constexpr std::size_t most_hits = 1 << 24;  // rays times surfaces
  std::uint32_t rays = 32768;
  while (rays > 256 && rays * lens.surface_count() > most_hits) rays /= 2;
  return rays;
}

Grid<MtfPoint> mtf_over_field(const LensReport& r, std::span<const double> fields_rad, std::uint32_t rays) {
  constexpr std::array frequencies{10.0, 20.0, 40.0};
  const std::size_t wavelengths = r.lens.wavelengths_nm().size();
  Grid<Spot> spots{std::vector<Spot>(fields_rad.size() * wavelengths), wavelengths};
  parallel_for(spots.values.size(), 1, r.conditions.threads, [&](std::size_t at, std::size_t) {
    const FieldPoint point{fields_rad[at / wavelengths], r.conditions.subject_z};
    spots.values[at] = analysis_detail::trace_spot(r.lens, point, at % wavelengths, rays);
  });
  return geometric_mtf(spots, frequencies, r.conditions.wavelength_weights, r.conditions.threads);
}

std::vector<MtfChart> mtf_chart(const LensReport& r, std::span<const double> fields_rad) {
  constexpr std::array frequencies{10.0, 20.0, 30.0, 40.0};
  std::vector<MtfChart> result;
  for (const double f_number : {*r.f_number, 8.0}) {
    if (fields_rad.empty() || (!result.empty() && f_number < 1.01 * *r.f_number)) continue;
    result.emplace_back(
        f_number, diffraction_mtf(result.empty() ? r.lens : with_f_number(r.lens, f_number), r.conditions.subject_z,
                                  fields_rad, frequencies, r.conditions.wavelength_weights, r.conditions.threads));
  }
  return result;
}

Grid<ThroughFocusSpot> spots_through_focus(const LensReport& r) {
  const auto& weights = r.conditions.wavelength_weights;
  const auto step = through_focus_step(r.lens, *r.spots, weights);
  if (!step) return {{}, 1};
  const std::array shifts{-2 * *step, -*step, 0.0, *step, 2 * *step};
  return through_focus(*r.spots, shifts, weights);
}

Grid<MtfPoint> mtf_through_focus(const LensReport& r, std::span<const double> fields_rad) {
  const std::vector<double> shifts = mtf_film_shifts(r);
  if (shifts.empty()) return {{}, 1};
  return diffraction_mtf(r.lens, r.conditions.subject_z, fields_rad, std::array{30.0}, r.conditions.wavelength_weights,
                         r.conditions.threads, shifts);
}

Grid<std::optional<double>> chief_ray_shifts(const LensReport& r) {
  Grid<std::optional<double>> shifts{{}, r.spots->columns};
  for (std::size_t i = 0; i < r.spots->values.size(); ++i) {
    const auto& at_primary = (*r.spots)[i / shifts.columns][r.lens.primary_wavelength()].chief_ray_height;
    const auto& height = r.spots->values[i].chief_ray_height;
    shifts.values.push_back(height && at_primary ? std::optional(*height - *at_primary) : std::nullopt);
  }
  return shifts;
}

Grid<std::optional<Wavefront>> wavefronts(const LensReport& r, std::span<const double> fields_rad,
                                          std::size_t directions) {
  const std::size_t wavelengths = r.lens.wavelengths_nm().size();
  Grid<std::optional<Wavefront>> fronts{std::vector<std::optional<Wavefront>>(fields_rad.size() * wavelengths),
                                        wavelengths};
  parallel_for(fronts.values.size(), 1, r.conditions.threads, [&](std::size_t k, std::size_t) {
    const FieldPoint point{.field_rad = fields_rad[k / wavelengths], .z = r.conditions.subject_z};
    fronts.values[k] = wavefront(r.lens, point, k % wavelengths, PupilCoordinates::stop, directions);
  });
  return fronts;
}

}  // namespace

std::vector<double> mtf_film_shifts(const LensReport& report) {
  std::vector<double> shifts;
  const auto& films = *report.through_focus;
  for (int k = -10; k <= 10 && !films.values.empty(); ++k) shifts.push_back(films[0].back().film_shift_mm * k / 20);
  return shifts;
}

LensReport lens_report(const Lens& lens, LensReport::Conditions conditions) {
  LensReport r{.lens = lens, .conditions = std::move(conditions)};
  const double z = r.conditions.subject_z;
  const std::vector<double>& weights = r.conditions.wavelength_weights;
  const int threads = r.conditions.threads;
  const std::size_t wavelengths = lens.wavelengths_nm().size();
  if (threads < 1) throw Error("threads = " + std::to_string(threads) + "; must be at least 1");
  if (!weights.empty() && weights.size() != wavelengths) {
    throw Error(lens.name() + ": wavelength_weights has " + std::to_string(weights.size()) + " values; must have " +
                std::to_string(wavelengths));
  }
  for (const double weight : weights) {
    if (weight >= 0 && std::isfinite(weight)) continue;
    throw Error(lens.name() + ": wavelength_weights: " + to_text(weight) + "; must be finite and not negative");
  }
  std::vector<double> fields;
  r.largest_field.object_distance = lens.surfaces().front().vertex_z - z;
  for (const double field : r.conditions.fields_deg) {
    if (!std::isfinite(field)) throw Error(lens.name() + ": fields_deg: " + to_text(field) + "; must be finite");
    fields.push_back(radians(field));
    r.largest_field.field_rad = std::max(r.largest_field.field_rad, std::abs(fields.back()));
  }

  const Meridian main = main_meridian(lens);
  for (const Meridian meridian : {main, main == Meridian::y ? Meridian::x : Meridian::y}) {
    if (meridian != main && lens.rotationally_symmetric()) continue;
    r.sections.push_back(
        {meridian, first_order(lens, {}, meridian), quantity([&] { return pupils(lens, {}, meridian); })});
  }
  r.f_number = quantity([&] { return real_f_number(lens); });
  r.paraxial_rays = quantity([&] { return paraxial_rays(lens, r.largest_field); });
  const auto seidel = [&](const ParaxialField& field) {
    const auto [shortest, longest] = std::ranges::minmax(lens.wavelengths_nm());
    return seidel_sums(lens, field, {}, lens.wavelength_index(Wavelength::nm(shortest)),
                       lens.wavelength_index(Wavelength::nm(longest)));
  };
  r.seidel = quantity([&] { return seidel(r.largest_field); });
  if (r.conditions.entrance_pupil_diameter) {
    ParaxialField declared = r.largest_field;
    declared.entrance_pupil_diameter = r.conditions.entrance_pupil_diameter;
    r.paraxial_rays_declared = quantity([&] { return paraxial_rays(lens, declared); });
    r.seidel_declared = quantity([&] { return seidel(declared); });
  }

  // Light of a point at infinity leaves an afocal lens as parallel light: it has no focus and no image height.
  const bool no_image =
      std::isinf(z) && std::ranges::any_of(r.sections, [](const auto& s) { return s.first_order.afocal; });
  const auto of_image = [&](const auto& compute) {
    return quantity([&] {
      if (no_image) throw Error(lens.name() + ": is afocal, and the subject is at infinity; must have an image");
      return compute();
    });
  };

  const std::uint32_t rays = rays_per_spot(lens);
  r.ray_fans = quantity([&] { return ray_fans(lens, z, fields); });
  r.field_curvature = of_image([&] { return field_curvature(lens, z, fields); });
  r.distortion = of_image([&] { return distortion_percent(lens, z, fields); });
  r.spots = quantity([&] { return spot_diagram(lens, z, fields, rays, threads); });
  std::vector<double> frequencies;
  for (int k = 0; k <= 20; ++k) frequencies.push_back(5 * k);
  r.mtf = of_image([&] { return geometric_mtf(*r.spots, frequencies, weights, threads); });
  r.diffraction_limit = of_image([&] {
    const double f_number = film_side_f_number(lens);
    const double nm = lens.wavelengths_nm()[lens.primary_wavelength()] / lens.index(lens.surface_count());
    std::vector<double> limit;
    for (const double frequency : frequencies) limit.push_back(diffraction_limited_mtf(frequency, nm, f_number));
    return limit;
  });
  std::vector<double> chart_fields;
  for (int k = 0; k <= 10 && r.largest_field.field_rad != 0; ++k) {
    chart_fields.push_back(r.largest_field.field_rad * k / 10);
  }
  r.mtf_over_field = of_image([&] { return mtf_over_field(r, chart_fields, rays / 8); });
  r.mtf_diffraction = quantity([&] {
    constexpr std::array coarse{0.0, 5.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0, 100.0};
    return diffraction_mtf(lens, z, fields, coarse, weights, threads);
  });
  r.mtf_chart = quantity([&] { return mtf_chart(r, chart_fields); });
  r.through_focus = of_image([&] { return spots_through_focus(r); });
  r.mtf_through_focus = quantity([&] { return mtf_through_focus(r, fields); });
  r.encircled_energy = quantity([&] {
    constexpr std::array fractions{0.5, 0.8, 0.9, 0.95};
    return encircled_energy(*r.spots, fractions, weights, threads);
  });
  r.longitudinal_aberration = of_image([&] { return longitudinal_aberration(lens, z); });
  r.lateral_colour = quantity([&] { return chief_ray_shifts(r); });
  r.wavefront = of_image([&] { return wavefronts(r, fields, rays < 32768 ? 12 : 48); });
  return r;
}

}  // namespace petzval
