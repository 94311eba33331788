// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "glass_names.hpp"
#include "import_requests.hpp"
#include "petzval/formats/lens_file.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval::formats_detail {

/// A lens file of another program as data: prescription, requests, and warnings. Filled by a reader for complete().
class Import {
 public:
  /// @param where file name, for messages
  /// @param options a null catalogue means glass_tables(), loaded for the first glass
  Import(std::string where, std::string_view format, const ReadOptions& options);

  Prescription lens;  ///< `imported` is set
  ImportRequests requests;

  /// Adds a warning about an assumption or omitted data. After a thousand warnings, further warnings are only counted.
  void warn(int line, std::string_view command, const std::string& message);
  /// Throws Error: "file: line 7: CURV = found; must be wanted".
  [[noreturn]] void refuse(int line, std::string_view command, const std::string& found, const std::string& rule) const;
  /// Throws Error: "file:7: parameter = value; must be rule".
  [[noreturn]] void must_be(int line, std::string_view parameter, const std::string& value,
                            const std::string& rule) const;
  /// Throws Error if a file has more than 10,000 items.
  /// @param ends additional items allowed, for object and image surfaces
  void limit(std::size_t count, std::string_view what = "surfaces", std::size_t ends = 0) const;
  /// Keeps a note of the file: at most a thousand notes of up to 4,096 bytes each.
  void note(std::string_view text);
  /// Converts a word to a number.
  /// @throws Error if the word is not a finite number within double, or has a decimal comma
  double number(int line, std::string_view command, std::string_view word) const;

  /// Finds a medium by its name in a file: "N-BK7", "NBK7" (dashes and blanks are ignored), "BK7_SCHOTT".
  /// n_d and V_d come from the formula of the glass, and are absent if the formula does not reach the d, F and C lines.
  /// Warns if a glass of another catalogue or name is used.
  ///
  /// @param catalogues catalogues that the file names, in order of preference; may be empty
  /// @param nd, vd numbers after the name; used if no table has the name, or as `numbers` defines
  /// @throws Error, with similar names, if no table has the glass and the file states no index
  Medium glass(int line, std::string_view name, std::span<const std::string> catalogues, std::optional<double> nd,
               std::optional<double> vd, Numbers numbers = Numbers::stated);
  const GlassCatalogue& glasses();
  const std::string& where() const noexcept { return where_; }
  /// ReadOptions::entry.
  const std::string& entry() const noexcept { return entry_; }

  /// The glasses if a glass was looked up or the options name them; otherwise null, which stands for glass_tables().
  const GlassCatalogue* loaded_glasses() const noexcept { return glasses_; }
  /// Adds a warning with the number of warnings beyond a thousand.
  void count_left_out_warnings();

 private:
  const GlassNames& names();

  std::string where_, entry_;
  const GlassCatalogue* glasses_;
  std::optional<GlassNames> names_;  ///< names in glasses_; filled on the first look-up
  std::size_t left_out_ = 0;
};

/// The index of a glass; nullopt if the wavelength is outside its range.
std::optional<double> index_at(const Glass& glass, double nm);

/// The change of a surface in a configuration; added empty if absent.
SurfaceChange& change_of(Configuration& configuration, int surface);

/// Medium of a code of six or more digits, n_d - 1 and V_d without the point: "517642", "517.642", "620410.603236".
/// nullopt if the text is not a code.
std::optional<Medium> medium_of_code(std::string_view code);

}  // namespace petzval::formats_detail
