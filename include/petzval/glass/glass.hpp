// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/core/config.hpp"

namespace petzval {

/// Dispersion formulas of catalogues: n as a function of the wavelength l in micrometres.
enum class DispersionFormula {
  sellmeier,          ///< n^2 = 1 + c0 + sum B l^2 / (l^2 - C)
  sellmeier_squared,  ///< n^2 = 1 + c0 + sum B l^2 / (l^2 - C^2)
  polynomial,         ///< n^2 = c0 + sum c l^e
  cauchy,             ///< n   = c0 + sum c l^e
  buchdahl,           ///< n   = c0 + c1 w + c2 w^2, w = (l - 0.574) / (1 + 2.5 (l - 0.574))
  rational,           ///< n^2 = c0 + sum c l^e / (l^2 - p); triples c, e, p
  herzberger,         ///< n   = c0 + c1 L + c2 L^2 + c3 l^2 + c4 l^4 + c5 l^6, L = 1 / (l^2 - 0.028)
  tabulated,          ///< pairs l, n with l increasing; interpolated by monotone cubics in 1 / l^2
};

/// The absorption of a glass at one wavelength.
struct AbsorptionEntry {
  double wavelength_nm = 0;
  double per_mm = 0;  ///< the internal transmittance of L mm is exp(-per_mm L)

  bool operator==(const AbsorptionEntry&) const = default;
};

/// One glass of a catalogue: its dispersion formula and the wavelength range of the formula.
struct Glass {
  std::string catalogue;  ///< "schott", "ohara", ...
  std::string name;       ///< "N-BK7"
  double nd = 1;          ///< index at 587.5618 nm, as printed in the catalogue
  double vd = 0;          ///< Abbe number, as printed in the catalogue
  DispersionFormula formula = DispersionFormula::cauchy;
  double shortest_nm = 0;
  double longest_nm = 0;
  std::vector<double> coefficients;  ///< in the order of the formula, for l in micrometres
  /// Wavelengths increase; empty if unknown. The tables of data/glass have no absorption, read_glasses() reads it.
  std::vector<AbsorptionEntry> absorption{};
};

/// The refractive index of a glass relative to air.
///
/// @throws Error if the wavelength is outside the range of the glass, or if its formula gives no real index
PETZVAL_API double refractive_index(const Glass& glass, double wavelength_nm);

/// The absorption coefficient of a glass (1/mm): the internal transmittance of L mm is exp(-absorption L).
///
/// The coefficient is linear between the entries of the table, and constant before the first and behind the last entry.
///
/// @return       nullopt if the glass has no table of absorption
/// @throws Error unless the wavelength is finite and positive
PETZVAL_API std::optional<double> absorption(const Glass& glass, double wavelength_nm);

/// The index of an unknown glass from n_d and V_d: n = A + B / lambda^2 with the given n_d and n_F - n_C.
///
/// @throws Error if the wavelength is outside 365 to 1014 nm, or unless n_d and V_d are finite and positive
///
/// Accuracy: from 420 to 680 nm the error is at most 5e-4 for half of the glasses in data/glass, 5e-3 for 95 % of the
/// glasses and 0.016 for the densest flints (table in tests/glass/dispersion_test.cpp).
PETZVAL_API double abbe_index(double nd, double vd, double wavelength_nm);

/// The wavelength of a spectral line (nm), by its letter: "d", "F", "C", "e", "F'", ...
///
/// @throws Error if the letter is unknown
PETZVAL_API double spectral_line_nm(std::string_view symbol);

/// A set of glasses from catalogues and from the user. Immutable and thread-safe.
///
///     const auto glasses = petzval::GlassCatalogue::load(petzval::data_directory() / "glass");
///     double n = petzval::refractive_index(*glasses.find("N-BK7", "schott"), 486.1327);
class PETZVAL_API GlassCatalogue {
 public:
  GlassCatalogue() = default;
  explicit GlassCatalogue(std::vector<Glass> glasses);

  /// Reads all files glass_*.csv of a folder, in alphabetical order.
  ///
  /// @throws Error with file and line if a table is invalid; if the folder cannot be read or has no such file
  static GlassCatalogue load(const std::filesystem::path& directory);

  /// The glass with a name in a catalogue, ignoring case; nullptr if it does not exist.
  ///
  /// Pointers to glasses are valid during the life of this object.
  const Glass* find(std::string_view name, std::string_view catalogue) const noexcept;

  /// The glass with a name and the nearest n_d; nullptr if no n_d is within 0.01.
  ///
  /// For media without a catalogue: F2 has n_d 1.62004 in one catalogue and 1.61293 in another. A glass added by
  /// with_glasses() takes precedence if its n_d is within 0.002.
  const Glass* find(std::string_view name, double nd) const noexcept;

  /// The glass with a name, ignoring case; nullptr if the name is unknown.
  ///
  /// Glasses added by with_glasses() rank first, then current catalogues, then "-legacy" and "-1983" catalogues. The
  /// first glass of the best rank is taken.
  ///
  /// @throws Error with a list if glasses of this rank differ by more than 1e-4 in n_d, as F2 of schott and F2 of cdgm
  const Glass* find(std::string_view name) const;

  const std::vector<Glass>& glasses() const noexcept { return glasses_; }

 private:
  std::span<const Glass> added() const noexcept { return std::span(glasses_).first(added_count_); }
  std::span<const Glass> tables() const noexcept { return std::span(glasses_).subspan(added_count_); }

  std::vector<Glass> glasses_;  // added glasses, then tables; both sorted by name, equal names in their order
  std::size_t added_count_ = 0;

  friend PETZVAL_API GlassCatalogue with_glasses(const GlassCatalogue&, std::vector<Glass>);
};

/// The glass tables in data_directory(), loaded by the first call and shared by all threads.
///
/// @throws Error if the tables are missing or invalid; the next call tries again
PETZVAL_API const GlassCatalogue& glass_tables();

/// A catalogue with additional glasses of the user.
///
/// Added glasses take precedence over glasses of the same name; later additions take precedence over earlier additions.
PETZVAL_API GlassCatalogue with_glasses(const GlassCatalogue& catalogue, std::vector<Glass> glasses);

/// The glasses nearest to an index and an Abbe number, nearest first.
///
/// The distance is hypot(dn_d / 0.001, dV_d / 0.5); these units are about the difference between two glasses of a
/// catalogue. Pointers are valid during the life of `catalogue`.
///
/// @param catalogue  the glasses to search
/// @param nd         index at the d line
/// @param vd         Abbe number; nullopt: compare n_d only
/// @param count      largest number of results
/// @throws Error if `nd` or `vd` is not finite
PETZVAL_API std::vector<const Glass*> nearest_glasses(const GlassCatalogue& catalogue, double nd,
                                                      std::optional<double> vd, std::size_t count);

/// The folder share/petzval with lenses/ and glass/, in the installed tree or in the build tree.
///
/// The search starts at the file from which the code was loaded, so that an installed tree can be moved. If a
/// statically linked program is moved without its data, it must pass its own path to the functions that read data.
///
/// @throws Error if the folder is not found
PETZVAL_API std::filesystem::path data_directory();

}  // namespace petzval
