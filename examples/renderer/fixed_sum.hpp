// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

namespace renderer {

/// A sum in multiples of 2^-64, up to 2^63. Its bits do not depend on the order of additions.
class FixedSum {
 public:
  constexpr FixedSum() noexcept = default;
  /// A finite number with an absolute value below 2^62, rounded towards zero to a multiple of 2^-64.
  explicit FixedSum(double x) noexcept {
    const double size = std::abs(x), whole = std::floor(size);
    high_ = static_cast<std::int64_t>(whole);
    low_ = static_cast<std::uint64_t>((size - whole) * 0x1p64);  // below 2^64: the difference is exact
    if (x < 0) *this = FixedSum() -= *this;
  }

  FixedSum& operator+=(const FixedSum& other) noexcept {
    low_ += other.low_;
    high_ += other.high_ + (low_ < other.low_ ? 1 : 0);
    return *this;
  }
  FixedSum& operator-=(const FixedSum& other) noexcept {
    high_ -= other.high_ + (low_ < other.low_ ? 1 : 0);
    low_ -= other.low_;
    return *this;
  }
  friend bool operator==(const FixedSum&, const FixedSum&) = default;

  /// The sum as a double, within one unit in the last place of the nearest double. Small negative numbers keep their
  /// digits.
  double value() const noexcept {
    if (high_ >= 0) return static_cast<double>(high_) + static_cast<double>(low_) * 0x1p-64;
    FixedSum opposite;
    opposite -= *this;
    return -opposite.value();
  }

 private:
  std::int64_t high_ = 0;
  std::uint64_t low_ = 0;
};

}  // namespace renderer
