// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "import.hpp"

namespace petzval::formats_detail {

/// A row of a table of positions: one value per position.
struct Variable {
  int line = 0;
  std::vector<std::string> values;
  bool used = false;
};

/// A length as a number or as a row of the table of positions; unknown if both are absent.
struct Length {
  std::optional<double> number;
  Variable* variable = nullptr;
};

/// The positions of a lens whose distances vary with zoom and focus, as a table with a column per position.
class Positions {
 public:
  /// The lengths of a surface, in mm.
  struct Row {
    int line = 0;
    Length thickness, diameter;
  };

  explicit Positions(Import& in) : in_(in) {}

  /// By name. Rows of no surface state a property of each position: "Focal Length", "F-Number", "Angle of View" (whole
  /// angle, degrees), "Image Height" (diagonal), "Magnification", "NA", "Aperture Diameter", "d0" (subject distance).
  std::map<std::string, Variable, std::less<>> variables;
  std::vector<Row> rows;                     ///< one per surface of the lens
  std::map<std::string, std::string> names;  ///< names of columns, by their number from 0

  /// Sets the surfaces and the declared data to the first position, and makes a configuration of each position.
  /// Requests the positions of the film that the table does not state.
  /// @throws Error if a distance has no value in any column
  void apply();

 private:
  void name_variables();
  std::optional<double> value(const Variable& variable, std::size_t column) const;
  std::optional<double> value(std::string_view name, std::size_t column) const;
  std::optional<double> value(const Length& length, std::size_t column) const;
  bool is_defined(std::size_t column) const;
  std::vector<std::size_t> defined_columns();
  void place(std::size_t column);
  void declare(std::size_t column);
  Configuration configuration(std::size_t column, std::size_t base);
  void configure(const std::vector<std::size_t>& columns);
  void place_film(const std::vector<std::size_t>& columns);

  Import& in_;
};

}  // namespace petzval::formats_detail
