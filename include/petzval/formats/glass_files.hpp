// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/prescription/file_origin.hpp"

namespace petzval {

/// The glasses of a file, with warnings about assumptions and omissions.
struct GlassFile {
  std::vector<Glass> glasses;
  std::vector<ImportWarning> warnings;
};

/// Reads glasses from a file. The content of the file determines its format:
///
/// - a Zemax catalogue (.agf), in UTF-16, UTF-8 or Latin-1, with or without text before the first glass. The name of
///   the catalogue is the file name in lower case, without its extension. All thirteen dispersion formulas are
///   supported. Formula 4 exists in two forms; the form that gives the printed n_d is used. Data on temperature,
///   transmittance and mechanics are skipped with a warning.
/// - a page of refractiveindex.info (YAML): formulas 1, 2, 3, 4, 5 and 7, tables of n, and tables of n and k at
///   wavelengths with k up to 0.01. The name of the glass is the file name, its catalogue "rii".
/// - a table of this library (CSV, data/README.md).
///
/// Each glass keeps the printed n_d and V_d. A warning names each glass with a formula that differs from these by more
/// than 1e-4 in n_d or 0.2 in V_d. A glass is left out with a warning if its formula is unknown or gives no real index.
/// At most 1,000 warnings are recorded.
///
///     const auto file = petzval::read_glasses("glasses/schott.agf");
///     const auto glasses = petzval::with_glasses(petzval::glass_tables(), file.glasses);
///
/// @throws Error with file and line if the file cannot be read, has another format or is incomplete; for a number that
///               is invalid or not finite; if no glass is left
PETZVAL_API GlassFile read_glasses(const std::filesystem::path& file);

}  // namespace petzval
