// SPDX-License-Identifier: Apache-2.0
#include "petzval/psf/sobol.hpp"

namespace petzval {
namespace {

/// The bits of x in the opposite order.
constexpr std::uint32_t reversed(std::uint32_t x) noexcept {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
  return (x >> 16) | (x << 16);
}

/// Coordinate 1 of the sequence with its first binary digit in the lowest bit; coordinate 0 in that order is the index
/// itself.
///
/// The generating matrix is Pascal's triangle modulo 2, and by Lucas's theorem binomial(k, j) is odd where the bits of
/// j are among those of k. Digit j is then the parity of the bits k of the index with j within k: a sum over supersets,
/// one bit of the bit numbers at a time.
constexpr std::uint32_t pascal(std::uint32_t x) noexcept {
  x ^= (x >> 1) & 0x55555555u;
  x ^= (x >> 2) & 0x33333333u;
  x ^= (x >> 4) & 0x0f0f0f0fu;
  x ^= (x >> 8) & 0x00ff00ffu;
  return x ^ (x >> 16);
}

/// A hash of all bits to all bits (the finaliser of splitmix64), for keys.
constexpr std::uint64_t mixed(std::uint64_t x) noexcept {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// Owen's scrambling of digits that start at the lowest bit: each bit is flipped or not by a hash of the bits below it.
///
/// Adding a key, multiplying by an odd number and x ^= x * (even number) change a bit by those below it and by the key
/// alone, and each can be undone. Three rounds under fresh keys let every bit reach all above.
constexpr std::uint32_t scrambled(std::uint32_t x, std::uint64_t key) noexcept {
  for (int round = 0; round < 3; ++round) {
    key = mixed(key);
    x += static_cast<std::uint32_t>(key);
    x ^= x * (static_cast<std::uint32_t>(key >> 32) & ~1u);
    x *= static_cast<std::uint32_t>(key >> 16) | 1u;
  }
  return x;
}

constexpr double unit(std::uint32_t digits) noexcept { return reversed(digits) * 0x1p-32; }

}  // namespace

std::array<double, 2> owen_sobol(std::uint32_t index, std::uint32_t seed) noexcept {
  const std::uint64_t key = std::uint64_t(seed) << 1;
  return {unit(scrambled(index, key)), unit(scrambled(pascal(index), key | 1))};
}

}  // namespace petzval
