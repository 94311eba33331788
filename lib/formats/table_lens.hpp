// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "import.hpp"

namespace petzval::formats_detail {

/// A surface as a table prints it, in mm.
struct TableRow {
  int line = 0;
  double radius = 0;                  ///< 0: a plane
  std::optional<double> thickness{};  ///< absent: unknown
  std::optional<double> index{};      ///< 0: air, and the stop if the surface is a plane
  std::optional<double> abbe{};
  std::string glass{}, catalogue{};  ///< empty: none is named
  std::optional<double> aperture{};  ///< 0: none
  double conic = 0;
  std::vector<AsphereTerm> terms{};
  bool mirror = false;
  Section curved_in = Section::both;
  std::string stop{};      ///< the word that marks the stop; empty if the row is not marked
  bool in_medium = false;  ///< a stop in a row of its own: without an index, the medium in front of it goes on
  std::string comment{};   ///< empty if there is none
};

/// The meaning of the numbers in a column of apertures.
enum class TableApertures { semi_diameters, diameters, unknown };

/// The meaning of the column of distances.
enum class TableGaps { behind, in_front, unknown };

/// The rows of a table, and how they are to be understood.
struct TableLens {
  std::vector<TableRow> rows;  ///< at least one
  TableApertures apertures = TableApertures::unknown;
  /// The meaning of unknown apertures if the file declares no f-number.
  TableApertures likely_apertures = TableApertures::diameters;
  TableGaps gaps = TableGaps::unknown;
};

/// The focal length in mm and the f-number that a title, a comment or a file name states: "100 mm", "100mm", ".100mm."
/// and "f/2", "F1.35". nullopt if the text has no such number.
std::optional<double> focal_length_in(std::string_view text);
std::optional<double> f_number_in(std::string_view text);

/// Makes surfaces of rows: media, the stop, the object and the film, apertures. import.lens has the declared focal
/// length and f-number. Each assumption becomes a warning. Throws Error with the line of a row that is no surface.
void build_table(TableLens table, Import& import);

}  // namespace petzval::formats_detail
