// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "petzval/core/export.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval::inline v0 {

/// Reads a lens from the JSON of data/lenses (format "petzval-lens 1", keys in data/README.md). Throws Error that names
/// the file, the surface (from 0), the key, what was found and what was wanted, or the byte where the text is no JSON.
/// Refused are unknown and duplicate keys, comments, NaN, numbers beyond double, brackets nested deeper than a lens has
/// them, lists of more than 10,000 entries, and what `validate` refuses. Takes time in proportion to the file and up to
/// 4 times its memory (8 where it is one number of megabytes).
PETZVAL_API Prescription read_prescription(const std::filesystem::path& file);

/// The same from memory; `where` stands for the file's name in messages.
PETZVAL_API Prescription parse_prescription(std::string_view json, const std::string& where);

/// The JSON text of a lens: one surface a line, numbers as the shortest decimals that read back exactly. Writing what
/// was read from such a text gives the same bytes.
PETZVAL_API std::string format_prescription(const Prescription& prescription);

/// That text into a file, as a whole or not at all. Throws Error that names the file.
PETZVAL_API void write_prescription(const Prescription& prescription, const std::filesystem::path& file);

}  // namespace petzval::inline v0
