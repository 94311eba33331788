// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "petzval/core/config.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval {

/// A point of the two-dimensional Sobol sequence with Owen scrambling, in [0, 1)^2.
///
/// Access is random and needs no state. Any 2^k consecutive points from a multiple of 2^k on are a (0, k, 2)-net: every
/// box of 2^-i by 2^(i-k) contains exactly one point.
/// Sources: Sobol 1967 (sequence); Owen 1995, "Randomly permuted (t,m,s)-nets and (t,s)-sequences" (scrambling); Laine
/// and Karras 2011, "Stratified sampling for stochastic transparency", and Burley 2020, "Practical hash-based Owen
/// scrambling" (scrambling by a hash in which each bit depends on higher bits only).
///
/// @param index  index of the point
/// @param seed   seed of the scrambling
PETZVAL_API Vec2<double> owen_sobol(std::uint32_t index, std::uint32_t seed) noexcept;

/// The points `first`, `first` + 1, ... Equal to single calls, but faster.
///
/// @param first  index of the first point
/// @param seed   seed of the scrambling
/// @param u,v    receive the coordinates; N values each
PETZVAL_API void owen_sobol(std::uint32_t first, std::uint32_t seed, std::span<double> u, std::span<double> v) noexcept;

}  // namespace petzval
