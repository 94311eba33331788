// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/core/config.hpp"

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

/// Writes a file atomically: readers see the old file or the complete new file.
///
/// The bytes go to a new file in the same folder, which is flushed to the disk and then replaces `file`; the mode is
/// kept. After a failure the old file is unchanged. If several processes write at once, the last wins. A process
/// that is killed may leave its new file, .petzval-PID-N. Links are followed; pipes and devices are written directly.
///
/// @throws Error with file and system's reason if the file cannot be written; if it is a folder; if its name contains a
///               zero byte
PETZVAL_API void write_file(std::string_view bytes, const std::filesystem::path& file);

/// Writes numbers as little-endian 32-bit floats with write_file().
PETZVAL_API void write_floats(std::span<const float> numbers, const std::filesystem::path& file);
/// Reads the numbers of write_floats(), with the same bits.
///
/// @throws Error if the file cannot be read, or if its size is not a multiple of 4 bytes
PETZVAL_API std::vector<float> read_floats(const std::filesystem::path& file);

/// The 64-bit FNV-1a hash (Fowler, Noll and Vo) as 16 hexadecimal digits. Detects changes, but is not cryptographic.
PETZVAL_API std::string checksum(std::string_view bytes);

}  // namespace petzval
