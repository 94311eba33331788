// SPDX-License-Identifier: Apache-2.0
#include "spectrum.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "petzval/core/error.hpp"

namespace petzval::lens_detail {
namespace {

using kernel::SquaredIndex;

constexpr std::size_t terms = SquaredIndex<double>::terms;

/// The polynomial through values at the zeros of the Chebyshev polynomial T_8: a sum of T_0 to T_7, in powers.
SquaredIndex<double> through(const std::array<double, terms>& values) {
  SquaredIndex<double> result{.by_power = {0}, .constant = false};
  std::array<double, terms> before{}, own{1};  // T_{k-1}, T_k
  for (std::size_t k = 0; k < terms; ++k) {
    double term = 0;
    for (std::size_t j = 0; j < terms; ++j) {
      const double angle = std::numbers::pi * (static_cast<double>(j) + 0.5) / terms;
      term += values[j] * std::cos(static_cast<double>(k) * angle) * (k == 0 ? 1.0 : 2.0) / terms;
    }
    for (std::size_t i = 0; i < terms; ++i) result.by_power[i] += term * own[i];
    std::array<double, terms> next{};
    for (std::size_t i = 0; i < terms; ++i) {
      next[i] = (i > 0 ? own[i - 1] * (k == 0 ? 1 : 2) : 0) - (k == 0 ? 0 : before[i]);
    }
    before = own;
    own = next;
  }
  return result;
}

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
  // `term` is in units of pi / terms: the zeros of T_8 are at odd halves, its extrema at integers.
  const auto nm_at = [&](double term) {
    const double t = std::cos(std::numbers::pi * term / terms);
    const double nm = coordinate_.scale / (t + coordinate_.offset);
    return std::clamp(nm, *std::min_element(compiled_nm_.begin(), compiled_nm_.end()),
                      *std::max_element(compiled_nm_.begin(), compiled_nm_.end()));
  };
  try {
    if (coordinate_.scale == 0) {
      const double n = index_at(compiled_nm_.front());
      medium.by_power[0] = n * n;
      return;
    }
    std::array<double, terms> values;
    for (std::size_t j = 0; j < terms; ++j) {
      const double n = index_at(nm_at(static_cast<double>(j) + 0.5));
      values[j] = n * n;
    }
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    medium.by_power[0] = values[0];
    medium.constant = *least == *most;
    if (medium.constant) return;
    medium = through(values);
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
