// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "petzval/core/config.hpp"

namespace petzval::image_detail {

/// True if a file can hold this many numbers, with at most `most` numbers per byte. Call it before memory is allocated,
/// because damaged headers may state any size. Also true for up to 2^20 numbers, and for files without a size.
inline bool fits_in_file(std::uint64_t numbers, std::uint64_t most, const std::filesystem::path& file) {
  std::error_code without;
  const std::uintmax_t size = std::filesystem::file_size(file, without);
  return without || numbers <= (std::uint64_t{1} << 20) || (numbers - 1) / most < size;
}

}  // namespace petzval::image_detail
