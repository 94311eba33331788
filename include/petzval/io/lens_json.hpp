// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "petzval/core/config.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval {

/// Reads a lens from a JSON file of the format "petzval-lens 1" (keys: data/README.md).
///
/// Surfaces without a clear aperture get the aperture of with_apertures(). read_lens() of petzval::formats reads this
/// and other formats.
///
/// @throws Error if the file cannot be read, or if parse_prescription() throws
PETZVAL_API Prescription read_prescription(const std::filesystem::path& file);

/// Reads a lens from JSON in memory. Missing clear apertures stay absent.
///
/// Time is proportional to the size of the text, which is at most 16 MiB; memory is at most 32 times its size.
///
/// @param json   the text
/// @param where  name of the source, for messages
/// @throws Error with source, line, column, surface (from 0), key, value and rule: for unknown and duplicate keys,
///               comments, NaN, numbers outside the range of double, brackets nested too deeply, lists of more than
///               10,000 entries, and lenses that validate() refuses
PETZVAL_API Prescription parse_prescription(std::string_view json, const std::string& where);

/// Formats a lens as JSON, with one surface per line.
///
/// Numbers are the shortest decimals that read back exactly. Reading and formatting the text again gives the same
/// bytes.
PETZVAL_API std::string format_prescription(const Prescription& prescription);

/// Writes the result of format_prescription() to a file.
///
/// @throws Error if write_file() throws
PETZVAL_API void write_prescription(const Prescription& prescription, const std::filesystem::path& file);

}  // namespace petzval
