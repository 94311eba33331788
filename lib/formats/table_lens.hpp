// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "import.hpp"

namespace petzval::formats_detail {

/// A surface as stated in a table, in mm.
struct TableRow {
  int line = 0;
  double radius = 0;                  ///< 0 for a plane
  std::optional<double> thickness{};  ///< nullopt if unknown
  std::optional<double> index{};      ///< 0 for air; for a plane also marks the stop
  std::optional<double> abbe{};
  std::string glass{}, catalogue{};  ///< empty if not named
  std::optional<double> aperture{};  ///< 0 if absent
  double conic = 0;
  std::vector<AsphereTerm> terms{};
  bool mirror = false;
  Section curved_in = Section::both;
  std::string stop{};      ///< the word that marks the stop; empty if not marked
  bool in_medium = false;  ///< stop in its own row: without an index, the medium in front continues
  std::string comment{};   ///< empty if absent
};

/// The meaning of the numbers in a column of apertures.
enum class TableApertures { semi_diameters, diameters, unknown };

/// The meaning of the column of distances.
enum class TableGaps { behind, in_front, unknown };

/// The rows of a table and their interpretation.
struct TableLens {
  std::vector<TableRow> rows;  ///< at least one
  TableApertures apertures = TableApertures::unknown;
  /// The meaning of unknown apertures if the file declares no f-number.
  TableApertures likely_apertures = TableApertures::diameters;
  TableGaps gaps = TableGaps::unknown;
};

/// The focal length (mm) and the f-number in a title or a comment: "100 mm", "100mm" and "f/2", "F1.35". nullopt if the
/// text has no such number.
std::optional<double> focal_length_in(std::string_view text);
std::optional<double> f_number_in(std::string_view text);

/// Builds surfaces from rows: media, the stop, the object and the film, apertures. import.lens has the declared focal
/// length and f-number. Each assumption becomes a warning.
/// @throws Error, with the line, if a row is not a surface
void build_table(TableLens table, Import& import);

}  // namespace petzval::formats_detail
