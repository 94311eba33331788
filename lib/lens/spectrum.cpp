// SPDX-License-Identifier: Apache-2.0
#include "spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/chebyshev.hpp"
#include "petzval/core/error.hpp"

namespace petzval::lens_detail {
namespace {

using kernel::SquaredIndex;

constexpr std::size_t terms = SquaredIndex<double>::terms;

}  // namespace

kernel::SpectralCoordinate<double> spectral_coordinate(std::span<const double> wavelengths_nm) {
  constexpr double rounding = 1.2e-7;  // of float
  kernel::SpectralCoordinate<double> result;
  if (wavelengths_nm.empty()) return result;
  const auto [shortest, longest] = std::minmax_element(wavelengths_nm.begin(), wavelengths_nm.end());
  result.shortest = *shortest * (1 - rounding);
  result.longest = *longest * (1 + rounding);
  if (*shortest == *longest) return result;
  const double from = 1 / *longest, to = 1 / *shortest;
  result.scale = 2 / (to - from);
  result.offset = (to + from) / (to - from);
  return result;
}

Spectrum::Spectrum(std::span<const double> wavelengths_nm)
    : compiled_nm_(wavelengths_nm.begin(), wavelengths_nm.end()), coordinate_(spectral_coordinate(wavelengths_nm)) {}

void Spectrum::add(const std::function<double(double)>& index_at, std::span<const double> kinks) {
  media_.emplace_back();
  SquaredIndex<double>& medium = media_.back();
  const auto nm_of = [&](double t) {
    const double nm = coordinate_.scale / (t + coordinate_.offset);
    return std::clamp(nm, *std::min_element(compiled_nm_.begin(), compiled_nm_.end()),
                      *std::max_element(compiled_nm_.begin(), compiled_nm_.end()));
  };
  // `term` is in units of pi / terms: the extrema of T_8 are at integers.
  const auto nm_at = [&](double term) { return nm_of(std::cos(std::numbers::pi * term / terms)); };
  try {
    if (coordinate_.scale == 0) {
      const double n = index_at(compiled_nm_.front());
      medium.by_power[0] = n * n;
      return;
    }
    double least = std::numeric_limits<double>::infinity(), most = 0;
    const auto series = core_detail::chebyshev_series<terms>([&](double t) {
      const double n = index_at(nm_of(t));
      least = std::min(least, n * n), most = std::max(most, n * n);
      return n * n;
    });
    medium.by_power[0] = most;
    medium.constant = least == most;
    if (medium.constant) return;
    medium.by_power = core_detail::by_powers(series);
    constexpr double error_margin = 1.1;  // margin for errors between the checked wavelengths
    const auto check = [&](double nm) {
      error_ = std::max(error_, error_margin * std::abs(index(media_.size() - 1, nm) - index_at(nm)));
    };
    for (std::size_t k = 0; k <= terms; ++k) check(nm_at(static_cast<double>(k)));
    for (const double nm : compiled_nm_) check(nm);
    // The error of a smooth function is largest at the extrema of T_8; with kinks it may be largest anywhere.
    constexpr std::size_t check_points = 32 * terms;
    for (const double nm : kinks) {
      if (nm >= nm_at(0) && nm <= nm_at(terms)) check(nm);
    }
    for (std::size_t k = 0; !kinks.empty() && k <= check_points; ++k)
      check(nm_at(static_cast<double>(k) * terms / check_points));
  } catch (const Error&) {
    error_ = std::numeric_limits<double>::infinity();
  }
  if (std::isfinite(error_)) return;
  // Without polynomials no wavelength between the compiled ones is covered.
  coordinate_.shortest = 1, coordinate_.longest = 0;
}

double Spectrum::index(std::size_t space, double nm) const noexcept {
  const double t = coordinate_.at(nm);
  return std::sqrt(media_[space].at(t, t * t, t * t * (t * t)));
}

}  // namespace petzval::lens_detail
