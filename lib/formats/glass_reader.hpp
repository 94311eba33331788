// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_set>

#include "petzval/formats/lens_file.hpp"

namespace petzval::formats_detail {

/// Collects the glasses of a file and checks each against the n_d and V_d printed in the file.
class GlassReader {
 public:
  /// @param where file name, for messages
  explicit GlassReader(std::string where) : where_(std::move(where)) {}

  /// Adds a warning. After a thousand warnings, further warnings are only counted.
  void warn(int line, std::string_view command, const std::string& message);
  /// Throws Error: "file: line 7: CD = "1,5"; must be a finite number".
  [[noreturn]] void refuse(int line, const std::string& found, const std::string& rule) const;
  /// Converts a word to a number.
  /// @param what name of the number, for the message
  /// @throws Error if the word is not a finite number
  double number(int line, std::string_view what, std::string_view word) const;

  /// Adds a glass, or leaves it out with a warning if its range is empty or its index is not real. If nd is 1 or less,
  /// which means that the file does not state it, n_d is computed.
  void add(Glass glass, int line);
  /// @throws Error if the file has no usable glass
  GlassFile finish();

 private:
  /// @param nm the d line, or the nearest end of the range
  void check_against_formula(Glass& glass, int line, double nm);

  std::string where_;
  GlassFile file_;
  std::unordered_set<std::string> names_;
  std::size_t warnings_left_out_ = 0;
};

/// Zemax catalogues.
/// @param catalogue catalogue name for the glasses
bool looks_like_agf(std::string_view text);
void read_agf(std::string_view text, const std::string& catalogue, GlassReader& reader);

/// Pages of refractiveindex.info.
/// @param name name for the glass
/// @throws Error if the library was built without yaml-cpp
void read_rii(std::string text, const std::string& name, GlassReader& reader);

}  // namespace petzval::formats_detail
