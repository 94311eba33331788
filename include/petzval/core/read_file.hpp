// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "petzval/core/export.hpp"

namespace petzval {

/// The largest files that the readers of this library take into memory: lenses, glasses, polynomials, camera tables and
/// tables of colour. Some formats have narrower limits. Pictures are limited by their pixels.
inline constexpr std::size_t largest_file_bytes = std::size_t{256} << 20;

/// Reads a whole file.
///
/// @param file  the file; pipes and devices are read to their end
/// @param kind  the kind of file, for messages: "a lens file"
/// @param most  the largest size, bytes
/// @return      its bytes as they are
/// @throws Error that names the file and the system's reason if it cannot be opened or read or is a folder, and the
/// size
///               and its limit if it is larger: after at most `most` bytes of an endless file, at once if the size is
///               known
PETZVAL_API std::string read_file(const std::filesystem::path& file, const std::string& kind = "a file",
                                  std::size_t most = largest_file_bytes);

}  // namespace petzval
