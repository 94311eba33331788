// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "petzval/core/version.hpp"

namespace petzval::image_detail {

/// Whether a file is long enough for so many numbers, if a byte of it holds `most` at most. Heads of damaged files
/// claim any size, and are asked before memory is taken for it. The first 2^20 numbers are always believed, and so is a
/// file without a size.
inline bool has_room_for(std::uint64_t numbers, std::uint64_t most, const std::filesystem::path& file) {
  std::error_code without;
  const std::uintmax_t size = std::filesystem::file_size(file, without);
  return without || numbers <= (std::uint64_t{1} << 20) || (numbers - 1) / most < size;
}

}  // namespace petzval::image_detail
