// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>

namespace petzval::testing {

/// Points spread evenly in a cube of N dimensions, each sequence with a random shift of its own (Kronecker's sequence;
/// its step by powers of the root of x^(N+1) = x + 1, as in Roberts 2018, "The unreasonable effectiveness of
/// quasirandom sequences").
template <std::size_t N>
class Kronecker {
 public:
  explicit Kronecker(std::uint64_t seed) {
    double root = 1.5;
    for (int i = 0; i < 64; ++i) root = std::pow(1 + root, 1.0 / (N + 1));
    std::mt19937_64 random(seed);
    for (std::size_t k = 0; k < N; ++k) {
      step_[k] = std::pow(root, -static_cast<double>(k + 1));
      shift_[k] = std::uniform_real_distribution<double>()(random);
    }
  }

  std::array<double, N> operator()(std::uint32_t i) const noexcept {
    std::array<double, N> x;
    for (std::size_t k = 0; k < N; ++k) x[k] = std::fmod(shift_[k] + (i + 1.0) * step_[k], 1.0);
    return x;
  }

 private:
  std::array<double, N> step_{}, shift_{};
};

}  // namespace petzval::testing
