// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lens_view.hpp"
#include "petzval/core/config.hpp"
#include "wavelength_rows.hpp"

namespace petzval::lens_detail {

/// Compiled wavelengths in ascending order, to find the neighbours of any wavelength. The rank of a wavelength is its
/// position in this order.
class PETZVAL_API CompiledWavelengths {
 public:
  /// Covers no wavelength.
  CompiledWavelengths() = default;
  explicit CompiledWavelengths(std::span<const double> wavelengths_nm);

  std::size_t count() const noexcept { return ranked_.size(); }
  std::size_t position(std::size_t rank) const noexcept { return ranked_[rank].position; }
  /// True if no step between neighbours is more than twice as long as another and the longest wavelength is at most 1.8
  /// times the shortest.
  bool even() const noexcept;

  /// The range of covered wavelengths (nm).
  double shortest() const noexcept { return coordinate_.shortest; }
  double longest() const noexcept { return coordinate_.longest; }
  /// True if a wavelength lies in the range, extended by the rounding of a float.
  bool covers(double nm) const noexcept { return coordinate_.covers(nm); }
  /// Maps a wavelength of the range linearly to -1 to 1.
  double coordinate(double nm) const noexcept { return coordinate_.at(nm); }

  /// Position of the nearest compiled wavelength; count() if the wavelength is not covered.
  std::size_t nearest(double nm) const noexcept;
  /// For loops over rays.
  NearestPosition nearest_position() const noexcept {
    return {steps_.data(), steps_.size(), static_cast<float>(coordinate_.shortest),
            static_cast<float>(coordinate_.longest),
            ranked_.empty() ? 0 : static_cast<std::int32_t>(ranked_.front().position)};
  }

  /// Neighbours of a wavelength, by rank, and their weights in the interpolated value.
  struct Neighbours {
    std::size_t first = 0;
    std::array<double, 4> weights{0, 0, 0, 0};
  };
  /// Interpolates by a cubic through four neighbours (fewer if there are fewer), or by a straight line if the
  /// neighbours are spaced so unevenly that a cubic would amplify their errors. The wavelength must be covered.
  Neighbours about(double nm) const noexcept {
    std::size_t rank = 0;
    for (std::size_t r = 1; r < intervals_.size(); ++r) rank += nm >= ranked_[r].nm;
    return about(intervals_[rank], coordinate(nm));
  }

 private:
  struct Ranked {
    double nm, coordinate;
    std::size_t position;
  };
  /// The interval between two ranks: weights of its nodes as cubics of the position in the interval.
  struct Interval {
    std::size_t first = 0;
    double from = 0;
    std::array<std::array<double, 4>, 4> by_power{};  // [power][node]
  };
  Interval interval(std::size_t rank, std::size_t first, std::size_t nodes) const noexcept;
  Neighbours about(const Interval& interval, double coordinate) const noexcept {
    const double t = coordinate - interval.from;
    Neighbours result{.first = interval.first};
    const auto& c = interval.by_power;
    for (std::size_t k = 0; k < 4; ++k) result.weights[k] = ((c[3][k] * t + c[2][k]) * t + c[1][k]) * t + c[0][k];
    return result;
  }

  kernel::SpectralCoordinate<double> coordinate_;
  std::vector<Ranked> ranked_;
  std::vector<Interval> intervals_;           // from each rank to the next
  std::vector<NearestPosition::Step> steps_;  // at the middles between neighbours
};

/// Numbers of a lens that are known at its compiled wavelengths, interpolated at any wavelength between. They are
/// stored as parabolas over equal cells, which are so small that they add little error: few_cells cells for uniform
/// wavelengths; 2047 for uneven wavelengths, whose straight lines meet at corners, and for wide ranges, at whose ends
/// dispersion is steep.
template <std::size_t numbers>
class BetweenWavelengths {
 public:
  using Values = std::array<double, numbers>;

