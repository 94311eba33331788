// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/core/export.hpp"

namespace petzval {

/// Writes a whole file or none: first to a new file in the same folder, flushed to the disk, which then replaces FILE
/// and keeps its mode. A failure keeps the old file and leaves no partial one; of several writers at once one wins. A
/// process that is killed may leave its new file, .petzval-PID-N. Links are followed. Pipes and devices are written to
/// directly. Throws Error that names the file and the system's reason; also for a folder, and for a name with a zero in
/// it.
PETZVAL_API void write_file(std::string_view bytes, const std::filesystem::path& file);

/// Writes numbers as they are, little-endian floats of 32 bits, as write_file() does: Camera::tables().
PETZVAL_API void write_floats(std::span<const float> numbers, const std::filesystem::path& file);
/// Reads them, bit for bit. Throws Error that names the file, also where its bytes are no whole number of floats.
PETZVAL_API std::vector<float> read_floats(const std::filesystem::path& file);

/// FNV-1a of 64 bits (Fowler, Noll and Vo) as 16 hexadecimal digits: tells whether bytes have changed, not who did it.
PETZVAL_API std::string checksum(std::string_view bytes);

}  // namespace petzval
