// SPDX-License-Identifier: Apache-2.0
#include "polynomial/ray_polynomial.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <string>
#include <utility>

#include "core/dual.hpp"
#include "core/text.hpp"
#include "data.hpp"
#include "modes.hpp"
#include "petzval/core/error.hpp"
#include "sums.hpp"

namespace petzval {
namespace {

using kernel::Dual;

using DualMap = polynomial_detail::Mapped<Dual> (*)(const polynomial_detail::Scales<double>&,
                                                    const polynomial_detail::Four<Dual>& line,
                                                    const double* coefficients) noexcept;
constexpr auto dual_maps = polynomial_detail::by_symmetry_and_degree(
    []<class Symmetry>(Symmetry) -> DualMap { return polynomial_detail::map<Symmetry, Dual>; });

/// Products of larger values overflow in float; no lens comes near this limit.
constexpr double max_value = 1e12;

std::vector<double> wavelengths_of(const std::vector<RayPolynomial::Fit>& fits) {
  std::vector<double> nm;
  for (const RayPolynomial::Fit& fit : fits) nm.push_back(fit.wavelength_nm);
  return nm;
}

/// Coefficients of a fit in the order of Job.
std::vector<double> all_coefficients(const RayPolynomial::Fit& fit) {
  std::vector<double> result;
  for (const auto* c : {&fit.direction_by_film, &fit.direction_by_pupil, &fit.offset_by_film, &fit.offset_by_pupil}) {
    result.insert(result.end(), c->begin(), c->end());
  }
  for (const double value : result) {
    if (std::abs(value) <= max_value) continue;
    throw Error("polynomial: fit at " + to_text(fit.wavelength_nm) + " nm: coefficient = " + to_text(value) +
                "; must be a number from " + to_text(-max_value) + " to " + to_text(max_value));
  }
  return result;
}

}  // namespace

RayPolynomial::Data::Data(int of_degree, const Domain& of_domain, std::vector<Fit> all, std::size_t primary)
    : degree(of_degree), domain(of_domain), fits(std::move(all)) {
  polynomial_detail::check_degree("polynomial: ", degree);
  std::vector<std::vector<double>> coefficients;
  std::transform(fits.begin(), fits.end(), std::back_inserter(coefficients), all_coefficients);
  // Between fits, errors grow by a twentieth and by less than the rounding of float.
  constexpr double relative_tolerance = 0.05, least_rad = 5e-8;
  double most_rad = 0, most_mm = 0, largest_offset = 0;
  for (const Fit& fit : fits) {
    most_rad = std::max(most_rad, fit.rms_rad), most_mm = std::max(most_mm, fit.rms_mm);
    for (const auto* offsets : {&fit.offset_by_film, &fit.offset_by_pupil}) {
      for (const double offset : *offsets) largest_offset = std::max(largest_offset, std::abs(offset));
    }
  }
  by_wavelength = {
      domain,
      wavelengths_of(fits),
      primary,
      coefficients,
      {relative_tolerance * most_rad + least_rad, relative_tolerance * most_mm + least_rad * largest_offset + 1e-300}};
}

namespace polynomial_detail {

WavelengthFits::WavelengthFits(const RayPolynomial::Domain& domain, std::span<const double> wavelengths_nm,
                               std::size_t primary, const std::vector<std::vector<double>>& coefficients,
                               const std::array<double, 2>& tolerances)
    : count_(coefficients.size()), primary_(primary), wavelengths_(wavelengths_nm) {
  const auto [modes, weights] = find_modes(coefficients, tolerances);
  modes_ = modes.size();
  mode_weights_ = {wavelengths_, weights};
  const auto round_to = [&, &modes = modes]<class R>(In<R>& in) {
    in.scales = scales_of<R>(domain);
    in.empty_domain = in.scales;
    in.empty_domain.per_film_radius = std::numeric_limits<R>::quiet_NaN();
    const auto append = [](std::vector<R>& to, const std::vector<double>& from) {
      std::transform(from.begin(), from.end(), std::back_inserter(to),
                     [](double value) { return static_cast<R>(value); });
    };
    for (const auto& mode : modes) append(in.modes, mode);
    in.rows = {coefficients[0].size(), count_};
    for (std::size_t w = 0; w < count_; ++w) {
      append(in.coefficients, coefficients[w]);
      for (std::size_t i = 0; i < coefficients[w].size(); ++i) in.rows.set(i, w, coefficients[w][i]);
    }
  };
  round_to(std::get<In<float>>(in_));
  round_to(std::get<In<double>>(in_));
}

}  // namespace polynomial_detail

void polynomial_detail::check_degree(const std::string& where, int degree) {
  if (degree >= 3 && degree <= 11 && degree % 2 == 1) return;
  throw Error(where + "degree = " + std::to_string(degree) + "; must be 3, 5, 7, 9 or 11");
}

RayPolynomial::RayPolynomial(int degree, const Domain& domain, std::vector<Fit> fits, std::size_t primary_wavelength)
    : data_(std::make_shared<const Data>(degree, domain, std::move(fits), primary_wavelength)) {}

int RayPolynomial::degree() const noexcept { return data_->degree; }
const RayPolynomial::Domain& RayPolynomial::domain() const noexcept { return data_->domain; }
const std::vector<RayPolynomial::Fit>& RayPolynomial::fits() const noexcept { return data_->fits; }

template <class T>
void RayPolynomial::to_scene(std::size_t count, const TwoPlaneRays<const T>& lines, const RayWavelengths& wavelengths,
                             const RayArrays<T>& rays, RayFate* fates) const noexcept {
  polynomial_detail::WavelengthFits::Buffer<T> between;
  auto job = data_->by_wavelength.job<T>(count, wavelengths, between);
  job.in = {lines.film_x, lines.film_y, lines.pupil_x, lines.pupil_y};
  job.out = {rays.x, rays.y, rays.z, rays.dx, rays.dy, rays.dz};
  job.fates = fates;
  using Loops = polynomial_detail::Loops<T, 2 * polynomial_detail::degree_count>;
  std::get<Loops>(polynomial_detail::polynomial_loops().to_scene)[data_->loop()](job);
}

RayFate RayPolynomial::to_scene(const TwoPlaneRay& line, Wavelength wavelength, Ray<double>& ray) const noexcept {
  polynomial_detail::WavelengthFits::Buffer<double> between;
  const auto [coefficients, scales] = data_->by_wavelength.fitted<double>(wavelength, between);
  return polynomial_detail::polynomial_loops().one[data_->loop()](coefficients, scales, line, ray);
}

RayOf<Dual> RayPolynomial::to_scene(const TwoPlaneRayOf<Dual>& line, Wavelength wavelength,
                                    RayFate& fate) const noexcept {
  polynomial_detail::WavelengthFits::Buffer<double> between;
  const auto [coefficients, scales] = data_->by_wavelength.fitted<double>(wavelength, between);
  const auto& [film_x, film_y, pupil_x, pupil_y] = line;
  const auto [inside, to] = dual_maps[data_->loop()](scales, {film_x, film_y, pupil_x, pupil_y}, coefficients);
  fate = inside ? RayFate::transmitted : RayFate::outside_fit;
  return {{to[0], to[1], to[2]}, {to[3], to[4], to[5]}};
}

void RayPolynomial::to_film(std::size_t count, const RayArrays<const double>& rays, const RayWavelengths& wavelengths,
                            const TwoPlaneRays<double>& lines, RayFate* fates) const noexcept {
  polynomial_detail::WavelengthFits::Buffer<double> between;
  const std::size_t at_once = wavelengths.shared() ? count : 1;
  for (std::size_t o = 0; o < count; o += at_once) {
    auto job = data_->by_wavelength.job<double>(at_once, {.all = wavelengths.at(o)}, between);
    job.in = {rays.x + o, rays.y + o, rays.z + o, rays.dx + o, rays.dy + o, rays.dz + o};
    job.out = {lines.film_x + o, lines.film_y + o, lines.pupil_x + o, lines.pupil_y + o};
    job.fates = fates + o;
    polynomial_detail::polynomial_loops().to_film[data_->loop()](job);
  }
}

template PETZVAL_API void RayPolynomial::to_scene<float>(std::size_t, const TwoPlaneRays<const float>&,
                                                         const RayWavelengths&, const RayArrays<float>&,
                                                         RayFate*) const noexcept;
template PETZVAL_API void RayPolynomial::to_scene<double>(std::size_t, const TwoPlaneRays<const double>&,
                                                          const RayWavelengths&, const RayArrays<double>&,
                                                          RayFate*) const noexcept;

}  // namespace petzval
