// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>

namespace petzval::testing {

/// Uniform points in the N-dimensional unit cube: steps of the powers of 1 / g, where g^(N + 1) = g + 1, from a point
/// that depends on the seed. Source: Roberts 2018, "The unreasonable effectiveness of quasirandom sequences".
template <std::size_t N>
class Kronecker {
 public:
  explicit Kronecker(std::uint64_t seed = 0) {
    double g = 1.5;
    for (int i = 0; i < 60; ++i) g = std::pow(1 + g, 1.0 / (N + 1));
    std::mt19937_64 random(seed);
    for (std::size_t k = 0; k < N; ++k) {
      steps_[k] = std::pow(g, -1.0 - static_cast<double>(k));
      shift_[k] = static_cast<double>(random() >> 11) * 0x1p-53;
    }
  }

  std::array<double, N> operator()(std::size_t index) const {
    std::array<double, N> point;
    for (std::size_t k = 0; k < N; ++k) point[k] = std::fmod(shift_[k] + static_cast<double>(index) * steps_[k], 1);
    return point;
  }

 private:
  std::array<double, N> steps_{}, shift_{};
};

/// Point `index` of `count` on a sunflower spiral, with u as the angle and v as the squared radius on a disc.
inline std::array<double, 2> fibonacci_point(std::size_t index, std::size_t count) {
  const double i = static_cast<double>(index);
  return {std::fmod(i * std::numbers::phi, 1.0), (i + 0.5) / static_cast<double>(count)};
}

}  // namespace petzval::testing
