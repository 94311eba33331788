// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace petzval::fuzz {

/// Numbers made of the bytes of a fuzzer; zeros after the last byte. A number uses few bytes, because an inserted byte
/// changes all further numbers. The evaluation order of arguments is unspecified, so that at most one argument of a
/// call may take bytes; in braces the order is fixed.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) noexcept : left_(data, size) {}

  bool empty() const noexcept { return left_.empty(); }

  std::uint8_t byte() noexcept {
    if (left_.empty()) return 0;
    const std::uint8_t first = left_.front();
    left_ = left_.subspan(1);
    return first;
  }
  /// An integer from least to most, both included, of at most 256 values.
  int count(int least, int most) noexcept { return least + byte() % (most - least + 1); }
  bool one_in(int n) noexcept { return byte() % n == n - 1; }

  /// A number from least to most in 2^16 steps.
  double between(double least, double most) noexcept {
    const int high = byte(), low = byte();
    return least + (most - least) * (high * 256 + low) / 65535;
  }
  /// Any double: a known hard number, a power of ten, or eight raw bytes.
  double wild() noexcept {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    constexpr std::array hard{
        0.0,    -0.0,   1.0,    -1.0,  infinity, -infinity, std::numeric_limits<double>::quiet_NaN(),
        5e-324, 1e-310, 1e-160, 1e160, 1.7e308,  -1.7e308,  1 + 1e-15,
        1e-12,  1e10,   0.5};
    const int kind = byte();
    if (kind < 128) return hard[static_cast<std::size_t>(kind) % hard.size()];
    if (kind < 224) {
      const double power = std::pow(10.0, count(-30, 30));
      return power * between(-1, 1);
    }
    std::uint64_t bits = 0;
    for (int i = 0; i < 8; ++i) bits = bits << 8 | byte();
    return std::bit_cast<double>(bits);
  }
  /// A number from least to most; every sixteenth is any double.
  double number(double least, double most) noexcept { return byte() < 16 ? wild() : between(least, most); }

 private:
  std::span<const std::uint8_t> left_;
};

}  // namespace petzval::fuzz
