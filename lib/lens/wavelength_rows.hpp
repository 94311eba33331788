// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lens_view.hpp"

namespace petzval::lens_detail {

/// Rows of numbers as core_detail::look_up() reads them: on registers of their own, with zeros to whole pairs.
template <class R>
class AlignedRows {
 public:
  AlignedRows() = default;
  AlignedRows(std::size_t rows, std::size_t numbers)
      : length_(kernel::row_length<R>(numbers)), registers_(rows * length_ / Register::size) {}

  /// From the beginning of a row to that of the next.
  std::size_t length() const noexcept { return length_; }
  const R* data() const noexcept { return registers_.empty() ? nullptr : registers_.front().numbers; }
  void set(std::size_t row, std::size_t at, double value) noexcept {
    const std::size_t o = row * length_ + at;
    registers_[o / Register::size].numbers[o % Register::size] = static_cast<R>(value);
  }

 private:
  struct alignas(64) Register {
    static constexpr std::size_t size = 64 / sizeof(R);
    R numbers[size] = {};
  };

  std::size_t length_ = 0;
  std::vector<Register> registers_;
};

/// The cells between even wavelengths: with the zero, permutations of registers reach them (core/look_up.hpp).
inline constexpr std::int32_t few_cells = 15;

/// Some numbers for each wavelength, borrowed, for loops over rays of mixed wavelengths (lens/look_up.hpp): of each
/// number a row by compiled wavelength, then, in nm, parabolas over even cells of the range.
template <class R>
struct WavelengthRows {
  const R* by_position = nullptr;  ///< [number]; zeros behind the compiled ones
  std::size_t length = 0;          ///< of these rows
  std::int32_t compiled = 0;
  std::int32_t cells = 0;
  const R* by_nm = nullptr;     ///< [number][power of the part of a cell] a number for each cell, and zero
  std::size_t cell_length = 0;  ///< of these rows
  R shortest = 1, longest = 0;  ///< the range, nm; empty where nothing is known between compiled wavelengths
  R cells_per_nm = 0;
};

/// The position of the compiled wavelength that is nearest to another one, borrowed: that of the smallest, and what is
/// added to it at each middle between neighbours that a wavelength exceeds.
struct NearestPosition {
  struct Step {
    float middle;  ///< nm
    std::int32_t added;
  };
  const Step* steps = nullptr;
  std::size_t count = 0;
  float shortest = 1, longest = 0;  ///< the range, nm
  std::int32_t first = 0;
};

}  // namespace petzval::lens_detail
