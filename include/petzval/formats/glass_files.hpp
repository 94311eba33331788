// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/prescription/file_origin.hpp"

namespace petzval {

/// The glasses of a file, and what was assumed or left out.
struct GlassFile {
  std::vector<Glass> glasses;
  std::vector<ImportWarning> warnings;
};

/// Reads glasses from a file, whose content tells the format, whatever its name:
///
/// - a Zemax catalogue (.agf), as UTF-16, UTF-8 or Latin-1, with or without words before the first glass. The catalogue
///   is called as the file, in lower case without its ending. All thirteen dispersion formulas are read. Formula 4 is
///   printed in two forms: the form that gives the printed n_d is taken. Temperature, transmittance and mechanical data
///   are skipped with a warning.
/// - a page of refractiveindex.info (YAML): formulas 1, 2, 3, 4, 5 and 7, tables of n, and tables of n and k between
///   the wavelengths where k is at most 0.01. The glass is called as the file, its catalogue "rii".
/// - a table of this library (CSV, data/README.md).
///
/// Each glass keeps the n_d and V_d that the file prints; a warning names it where its formula differs by more than
/// 1e-4 in n_d or 0.2 in V_d. Glasses whose formula is unknown or gives no real index are left out with a warning.
///
///     const auto file = petzval::read_glasses("glasses/schott.agf");
///     const auto glasses = petzval::with_glasses(petzval::glass_tables(), file.glasses);
///
/// Throws Error with file and line for a file that cannot be read, is of another kind or ends too early, for a number
/// that is none or not finite, and where no glass is left. Warnings end after the first thousand.
PETZVAL_API GlassFile read_glasses(const std::filesystem::path& file);

}  // namespace petzval
