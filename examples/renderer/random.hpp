// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace renderer {

/// Hashes a number: every bit of the result depends on all bits of the argument.
/// Source: Steele, Lea, Flood, Fast splittable pseudorandom number generators, 2014 (the finalizer of SplitMix64).
constexpr std::uint64_t mixed(std::uint64_t x) noexcept {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// The random numbers of one path. They depend only on its keys, so that pictures do not depend on threads.
class Random {
 public:
  constexpr Random(std::uint64_t seed, std::uint64_t pixel, std::uint64_t sample) noexcept
      : state_(mixed(mixed(mixed(seed + step) + pixel + step) + sample + step)) {}

  /// The next number, uniform in [0, 1).
  float operator()() noexcept { return static_cast<float>(mixed(state_ += step) >> 40) * 0x1p-24f; }

 private:
  static constexpr std::uint64_t step = 0x9e3779b97f4a7c15u;
  std::uint64_t state_;
};

}  // namespace renderer
