// SPDX-License-Identifier: Apache-2.0
// Uniform point sets other than the Owen-scrambled Sobol sequence of petzval/core/sobol.hpp, which is limited to two
// dimensions and to blocks of powers of two.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace petzval::core_detail {

/// Increment of the state of splitmix64; its random numbers are mixed(state) for successive states.
inline constexpr std::uint64_t splitmix_step = 0x9e3779b97f4a7c15u;

/// A hash in which every output bit depends on every input bit: the finaliser of splitmix64.
/// Source: Steele, Lea and Flood 2014, "Fast splittable pseudorandom number generators".
constexpr std::uint64_t mixed(std::uint64_t x) noexcept {
  x += splitmix_step;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// The powers 1 to N of 1 / g, where g^(N + 1) = g + 1.
template <std::size_t N>
constexpr std::array<double, N> kronecker_steps() noexcept {
  double g = 1.5;  // Newton's iteration
  for (int i = 0; i < 16; ++i) {
    double power = 1;
    for (std::size_t k = 0; k < N; ++k) power *= g;
    g -= (power * g - g - 1) / (static_cast<double>(N + 1) * power - 1);
  }
  std::array<double, N> steps{};
  double power = 1;
  for (double& step : steps) step = power /= g;
  return steps;
}

/// Kronecker sequence in the N-dimensional unit cube. Unlike with Sobol points, a run of any length is uniform from any
/// index on, and N is not limited to 2.
///
/// The steps are the powers of 1 / g, where g^(N + 1) = g + 1. Source: Roberts 2018, "The unreasonable effectiveness of
/// quasirandom sequences".
template <std::size_t N>
class Kronecker {
 public:
  /// Starts half a step from the origin.
  constexpr Kronecker() noexcept {
    for (std::size_t k = 0; k < N; ++k) shift_[k] = steps[k] / 2;
  }
  /// Starts at a point derived from the seed.
  explicit constexpr Kronecker(std::uint64_t seed) noexcept {
    for (std::size_t k = 0; k < N; ++k) shift_[k] = static_cast<double>(mixed(N * seed + k) >> 11) * 0x1p-53;
  }

  std::array<double, N> operator()(std::size_t index) const noexcept {
    std::array<double, N> point;
    for (std::size_t k = 0; k < N; ++k) {
      const double x = shift_[k] + static_cast<double>(index) * steps[k];
      point[k] = x - std::floor(x);
    }
    return point;
  }

 private:
  static constexpr std::array<double, N> steps = kronecker_steps<N>();
  std::array<double, N> shift_{};
};

/// Point `index` of a Fibonacci lattice of `count` points. With u as the angle and v as the squared radius on a disc,
/// it is a sunflower spiral. Every v occurs once, so that the rim of the disc is sampled more finely than by Sobol
/// points.
inline std::array<double, 2> fibonacci_point(std::size_t index, std::size_t count) noexcept {
  const double i = static_cast<double>(index);
  return {std::fmod(i * std::numbers::phi, 1.0), (i + 0.5) / static_cast<double>(count)};
}

}  // namespace petzval::core_detail
