// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval {

class GlassCatalogue;

enum class FindingKind : std::uint8_t {
  focal_length,   ///< computed differs from declared by more than 2 %
  f_number,       ///< the same for the f-number of an exact ray
  overlap,        ///< neighbouring surfaces intersect inside their clear apertures
  semi_diameter,  ///< beyond the end of the surface (LensSurface), or 0 on a surface that is not the stop
  no_stop,
  several_stops,
  image_distance,  ///< the film is farther from the paraxial focus than 2 % of the focal length
  units,           ///< the lens is 10, 25.4 or 1000 times as large, or as small, as its declared focal length
  apertures,       ///< semi-diameters that are diameters, or halves of semi-diameters: the declared f-number tells
  idle_stop,       ///< a rim clips the axial beam well before the marked stop does
  glass_index,     ///< n_d is not that of the named glass
  film_size,       ///< a film several times as large as the image circle, or smaller than a fiftieth of it
  pixel_shape,     ///< pixels that are not square within 0.5 %, beyond the rounding to whole ones
};

/// "focal_length", "f_number", "overlap", ...
PETZVAL_API std::string_view name(FindingKind kind) noexcept;

/// A doubtful entry of a prescription. It is no failure: the lens can be traced as it is.
struct Finding {
  FindingKind kind{};
  std::optional<int> surface;  ///< from 0
  double found = 0;
  double wanted = 0;
  std::string message;  ///< one line, with units
};

/// Compares the declared data of a prescription, in its first configuration, with computed ones, at its reference
/// wavelength. The film is compared with the image of the design's object. Throws Error only for an invalid
/// prescription, and for a glass without a stated index that glass_tables() lack.
PETZVAL_API std::vector<Finding> lint(const Prescription& prescription);

/// The same with these glasses, and a check of the glasses: n_d of a medium must be within 0.005 of n_d of its glass.
PETZVAL_API std::vector<Finding> lint(const Prescription& prescription, const GlassCatalogue& glasses);

/// A prescription without the faults whose cure is certain, and what was changed.
struct Repaired {
  Prescription prescription;
  std::vector<ImportWarning> changes;  ///< command: the kind of the finding
};

/// Mends, in this order, what lint() finds beyond doubt: `units` by the factor, `apertures` by 2 or a half,
/// `several_stops` by the first, and `image_distance` by the paraxial image; not by what makes a lens invalid. Every
/// other finding, and a lens with configurations but for its stops, stays. glasses: as in CompileOptions. Throws Error
/// as lint() does.
PETZVAL_API Repaired repair(const Prescription& prescription, const GlassCatalogue* glasses = nullptr);

/// The film of a camera compared with the image circle of its lens (image_circle_mm, of any light): found is the
/// diameter of the circle about the axis that holds the film, wanted that of the image. A film is as large as one likes
/// up to three times the image circle. Of its pixels, found is the width over the height, wanted 1; those of a lens
/// with cylinders may have any shape. Throws Error for a film without area or pixels and other numbers that no Camera
/// takes, and where with_film() and image_circle_mm() do.
PETZVAL_API std::vector<Finding> lint(const Lens& lens, const Film& film);

}  // namespace petzval
