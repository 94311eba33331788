// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

namespace petzval::testing {

/// One published number, or several of one ray or surface, and the numbers that petzval computes.
struct Comparison {
  std::string quantity;
  std::string published;        ///< numbers as printed in the source, separated by blanks
  std::vector<double> petzval;  ///< one value for each published number
  double tolerance = 0.51;      ///< largest difference, in units of the last printed digit of each number
  std::string reason{};         ///< reason of a tolerance above one unit
};

/// The comparisons with one source.
struct ComparisonTable {
  std::string title;
  std::string source;
  std::vector<Comparison> rows;
};

/// A table by its name, a word that names the test. compute() calls the library.
struct NamedTable {
  const char* name;
  ComparisonTable (*compute)();
};

/// The list of all tables.
std::span<const NamedTable> comparison_tables();

/// The numbers of petzval with as many decimals as the published numbers.
std::string rounded(const Comparison& row);

/// The largest difference of a row in units of the last printed digit; infinite if a number is missing.
double largest_units(const Comparison& row);

/// A table as Markdown: heading, source, and rows of quantity, published number, number of petzval, and difference.
std::string markdown(const ComparisonTable& table);

}  // namespace petzval::testing
