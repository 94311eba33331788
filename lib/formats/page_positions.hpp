// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "import.hpp"
#include "page_text.hpp"
#include "positions.hpp"

namespace petzval::formats_detail {

/// The data of a printed page on its positions: "f = 50.0 FNO = 1.8 2w = 46.8", "Focal length 24.7 35.0 67.9",
/// "d5 2.10 11.4 24.6", or a row per position below the names. One value, or one per position.
class PagePositions {
 public:
  /// @param gaps names of the thicknesses that vary: "d5"
  PagePositions(std::set<std::string> gaps, Import& in) : gaps_(std::move(gaps)), in_(in) {}

  /// Takes a line with names and values, with names of positions, or with names of columns; false for other lines.
  bool take(const PageLine& line);
  /// Takes distances that a row of the table states for each position: "r5 = -87.4 d5 = 1.9, 48.7".
  void take_gaps(const PageLine& line);
  /// Moves the values into the rows of Positions.
  void apply(Positions& positions);

 private:
  struct Values {
    int line = 0;
    std::string name;  ///< as printed
    std::vector<std::string> numbers;
  };

  std::optional<std::string> quantity(std::string_view name) const;
  bool take_names(const PageLine& line);
  bool take_columns(const PageLine& line);
  bool take_row(const PageLine& line);
  std::vector<Values*> gap_rows();
  void repeat_blocks(std::size_t& count);
  void put(const std::string& quantity, Values values);
  void scale(Positions& positions, const char* from, const char* to, double factor);

  std::set<std::string> gaps_;
  Import& in_;
  std::map<std::string, Values> values_;
  std::vector<std::string> names_, columns_;
  bool focal_lengths_follow_ = false;
};

}  // namespace petzval::formats_detail