  /// Covers no wavelength.
  BetweenWavelengths() : BetweenWavelengths({}, {}) {}
  /// @param wavelengths wavelengths of the values; empty to look up compiled wavelengths only
  /// @param values by position of the wavelength
  BetweenWavelengths(const CompiledWavelengths& wavelengths, std::span<const Values> values)
      : wavelengths_(wavelengths), compiled_(values.size()) {
    const double range = std::max(wavelengths.longest() - wavelengths.shortest(), 0.0);
    const auto at = [&](double nm) {
      const auto [first, weights] = wavelengths.about(nm);
      Values sum{};
      for (std::size_t k = 0; k < weights.size() && first + k < wavelengths.count(); ++k) {
        const Values& own = values[wavelengths.position(first + k)];
        for (std::size_t j = 0; j < numbers; ++j) sum[j] += weights[k] * own[j];
      }
      return sum;
    };
    if (wavelengths.count() > 0) cut(wavelengths.even() ? permuted_cells : 2047, range, at);
    single_ = In<float>(compiled_, powers_.size());
    twice_ = In<double>(compiled_, powers_.size());
    const auto fill = [&](auto& in) {
      for (std::size_t j = 0; j < numbers; ++j) {
        for (std::size_t w = 0; w < compiled_; ++w) in.by_position.set(j, w, values[w][j]);
        for (std::size_t i = 0; i < powers_.size(); ++i) {
          for (std::size_t p = 0; p < 3; ++p) in.by_nm.set(3 * j + p, i, powers_[i][j][p]);
        }
      }
    };
    fill(single_);
    fill(twice_);
  }

  bool covers(double nm) const noexcept { return wavelengths_.covers(nm); }
  /// Requires a covered wavelength.
  Values operator()(double nm) const noexcept {
    const double at = std::max((nm - wavelengths_.shortest()) * cells_per_nm_, 0.0);
    const auto cell = std::min(static_cast<std::size_t>(at), powers_.size() - 1);
    const double fraction = at - static_cast<double>(cell);
    Values result;
    for (std::size_t j = 0; j < numbers; ++j) {
      const auto& [begin, by_fraction, by_square] = powers_[cell][j];
      result[j] = begin + fraction * (by_fraction + fraction * by_square);
    }
    return result;
  }

  /// For loops over rays.
  template <class R>
  WavelengthRows<R> rows() const noexcept {
    const auto of = [this](const In<R>& in) -> WavelengthRows<R> {
      return {in.by_position.data(),
              in.by_position.length(),
              static_cast<std::int32_t>(compiled_),
              static_cast<std::int32_t>(powers_.size()),
              in.by_nm.data(),
              in.by_nm.length(),
              static_cast<R>(wavelengths_.shortest()),
              static_cast<R>(wavelengths_.longest()),
              static_cast<R>(cells_per_nm_)};
    };
    if constexpr (sizeof(R) == sizeof(float)) {
      return of(single_);
    } else {
      return of(twice_);
    }
  }

 private:
  /// Fits parabolas to at(nm) over a number of cells.
  template <class At>
  void cut(std::size_t cells, double range, const At& at) {
    const double width = range / static_cast<double>(cells);
    cells_per_nm_ = range > 0 ? 1 / width : 0;
    powers_.resize(cells);
    for (std::size_t i = 0; i < cells; ++i) {
      const double from = wavelengths_.shortest() + width * static_cast<double>(i);
      const Values begin = at(from), middle = at(from + width / 2), end = at(from + width);
      for (std::size_t j = 0; j < numbers; ++j) {
        const double by_square = 2 * (begin[j] - 2 * middle[j] + end[j]);
        powers_[i][j] = {begin[j], end[j] - begin[j] - by_square, by_square};
      }
    }
  }

  /// The tables in the layout of WavelengthRows.
  template <class R>
  struct In {
    AlignedRows<R> by_position, by_nm;
    In() = default;
    In(std::size_t compiled, std::size_t cells) : by_position(numbers, compiled + 1), by_nm(3 * numbers, cells + 1) {}
  };

  CompiledWavelengths wavelengths_;
  std::size_t compiled_ = 0;
  double cells_per_nm_ = 0;
  std::vector<std::array<std::array<double, 3>, numbers>> powers_;  // [cell], powers of the fraction in it
  In<float> single_;
  In<double> twice_;
};

}  // namespace petzval::lens_detail
