// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_set>

#include "petzval/formats/glass_files.hpp"

namespace petzval::formats_detail {

/// The glasses of a file on their way: each is checked against what the file prints of it.
class GlassReader {
 public:
  /// where: the file's name, for messages.
  explicit GlassReader(std::string where) : where_(std::move(where)) {}

  /// After a thousand only their number is kept.
  void warn(int line, std::string_view command, const std::string& message);
  /// Throws Error: "file: line 7: CD is "1,5", wanted a finite number".
  [[noreturn]] void refuse(int line, const std::string& found, const std::string& wanted) const;
  /// The word as a number; refuses what is none, or not finite. what: its name, for the message.
  double number(int line, std::string_view what, std::string_view word) const;

  /// Adds a glass, or leaves it out with a warning where its range or its index is none. nd of 1 or less means that the
  /// file prints none: it is computed.
  void add(Glass glass, int line);
  /// Refuses a file without a glass.
  GlassFile finish();

 private:
  /// nm: the d line, or the end of the range next to it.
  void check_against_formula(Glass& glass, int line, double nm);

  std::string where_;
  GlassFile file_;
  std::unordered_set<std::string> names_;
  std::size_t warnings_left_out_ = 0;
};

/// Zemax catalogues. catalogue: the name that its glasses get.
bool looks_like_agf(std::string_view text);
void read_agf(std::string_view text, const std::string& catalogue, GlassReader& reader);

/// Pages of refractiveindex.info. name: of the glass. Throws Error if the library was built without yaml-cpp.
void read_rii(std::string text, const std::string& name, GlassReader& reader);

}  // namespace petzval::formats_detail
