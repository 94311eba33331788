// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>

namespace testing_bits {

/// FNV-1a over 64-bit words.
class Hash {
 public:
  void take(std::uint64_t word) noexcept { value_ = (value_ ^ word) * 0x100000001b3u; }
  void take(double number) noexcept { take(std::bit_cast<std::uint64_t>(number)); }
  void take(float number) noexcept { take(std::uint64_t{std::bit_cast<std::uint32_t>(number)}); }

  std::uint64_t value() const noexcept { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

}  // namespace testing_bits
