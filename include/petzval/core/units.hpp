// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

#include "petzval/core/version.hpp"

namespace petzval {

/// Wavelength of the helium d line, the usual reference of printed indices (nm).
inline constexpr double d_line_nm = 587.5618;

constexpr double radians(double degrees) noexcept { return degrees * (std::numbers::pi / 180.0); }
constexpr double degrees(double radians) noexcept { return radians * (180.0 / std::numbers::pi); }

}  // namespace petzval
