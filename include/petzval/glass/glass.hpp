// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/core/export.hpp"

namespace petzval {

/// The formulas in which catalogues print n(lambda); l is the wavelength in micrometres.
enum class DispersionFormula {
  sellmeier,          ///< n^2 = 1 + c0 + sum B l^2 / (l^2 - C)
  sellmeier_squared,  ///< n^2 = 1 + c0 + sum B l^2 / (l^2 - C^2)
  polynomial,         ///< n^2 = c0 + sum c l^e
  cauchy,             ///< n   = c0 + sum c l^e
  buchdahl,           ///< n   = c0 + c1 w + c2 w^2, w = (l - 0.574) / (1 + 2.5 (l - 0.574))
  rational,           ///< n^2 = c0 + sum c l^e / (l^2 - p); triples c, e, p
  herzberger,         ///< n   = c0 + c1 L + c2 L^2 + c3 l^2 + c4 l^4 + c5 l^6, L = 1 / (l^2 - 0.028)
  tabulated,          ///< pairs l, n with l increasing; between them a monotone cubic of 1 / l^2
};

/// One glass of a catalogue: its dispersion formula and the range in which the formula was fitted.
struct Glass {
  std::string catalogue;  ///< "schott", "ohara", ...
  std::string name;       ///< "N-BK7"
  double nd = 1;          ///< index at 587.5618 nm, as the catalogue prints it
  double vd = 0;          ///< Abbe number
  DispersionFormula formula = DispersionFormula::cauchy;
  double shortest_nm = 0;
  double longest_nm = 0;
  std::vector<double> coefficients;  ///< in the order of the formula
};

/// The index of a glass relative to air. Throws Error that names the glass and its range for a wavelength outside the
/// range, and for a formula that gives no real index there.
PETZVAL_API double refractive_index(const Glass& glass, double wavelength_nm);

/// The index from n_d and the Abbe number: n = A + B / lambda^2, with n_d and n_F - n_C as stated. For media whose
/// glass is unknown. From 420 to 680 nm the error is at most 5e-4 for half of the glasses in data/glass, 5e-3 for 95 %
/// of them and 0.016 for the densest flints (table in tests/glass/dispersion_test.cpp). Valid from 365 to 1014 nm.
PETZVAL_API double abbe_index(double nd, double vd, double wavelength_nm);

/// The wavelength of a spectral line by its letter ("d", "F", "C", "e", "F'", ...), nm. Throws Error for an unknown
/// letter.
PETZVAL_API double spectral_line_nm(std::string_view symbol);

/// The glasses that a program knows. Immutable once loaded; threads may share it.
///
///     const auto glasses = petzval::GlassCatalogue::load(petzval::data_directory() / "glass");
///     double n = petzval::refractive_index(*glasses.find("N-BK7", "schott"), 486.1327);
class PETZVAL_API GlassCatalogue {
 public:
  GlassCatalogue() = default;
  explicit GlassCatalogue(std::vector<Glass> glasses);

  /// Reads every glass_*.csv of a folder, in the order of their names. Throws Error with file and line for an invalid
  /// one.
  static GlassCatalogue load(const std::filesystem::path& directory);

  /// The glass of that name in that catalogue, ignoring case; nullptr if there is none. The pointer is valid as long as
  /// the catalogue.
  const Glass* find(std::string_view name, std::string_view catalogue) const noexcept;

  /// The glass of that name with the nearest n_d, if it is within 0.01; nullptr otherwise. For media without a
  /// catalogue: F2 has n_d 1.62004 in one catalogue and 1.61293 in another. A glass that `with_glasses` added comes
  /// first where its n_d is within 0.002.
  const Glass* find(std::string_view name, double nd) const noexcept;

  /// The glass of that name, ignoring case; nullptr for an unknown name. Glasses of `with_glasses` come first, then
  /// catalogues of today, then "-legacy", then "-1983" ones; the first of equal rank is taken.
  ///
  /// @throws Error with a list if glasses of equal rank differ by more than 1e-4 in n_d, as F2 of schott and F2 of cdgm
  const Glass* find(std::string_view name) const;

  const std::vector<Glass>& glasses() const noexcept { return glasses_; }

 private:
  std::span<const Glass> added() const noexcept { return std::span(glasses_).first(added_count_); }
  std::span<const Glass> tables() const noexcept { return std::span(glasses_).subspan(added_count_); }

  std::vector<Glass> glasses_;  // added ones, then those of the tables; each sorted by name, then in their order
  std::size_t added_count_ = 0;

  friend PETZVAL_API GlassCatalogue with_glasses(const GlassCatalogue&, std::vector<Glass>);
};

/// The glass tables in data_directory(), loaded at the first call, once per process, then shared by all threads.
///
/// @throws Error if the tables are not found or invalid; the next call tries again
PETZVAL_API const GlassCatalogue& glass_tables();

/// The catalogue and more glasses, those of a user: they are found before glasses of the same name (of the same
/// catalogue, where one is asked for). What was added last is found first.
PETZVAL_API GlassCatalogue with_glasses(const GlassCatalogue& catalogue, std::vector<Glass> glasses);

/// The glasses most like an index and an Abbe number, the most like first: by the sum of the squares of the differences
/// over 0.001 in n_d and 0.5 in V_d, about what tells two glasses of a catalogue apart. Without vd, by n_d alone. They
/// are valid as long as the catalogue. Throws Error for a number that is not finite.
PETZVAL_API std::vector<const Glass*> nearest_glasses(const GlassCatalogue& catalogue, double nd,
                                                      std::optional<double> vd, std::size_t count);

/// The folder that holds lenses/ and glass/: share/petzval beside the library, in the installed tree or in the build
/// tree. No absolute path is baked in: the search starts where the code was loaded from. Throws Error where it finds
/// none; a program linked statically and moved elsewhere passes its own path instead.
PETZVAL_API std::filesystem::path data_directory();

}  // namespace petzval
