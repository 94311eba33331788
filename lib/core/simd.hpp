// SPDX-License-Identifier: Apache-2.0
// Compiler vectors as wide as the registers of the instruction set for which a file is compiled. (Google Highway as
// packaged by Debian 12 has no SSE2 target and no approximate square root of doubles.)
//
// Sources that are compiled for several instruction sets (petzval_lanes, petzval_loops in cmake/module.cmake) define
// all names in unnamed namespaces, as here: the linker must never mix functions of two sets.
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

/// Vector types of one register. Values: numbers of type R. Bits: the result of comparing two Values, an integer with
/// all bits set or clear per lane. Bytes: one byte per lane.
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

/// Number of values of type R in a register.
template <class R>
inline constexpr int lane_count = lane_bytes / static_cast<int>(sizeof(R));

/// For functions with vector arguments, which a call would pass through memory.
#define PETZVAL_INLINE inline __attribute__((always_inline))

/// a b + c d, in which only the first product may be fused with the sum. A compiler may fuse either product and choose
/// differently in each place; results would then depend on the code path of a ray.
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
