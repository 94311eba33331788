// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/core/units.hpp"
#include "petzval/prescription/configuration.hpp"
#include "petzval/prescription/design_data.hpp"
#include "petzval/prescription/file_origin.hpp"
#include "petzval/prescription/surface_row.hpp"

namespace petzval {

/// A lens as its source prints it: plain data that a program may edit. `compile` makes a Lens of it.
///
///     petzval::Prescription singlet;
///     singlet.name = "singlet";
///     singlet.surfaces = {{.radius = 50, .thickness = 5, .medium = {.nd = 1.5168}, .semi_diameter = 12, .stop = true},
///                         {.radius = -50, .thickness = 48, .semi_diameter = 12}};
///     petzval::Lens lens = petzval::compile(singlet);
///
/// Strings hold what the file says; nothing is computed from them.
struct Prescription {
  std::string id{};
  std::string name{};
  std::string source_design{};
  std::string source_numbers{};
  std::optional<double> focal_length_mm{};  ///< nominal, as printed
  std::optional<double> f_number{};
  std::optional<double> half_field_deg{};
  std::optional<double> image_diagonal_mm{};
  double reference_wavelength_nm = d_line_nm;   ///< of the printed nd
  std::optional<std::string> semi_diameters{};  ///< origin of the diameters
  std::optional<std::string> stop_size{};
  std::optional<std::string> image_distance{};
  std::optional<std::string> glass_names{};
  std::optional<std::string> notes{};
  std::vector<std::string> aliases{};
  std::optional<FileOrigin> imported{};  ///< absent: a lens of this library
  DesignData design{};
  Medium object_space{};               ///< before the first surface; air unless a lens was reversed
  std::vector<SurfaceRow> surfaces{};  ///< from the object side to the film
  /// Positions of moving groups: zoom positions in their order, and those that focus them. `configured` applies one.
  std::vector<Configuration> configurations{};

  bool operator==(const Prescription&) const = default;
};

/// Throws Error for a number that is not finite, |radius| below 1e-12 mm (0 is a plane), |thickness| of 1e10 mm or more
/// (an object at infinity is not a surface), an index outside 0.1 to 5, a central obscuration not smaller than its
/// surface, an asphere order outside 2 to 40 or given twice, a term whose slope reaches 1 within 1e-12 mm, a conic
/// with radius / sqrt|1 + conic| below 1e-15 mm, a mirror whose medium differs from the one in front of it, no
/// surface, or more than 10,000; and for configurations of the same name or without one, more than 1,000 of them, a
/// change of a surface that the lens lacks or that is changed twice, or one that makes an invalid lens; a position that
/// focuses no zoom position. The message begins with `where`, the name of the file or of the lens.
PETZVAL_API void validate(const Prescription& prescription, const std::string& where);

/// The lens in one of its configurations: the rows, the stop and the nominal data are those of the configuration. Its
/// own position and those that focus it stay in the list, so that `compile` knows how it focuses. Between two
/// neighbours thicknesses, radii, conics and semi-diameters are linear, and nominal data that differ are absent; of
/// positions that focus both at the same distances, the same is done. A prescription without configurations is its
/// configuration 0. Throws Error that lists the names for one that does not exist, and for a place between positions
/// of which one focuses another, or whose media or stops differ.
PETZVAL_API Prescription configured(const Prescription& prescription, const ConfigurationChoice& choice);

/// The lens, `factor` times as large. Powers of two change no digit. Throws Error for a factor that is not finite and
/// positive, and if a number would leave the normal range of double.
PETZVAL_API Prescription scale(const Prescription& prescription, double factor);

/// The reversed lens: the last surface comes first, and the old image space is in front of it. Light enters towards +z
/// again: z of the old lens frame is z_last - z in the new one, or z - z_last with an odd number of mirrors (z_last:
/// the old last vertex).
///
/// The place of the new film is unknown: the last thickness is 0. Data of one side are dropped: f_number,
/// half_field_deg, image_diagonal_mm, image_distance, design, positions that focus, and a changed thickness in front of
/// the film.
PETZVAL_API Prescription reverse(const Prescription& prescription);

}  // namespace petzval
