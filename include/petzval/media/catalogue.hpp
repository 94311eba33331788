// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/media/dispersion.hpp"

namespace petzval::inline v0 {

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
  /// catalogue: F2 has n_d 1.62004 in one catalogue and 1.61293 in another.
  const Glass* find(std::string_view name, double nd) const noexcept;

  const std::vector<Glass>& glasses() const noexcept { return glasses_; }

 private:
  std::span<const Glass> named(std::string_view name) const noexcept;

  std::vector<Glass> glasses_;  // sorted by name, then in the order of loading
};

/// The folder that holds lenses/ and glass/: share/petzval beside the library, in the installed tree or in the build
/// tree. No absolute path is baked in: the search starts where the code was loaded from. Throws Error where it finds
/// none; a program linked statically and moved elsewhere passes its own path instead.
PETZVAL_API std::filesystem::path data_directory();

}  // namespace petzval::inline v0
