// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "petzval/analysis/spot.hpp"
#include "petzval/core/error.hpp"
#include "spot_moments.hpp"

namespace petzval {
namespace {

bool has_slopes(std::span<const Spot> spots) {
  return std::ranges::all_of(spots, [](const Spot& spot) {
    return spot.slope_x.size() == spot.x.size() && spot.slope_y.size() == spot.x.size();
  });
}

Grid<double> weights_of_rays_with_slopes(std::string_view where, const Grid<Spot>& spots,
                                         std::span<const double> wavelength_weights) {
  auto weights = analysis_detail::ray_weights(where, spots, wavelength_weights);
  if (!has_slopes(spots.values)) {
    throw Error(std::string(where) + ": spots have fewer slopes than positions; must be spots of spot_diagram");
  }
  return weights;
}

}  // namespace

namespace analysis_detail {

Grid<double> ray_weights(std::string_view where, const Grid<Spot>& spots, std::span<const double> wavelength_weights) {
  const bool weighted = !wavelength_weights.empty();
  if (spots.columns == 0 || spots.values.size() % spots.columns != 0 ||
      (weighted && wavelength_weights.size() != spots.columns)) {
    throw Error(std::string(where) + ": " + std::to_string(spots.values.size()) + " spots, " +
                std::to_string(spots.columns) + " wavelengths and " + std::to_string(wavelength_weights.size()) +
                " weights; must be spots of all wavelengths of each field, and a weight for each wavelength or none");
  }
  // Rays sample the pupil evenly: a wavelength counts by its weight and by the rays that pass.
  Grid<double> weights{{}, spots.columns};
  for (std::size_t i = 0; i < spots.values.size(); ++i) {
    weights.values.push_back((weighted ? wavelength_weights[i % spots.columns] : 1) /
                             static_cast<double>(std::max<std::size_t>(spots.values[i].sent, 1)));
  }
  return weights;
}

SpotMoments::SpotMoments(std::span<const Spot> spots, std::span<const double> ray_weights)
    : SpotMoments(spots, ray_weights, 0, error_parts) {}

SpotMoments::SpotMoments(std::span<const Spot> spots, std::span<const double> ray_weights, std::size_t first_part,
                         std::size_t last_part) {
  const auto lit = std::ranges::find_if(spots, [](const Spot& spot) { return !spot.x.empty(); });
  if (lit == spots.end()) return;
  // Relative to one of the rays: rounding errors are then proportional to the size of the spot and not to its height.
  const bool sloped = has_slopes(spots);
  const double x0 = lit->x[0], y0 = lit->y[0], u0 = sloped ? lit->slope_x[0] : 0, v0 = sloped ? lit->slope_y[0] : 0;
  double xs = 0, ys = 0, us = 0, vs = 0, squares = 0, products = 0, slope_squares = 0;
  for (std::size_t k = 0; k < spots.size(); ++k) {
    const Spot& spot = spots[k];
    const double w = ray_weights[k];
    const std::size_t count = spot.x.size(), last = last_part * count / error_parts;
    for (std::size_t i = first_part * count / error_parts; i < last; ++i) {
      const double x = spot.x[i] - x0, y = spot.y[i] - y0;
      const double u = sloped ? spot.slope_x[i] - u0 : 0, v = sloped ? spot.slope_y[i] - v0 : 0;
      weight_ += w;
      xs += w * x, ys += w * y, us += w * u, vs += w * v;
      squares += w * (x * x + y * y);
      products += w * (x * u + y * v);
      slope_squares += w * (u * u + v * v);
    }
  }
  if (empty()) return;
  const Vec2<double> position = Vec2<double>{xs, ys} / weight_, slope = Vec2<double>{us, vs} / weight_;
  position_ = Vec2<double>{x0, y0} + position;
  slope_ = Vec2<double>{u0, v0} + slope;
  squares_ = squares / weight_ - (position.x * position.x + position.y * position.y);
  position_times_slope_ = products / weight_ - (position.x * slope.x + position.y * slope.y);
  slope_squares_ = slope_squares / weight_ - (slope.x * slope.x + slope.y * slope.y);
}

Vec2<double> SpotMoments::centroid(double shift) const noexcept { return position_ + shift * slope_; }

double SpotMoments::rms(double shift) const noexcept {
  return std::sqrt(std::max(0.0, squares_ + shift * (2 * position_times_slope_ + shift * slope_squares_)));
}

std::optional<BlurParabola> SpotMoments::parabola() const noexcept {
  if (!(slope_squares_ > 0)) return {};
  const double best = -position_times_slope_ / slope_squares_;
  return BlurParabola{best, squares_ + best * position_times_slope_, slope_squares_};
}

std::optional<BlurParabola> mean(std::span<const std::optional<BlurParabola>> fields) noexcept {
  double count = 0, steepness = 0, moment = 0;
  for (const auto& f : fields) {
    if (f) ++count, steepness += f->steepness, moment += f->steepness * f->best;
  }
  if (count == 0) return {};
  const double best = moment / steepness;
  double least = 0;
  for (const auto& f : fields) {
    if (f) least += f->rms(best) * f->rms(best);
  }
  return BlurParabola{best, least / count, steepness / count};
}

double focus_range(const Lens& lens, const BlurParabola& blur) noexcept {
  const double lambda = lens.wavelengths_nm()[lens.primary_wavelength()] * 1e-6;
  return std::max(std::sqrt(8 * std::max(blur.least, 0.0) / blur.steepness), lambda / (2 * blur.steepness));
}

}  // namespace analysis_detail

Grid<ThroughFocusSpot> through_focus(const Grid<Spot>& spots, std::span<const double> film_shifts_mm,
                                     std::span<const double> wavelength_weights) {
  const auto weights = weights_of_rays_with_slopes("through_focus", spots, wavelength_weights);
  Grid<ThroughFocusSpot> result{{}, film_shifts_mm.size()};
  for (std::size_t field = 0; field < spots.size(); ++field) {
    const auto own = spots[field];
    const auto own_weights = weights[field];
    const analysis_detail::SpotMoments all(own, own_weights);
    std::vector<analysis_detail::SpotMoments> parts;
    for (std::size_t k = 0; k < analysis_detail::error_parts; ++k) parts.emplace_back(own, own_weights, k);
    for (const double shift : film_shifts_mm) {
      ThroughFocusSpot& spot = result.values.emplace_back(ThroughFocusSpot{own.front().point.field_rad, shift});
      if (all.empty()) continue;
      spot.centroid = all.centroid(shift);
      spot.rms_radius_mm = all.rms(shift);
      for (const auto& part : parts) {
        spot.sampling_error_mm = std::max(spot.sampling_error_mm, std::abs(part.rms(shift) - all.rms(shift)));
      }
    }
  }
  return result;
}

std::optional<double> through_focus_step(const Lens& lens, const Grid<Spot>& spots,
                                         std::span<const double> wavelength_weights) {
  const auto weights = weights_of_rays_with_slopes("through_focus_step", spots, wavelength_weights);
  std::vector<std::optional<analysis_detail::BlurParabola>> fields;
  for (std::size_t field = 0; field < spots.size(); ++field) {
    fields.push_back(analysis_detail::SpotMoments(spots[field], weights[field]).parabola());
  }
  const auto blur = analysis_detail::mean(fields);
  if (!blur) return {};
  const double step = std::max(analysis_detail::focus_range(lens, *blur), std::abs(blur->best)) / 2;
  const double ten = std::pow(10, std::floor(std::log10(step)));
  if (!std::isfinite(ten) || !(ten > 0)) return {};
  constexpr std::array steps{1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0};
  return ten * *std::ranges::min_element(steps, {}, [&](double s) { return std::abs(std::log(s * ten / step)); });
}

}  // namespace petzval
