// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/sobol.hpp"

#include "core/instruction_set.hpp"
#include "low_discrepancy.hpp"

namespace petzval {
namespace {

using core_detail::mixed;

/// The bits of x in reverse order. The swap of nibbles comes between the swaps of bytes and half words: compilers would
/// merge two adjacent swaps into a single instruction that baseline vectors lack.
constexpr std::uint32_t reversed(std::uint32_t x) noexcept {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  return (x >> 16) | (x << 16);
}

/// Coordinate 1 of the sequence, its first binary digit in the lowest bit. In this order coordinate 0 is the index.
///
/// The generating matrix is Pascal's triangle modulo 2, and by Lucas's theorem binomial(k, j) is odd if the bits of j
/// are a subset of the bits of k. Digit j is therefore the parity of all bits k of the index for which the bits of k
/// include the bits of j. This sum over supersets is computed one bit of the bit numbers at a time.
constexpr std::uint32_t pascal(std::uint32_t x) noexcept {
  x ^= (x >> 1) & 0x55555555u;
  x ^= (x >> 2) & 0x33333333u;
  x ^= (x >> 4) & 0x0f0f0f0fu;
  x ^= (x >> 8) & 0x00ff00ffu;
  return x ^ (x >> 16);
}

/// Owen scrambling of digits that start at the lowest bit: a hash of the lower bits decides if a bit is flipped.
///
/// Adding a key, multiplying by an odd number and x ^= x * (even number) change a bit depending only on the key and the
/// bits below it, and each step can be inverted. After three rounds with new keys every bit affects all bits above it.
class Scrambling {
 public:
  explicit constexpr Scrambling(std::uint64_t key) noexcept
      : first_(mixed(key)), second_(mixed(mixed(key))), third_(mixed(mixed(mixed(key)))) {}

  constexpr std::uint32_t operator()(std::uint32_t x) const noexcept { return third_(second_(first_(x))); }

 private:
  struct Round {
    std::uint32_t added, even, odd;

    explicit constexpr Round(std::uint64_t key) noexcept
        : added(static_cast<std::uint32_t>(key)),
          even(static_cast<std::uint32_t>(key >> 32) & ~1u),
          odd(static_cast<std::uint32_t>(key >> 16) | 1u) {}

    constexpr std::uint32_t operator()(std::uint32_t x) const noexcept {
      x += added;
      x ^= x * even;
      return x * odd;
    }
  };
  Round first_, second_, third_;
};

/// Converts reversed digits exactly to [0, 1), through a signed integer, which baseline vectors can convert.
constexpr double unit(std::uint32_t digits) noexcept {
  return static_cast<std::int32_t>(reversed(digits) ^ 0x80000000u) * 0x1p-32 + 0.5;
}

/// Plain loops that the compiler vectorises.
[[gnu::always_inline]] inline void fill(std::uint32_t first, std::uint32_t seed, std::span<double> u,
                                        std::span<double> v) noexcept {
  const std::uint64_t key = std::uint64_t(seed) << 1;
  const Scrambling of_u(key), of_v(key | 1);
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = unit(of_u(first + static_cast<std::uint32_t>(i)));
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = unit(of_v(pascal(first + static_cast<std::uint32_t>(i))));
}

#if defined(__x86_64__) && defined(__GNUC__)
// Baseline vectors have no instruction for the multiplication in the scrambling. All steps are exact: every instruction
// set gives the same points.
[[gnu::target("avx2")]] void fill_avx2(std::uint32_t first, std::uint32_t seed, std::span<double> u,
                                       std::span<double> v) noexcept {
  fill(first, seed, u, v);
}

[[gnu::target("avx512f")]] void fill_avx512(std::uint32_t first, std::uint32_t seed, std::span<double> u,
                                            std::span<double> v) noexcept {
  fill(first, seed, u, v);
}
#endif

}  // namespace

Vec2<double> owen_sobol(std::uint32_t index, std::uint32_t seed) noexcept {
  Vec2<double> point;
  fill(index, seed, std::span(&point.x, 1), std::span(&point.y, 1));
  return point;
}

void owen_sobol(std::uint32_t first, std::uint32_t seed, std::span<double> u, std::span<double> v) noexcept {
#if defined(__x86_64__) && defined(__GNUC__)
  const InstructionSet widest = instruction_sets().back();
  if (widest == InstructionSet::avx512) return fill_avx512(first, seed, u, v);
  if (widest == InstructionSet::avx2) return fill_avx2(first, seed, u, v);
#endif
  fill(first, seed, u, v);
}

}  // namespace petzval
