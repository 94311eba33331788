// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

/// Reads the parts of a figure.
namespace petzval::testing {

using Points = std::vector<std::pair<double, double>>;

/// A match of a regular expression: its position in the text, and its groups; group 0 is the whole match.
struct Match {
  std::size_t position = 0;
  std::vector<std::string> groups;

  const std::string& operator[](std::size_t group) const { return groups.at(group); }
  double number(std::size_t group) const { return std::stod(groups.at(group)); }
};

/// All matches of a regular expression, in the order of the text.
std::vector<Match> matches(const std::string& text, const std::string& expression);

/// Number of occurrences of a part in a text.
std::size_t count(const std::string& text, const std::string& part);

/// Centres of the numbered points in a figure of a scene, px, in order.
Points marks(const std::string& svg);

/// Checks that the markers of rays lie within the frames of their cells, above the text. Returns their number.
std::size_t expect_marks_within_cells(const std::string& svg);

/// The corners of each path whose attributes contain `style`, px.
std::vector<Points> paths(const std::string& svg, const std::string& style);

/// Pixels per millimetre, from the scale bar; 0 without one.
double scale(const std::string& svg);

}  // namespace petzval::testing
