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

/// A lens as printed in its source: plain data that a program may edit. compile() turns it into a Lens.
///
///     petzval::Prescription singlet;
///     singlet.name = "singlet";
///     singlet.surfaces = {{.radius = 50, .thickness = 5, .medium = {.nd = 1.5168}, .semi_diameter = 12, .stop = true},
///                         {.radius = -50, .thickness = 48, .semi_diameter = 12}};
///     petzval::Lens lens = petzval::compile(singlet);
///
/// Strings keep the words of the file and are not interpreted.
struct Prescription {
  std::string id{};
  std::string name{};
  std::string source_design{};
  std::string source_numbers{};
  std::optional<double> focal_length_mm{};  ///< nominal, as printed in the source
  std::optional<double> f_number{};
  std::optional<double> half_field_deg{};
  std::optional<double> image_diagonal_mm{};
  double reference_wavelength_nm = d_line_nm;   ///< wavelength of the stated indices
  std::optional<std::string> semi_diameters{};  ///< origin of the semi-diameters
  std::optional<std::string> stop_size{};
  std::optional<std::string> image_distance{};
  std::optional<std::string> glass_names{};
  std::optional<std::string> notes{};
  std::vector<std::string> aliases{};
  std::optional<FileOrigin> imported{};  ///< nullopt for a lens in the library's own format
  DesignData design{};
  Medium object_space{};               ///< medium in front of the first surface; air unless a lens was reversed
  std::vector<SurfaceRow> surfaces{};  ///< from the object side to the film
  /// Zoom positions in order, and the positions that focus a zoom position. configured() applies a configuration.
  std::vector<Configuration> configurations{};

  bool operator==(const Prescription&) const = default;
};

/// Checks a prescription.
///
/// @param prescription  the lens
/// @param where         the name of the file or of the lens, the beginning of the message
/// @throws Error if a rule is broken:
/// - lens: 1 to 10,000 surfaces; all numbers are finite (clear apertures and subject distances may be infinite);
///   f-numbers are positive; wavelengths are 10 to 100,000 nm;
/// - surface: |radius| is at least 1e-12 mm, or 0 for a plane; |thickness| is below 1e10 mm (an object at infinity is
///   not a surface); the central obscuration is smaller than the semi-diameter; radius / sqrt|1 + conic| is at least
///   1e-15 mm; orders of aspheric terms are 2 to 40 and unique, and the slope of a term is below 1 up to 1e-12 mm;
/// - medium: the index is 0.1 to 5; V_d is not negative and needs an index or a glass; a mirror has the same medium on
///   both sides;
/// - configurations: at most 1,000, with unique names; the first is a zoom position, and focus positions belong to zoom
///   positions; a configuration changes a surface at most once, and its surfaces obey the rules.
PETZVAL_API void validate(const Prescription& prescription, const std::string& where);

/// The lens in one of its configurations, with the rows, the stop and the nominal data of the configuration.
///
/// The list keeps the chosen zoom position and the positions that focus it, so that compile() knows how the lens
/// focuses. Between two adjacent zoom positions, thicknesses, conics and semi-diameters are linear; radii are linear if
/// both have the same sign; otherwise the curvature is linear. Nominal data that differ become absent. Positions that
/// focus both zoom positions at the same distance are interpolated as well. A prescription without configurations is
/// its own configuration 0.
///
/// @throws Error with the names of the configurations if the choice does not exist; for a fraction, if one of the two
///               configurations focuses another, or if their media or stops differ
PETZVAL_API Prescription configured(const Prescription& prescription, const ConfigurationChoice& choice);

/// The lens scaled by a factor. Powers of two add no rounding error.
///
/// @throws Error if `factor` is not finite and positive, or if a number leaves the normal range of double
PETZVAL_API Prescription scale(const Prescription& prescription, double factor);

/// The reversed lens: the last surface becomes the first, and the old image space becomes object space.
///
/// Light enters towards +z again: z in the old lens frame becomes z_last - z, or z - z_last with an odd number of
/// mirrors, with z_last the z of the old last vertex. The position of the new film is unknown: the last thickness is 0.
/// Data that apply to one side are dropped: f_number, half_field_deg, image_diagonal_mm, image_distance, design,
/// positions that focus, and changes of the thickness in front of the film.
///
/// @throws Error if the lens has no surface
PETZVAL_API Prescription reverse(const Prescription& prescription);

}  // namespace petzval
