// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lens_view.hpp"
#include "petzval/core/export.hpp"
#include "wavelength_rows.hpp"

namespace petzval::inline v0::lens_detail {

/// Compiled wavelengths in the order of their ranks, the smallest first, to find those about any other.
class PETZVAL_API CompiledWavelengths {
 public:
  /// Of nothing: it covers no wavelength.
  CompiledWavelengths() = default;
  explicit CompiledWavelengths(std::span<const double> wavelengths_nm);

  std::size_t count() const noexcept { return ranked_.size(); }
  std::size_t position(std::size_t rank) const noexcept { return ranked_[rank].position; }

  /// The range of wavelengths that are covered, nm.
  double shortest() const noexcept { return place_.shortest; }
  double longest() const noexcept { return place_.longest; }
  /// Whether a wavelength lies among them, or beside them by the rounding of a float.
  bool covers(double nm) const noexcept { return place_.covers(nm); }
  const kernel::SpectralPlace<double>& range() const noexcept { return place_; }
  /// The place in the range, from -1 to 1.
  double place(double nm) const noexcept { return place_.at(nm); }
  /// The wavelength at a place.
  double nm_at(double place) const noexcept;

  /// Position of the nearest one; count() for a wavelength that is not covered.
  std::size_t nearest(double nm) const noexcept;
  /// The same for N; 65535 for those not covered.
  void nearest(std::size_t count, const float* nm, std::uint16_t* positions) const noexcept;

  /// The weights of some ranks in what lies at a wavelength between them.
  struct Neighbours {
    std::size_t first = 0;
    std::array<double, 4> weights{0, 0, 0, 0};
  };
  /// Cubics through four neighbours, or as many as there are; straight lines where neighbours stand so unevenly that a
  /// cubic would make their errors larger. For a wavelength that is covered.
  Neighbours about(double nm) const noexcept {
    std::size_t rank = 0;
    for (std::size_t r = 1; r < intervals_.size(); ++r) rank += nm >= ranked_[r].nm;
    return about(intervals_[rank], place(nm));
  }

 private:
  struct Ranked {
    double nm, place;
    std::size_t position;
  };
  /// Between two ranks: weights of nodes as cubics of the place, from its begin.
  struct Interval {
    std::size_t first = 0;
    double from = 0;
    std::array<std::array<double, 4>, 4> by_power{};  // [power][node]
  };
  Interval interval(std::size_t rank, std::size_t first, std::size_t nodes) const noexcept;
  Neighbours about(const Interval& interval, double place) const noexcept {
    const double t = place - interval.from;
    Neighbours result{.first = interval.first};
    const auto& c = interval.by_power;
    for (std::size_t k = 0; k < 4; ++k) result.weights[k] = ((c[3][k] * t + c[2][k]) * t + c[1][k]) * t + c[0][k];
    return result;
  }

  kernel::SpectralPlace<double> place_;
  std::vector<Ranked> ranked_;
  std::vector<Interval> intervals_;  // from each rank to the next
  std::vector<float> middles_;       // nm, between neighbours
};

/// Some numbers of a lens, known at its compiled wavelengths, at any wavelength between: in tables so fine that linear
/// interpolation shows nothing of them.
template <std::size_t numbers>
class BetweenWavelengths {
 public:
  using Values = std::array<double, numbers>;

  /// Of no wavelength.
  BetweenWavelengths() : BetweenWavelengths({}, {}) {}
  /// values: by position. wavelengths: theirs, or none where there is nothing between them.
  BetweenWavelengths(const CompiledWavelengths& wavelengths, std::span<const Values> values)
      : wavelengths_(wavelengths), compiled_(values.size()) {
    std::vector<Values> rows(values.begin(), values.end());
    for (std::size_t i = 0; i <= cells && wavelengths.count() > 0; ++i) {
      const auto [first, weights] = wavelengths.about(wavelengths.nm_at(2 * static_cast<double>(i) / cells - 1));
      Values& row = rows.emplace_back(Values{});
      for (std::size_t k = 0; k < weights.size() && first + k < wavelengths.count(); ++k) {
        const Values& own = values[wavelengths.position(first + k)];
        for (std::size_t j = 0; j < numbers; ++j) row[j] += weights[k] * own[j];
      }
    }
    rows.resize(rows.size() + 2, Values{});
    for (const Values& row : rows) {
      twice_.insert(twice_.end(), row.begin(), row.end());
      for (const double value : row) single_.push_back(static_cast<float>(value));
    }
  }

  bool covers(double nm) const noexcept { return wavelengths_.covers(nm); }
  /// For a wavelength that is covered.
  Values operator()(double nm) const noexcept {
    const double at = (wavelengths_.place(nm) + 1) / 2 * cells;
    const auto cell = std::min(static_cast<std::size_t>(at), cells - 1);
    const double part = at - static_cast<double>(cell);
    const double* const row = twice_.data() + (compiled_ + cell) * numbers;
    Values result;
    for (std::size_t j = 0; j < numbers; ++j) result[j] = row[j] + part * (row[j + numbers] - row[j]);
    return result;
  }

  /// For loops over rays.
  template <class R>
  WavelengthRows<R, numbers> rows() const noexcept {
    const auto of = [this](const std::vector<R>& rows) -> WavelengthRows<R, numbers> {
      const auto& [shortest, longest, scale, offset] = wavelengths_.range();
      const auto number = [](double x) { return static_cast<R>(x); };
      return {rows.data(),
              static_cast<std::int32_t>(compiled_),
              static_cast<std::int32_t>(rows.size() / numbers - 2),
              {number(shortest), number(longest), number(scale), number(offset)}};
    };
    if constexpr (sizeof(R) == sizeof(float)) {
      return of(single_);
    } else {
      return of(twice_);
    }
  }

 private:
  static constexpr std::size_t cells = WavelengthRows<double, numbers>::cells;

  CompiledWavelengths wavelengths_;
  std::size_t compiled_ = 0;
  std::vector<float> single_;  // WavelengthRows::rows
  std::vector<double> twice_;
};

}  // namespace petzval::inline v0::lens_detail
