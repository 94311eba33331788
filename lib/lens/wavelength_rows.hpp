// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lens_view.hpp"

namespace petzval::lens_detail {

/// Rows of numbers in the layout of core_detail::look_up(): aligned to registers and padded with zeros to pairs of
/// registers.
template <class R>
class AlignedRows {
 public:
  AlignedRows() = default;
  AlignedRows(std::size_t rows, std::size_t numbers)
      : length_(kernel::row_length<R>(numbers)), registers_(rows * length_ / Register::size) {}

  /// Distance between the starts of two rows.
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

/// Number of cells between uniform wavelengths: with the entry of zeros, register permutations can read all cells.
inline constexpr std::int32_t permuted_cells = 15;

/// Numbers per wavelength, borrowed, for loops over rays of mixed wavelengths (lens/look_up.hpp). Each number has a row
/// over the compiled wavelengths, and parabolas over equal cells of the range in nm.
template <class R>
struct WavelengthRows {
  const R* by_position = nullptr;  ///< [number] rows, padded with zeros
  std::size_t length = 0;          ///< length of the rows by_position
  std::int32_t compiled = 0;
  std::int32_t cells = 0;
  const R* by_nm =
      nullptr;  ///< rows [number][power of the fraction in a cell], each with one number per cell and a zero
  std::size_t cell_length = 0;  ///< length of the rows by_nm
  R shortest = 1, longest = 0;  ///< the range, nm; empty if only compiled wavelengths are known
  R cells_per_nm = 0;
};

/// Finds the compiled wavelength nearest to a given one; borrowed. Starts at the position of the shortest wavelength
/// and adds a step for each midpoint between neighbours that the given wavelength exceeds.
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
