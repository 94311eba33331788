// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "petzval/analysis/spot.hpp"
#include "petzval/core/config.hpp"

namespace petzval::analysis_detail {

/// The rays of a point at one wavelength, without chief ray and illumination.
PETZVAL_API Spot trace_spot(const Lens& lens, const FieldPoint& point, std::size_t wavelength, std::uint32_t samples);

/// Weight of a ray for each wavelength of spots: the weight of the wavelength divided by the rays that were sent.
///
/// @param where   name of the function, for messages
/// @throws Error  if the number of spots is not a multiple of their wavelengths, or the number of weights differs
PETZVAL_API Grid<double> ray_weights(std::string_view where, const Grid<Spot>& spots,
                                     std::span<const double> wavelength_weights);

/// Sampling errors are stated as the largest deviation of a quarter of the rays from all rays. For 30 lenses of
/// data/lenses the largest errors of a figure, against eight times as many rays, are at most 0.92 of it.
inline constexpr std::size_t error_parts = 4;
/// The values of a part, from 0 to error_parts - 1.
inline std::span<const double> part_of(std::span<const double> values, std::size_t part) noexcept {
  const std::size_t begin = part * values.size() / error_parts, end = (part + 1) * values.size() / error_parts;
  return values.subspan(begin, end - begin);
}

/// Mean square radius of a spot over film shifts (mm): least + steepness (shift - best)^2.
struct BlurParabola {
  double best = 0, least = 0, steepness = 0;

  double rms(double shift) const noexcept {
    return std::sqrt(std::max(0.0, least + steepness * (shift - best) * (shift - best)));
  }
  double least_rms() const noexcept { return std::sqrt(std::max(0.0, least)); }
};

/// Moments of weighted rays in the film: the centroid and the mean square radius follow for any shift of the film.
class PETZVAL_API SpotMoments {
 public:
  SpotMoments() = default;
  /// ray_weights: one per spot.
  SpotMoments(std::span<const Spot> spots, std::span<const double> ray_weights);
  /// A part of the rays of each spot.
  SpotMoments(std::span<const Spot> spots, std::span<const double> ray_weights, std::size_t part)
      : SpotMoments(spots, ray_weights, part, part + 1) {}

  /// True if no ray passes.
  bool empty() const noexcept { return !(weight_ > 0); }
  Vec2<double> centroid(double shift) const noexcept;
  double rms(double shift) const noexcept;
  /// nullopt if there are no rays or the rays are parallel.
  std::optional<BlurParabola> parabola() const noexcept;

 private:
  SpotMoments(std::span<const Spot> spots, std::span<const double> ray_weights, std::size_t first_part,
              std::size_t last_part);

  double weight_ = 0;
  Vec2<double> position_{0, 0}, slope_{0, 0};                          // means
  double squares_ = 0, position_times_slope_ = 0, slope_squares_ = 0;  // about the means
};

/// The unweighted mean of the parabolas of several fields; nullopt if no field has a parabola.
PETZVAL_API std::optional<BlurParabola> mean(std::span<const std::optional<BlurParabola>> fields) noexcept;

/// Distance from the best film at which the RMS radius is three times its least value, at least the depth of focus
/// 4 lambda N^2. The RMS radius of a uniform cone grows by 1 / sqrt(8) / N.
PETZVAL_API double focus_range(const Lens& lens, const BlurParabola& blur) noexcept;

}  // namespace petzval::analysis_detail
