// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "petzval/glass/glass.hpp"

namespace petzval::formats_detail {

/// Meaning of the n_d and V_d that a file states after the name of a glass.
enum class Numbers {
  stated,    ///< select among glasses of one name, and replace n_d and V_d of the glass if different
  leftovers  ///< only the name counts
};

/// Text for messages: "F2 (schott, n_d 1.62004, V_d 36.37)".
std::string describe(const Glass& glass);

/// True if a list names the maker of a glass: "SCHOTT" covers schott, schott-legacy, schott-1983.
bool is_listed(std::span<const std::string> catalogues, const Glass& glass);

/// Looks up glasses by the names in files of other programs: dashes, blanks and case are ignored.
class GlassNames {
 public:
  /// The glasses must outlive the object.
  explicit GlassNames(const GlassCatalogue& glasses);

  /// Finds the glass for a name in a file.
  ///
  /// @param catalogues catalogues that the file names, in order of preference; newer catalogues of a maker come first
  /// @param nd n_d after the name; if `numbers` are leftovers, used only between catalogues outside `catalogues`
  /// @return the glass; null if no table has the name
  const Glass* find(std::string_view name, std::span<const std::string> catalogues, std::optional<double> nd,
                    Numbers numbers) const;

  /// Text for messages: other glasses named like `found`, in catalogues that are equally new, whose n_d differs by more
  /// than 1e-4. Empty if the file names the catalogue or states the n_d of `found`.
  std::string others(const Glass& found, std::span<const std::string> catalogues, std::optional<double> nd) const;

 private:
  std::multimap<std::string, const Glass*> by_name_;  ///< by bare name, in catalogue order
};

}  // namespace petzval::formats_detail
