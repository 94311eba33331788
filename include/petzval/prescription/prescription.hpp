// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/core/units.hpp"

namespace petzval::inline v0 {

/// The medium behind a surface. nd is the printed index; the glass, if known, gives the dispersion.
struct Medium {
  std::optional<std::string> glass{};         ///< "N-BK7"
  std::optional<std::string> catalogue{};     ///< of the glass; absent: any
  std::optional<std::string> glass_origin{};  ///< "matched": found by nd and vd, not printed in the source
  double nd = 1;
  std::optional<double> vd{};

  bool operator==(const Medium&) const = default;
};

/// coefficient * r^order added to the sag; order 2 or more, even or odd; coefficient in mm^(1 - order).
struct AsphereTerm {
  int order = 4;
  double coefficient = 0;

  bool operator==(const AsphereTerm&) const = default;
};

/// The section in which a surface is curved: both, or one of them for a cylinder.
enum class Section { both, x, y };

/// One row of a lens table: a surface and what follows it. Millimetres.
struct SurfaceRow {
  double radius = 0;     ///< at the vertex; positive if the centre lies on the +z side; 0 is a plane
  double thickness = 0;  ///< to the next vertex (the last: to the film); negative where light runs backwards
  Medium medium{};       ///< behind the surface; of a mirror: the medium in front of it
  std::optional<double> semi_diameter{};              ///< of the clear aperture; absent: unlimited
  std::optional<double> obscuration_semi_diameter{};  ///< of a central obscuration; rays inside it are lost
  double conic = 0;                                   ///< k in c r^2 / (1 + sqrt(1 - (1+k) c^2 r^2))
  std::vector<AsphereTerm> aspheric{};
  bool stop = false;
  bool mirror = false;
  Section curved_in = Section::both;

  bool operator==(const SurfaceRow&) const = default;
};

/// The position of a zoom lens that a file describes: its variable thicknesses (mm) by surface number, from 0.
struct ZoomPosition {
  std::string position{};
  std::map<int, double> variable_gaps{};

  bool operator==(const ZoomPosition&) const = default;
};

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
  std::optional<ZoomPosition> zoom{};
  std::optional<std::string> notes{};
  std::vector<std::string> aliases{};
  Medium object_space{};               ///< before the first surface; air unless a lens was reversed
  std::vector<SurfaceRow> surfaces{};  ///< from the object side to the film

  bool operator==(const Prescription&) const = default;
};

/// Throws Error for a number that is not finite, |radius| below 1e-12 mm (0 is a plane), |thickness| of 1e10 mm or more
/// (an object at infinity is not a surface), an index outside 0 < n <= 5, a central obscuration not smaller than its
/// surface, an asphere order outside 2 to 40 or given twice, a mirror whose medium differs from the one in front of it,
/// no surface, or more than 10,000. The message begins with `where`, the name of the file or of the lens.
PETZVAL_API void validate(const Prescription& prescription, const std::string& where);

/// The lens, `factor` times as large. Powers of two change no digit. Throws Error for a factor that is not finite and
/// positive, and if a number would leave the normal range of double.
PETZVAL_API Prescription scale(const Prescription& prescription, double factor);

/// The reversed lens: the last surface comes first, and the old image space is in front of it. Light enters towards +z
/// again: z of the old lens frame is z_last - z in the new one, or z - z_last with an odd number of mirrors (z_last:
/// the old last vertex).
///
/// The place of the new film is unknown: the last thickness is 0. Data of one side are dropped: f_number,
/// half_field_deg, image_diagonal_mm, image_distance, and a variable thickness in front of the film.
PETZVAL_API Prescription reverse(const Prescription& prescription);

}  // namespace petzval::inline v0
