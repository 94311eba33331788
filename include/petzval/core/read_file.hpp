// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "petzval/core/export.hpp"

namespace petzval {

/// The largest size of a file of lenses, glasses, polynomials, camera tables or colour tables (bytes).
///
/// Some formats have narrower limits. Images are limited by their number of pixels.
inline constexpr std::size_t largest_file_bytes = std::size_t{256} << 20;

/// Reads a whole file.
///
/// @param file  the file; pipes and devices are read to their end
/// @param kind  the kind of file, for messages: "a lens file"
/// @param most  the largest size (bytes)
/// @return      the bytes of the file, unchanged
/// @throws Error if the file is a folder or cannot be opened or read, with the system's reason; if it is larger than
///               `most`, at once if the system knows its size, else after reading at most `most` bytes
PETZVAL_API std::string read_file(const std::filesystem::path& file, const std::string& kind = "a file",
                                  std::size_t most = largest_file_bytes);

}  // namespace petzval
