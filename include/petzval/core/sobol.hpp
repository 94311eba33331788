// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "petzval/core/export.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval {

/// Point `index` of the two-dimensional Sobol sequence, Owen-scrambled by a hash of `seed`: in [0, 1)^2, random access,
/// no state.
///
/// Any 2^k consecutive points that start at a multiple of 2^k are a (0, k, 2)-net: one of them in every box of 2^-i by
/// 2^(i-k). Sources: Sobol 1967 for the sequence; Owen 1995, "Randomly permuted (t,m,s)-nets and (t,s)-sequences", for
/// the scrambling; Laine and Karras 2011, "Stratified sampling for stochastic transparency", and Burley 2020,
/// "Practical hash-based Owen scrambling", for doing it by a hash in which no bit depends on a lower one.
PETZVAL_API Vec2<double> owen_sobol(std::uint32_t index, std::uint32_t seed) noexcept;

/// The points from `first` on, the same as one by one, faster. u, v: N each.
PETZVAL_API void owen_sobol(std::uint32_t first, std::uint32_t seed, std::span<double> u, std::span<double> v) noexcept;

}  // namespace petzval
