// SPDX-License-Identifier: Apache-2.0
// The vectors of the compiler, as wide as the registers of the instruction set that a file is compiled for. (Google
// Highway has its own, but that of Debian 12 has no SSE2 and no approximate square root of doubles.)
//
// Sources that are compiled for several instruction sets (petzval_lanes, petzval_loops in cmake/module.cmake) define
// all their names in unnamed namespaces, as here: the linker must never take a function of one set for that of another.
#pragma once

#include <cstdint>
#include <type_traits>

namespace petzval::core_detail {
namespace {

#if defined(__AVX512F__)
inline constexpr int lane_bytes = 64;
#elif defined(__AVX2__)
inline constexpr int lane_bytes = 32;
#else
inline constexpr int lane_bytes = 16;
#endif

/// The vectors of a register. Values: of R. Bits: what comparing two of them gives, an integer of all bits or none for
/// each lane. Bytes: one byte for each lane.
template <class R>
struct Native;
template <>
struct Native<float> {
  using Values = float __attribute__((vector_size(lane_bytes)));
  using Bit = std::int32_t;
  using Bits = Bit __attribute__((vector_size(lane_bytes)));
  using Bytes = std::uint8_t __attribute__((vector_size(lane_bytes / sizeof(float))));
};
template <>
struct Native<double> {
  using Values = double __attribute__((vector_size(lane_bytes)));
  using Bit = std::int64_t;
  using Bits = Bit __attribute__((vector_size(lane_bytes)));
  using Bytes = std::uint8_t __attribute__((vector_size(lane_bytes / sizeof(double))));
};

/// How many numbers of type R a register holds.
template <class R>
inline constexpr int lane_count = lane_bytes / static_cast<int>(sizeof(R));

/// For functions over vectors: a call would pass them through memory.
#define PETZVAL_INLINE inline __attribute__((always_inline))

/// a b + c d, where the first product alone may be fused with the sum. Compilers choose one of the two, not the same
/// one everywhere, and results would depend on the code that a ray meets.
template <class T>
PETZVAL_INLINE T sum_of_products(const T& a, const T& b, const T& c, const T& d) noexcept {
  T second = c * d;
#if defined(__x86_64__)
  if constexpr (std::is_floating_point_v<T> || std::is_same_v<T, Native<float>::Values> ||
                std::is_same_v<T, Native<double>::Values>) {
    asm("" : "+v"(second));
  }
#endif
  return a * b + second;
}

}  // namespace
}  // namespace petzval::core_detail
